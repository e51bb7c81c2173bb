//! Dissipation: numerical damping, material loss and mass damping remove the energy they report.
//!
//! ```text
//! numerical damping:  log decrement of a mode 2π ζ ω/ω_e
//! material loss:      log decrement 2π σ/ω of the root p = −σ + iω of
//!                     p² + ω0² (1 + g)(1 + pτ)/(1 + g + pτ) = 0
//! mass damping:       v = v0 exp(−c t) + g (1 − exp(−c t))/c in free flight
//! ```
//!
//! Symbols: ω frequency of the mode, ω0 that of film without loss, `ω_e` the highest frequency of an
//! element, rad/s; g and τ of [`billow_solver::mechanics::material_loss`].

use billow_solver::geometry::shapes::strip;
use billow_solver::mechanics::material_loss::Creep;
use nalgebra::Complex;

use super::oscillation::extrema;
use super::prelude::*;

/// What a vibrating strip shows.
struct Vibration {
    film: FilmSimulation,
    /// Angular frequency, rad/s.
    omega: f64,
    /// Log decrement of a period.
    decrement: f64,
    /// Kinetic energy at the start less kinetic and stored energy at the end, J.
    lost: f64,
}

/// A standing wave along a strip of equal elements, held in its transverse directions. The first
/// sixteen half periods are left out: film that creeps starts out of step.
fn vibrate(rig: &Rig, film: Film, cfl: f64) -> Result<Vibration> {
    let (columns, length) = (40_u32, 1.0);
    let shell = strip(columns, length, 0.05);
    let all = (0..2 * (columns + 1)).collect();
    let ends = vec![0, columns, columns + 1, 2 * columns + 1];
    let wave = |x: &Vector3<f64>| Vector3::x() * (1e-4 * libm::sin(PI * x.x / length));
    let mut scene = FilmScene {
        velocities: shell.positions.iter().map(wave).collect(),
        supports: vec![held(all, "yz"), held(ends, "x")],
        ..free_film(shell, film)
    };
    scene.solver.cfl = cfl;
    let centre = columns as usize / 2;
    let position = scene.shell.positions[centre].x;
    let mut film = rig.start(&scene)?;
    let interval = film.view().next_step();
    let extrema =
        extrema(&mut film, interval, 25, |film| film.state.positions.x[centre] - position)?;
    // Eight half periods.
    let omega = 4.0 * TAU / (extrema[24].time - extrema[16].time);
    let decrement = libm::log(extrema[16].value / extrema[24].value) / 4.0;
    let ledger = film.view().ledger();
    let kinetic: f64 = scene
        .velocities
        .iter()
        .zip(&film.view().system.model.mass)
        .map(|(v, mass)| 0.5 * mass * v.norm_squared())
        .sum();
    Ok(Vibration { film, omega, decrement, lost: kinetic - ledger.kinetic - ledger.strain })
}

/// A vibrating strip under numerical damping.
pub fn strip_decrement(rig: &Rig) -> Outcome {
    let film = Film { compression: 1.0, numerical_damping: 0.1, ..Film::PAPER_ELASTIC };
    let Vibration { film: moved, omega, decrement, lost } = vibrate(rig, film, 0.1)?;
    let expected = TAU * film.numerical_damping * omega / moved.view().system.model.frequency[0];
    let band = number("damping/band");
    Ok(vec![
        Row::new("log decrement of a strip's mode", decrement, expected, band),
        Row::new("dissipated energy, J", moved.view().ledger().numerical_dissipation, lost, band),
    ])
}

/// A vibrating strip under material loss, above the frequency of the largest loss factor. Creep is of
/// first order in the step, so the decrement is extrapolated from two steps.
pub fn strip_loss(rig: &Rig) -> Outcome {
    let film =
        Film { compression: 1.0, loss_factor: 0.03, loss_frequency: 200.0, ..Film::PAPER_ELASTIC };
    let coarse = vibrate(rig, film, 0.1)?;
    let Vibration { film: moved, omega, decrement, lost } = vibrate(rig, film, 0.05)?;
    let extrapolated = 2.0 * decrement - coarse.decrement;
    let material = billow_solver::mechanics::material::Material::new(&film);
    let expected = TAU * decay(&Creep::new(&film, &material), omega) / omega;
    let band = number("damping/band");
    Ok(vec![
        Row::new("log decrement of a strip's mode", extrapolated, expected, band),
        Row::new("energy lost in the material, J", moved.view().ledger().material_loss, lost, band),
    ])
}

/// σ, 1/s, of the mode whose angular frequency is ω: the one for which ω0² is real. By bisection.
fn decay(creep: &Creep, omega: f64) -> f64 {
    let instant = 1.0 + creep.ratio;
    let imaginary = |sigma: f64| {
        let p = Complex::new(-sigma, omega);
        let creeps = Complex::new(instant, 0.0) + p * creep.time;
        let rests = Complex::new(1.0, 0.0) + p * creep.time;
        (-(p * p) * creeps / rests).im
    };
    let (mut low, mut high) = (0.0, omega);
    for _ in 0..60 {
        let middle = 0.5 * (low + high);
        if (imaginary(middle) > 0.0) == (imaginary(low) > 0.0) {
            low = middle;
        } else {
            high = middle;
        }
    }
    0.5 * (low + high)
}

/// Free flight under mass damping and gravity.
pub fn free_flight(rig: &Rig) -> Outcome {
    let shell = sheet(2, 2, 0.1, 0.1);
    let (start, damping, time) = (Vector3::new(3.0, -1.0, 2.0), 40.0, 0.03);
    let gravity = Vector3::new(0.0, 0.0, -300.0);
    let velocities = vec![start; shell.positions.len()];
    let mut scene = FilmScene { velocities, gravity, ..free_film(shell, Film::PAPER_ELASTIC) };
    scene.solver.mass_damping = damping;
    let mut film = rig.start(&scene)?;
    let before = film.view().ledger();
    advance(&mut film, time, &Phase::default())?;
    let now = film.view().state.velocities.get(4);
    let left = libm::exp(-damping * time);
    let expected = start * left + gravity * ((1.0 - left) / damping);
    let after = film.view().ledger();
    let lost = before.kinetic - after.kinetic + after.gravity_work;
    let band = number("damping/band");
    Ok(vec![
        Row::new("speed along the flight, m/s", now.x, expected.x, band),
        Row::new("speed of the fall, m/s", now.z, expected.z, band),
        Row::new("dissipated energy, J", after.damping_work, lost, band),
    ])
}
