//! A rigid plate on a column of gas, with the explicit step.
//!
//! ```text
//! injected:  x = C t^1.5,  C² = ṁ cp T_in/(M (0.75/(γ−1) + 1.125)),  T = T_in 2γ/(3γ−1)
//! spring:    M ẍ = p0 A ((L0/x)^γ − 1)             T_lin = 2π √(M L0/(γ p0 A))
//! ```
//!
//! The plate is film on a rigid plane; the walls close the volume and are no film. Each run halves the
//! CFL number of the one before.

use billow_solver::integrators::{FilmSimulation, FilmView};
use billow_solver::scene::film_scene::{Filling, FilmScene};
use billow_solver::scene::paper::{free_film, nitrogen_supply};
use billow_solver::scene::timeline::Phase;
use billow_solver::scene::{Film, GasSupply, IntegratorKind, Species};

use super::gas_column::column;
use super::piston_model;
use super::reference::{entry, number, rows};
use super::rig::{advance, inflow};
use super::row::self_convergence_order;
use super::{Outcome, Rig, Row};

/// A moving plate on gas.
struct Piston {
    area: f64,
    height: f64,
    mass: f64,
    speed: f64,
    force: f64,
    supply: GasSupply,
    temperature: f64,
    cfl: f64,
    integrator: IntegratorKind,
}

impl Piston {
    fn start(&self, rig: &Rig) -> Result<FilmSimulation, String> {
        let column = column(self.area, self.height);
        let filling =
            Filling::Gas { supply: self.supply.clone(), initial_temperature: self.temperature };
        let film = Film { ..Film::PAPER_ELASTIC };
        let supports = column.piston(self.mass, film.area_density(), self.speed, self.force);
        let mut scene = FilmScene { supports, filling, ..free_film(column.shell, film) };
        (scene.solver.cfl, scene.solver.integrator) = (self.cfl, self.integrator);
        rig.start(&scene)
    }
}

/// Height of the plate, m.
pub fn height(film: &FilmView<'_>) -> f64 {
    film.state.positions.z[4]
}

fn injection() -> Phase {
    inflow(number("injected_piston/rate"), number("injected_piston/inflow_temperature"))
}

/// Position, m, of the plate at a time, s: x = C t^1.5.
pub fn injected_exact(time: f64) -> f64 {
    let [mass, rate, entering] = entry("injected_piston", ["mass", "rate", "inflow_temperature"]);
    let cp = number("nitrogen/cp");
    let gamma = cp / (cp - number("nitrogen/gas_constant"));
    let square = rate * cp * entering / (mass * (0.75 / (gamma - 1.0) + 1.125));
    square.sqrt() * libm::pow(time, 1.5)
}

/// The plate driven by an inflow, from the closed form at 1 ms to 50 ms, with an integrator at a CFL number.
///
/// # Errors
/// A failure of the run.
pub fn injected(rig: &Rig, integrator: IntegratorKind, cfl: f64) -> Result<FilmSimulation, String> {
    let [mass, rate, entering, c, start, end] =
        entry("injected_piston", ["mass", "rate", "inflow_temperature", "C", "start", "end"]);
    let cp = number("nitrogen/cp");
    let gamma = cp / (cp - number("nitrogen/gas_constant"));
    let piston = Piston {
        area: 0.5,
        height: c * libm::pow(start, 1.5),
        mass,
        speed: 1.5 * c * start.sqrt(),
        force: 0.0,
        supply: GasSupply { initial_mass: rate * start, ..nitrogen_supply() },
        temperature: entering * 2.0 * gamma / (3.0 * gamma - 1.0),
        cfl,
        integrator,
    };
    let mut film = piston.start(rig)?;
    advance(&mut film, end - start, &injection())?;
    Ok(film)
}

/// The injected piston, with the step halved twice.
pub fn injected_piston(rig: &Rig) -> Outcome {
    let [rate, entering, end] = entry("injected_piston", ["rate", "inflow_temperature", "end"]);
    let cp = number("nitrogen/cp");
    let run = |cfl| injected(rig, IntegratorKind::Explicit, cfl);
    let runs = [run(0.16)?, run(0.08)?, run(0.04)?];
    let [expected, band, least] = entry("injected_piston", ["position_at_50_ms", "band", "order"]);
    let heights = runs.each_ref().map(|film| height(&film.view()));
    let finest = &runs[2];
    let enthalpy = rate * end * cp * entering;
    let kinetic_fraction = finest.view().kinetic_energy() / enthalpy;
    Ok(vec![
        Row::converging("x at 50 ms, m", heights, expected, band, least),
        Row::new(
            "kinetic energy over enthalpy in",
            kinetic_fraction,
            number("injected_piston/kinetic_share_of_enthalpy"),
            number("injected_piston/offset_band"),
        ),
    ])
}

/// From rest on an empty dead volume, against the piston model at a tolerance of 1e-13.
pub fn injected_piston_dead_volume(rig: &Rig) -> Outcome {
    let area = 0.1;
    let volume = number("injected_piston/offset_volume");
    let end = number("injected_piston/end");
    let start = volume / area;
    let run = |cfl: f64| -> Result<f64, String> {
        let piston = Piston {
            area,
            height: start,
            mass: number("injected_piston/mass"),
            speed: 0.0,
            force: 0.0,
            supply: nitrogen_supply(),
            temperature: 293.0,
            cfl,
            integrator: IntegratorKind::Explicit,
        };
        let mut film = piston.start(rig)?;
        advance(&mut film, end, &injection())?;
        Ok(height(&film.view()) - start)
    };
    let values = [run(0.04)?, run(0.02)?, run(0.01)?];
    let expected = piston_model::from_dead_volume(area, volume, 1e-13)?;
    let band = number("injected_piston/offset_band");
    Ok(vec![
        Row::new("x at 50 ms, m", values[2], expected, band)
            .with_order(self_convergence_order(values)),
    ])
}

/// Period of a mass on gas against a constant force, at three amplitudes.
pub fn gas_spring(rig: &Rig) -> Outcome {
    let gamma = number("gas_spring/gamma");
    // cp/cv = γ exactly.
    let species = Species { gas_constant: 296.8, cp: 296.8 * gamma / (gamma - 1.0) };
    let (mass, length, area, pressure) = (0.4, 0.3, 0.02, 2000.0);
    let linear = 2.0 * core::f64::consts::PI * (mass * length / (gamma * pressure * area)).sqrt();
    let content = pressure * area * length / (species.gas_constant * 293.0);
    let mut judged = Vec::new();
    for row in rows("gas_spring") {
        let (amplitude, ratio) = (row[0], row[1]);
        let period = |cfl: f64| -> Result<f64, String> {
            let piston = Piston {
                area,
                height: length * (1.0 + amplitude),
                mass,
                speed: 0.0,
                force: -pressure * area,
                supply: GasSupply { species, initial_mass: content, ..nitrogen_supply() },
                temperature: 293.0 * libm::pow(1.0 + amplitude, 1.0 - gamma),
                cfl,
                integrator: IntegratorKind::Explicit,
            };
            let mut film = piston.start(rig)?;
            advance(&mut film, ratio * linear, &Phase::default())?;
            // After one period the plate is at rest: the remaining speed over the acceleration is the
            // error of the period.
            let speed = film.view().state.velocities.z[4];
            let force =
                film.view().force_on(&film.view().system.supports.bodies[0]) - pressure * area;
            Ok(ratio * linear - speed / (force / mass))
        };
        let values = [period(0.8)?, period(0.4)?, period(0.2)?];
        let quantity = format!("period over linear period at amplitude {amplitude}");
        judged.push(
            Row::new(&quantity, values[2] / linear, ratio, number("gas_spring/band"))
                .with_order(self_convergence_order(values)),
        );
    }
    Ok(judged)
}
