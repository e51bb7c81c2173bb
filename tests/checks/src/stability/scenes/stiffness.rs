//! The fastest mode of flat film at rest, from its assembled stiffness.
//!
//! ```text
//! ω_max²: largest eigenvalue of M⁻¹K, by power iteration
//! ```
//!
//! K is assembled here from the gradients of the reference, not by the solver.

use crate::cases::prelude::*;
use billow_solver::mechanics::film_model::FilmModel;
use nalgebra::{Matrix2x3, Vector2};

/// The in-plane strain-displacement gradients of an element's reference, corner by corner.
fn gradients([a, b, c]: [Vector2<f64>; 3]) -> Matrix2x3<f64> {
    let (p, q) = (b - a, c - a);
    let twice = p.perp(&q);
    let first = Vector2::new(q.y, -q.x) / twice;
    let second = Vector2::new(-p.y, p.x) / twice;
    Matrix2x3::from_columns(&[-(first + second), first, second])
}

/// Its ω, rad/s.
pub(super) fn fastest_mode(shell: &Shell, film: &Film, model: &FilmModel) -> f64 {
    let nu = film.poisson_ratio;
    let k = film.youngs_modulus / (1.0 - nu * nu);
    let mut mode = pseudo_random(shell.positions.len(), 1);
    let mut value = 0.0;
    for _ in 0..4000 {
        let mut force = vec![Vector3::<f64>::zeros(); mode.len()];
        for (element, triangle) in shell.triangles.iter().enumerate() {
            let g = gradients(shell.reference[element]);
            let u = triangle.map(|node| mode[node as usize]);
            let (mut xx, mut yy, mut xy) = (0.0, 0.0, 0.0);
            for corner in 0..3 {
                xx += g[(0, corner)] * u[corner].x;
                yy += g[(1, corner)] * u[corner].y;
                xy += g[(1, corner)] * u[corner].x + g[(0, corner)] * u[corner].y;
            }
            let (sx, sy) = (k * (xx + nu * yy), k * (yy + nu * xx));
            let t = 0.5 * k * (1.0 - nu) * xy;
            for corner in 0..3 {
                let (gx, gy) = (g[(0, corner)], g[(1, corner)]);
                let nodal = Vector3::new(gx * sx + gy * t, gy * sy + gx * t, 0.0);
                force[triangle[corner] as usize] += nodal * model.volume[element];
            }
        }
        let next: Vec<Vector3<f64>> =
            force.iter().zip(&model.mass).map(|(force, mass)| force / *mass).collect();
        let norm = next.iter().map(Vector3::norm_squared).sum::<f64>().sqrt();
        value = norm / mode.iter().map(Vector3::norm_squared).sum::<f64>().sqrt();
        mode = next.iter().map(|v| v / norm).collect();
    }
    value.sqrt()
}
