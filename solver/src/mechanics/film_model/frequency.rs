//! The largest in-plane frequency of one element with lumped mass.
//!
//! ```text
//! K = A t Bᵀ C B       M = (ρ t A/3) 1       ω² = largest eigenvalue of M⁻¹K = (3/ρ) λ(C B Bᵀ)
//! ```
//!
//! B (3×6) maps corner displacements to the strains (exx, eyy, 2exy); C is the plane-stress
//! stiffness. Three of the six eigenvalues are zero (rigid motions). The others are the eigenvalues of
//! the symmetric 3×3 matrix Lᵀ B Bᵀ L, C = L Lᵀ, computed by Jacobi rotations.

use crate::mechanics::material::Material;

/// `ω_e`, rad/s, of an element with this Dm⁻¹ (row by row, 1/m) and density ρ (kg/m³).
pub fn largest_frequency(material: &Material, density: f64, inverse_shape: [f64; 4]) -> f64 {
    let [a, b, c, d] = inverse_shape;
    // Gradients of the shape functions: minus the sum of the rows of Dm⁻¹, then the rows.
    let gradients = [[-(a + c), -(b + d)], [a, b], [c, d]];
    let (mut xx, mut yy, mut xy) = (0.0, 0.0, 0.0);
    for [x, y] in gradients {
        xx += x * x;
        yy += y * y;
        xy += x * y;
    }
    let b_bt = [[xx, 0.0, xy], [0.0, yy, xy], [xy, xy, xx + yy]];
    let nu = material.poisson_ratio;
    // L of [[1, ν, 0], [ν, 1, 0], [0, 0, (1−ν)/2]].
    let lower =
        [[1.0, 0.0, 0.0], [nu, (1.0 - nu * nu).sqrt(), 0.0], [0.0, 0.0, (0.5 * (1.0 - nu)).sqrt()]];
    let mut matrix = [[0.0; 3]; 3];
    for (row, entries) in matrix.iter_mut().enumerate() {
        for (column, entry) in entries.iter_mut().enumerate() {
            for (k, row_of_b_bt) in b_bt.iter().enumerate() {
                for (l, value) in row_of_b_bt.iter().enumerate() {
                    *entry += lower[k][row] * value * lower[l][column];
                }
            }
        }
    }
    (3.0 * material.plane_modulus() / density * largest_eigenvalue(matrix)).sqrt()
}

/// Cyclic Jacobi sweeps. Chosen: convergence is quadratic, a 3×3 matrix needs about 5.
const JACOBI_SWEEPS: usize = 12;

/// Largest eigenvalue of a symmetric matrix, by cyclic Jacobi rotations.
fn largest_eigenvalue(mut a: [[f64; 3]; 3]) -> f64 {
    for _ in 0..JACOBI_SWEEPS {
        for (p, q) in [(0, 1), (0, 2), (1, 2)] {
            if a[p][q] == 0.0 {
                continue;
            }
            let theta = (a[q][q] - a[p][p]) / (2.0 * a[p][q]);
            let sign = if theta < 0.0 { -1.0 } else { 1.0 };
            let tangent = sign / (theta.abs() + (theta * theta + 1.0).sqrt());
            let cos = 1.0 / (tangent * tangent + 1.0).sqrt();
            let sin = tangent * cos;
            let rotate =
                |left: f64, right: f64| (cos * left - sin * right, sin * left + cos * right);
            for row in &mut a {
                (row[p], row[q]) = rotate(row[p], row[q]);
            }
            let (upper, lower) = (a[p], a[q]);
            for k in 0..3 {
                (a[p][k], a[q][k]) = rotate(upper[k], lower[k]);
            }
        }
    }
    a[0][0].max(a[1][1]).max(a[2][2])
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::scene::Film;

    #[test]
    fn jacobi_rotations_find_a_known_largest_eigenvalue() {
        // Eigenvalues 1, 2, 4.
        let matrix = [[3.0, 1.0, 0.0], [1.0, 3.0, 0.0], [0.0, 0.0, 1.0]];
        assert!((largest_eigenvalue(matrix) - 4.0).abs() < 1e-15);
        let full = [[2.0, -1.0, 0.0], [-1.0, 2.0, -1.0], [0.0, -1.0, 2.0]];
        assert!((largest_eigenvalue(full) - (2.0 + core::f64::consts::SQRT_2)).abs() < 1e-14);
    }

    /// The stable step in units of h/c (h height, c wave speed) equals its closed form.
    #[test]
    fn frequency_of_an_equilateral_triangle_is_its_closed_form() {
        let height = 0.75_f64.sqrt();
        // X = (0, 0), (1, 0), (1/2, h): Dm = [[1, 1/2], [0, h]].
        let inverse = [1.0, -0.5 / height, 0.0, 1.0 / height];
        let film = Film { numerical_damping: 0.0, ..Film::PAPER };
        let material = Material::new(&film);
        let omega = largest_frequency(&material, film.density, inverse);
        let speed = (material.plane_modulus() / film.density).sqrt();
        let factor = 2.0 / omega * speed / height;
        // BBᵀ = [[2, 0, 0], [0, 2, 0], [0, 0, 4]]: λ = 2(1 + ν), dt = 2h'/c √(1/(3·2(1+ν))).
        let expected = 2.0 / (6.0 * 1.3_f64).sqrt() / height;
        assert!((factor / expected - 1.0).abs() < 1e-14, "{factor} {expected}");
        assert!((factor - 0.827).abs() < 5e-4, "{factor}");
    }
}
