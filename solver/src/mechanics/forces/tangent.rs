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
//! every regime; for c = 0 so is K without the pressure. The tangent of a follower pressure is not
//! symmetric element by element; `K_p` is its symmetric part. The antisymmetric part cancels over a closed
//! surface, and over an open surface whose edge is held or slides in planes.

use nalgebra::{Matrix3, Matrix3x2, SMatrix, Vector2, Vector3};

use crate::geometry::field::Field;
use crate::mechanics::film_model::FilmModel;
use crate::mechanics::forces::membrane::strain;
use crate::mechanics::material::{Material, PlaneTensor, Regime};

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

/// Elastic stiffness of an element with its nodes at these positions (m).
pub fn elastic(model: &FilmModel, positions: &Field, element: usize) -> Stiffness {
    let corners = model.triangles[element].map(|node| positions.get(node as usize));
    let [a, b, c, d] = model.inverse_shape.each_ref().map(|column| column[element]);
    let slopes = [Vector2::new(-(a + c), -(b + d)), Vector2::new(a, b), Vector2::new(c, d)];
    let (p, q) = (corners[1] - corners[0], corners[2] - corners[0]);
    let gradient = Matrix3x2::from_columns(&[p * a + q * c, p * b + q * d]);
    let strain = strain(model, positions, element);
    let stress = model.material.stress(strain).tensor;
    let tangent = material_tangent(&model.material, strain);
    let volume = model.volume[element];
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

/// Stiffness of a pressure (Pa) on a face at these positions (m), N/m.
pub fn pressure(face: [u32; 3], positions: &Field, pressure: f64) -> Stiffness {
    let mut stiffness = Stiffness::zeros();
    add_pressure(&mut stiffness, face, positions, pressure);
    stiffness
}

/// Adds the stiffness of a pressure (Pa) on a face at these positions (m).
pub fn add_pressure(stiffness: &mut Stiffness, face: [u32; 3], positions: &Field, pressure: f64) {
    let [a, b, c] = face.map(|node| positions.get(node as usize));
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
