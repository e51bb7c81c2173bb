//! Stiffness of contacts: second derivatives of their energies.
//!
//! ```text
//! d = min_s |r|,  r = Σ w_i(s) x_i        n = r/d
//! ∂d/∂x_i = w_i n
//! ∂²(½ d²)/∂x_i∂x_j = w_i w_j 1 − Σ_kl c_ki (A⁻¹)_kl c_ljᵀ
//!     A_kl = r_k·r_l       c_ki = (∂w_i/∂s_k) r + w_i r_k       r_k = ∂r/∂s_k
//! ∂²E/∂x_i∂x_j = E″ w_i w_j n nᵀ + E′/d (∂²(½ d²)/∂x_i∂x_j − w_i w_j n nᵀ)
//! ```
//!
//! Symbols: s free parameters of the closest points: none at a node, one on an edge, two on an element or of
//! two edges; w their weights. The sum over k, l is Schur's complement of the minimum over s.

use nalgebra::{Matrix3, Vector3};

use super::distance::Closest;
use super::force_law::Contact;
use super::model::ContactModel;
use super::pair::PairKind;
use super::state::ContactState;
use crate::geometry::field::Field;
use crate::mechanics::energy_term::Blocks;
use crate::mechanics::film_model::FilmModel;

/// A free parameter of closest points: ∂w/∂s.
type WeightRate = [f64; 4];

impl ContactModel {
    /// Gives the blocks of the stiffness of contacts and plates, as they were found at these positions (m).
    /// `time` (s): that of the plates.
    pub fn stiffness(
        &self,
        film: &FilmModel,
        state: &ContactState,
        positions: &Field,
        time: f64,
        add: Blocks<'_>,
    ) {
        for contact in &state.contacts {
            self.pair_blocks(contact, positions, add);
        }
        for (plate, plate_state) in self.plates.iter().zip(&state.plates) {
            let height = plate.height(time);
            let blocks = plate.normal * plate.normal.transpose();
            for (node, offset) in (0_u32..).zip(&plate_state.offsets) {
                let gap = plate.normal.dot(&positions.get(node as usize)) - height;
                let penetration = offset - gap;
                if penetration > 0.0 {
                    let stiffness = self.stiffness_per_mass * film.mass[node as usize] / offset;
                    add([node, node], &(blocks * (stiffness * penetration)));
                }
            }
        }
    }

    fn pair_blocks(&self, contact: &Contact, positions: &Field, add: Blocks<'_>) {
        let nodes = contact.pair.nodes(&self.mesh.topology);
        let x = positions.at(nodes);
        let Closest { weights, between, squared } = contact.pair.closest(&x);
        let gap = squared.sqrt();
        let range = self.adhesion.range;
        let slope = contact.adhesive_force(gap, range) - contact.repulsive_force(gap);
        let curvature = contact.repulsive_stiffness(gap) + contact.adhesive_stiffness(gap, range);
        if gap <= 0.0 || (slope == 0.0 && curvature == 0.0) {
            return;
        }
        let normal = between / gap;
        let along = normal * normal.transpose();
        let rates = free_parameters(contact.pair.kind, &weights);
        let coupling = Coupling::new(&rates, &weights, &x, between);
        for i in 0..4 {
            for j in 0..4 {
                let product = weights[i] * weights[j];
                let half_square = Matrix3::identity() * product - coupling.block(i, j);
                let block =
                    along * (product * curvature) + (half_square - along * product) * (slope / gap);
                add([nodes[i], nodes[j]], &block);
            }
        }
    }
}

/// The free parameters of closest points with these weights. A weight is exactly 0 where its node does not
/// belong to the closest feature.
fn free_parameters(kind: PairKind, weights: &[f64; 4]) -> Vec<WeightRate> {
    let groups: &[&[usize]] = match kind {
        PairKind::NodeElement => &[&[1, 2, 3]],
        PairKind::EdgeEdge => &[&[0, 1], &[2, 3]],
    };
    let mut rates = Vec::new();
    for group in groups {
        let mut active = group.iter().filter(|node| weights[**node] != 0.0);
        let Some(first) = active.next() else { continue };
        for other in active {
            let mut rate = [0.0; 4];
            (rate[*first], rate[*other]) = (-1.0, 1.0);
            rates.push(rate);
        }
    }
    rates
}

/// The sum over k and l of a pair.
struct Coupling {
    /// `c_ki`, for k and i.
    columns: Vec<[Vector3<f64>; 4]>,
    /// A⁻¹, of as many rows as columns.
    inverse: [[f64; 2]; 2],
}

/// Determinant of A over the product of its diagonal below which its parameters count as one: parallel
/// edges. Chosen: far above rounding.
const MIN_DETERMINANT: f64 = 1e-12;

impl Coupling {
    fn new(
        rates: &[WeightRate],
        weights: &[f64; 4],
        x: &[Vector3<f64>; 4],
        between: Vector3<f64>,
    ) -> Self {
        let slope = |rate: &WeightRate| -> Vector3<f64> { (0..4).map(|i| x[i] * rate[i]).sum() };
        let slopes: Vec<Vector3<f64>> = rates.iter().map(slope).collect();
        let mut columns: Vec<[Vector3<f64>; 4]> = rates
            .iter()
            .zip(&slopes)
            .map(|(rate, slope)| core::array::from_fn(|i| between * rate[i] + slope * weights[i]))
            .collect();
        let entry = |k: usize, l: usize| slopes[k].dot(&slopes[l]);
        let mut inverse = [[0.0; 2]; 2];
        if columns.len() == 2 {
            let (a, b, d) = (entry(0, 0), entry(0, 1), entry(1, 1));
            let determinant = a * d - b * b;
            if determinant > MIN_DETERMINANT * a * d {
                inverse = [[d, -b], [-b, a]].map(|row| row.map(|entry| entry / determinant));
            } else {
                columns.truncate(1);
            }
        }
        if columns.len() == 1 {
            inverse[0][0] = 1.0 / entry(0, 0);
        }
        Self { columns, inverse }
    }

    fn block(&self, i: usize, j: usize) -> Matrix3<f64> {
        let mut sum = Matrix3::zeros();
        for (k, left) in self.columns.iter().enumerate() {
            for (l, right) in self.columns.iter().enumerate() {
                sum += left[i] * right[j].transpose() * self.inverse[k][l];
            }
        }
        sum
    }
}
