//! The longest stable step: measured, from the assembled stiffness, and from the element bound.
//!
//! ```text
//! Δt = 2/ω_max                ω_max²: largest eigenvalue of M⁻¹K, by power iteration
//! ω_max ≤ max ω_e             Rayleigh quotient: what the explicit step relies on
//! ```
//!
//! K is assembled here from the gradients of the reference, not by the solver. The measured limit is
//! found by bisection: a small motion grows beyond it.

use billow_solver::geometry::shapes::{pseudo_random, sheet};
use billow_solver::geometry::shell::Shell;
use billow_solver::integrators::SimulationSettings;
use billow_solver::mechanics::film_model::FilmModel;
use billow_solver::scene::Film;
use billow_solver::scene::film_scene::FilmScene;
use billow_solver::scene::paper::free_film;
use billow_solver::scene::timeline::Phase;
use nalgebra::{Matrix2x3, Vector2, Vector3};

use super::reference::number;
use super::{Outcome, Rig, Row};

/// The in-plane strain-displacement gradients of an element's reference, corner by corner.
fn gradients([a, b, c]: [Vector2<f64>; 3]) -> Matrix2x3<f64> {
    let (p, q) = (b - a, c - a);
    let twice = p.perp(&q);
    let first = Vector2::new(q.y, -q.x) / twice;
    let second = Vector2::new(-p.y, p.x) / twice;
    Matrix2x3::from_columns(&[-(first + second), first, second])
}

/// ω of the fastest mode of flat film at rest, rad/s.
pub fn assembled(shell: &Shell, film: &Film, model: &FilmModel) -> f64 {
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

/// Whether a small motion in the plane grows with this fraction of the step 2/ω.
fn grows(rig: &Rig, shell: &Shell, film: &Film, fraction: f64, omega: f64) -> Result<bool, String> {
    let kick = |kick: &Vector3<f64>| Vector3::new(kick.x, kick.y, 0.0) * 1e-6;
    let velocities = pseudo_random(shell.positions.len(), 4).iter().map(kick).collect();
    let moving = rig.start(&FilmScene { velocities, ..free_film(shell.clone(), *film) })?;
    let cfl = fraction * moving.view().system.model.largest_frequency() / omega;
    let mut moving =
        moving.with(|system, settings| (system, SimulationSettings { cfl, ..settings }));
    let target = 3000.0 * moving.view().next_step();
    if moving.advance(target, &Phase::default()).is_err() {
        return Ok(true);
    }
    let fastest = moving.view().state.velocities.iter().map(|v| v.norm()).fold(0.0, f64::max);
    Ok(fastest > 1e-3)
}

/// The limits of three uneven sheets.
pub fn step_limit(rig: &Rig) -> Outcome {
    let film = Film { compression: 1.0, ..Film::PAPER_ELASTIC };
    let mut judged = Vec::new();
    for (columns, rows, width, height) in [(4, 3, 0.2, 0.15), (6, 2, 0.1, 0.15), (3, 5, 0.4, 0.05)]
    {
        let shell = sheet(columns, rows, width, height);
        let model = FilmModel::of_shell(&film, &shell).map_err(|error| error.to_string())?;
        let omega = assembled(&shell, &film, &model);
        let (mut stable, mut unstable) = (0.9, 1.1);
        if grows(rig, &shell, &film, stable, omega)? || !grows(rig, &shell, &film, unstable, omega)?
        {
            return Err("the limit is not between 0.9 and 1.1 of 2/omega_max".to_owned());
        }
        while unstable - stable > 1e-3 {
            let middle = 0.5 * (stable + unstable);
            if grows(rig, &shell, &film, middle, omega)? {
                unstable = middle;
            } else {
                stable = middle;
            }
        }
        let limit = 0.5 * (stable + unstable);
        let name = format!("sheet {columns} x {rows}");
        let band = number("step_limit/band");
        judged.push(Row::new(&format!("{name}: limit over 2/omega_max"), limit, 1.0, band));
        let share = omega / model.largest_frequency();
        judged.push(Row::at_most(&format!("{name}: omega_max over element bound"), share, 1.0));
    }
    Ok(judged)
}
