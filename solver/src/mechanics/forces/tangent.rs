//! Tangent stiffness of an element: minus the change of its nodal forces with the positions of its nodes.
//!
//! ```text
//! K_ab = A t [(g_a·S g_b) 1 + B_aᵀ D B_b] − K_p,ab       D = ∂²W/∂e²
//! D = C                                        taut
//!   = E v1 v1ᵀ + 2E e1/(e1 − e2) v2 v2ᵀ        wrinkled; v1: n⊗n, v2: sym(n⊗m)
//!   = 0                                        slack
//! D ← D + c (C − D)
//! K_p,ab = p/12 [e_b − e_a]×                   pressure p, e_a the edge opposite corner a
//! ```
//!
//! Symbols: g gradients of the shape functions of the corners (1/m), B strain of a unit displacement, n
//! direction of tension, m direction across it, c compression fraction. D is positive semidefinite in
//! every regime; for c = 0 so is K without the pressure. Film that creeps has S(Ê) and (1 + g) D(Ê), at a fixed
//! creep strain. The tangent of a follower pressure is not
//! symmetric element by element; `K_p` is its symmetric part. The antisymmetric part cancels over a closed
//! surface, and over an open surface whose edge is held or slides in planes.

use nalgebra::{Matrix3, Matrix3x2, SMatrix, SVector, Vector2, Vector3};

use crate::geometry::field::Field;
use crate::mechanics::film_model::FilmModel;
use crate::mechanics::forces::membrane::{CreepStrain, strain, strain_of};
use crate::mechanics::material::{Material, PlaneTensor, Regime};
use crate::platform::simd::WIDTH;

/// Stiffness of three nodes, three components each, N/m.
pub type Stiffness = SMatrix<f64, 9, 9>;

/// D at a strain, Pa, for the strain components (xx, yy, 2xy).
pub fn material_tangent(material: &Material, strain: PlaneTensor) -> Matrix3<f64> {
    let (k, nu) = (material.plane_modulus(), material.poisson_ratio);
    let full = Matrix3::new(k, k * nu, 0.0, k * nu, k, 0.0, 0.0, 0.0, 0.5 * k * (1.0 - nu));
    let relaxed = match material.regime(strain) {
        Regime::Taut => full,
        Regime::Wrinkled => {
            let (first, second) = strain.principal();
            let difference = first - second;
            let cos = (strain.xx - strain.yy) / difference;
            let sin = 2.0 * strain.xy / difference;
            let along = Vector3::new(0.5 * (1.0 + cos), 0.5 * (1.0 - cos), 0.5 * sin);
            let shear = Vector3::new(-0.5 * sin, 0.5 * sin, 0.5 * cos);
            let modulus = material.youngs_modulus;
            along * along.transpose() * modulus
                + shear * shear.transpose() * (2.0 * modulus * first / difference)
        }
        Regime::Slack => Matrix3::zeros(),
    };
    relaxed + (full - relaxed) * material.compression
}

/// Elastic stiffness of an element of film without loss with its nodes at these positions (m).
pub fn elastic(model: &FilmModel, positions: &Field, element: usize) -> Stiffness {
    let corners = positions.at(model.triangles[element]);
    let inverse_shape = model.inverse_shape.each_ref().map(|column| column[element]);
    let strain = strain(model, positions, element);
    let tangent = material_tangent(&model.material, strain);
    let stress = model.material.stress(strain).tensor;
    of_element(corners, inverse_shape, model.volume[element], stress, &tangent)
}

/// Nodes and elastic stiffness of every element at these positions (m) and creep strains; no creep strains for
/// film without loss.
pub fn elements<'a>(
    model: &'a FilmModel,
    creep: &'a [[CreepStrain; 2]],
    positions: &'a Field,
) -> Box<dyn Iterator<Item = ([u32; 3], Stiffness)> + 'a> {
    if creep.is_empty() {
        let triangles = model.triangles.iter().enumerate();
        return Box::new(
            triangles.map(|(element, nodes)| (*nodes, elastic(model, positions, element))),
        );
    }
    let halves = model.kites.iter().enumerate().flat_map(|(index, kite)| {
        let [s, a, t, b] = *kite;
        [(index, 0, [s, a, t]), (index, 1, [s, t, b])]
    });
    Box::new(halves.filter_map(move |(index, half, nodes)| {
        let (block, lane) = (index / WIDTH, index % WIDTH);
        let constants = &model.constants[block][half];
        let volume = -constants.minus_volume.0[lane];
        if volume <= 0.0 {
            return None;
        }
        let [a, b, d] = constants.inverse_shape.each_ref().map(|lanes| lanes.0[lane]);
        let corners = positions.at(nodes);
        let inverse_shape = [a, b, 0.0, d];
        let (total, ratio) = (strain_of(corners, inverse_shape), model.creep.ratio);
        let [sum, difference, shear] = creep[block][half].lane(lane);
        let elastic = PlaneTensor {
            xx: total.xx + ratio * (total.xx - 0.5 * (sum + difference)),
            yy: total.yy + ratio * (total.yy - 0.5 * (sum - difference)),
            xy: total.xy + ratio * (total.xy - 0.5 * shear),
        };
        let tangent = material_tangent(&model.material, elastic) * (1.0 + ratio);
        let stress = model.material.stress(elastic).tensor;
        Some((nodes, of_element(corners, inverse_shape, volume, stress, &tangent)))
    }))
}

/// Stiffness of an element with these corners (m), Dm⁻¹ (row by row, 1/m), volume A t (m³), stress (Pa) and
/// material tangent (Pa).
fn of_element(
    corners: [Vector3<f64>; 3],
    [a, b, c, d]: [f64; 4],
    volume: f64,
    stress: PlaneTensor,
    tangent: &Matrix3<f64>,
) -> Stiffness {
    let slopes = [Vector2::new(-(a + c), -(b + d)), Vector2::new(a, b), Vector2::new(c, d)];
    let (p, q) = (corners[1] - corners[0], corners[2] - corners[0]);
    let gradient = Matrix3x2::from_columns(&[p * a + q * c, p * b + q * d]);
    // Strain of a displacement u of corner i: `slopes[i]` (u·f, u·g), f and g the columns of the gradient.
    let strain_matrices =
        slopes.map(|slope| Matrix3x2::new(slope.x, 0.0, 0.0, slope.y, slope.y, slope.x));
    let mut stiffness = Stiffness::zeros();
    for i in 0..3 {
        let left = strain_matrices[i].transpose() * tangent * volume;
        for j in 0..=i {
            let (s, r) = (slopes[i], slopes[j]);
            let initial_stress =
                stress.xx * s.x * r.x + stress.yy * s.y * r.y + stress.xy * (s.x * r.y + s.y * r.x);
            let core = left * strain_matrices[j];
            let mut block = gradient * core * gradient.transpose();
            for axis in 0..3 {
                block[(axis, axis)] += initial_stress * volume;
            }
            stiffness.fixed_view_mut::<3, 3>(3 * i, 3 * j).copy_from(&block);
            if i != j {
                stiffness.fixed_view_mut::<3, 3>(3 * j, 3 * i).copy_from(&block.transpose());
            }
        }
    }
    stiffness
}

/// Adds K u of faces with these stiffnesses, N, of displacements u (m) to `products`.
pub fn add_products(
    faces: &[[u32; 3]],
    stiffness: &[Stiffness],
    displacements: &Field,
    products: &mut Field,
) {
    for (nodes, stiffness) in faces.iter().zip(stiffness) {
        let u = displacements.at(*nodes);
        let u = SVector::<f64, 9>::from_fn(|row, _| u[row / 3][row % 3]);
        let f = stiffness * u;
        for (corner, node) in nodes.iter().enumerate() {
            let node = *node as usize;
            products.set(node, products.get(node) + f.fixed_rows::<3>(3 * corner));
        }
    }
}

/// Stiffness of a pressure (Pa) on a face at these positions (m), N/m.
pub fn pressure(face: [u32; 3], positions: &Field, pressure: f64) -> Stiffness {
    let mut stiffness = Stiffness::zeros();
    add_pressure(&mut stiffness, face, positions, pressure);
    stiffness
}

/// Adds the stiffness of a pressure (Pa) on a face at these positions (m).
pub fn add_pressure(stiffness: &mut Stiffness, face: [u32; 3], positions: &Field, pressure: f64) {
    let [a, b, c] = positions.at(face);
    let edges = [c - b, a - c, b - a];
    for i in 0..3 {
        for j in 0..i {
            // The matrix of the cross product v×; the block across the diagonal is its transpose.
            let v = (edges[i] - edges[j]) * (pressure / 12.0);
            for (row, column, entry) in [(0, 1, -v.z), (0, 2, v.y), (1, 2, -v.x)] {
                stiffness[(3 * i + row, 3 * j + column)] += entry;
                stiffness[(3 * i + column, 3 * j + row)] -= entry;
                stiffness[(3 * j + column, 3 * i + row)] += entry;
                stiffness[(3 * j + row, 3 * i + column)] -= entry;
            }
        }
    }
}
