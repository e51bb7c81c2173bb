//! Membrane forces of the film, elastic and viscous, and ∂V/∂x.
//!
//! ```text
//! F = [x1 − x0, x2 − x0] Dm⁻¹     E = (FᵀF − 1)/2     energy = A t W(E)
//! [f1, f2] = −A t F (S + S_v) Dm⁻ᵀ                    f0 = −(f1 + f2)
//! ∂V/∂x_i = Σ_e (x1 − x0) × (x2 − x0)/6               over the elements e at node i
//! ```
//!
//! Constant-strain triangles, total Lagrangian: S of [`crate::mechanics::material`], `S_v` of
//! [`super::damping`]. The loop over the elements (`elements`) uses the metric of their edges instead
//! of F.

use nalgebra::Vector3;

use crate::geometry::field::Field;
use crate::mechanics::film_model::FilmModel;
use crate::mechanics::material::PlaneTensor;
use crate::platform::simd::{InstructionSet, NodeSum};

mod elements;
mod viscous_history;

pub use viscous_history::{ViscousHistory, viscous_forces};

use elements::{LaneSums, sum_elements};

/// Sums over all elements.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct MembraneSums {
    /// Six times the volume enclosed by the film and the closing faces, m³.
    pub six_volumes: f64,
    /// Energy dissipated by viscosity in the step, J: by the mean of the stress before and after it.
    pub viscous_work: f64,
    /// Largest principal second Piola-Kirchhoff stress, Pa, without its viscous part.
    pub largest_stress: f64,
}

impl LaneSums {
    fn sums(self) -> MembraneSums {
        MembraneSums {
            six_volumes: self.six_volumes.sum(),
            viscous_work: -0.5 * self.minus_twice_work.sum(),
            largest_stress: self.largest_stress.largest(),
        }
    }
}

/// Computes the membrane forces and ∂V/∂x of all nodes at these positions (m), into `out`.
///
/// `step` is the time since the previous call, s. Where it is 0 (no previous call, or nothing moved),
/// `S_v` is the stored one. Replaces `histories` by strain and viscous stress at these positions.
pub fn assemble_membrane(
    instruction_set: InstructionSet,
    model: &FilmModel,
    positions: &Field,
    step: f64,
    histories: &mut [[ViscousHistory; 2]],
    out: &mut NodeForces,
) -> MembraneSums {
    sum_elements(instruction_set, model, positions, step, histories, &mut out.sums).sums()
}

/// Columns of F of an element.
fn deformation_gradient(model: &FilmModel, field: &Field, element: usize) -> [Vector3<f64>; 2] {
    let [x0, x1, x2] = model.triangles[element].map(|node| field.get(node as usize));
    let [a, b, c, d] = model.inverse_shape.each_ref().map(|column| column[element]);
    let (p, q) = (x1 - x0, x2 - x0);
    [p * a + q * c, p * b + q * d]
}

/// Green strain of an element at these positions (m).
pub fn strain(model: &FilmModel, positions: &Field, element: usize) -> PlaneTensor {
    let [f, g] = deformation_gradient(model, positions, element);
    PlaneTensor { xx: (f.dot(&f) - 1.0) * 0.5, yy: (g.dot(&g) - 1.0) * 0.5, xy: f.dot(&g) * 0.5 }
}

/// Strain energy Σ A t W of the film at these positions (m), J.
pub fn strain_energy(model: &FilmModel, positions: &Field) -> f64 {
    (0..model.elements())
        .map(|element| {
            let strain = strain(model, positions, element);
            model.volume[element] * model.material.energy_density(strain)
        })
        .sum()
}

/// Factor from the sum of the normals (x1 − x0) × (x2 − x0) at a node to ∂V/∂x; V = Σ x0·(x1 × x2)/6.
pub(crate) const NORMAL_TO_GRADIENT: f64 = 1.0 / 6.0;

/// Forces on the nodes.
#[derive(Debug, Clone, PartialEq)]
pub struct NodeForces {
    /// Membrane force and 6 ∂V/∂x of each node.
    pub(crate) sums: Vec<NodeSum>,
    /// Contact force on each node, N.
    pub contact: Field,
}

impl NodeForces {
    /// Zero forces on the nodes of a model.
    pub fn new(model: &FilmModel) -> Self {
        let sums = vec![NodeSum::default(); model.nodes()];
        Self { sums, contact: Field::zeros(model.nodes()) }
    }

    /// Membrane force on a node, elastic and viscous, N.
    #[inline]
    pub fn film(&self, node: usize) -> Vector3<f64> {
        let [x, y, z, _] = self.sums[node].film;
        Vector3::new(x, y, z)
    }

    /// ∂V/∂x of a node, m².
    #[inline]
    pub fn area(&self, node: usize) -> Vector3<f64> {
        let [x, y, z, _] = self.sums[node].normal;
        Vector3::new(x, y, z) * NORMAL_TO_GRADIENT
    }

    /// Membrane forces on all nodes, N.
    pub fn films(&self) -> Field {
        Field::of(&(0..self.sums.len()).map(|node| self.film(node)).collect::<Vec<_>>())
    }

    /// ∂V/∂x of all nodes, m².
    pub fn areas(&self) -> Field {
        Field::of(&(0..self.sums.len()).map(|node| self.area(node)).collect::<Vec<_>>())
    }

    /// Sets the membrane force (N) on a node.
    pub(crate) fn set_film(&mut self, node: usize, force: Vector3<f64>) {
        self.sums[node].film[..3].copy_from_slice(force.as_slice());
    }

    /// Adds the normal (m²) of a closing face to a node: a sixth of it to ∂V/∂x.
    pub(crate) fn add_normal(&mut self, node: usize, normal: Vector3<f64>) {
        for (sum, entry) in self.sums[node].normal.iter_mut().zip(&normal) {
            *sum += entry;
        }
    }

    /// Multiplies ∂V/∂x of a node by a factor.
    pub(crate) fn scale_area(&mut self, node: usize, factor: f64) {
        self.sums[node].normal.iter_mut().for_each(|entry| *entry *= factor);
    }
}
