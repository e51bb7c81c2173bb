//! Dissipation: viscosity and mass damping remove the energy they report.
//!
//! ```text
//! numerical_damping:     log decrement of a mode 2π ζ ω/ω_e
//! mass damping:  v = v0 exp(−c t) in free flight
//! ```

use core::f64::consts::{PI, TAU};

use billow_solver::geometry::shapes::{sheet, strip};
use billow_solver::scene::Film;
use billow_solver::scene::film_scene::FilmScene;
use billow_solver::scene::paper::free_film;
use billow_solver::scene::timeline::Phase;
use nalgebra::Vector3;

use super::oscillation::extrema;
use super::reference::number;
use super::rig::{advance, held};
use super::{Outcome, Rig, Row};

/// A standing wave along a strip of equal elements, held in its transverse directions.
pub fn strip_decrement(rig: &Rig) -> Outcome {
    let (columns, length) = (40_u32, 1.0);
    let shell = strip(columns, length, 0.05);
    let all = (0..2 * (columns + 1)).collect();
    let ends = vec![0, columns, columns + 1, 2 * columns + 1];
    let film = Film { compression: 1.0, numerical_damping: 0.1, ..Film::PAPER_ELASTIC };
    let wave = |x: &Vector3<f64>| Vector3::x() * (1e-4 * libm::sin(PI * x.x / length));
    let mut scene = FilmScene {
        velocities: shell.positions.iter().map(wave).collect(),
        supports: vec![held(all, "yz"), held(ends, "x")],
        ..free_film(shell, film)
    };
    scene.solver.cfl = 0.1;
    let centre = columns as usize / 2;
    let position = scene.shell.positions[centre].x;
    let mut film = rig.start(&scene)?;
    let interval = film.stable_step();
    let extrema =
        extrema(&mut film, interval, 9, |film| film.state.positions.x[centre] - position)?;
    // Eight half periods.
    let omega = 4.0 * TAU / (extrema[8].time - extrema[0].time);
    let decrement = libm::log(extrema[0].value / extrema[8].value) / 4.0;
    let expected = TAU * scene.film.numerical_damping * omega / film.model.frequency[0];
    let ledger = film.ledger();
    let kinetic: f64 = scene
        .velocities
        .iter()
        .zip(&film.model.mass)
        .map(|(v, mass)| 0.5 * mass * v.norm_squared())
        .sum();
    let lost = kinetic - ledger.kinetic - ledger.strain;
    let band = number("damping/band");
    Ok(vec![
        Row::new("log decrement of a strip's mode", decrement, expected, band),
        Row::new("dissipated energy, J", ledger.numerical_dissipation, lost, band),
    ])
}

/// Free flight under mass damping.
pub fn free_flight(rig: &Rig) -> Outcome {
    let shell = sheet(2, 2, 0.1, 0.1);
    let (start, damping, time) = (Vector3::new(3.0, -1.0, 2.0), 40.0, 0.03);
    let velocities = vec![start; shell.positions.len()];
    let mut scene = FilmScene { velocities, ..free_film(shell, Film::PAPER_ELASTIC) };
    scene.solver.mass_damping = damping;
    let mut film = rig.start(&scene)?;
    let before = film.kinetic_energy();
    advance(&mut film, time, &Phase::default())?;
    let share = film.velocities().get(4).norm() / start.norm();
    let lost = before - film.kinetic_energy();
    let band = number("damping/band");
    Ok(vec![
        Row::new("remaining speed of free flight", share, libm::exp(-damping * time), band),
        Row::new("dissipated energy, J", film.ledger().damping_work, lost, band),
    ])
}
