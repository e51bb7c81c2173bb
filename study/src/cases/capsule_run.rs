//! Runs of gas and film whose energy must add up: the paper's capsule without contact, and a sphere
//! that meets every term of the equations.
//!
//! ```text
//! residual = |Δ(kinetic + strain) + viscous + damping − external works| / (peak kinetic + Σ|external works|)
//! ```

use billow_solver::geometry::fold::{Caps, Chirality, Fit, FoldDesign};
use billow_solver::integrators::dormand_prince::DEFAULT_TOLERANCE;
use billow_solver::integrators::explicit::DEFAULT_CFL;
use billow_solver::models::film::FilmRun;
use billow_solver::models::run::{self, Unobserved};
use billow_solver::output::ledger::{GasBalance, gas_residuals, residuals};
use billow_solver::output::measures::Reference;
use billow_solver::output::outcome::Stop;
use billow_solver::scene::film_scene::{Filling, FilmScene};
use billow_solver::scene::inflow::Inflow;
use billow_solver::scene::timeline::{Phase, Timeline};
use billow_solver::scene::{
    Contact, Film, GasSupply, HeatTransfer, InflowWindow, ModelKind, Outputs, Scene, Solver,
    Stepping, Support, SupportLocation, Thresholds,
};
use nalgebra::Vector3;

use super::reference::number;
use super::rig::{advance, film, nitrogen, scene};
use super::row::worse;
use super::shapes_dynamic::icosphere;
use super::{Outcome, Rig, Row};

/// The paper's capsule on its bottom ring in orbit, 5 g/s, ζ 0.1, a tension field.
pub fn paper_capsule(subdivisions: u32, end_time: f64) -> Scene {
    Scene {
        design: FoldDesign {
            fit: Fit::Cone,
            panels: 6,
            storeys: 3,
            bottom_radius: 0.5,
            top_radius: Some(0.365),
            height: Some(1.0),
            half_angle: None,
            alpha1_over_phi: None,
            chirality: Chirality::Same,
            stowed_height: 0.04,
            subdivisions,
            caps: Caps::Polygon,
        },
        film: Film { viscosity: 0.1, ..film() },
        gas: GasSupply {
            heat_transfer: HeatTransfer::Coefficient(0.3),
            windows: vec![InflowWindow {
                from: 0.0,
                to: 1.5,
                mass_flow_rate: 5e-3,
                temperature: 293.0,
            }],
            ..nitrogen()
        },
        supports: vec![Support { on: SupportLocation::BottomRing, fix: "xyz".to_owned() }],
        contact: Contact { distance: None, friction: 0.0, adhesion: 0.0 },
        gravity: 0.0,
        release_time: 0.0,
        solver: Solver {
            model: ModelKind::Piston,
            end_time,
            stepping: Stepping::Adaptive(DEFAULT_TOLERANCE),
            step_limit: 10_000_000,
        },
        outputs: Outputs { sample_interval: 5e-4, frames: 0, thresholds: Thresholds::default() },
        seed: 0,
    }
}

/// The paper's capsule deployed without contact for 0.3 s: its ledgers.
pub(super) fn capsule_ledger(rig: &Rig) -> Outcome {
    let scene = paper_capsule(5, 0.3);
    // Nothing here is judged by its static states.
    let unread = Reference::new(vec![[1.0, 1.0, 1.0]]);
    let mut run = FilmRun::from_scene(rig.instruction_set, &scene, DEFAULT_CFL, None, Some(unread))
        .map_err(|e| e.to_string())?;
    run.film = rig.faulty(run.film);
    let deployment = run::run(&mut run, &Timeline::new(&scene), &mut Unobserved);
    if deployment.stop != Stop::Done {
        return Err(format!("stopped: {:?}", deployment.stop));
    }
    let audit = &deployment.audit;
    let viscous = format!("viscous share of the gas work {:.3}", audit.viscous_fraction);
    Ok(vec![
        Row::at_most("film residual", audit.ledger_residual, number("ledger/band"))
            .with_note(&viscous),
        Row::at_most("gas residual", audit.gas_residual, number("ledger/gas_band")),
    ])
}

/// A viscous sphere thrown upward in air, that is filled, leaks, exchanges heat, and is slowed by
/// mass damping: every term at once.
pub(super) fn sphere_ledger(rig: &Rig) -> Outcome {
    let ambient = 1000.0;
    let shell = icosphere(2, 0.5);
    let species = nitrogen().species;
    let volume = shell.volume(|node| shell.positions[node as usize]);
    let supply = GasSupply {
        initial_mass: 2.0 * ambient * volume / (species.gas_constant * 350.0),
        ambient_pressure: ambient,
        heat_transfer: HeatTransfer::Coefficient(50.0),
        leak_area: 2e-2,
        ..nitrogen()
    };
    let velocities =
        shell.positions.iter().map(|x| Vector3::new(0.0, 0.0, 3.0) + x * 4.0).collect();
    let mut scene = FilmScene {
        velocities,
        filling: Filling::Gas { supply, initial_temperature: 350.0 },
        gravity: Vector3::new(0.0, 0.0, -9.806_65),
        ..scene(shell, Film { viscosity: 0.1, compression: 0.01, ..film() })
    };
    scene.solver.mass_damping = 5.0;
    scene.solver.cfl = 0.2;
    let mut film = rig.start(&scene)?;
    let inflow = Inflow { mass_flow_rate: 1.0, temperature_flow: 400.0 };
    let phase = Phase { packed: false, inflow };
    let (mut ledgers, mut books) = (vec![film.ledger()], vec![film.gas_balance()]);
    for sample in 1..=40 {
        let time = f64::from(sample) * 1e-3;
        advance(&mut film, time, &phase)?;
        ledgers.push(film.ledger());
        books.push(GasBalance { mass_in: inflow.mass_flow_rate * time, ..film.gas_balance() });
    }
    let largest = |series: Vec<f64>| series.into_iter().fold(0.0, worse);
    Ok(vec![
        Row::at_most("film residual", largest(residuals(&ledgers)), number("ledger/sphere_band")),
        Row::at_most("gas residual", largest(gas_residuals(&books)), number("ledger/gas_band")),
    ])
}
