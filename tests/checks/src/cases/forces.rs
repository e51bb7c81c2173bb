//! Forces compared with their energies.
//!
//! ```text
//! conservative:  f = −∂W/∂x      inside each regime, by central differences, relative to E t h
//!                ∫ f·dx = −ΔW    along a path through all regimes
//! dissipative:   Σ f·v = −power ≤ 0,  Σ f = 0,  Σ x × f = 0
//! ```

use billow_solver::geometry::field::Field;
use billow_solver::geometry::shapes::{icosphere, pseudo_random, sheet};
use billow_solver::geometry::shell::Shell;
use billow_solver::integrators::FilmSimulation;
use billow_solver::mechanics::forces::membrane::{numerical_forces, strain, strain_energy};
use billow_solver::mechanics::forces::pressure;
use billow_solver::mechanics::material::Regime;
use billow_solver::scene::Film;
use billow_solver::scene::film_scene::FilmScene;
use billow_solver::scene::paper::free_film;
use billow_solver::scene::timeline::Phase;
use nalgebra::{Rotation3, Vector3};

use super::reference::number;
use super::rig::{advance, explicit};
use super::row::worse;
use super::{Outcome, Rig, Row};

/// Film of this shape at these positions (m) and velocities (m/s).
fn film_at(
    rig: &Rig,
    shell: &Shell,
    film: Film,
    positions: Vec<Vector3<f64>>,
    velocities: Vec<Vector3<f64>>,
) -> Result<FilmSimulation, String> {
    let shell = Shell { positions, ..shell.clone() };
    rig.start(&FilmScene { velocities, ..free_film(shell, film) })
}

/// Largest difference between a force and minus the central difference of its energy, over all
/// nodes and components.
fn defect(force: &Field, positions: &Field, step: f64, energy: impl Fn(&Field) -> f64) -> f64 {
    let mut worst = 0.0_f64;
    for node in 0..positions.len() {
        for axis in 0..3 {
            let energy_at = |by: f64| {
                let mut shifted = positions.clone();
                let mut position = shifted.get(node);
                position[axis] += by;
                shifted.set(node, position);
                energy(&shifted)
            };
            let slope = (energy_at(step) - energy_at(-step)) / (2.0 * step);
            worst = worse(worst, (force.get(node)[axis] + slope).abs());
        }
    }
    worst
}

/// A sheet stretched by (1 + a, 1 + b), slightly uneven, rotated in space.
fn stretched(shell: &Shell, a: f64, b: f64) -> Vec<Vector3<f64>> {
    let turn = Rotation3::from_euler_angles(0.4, -0.9, 1.3);
    let bumps = pseudo_random(shell.positions.len(), 3);
    let position = |(x, bump): (&Vector3<f64>, Vector3<f64>)| {
        turn * (Vector3::new(x.x * (1.0 + a), x.y * (1.0 + b), 0.0) + bump * 1e-5)
    };
    shell.positions.iter().zip(bumps).map(position).collect()
}

/// The sheet of these cases.
fn test_sheet() -> Shell {
    sheet(4, 3, 0.2, 0.15)
}

/// Every conservative force against finite differences of its energy, inside each regime.
pub fn force_energy(rig: &Rig) -> Outcome {
    let (shell, cell, band) = (test_sheet(), 0.05, number("forces/band"));
    let regimes = [
        ("taut", 5e-3, 4e-3, Regime::Taut),
        ("wrinkled", 6e-3, -5e-3, Regime::Wrinkled),
        ("slack", -6e-3, -5e-3, Regime::Slack),
        ("folded", -0.2, -0.3, Regime::Slack),
    ];
    let mut judged = Vec::new();
    for compression in [0.0, 0.01, 1.0] {
        for (name, a, b, regime) in regimes {
            let film = Film { compression, ..Film::PAPER_ELASTIC };
            let moved = film_at(rig, &shell, film, stretched(&shell, a, b), Vec::new())?;
            let (model, positions) = (&moved.view().system.model, &moved.view().state.positions);
            let mut elements = 0..model.elements();
            if !elements.all(|e| model.material.regime(strain(model, positions, e)) == regime) {
                return Err(format!("the film is not {name}"));
            }
            let scale = film.youngs_modulus * film.thickness * cell;
            let off = defect(&moved.view().forces().films(), positions, 1e-7, |x| {
                strain_energy(model, x)
            }) / scale;
            let quantity = format!("film force, {name}, c {compression}, over E t h");
            judged.push(Row::at_most(&quantity, off, band));
        }
    }
    let shell = icosphere(1, 0.5);
    let perturbed =
        |(x, off): (&Vector3<f64>, Vector3<f64>)| x + off * 0.05 + Vector3::new(1.0, 2.0, -3.0);
    let positions: Vec<_> = shell
        .positions
        .iter()
        .zip(pseudo_random(shell.positions.len(), 9))
        .map(perturbed)
        .collect();
    let moved = film_at(rig, &shell, Film::PAPER_ELASTIC, positions, Vec::new())?;
    let (areas, positions) = (moved.view().forces().areas(), &moved.view().state.positions);
    let volume = |x: &Field| -pressure::volume(&moved.view().system.model, x);
    let off = defect(&areas, positions, 1e-6, volume) / (0.25 * 0.25);
    judged.push(Row::at_most("force of pressure over p h^2", off, band));
    let net: Vector3<f64> = areas.iter().sum();
    let moment: Vector3<f64> = positions.iter().zip(areas.iter()).map(|(x, f)| x.cross(&f)).sum();
    judged.push(Row::at_most("net force of pressure over p, m^2", net.norm(), 1e-13));
    judged.push(Row::at_most("net moment of pressure over p, m^3", moment.norm(), 1e-13));

    let gravity = Vector3::new(1.0, -2.0, -9.806_65);
    let heavy =
        rig.start(&FilmScene { gravity, ..free_film(test_sheet(), Film::PAPER_ELASTIC) })?;
    let mut weight = Field::zeros(heavy.view().system.model.nodes());
    (0..heavy.view().system.model.nodes())
        .for_each(|node| weight.set(node, heavy.view().force(node)));
    let masses = &heavy.view().system.model.mass;
    let energy = |x: &Field| -> f64 {
        masses.iter().zip(x.iter()).map(|(mass, x)| -mass * gravity.dot(&x)).sum()
    };
    let total: f64 = masses.iter().sum::<f64>() * gravity.norm();
    let off = defect(&weight, &heavy.view().state.positions, 1e-3, energy) / total;
    judged.push(Row::at_most("weight over total weight", off, band));
    Ok(judged)
}

/// Work of the film's force along a path through all regimes, compared with its energy.
pub fn path_energy(rig: &Rig) -> Outcome {
    let shell = test_sheet();
    let (film, steps) = (Film { compression: 1e-3, ..Film::PAPER_ELASTIC }, 20_000);
    // From slack through wrinkled to taut and back to slack on another path.
    let positions = |k: u32| {
        let s = 4.0 * f64::from(k) / f64::from(steps);
        stretched(&shell, 8e-3 * libm::sin(s), 8e-3 * libm::sin(1.7 * s + 0.4))
    };
    let mut moved = film_at(rig, &shell, film, positions(0), Vec::new())?;
    let start = moved.view().strain_energy();
    let (mut work, mut largest) = (0.0, 0.0_f64);
    for k in 1..=steps {
        let next = film_at(rig, &shell, film, positions(k), Vec::new())?;
        let (before, after) = (moved.view(), next.view());
        for node in 0..after.system.model.nodes() {
            let mean = (before.forces().film(node) + after.forces().film(node)) * 0.5;
            let [from, to] = [before, after].map(|film| film.state.positions.get(node));
            work -= mean.dot(&(to - from));
        }
        moved = next;
        largest = largest.max(moved.view().strain_energy());
    }
    let change = moved.view().strain_energy() - start;
    Ok(vec![
        Row::at_least("largest energy on the path, J", largest, 0.1),
        Row::at_most(
            "work plus change of energy, over the largest",
            (work - change).abs() / largest,
            number("forces/band"),
        ),
    ])
}

/// Length of the step over which film gets its numerical stress, s. Chosen: short, so that the film moves
/// along straight lines, and long enough to count as a step.
const SHORT_STEP: f64 = 1e-9;

/// Numerical damping dissipates energy and has no net force and no net moment.
pub fn dissipation(rig: &Rig) -> Outcome {
    let shell = icosphere(2, 0.5);
    let count = shell.positions.len();
    let [elastic, damped] =
        [0.0, 0.1].map(|numerical_damping| Film { numerical_damping, ..Film::PAPER_ELASTIC });
    let [mut least, mut balance, mut force, mut moment] = [f64::INFINITY, 0.0, 0.0, 0.0];
    for seed in 0..5 {
        let positions: Vec<Vector3<f64>> = shell
            .positions
            .iter()
            .zip(pseudo_random(count, seed))
            .map(|(x, off)| x + off * 0.01)
            .collect();
        let velocities = pseudo_random(count, seed + 100);
        let after_step = |film: Film| -> Result<FilmSimulation, String> {
            let mut film = film_at(rig, &shell, film, positions.clone(), velocities.clone())?;
            advance(&mut film, SHORT_STEP, &Phase::default())?;
            Ok(film)
        };
        let (with, without) = (after_step(damped)?, after_step(elastic)?);
        let difference = |a: Field, b: Field| -> Vec<Vector3<f64>> {
            a.iter().zip(b.iter()).map(|(f, g)| f - g).collect()
        };
        let numerical = |film: &FilmSimulation| {
            let (now, histories) = (film.view(), explicit(film).histories);
            numerical_forces(&now.system.model, &now.state.positions, &histories)
        };
        // The damping part of the force: the difference to film without damping.
        let damping_part =
            difference(with.view().forces().films(), without.view().forces().films());
        let reported = difference(numerical(&with), numerical(&without));
        let (positions, velocities) =
            (&with.view().state.positions, &explicit(&with).motion.velocities);
        let power: f64 = reported.iter().zip(velocities.iter()).map(|(f, v)| -f.dot(&v)).sum();
        let dissipated: f64 =
            damping_part.iter().zip(velocities.iter()).map(|(f, v)| -f.dot(&v)).sum();
        let size: f64 = damping_part.iter().map(Vector3::norm).sum();
        let net: Vector3<f64> = damping_part.iter().sum();
        let turn: Vector3<f64> = positions.iter().zip(&damping_part).map(|(x, f)| x.cross(f)).sum();
        least = least.min(dissipated / size);
        balance = worse(balance, (dissipated / power - 1.0).abs());
        force = worse(force, net.norm() / size);
        moment = worse(moment, turn.norm() / size);
    }
    Ok(vec![
        Row::at_least("dissipated power over sum of |f|, m/s", least, 0.0),
        Row::at_most("reported power against force times velocity", balance, 1e-9),
        Row::at_most("net force over sum of |f|", force, 1e-12),
        Row::at_most("net moment over sum of |f|, m", moment, 1e-12),
    ])
}
