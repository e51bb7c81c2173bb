//! Radial oscillation of a sphere of film filled with gas.
//!
//! ```text
//! m λ̈ R² = (p 4π R³ λ² − dW/dλ)         p = p0 (λ0/λ)^(3γ),  W = 4π R² t E/(1−ν) ((λ²−1)/2)²
//! ```

use billow_solver::models::film::Relaxation;

use super::oscillation::{extrema, frequency};
use super::prelude::*;
use super::rig::stopped;
use super::row::converged;

/// Temperature of the gas, K. Chosen: that of the film, so that its mass follows from its pressure.
const TEMPERATURE: f64 = 293.0;
/// CFL number of the released sphere. Chosen: small, because the step error of the period has the
/// opposite sign of the mesh error and would hide it.
const CFL: f64 = 0.1;
/// Half periods over which a frequency is measured.
const HALF_PERIODS: usize = 12;

fn sphere(level: u32) -> Shell {
    icosphere(level, number("breathing_sphere/radius"))
}

/// The sphere in equilibrium under an overpressure, Pa.
fn equilibrium(rig: &Rig, level: u32, overpressure: f64) -> Result<FilmSimulation> {
    let filling = Filling::Pressure(overpressure);
    let film =
        rig.start(&FilmScene { filling, ..free_film(sphere(level), Film::PAPER_ELASTIC) })?;
    // The remaining motion must be small against an amplitude of 1e-5 of the radius.
    let relaxation = Relaxation { max_kinetic_fraction: 1e-15, ..Relaxation::default() };
    let settled = relaxation.relax_at(film, overpressure);
    settled.map_err(|unsettled| stopped(&unsettled.failure).into())
}

/// Gas of this pressure (Pa) in this volume (m³).
fn filled(pressure: f64, volume: f64) -> Filling {
    let gas_constant = nitrogen_supply().species.gas_constant;
    nitrogen_filling(pressure * volume / (gas_constant * TEMPERATURE), TEMPERATURE)
}

/// A sphere that starts to breathe about its equilibrium at this pressure (Pa), and its volume at rest (m³), with an
/// integrator at a CFL number; `None` for its usual one.
pub fn breathing_start(
    rig: &Rig,
    level: u32,
    pressure: f64,
    (integrator, cfl): (IntegratorKind, Option<f64>),
) -> Result<(FilmSimulation, f64)> {
    let rest = equilibrium(rig, level, pressure)?;
    let mut shell = sphere(level);
    shell.positions = rest.view().state.positions.iter().collect();
    // An amplitude of 1e-5 of the radius at about 5300 rad/s.
    let rate = number("breathing_sphere/amplitude") * 5300.0;
    let velocities = shell.positions.iter().map(|x| x * rate).collect();
    let filling = filled(pressure, rest.view().state.volume);
    let mut scene = FilmScene { velocities, filling, ..free_film(shell, Film::PAPER_ELASTIC) };
    scene.solver.cfl = cfl.unwrap_or(scene.solver.cfl);
    scene.solver.integrator = integrator;
    Ok((rig.start(&scene)?, rest.view().state.volume))
}

/// Frequency of the radial mode of a breathing sphere with this volume at rest (m³), Hz, over six periods sampled at
/// an interval (s); without one, at each step.
pub fn breathing_frequency(
    film: &mut FilmSimulation,
    volume: f64,
    interval: Option<f64>,
) -> Result<f64> {
    let interval = interval.unwrap_or(film.view().next_step());
    frequency(film, interval, HALF_PERIODS + 1, |film| film.state.volume - volume)
}

/// The radial mode about equilibrium, at two pressures.
pub fn breathing_sphere(rig: &Rig, levels: [u32; 3]) -> Outcome {
    let bands = entry("breathing_sphere", ["raw_band", "band", "order"]);
    each("breathing_sphere", |row| {
        let quantity = format!("frequency at {} Pa, Hz", row[0]);
        converged(levels, [(quantity, row[1])], bands, |level| {
            let explicit = (IntegratorKind::Explicit, None);
            let (mut film, volume) = breathing_start(rig, level, row[0], explicit)?;
            Ok([breathing_frequency(&mut film, volume, None)?])
        })
    })
}

/// Largest λ − 1 and period (s) of a sphere released unstretched. Its gas has this pressure (Pa) at
/// equilibrium.
fn release(rig: &Rig, level: u32, pressure: f64) -> Result<[f64; 2]> {
    let rest = equilibrium(rig, level, pressure)?;
    let empty = sphere(level);
    let start = empty.volume(|node| empty.positions[node as usize]);
    let species = nitrogen_supply().species;
    let gamma = species.cp / (species.cp - species.gas_constant);
    let denser = pressure * libm::pow(rest.view().state.volume / start, gamma);
    let filling = filled(denser, start);
    let mut scene = FilmScene { filling, ..free_film(empty, Film::PAPER_ELASTIC) };
    scene.solver.cfl = CFL;
    let mut film = rig.start(&scene)?;
    let interval = film.view().next_step();
    let extrema = extrema(&mut film, interval, 2, |film| film.state.volume)?;
    Ok([libm::cbrt(extrema[0].value / start) - 1.0, extrema[1].time])
}

/// A sphere released unstretched: its turning points.
pub fn released_sphere(rig: &Rig) -> Outcome {
    let [pressure, lambda, period] =
        entry("breathing_sphere/released", ["p0", "largest_lambda", "period"]);
    let bands = entry("breathing_sphere", ["raw_band", "band", "order"]);
    let quantities = [("largest lambda - 1", lambda - 1.0), ("period, s", period)];
    converged([3, 4, 5], quantities, bands, |level| release(rig, level, pressure))
}
