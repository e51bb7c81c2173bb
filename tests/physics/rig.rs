//! Pistons without a capsule, and the scene of the paper's capsule.

use std::sync::LazyLock;

use billow_solver::integrators::dormand_prince::{Control, DEFAULT_TOLERANCE};
use billow_solver::mechanics::gas::Gas;
use billow_solver::models;
use billow_solver::models::piston::{EndFilm, Piston, VolumeLaw};
use billow_solver::models::run::Unobserved;
use billow_solver::output::outcome::Deployment;
use billow_solver::platform::simd::InstructionSet;
use billow_solver::scene::{
    Contact, Film, GasSupply, HeatTransfer, InflowWindow, ModelKind, Outputs, Scene, Solver,
    Species, Stepping, Support, SupportLocation, Thresholds,
};
use serde_json::Value;

use crate::geometry::paper_design;

/// The committed reference numbers of gas and piston.
pub static REFERENCE: LazyLock<Value> = LazyLock::new(|| {
    serde_json::from_str(include_str!("../reference/gas.json")).expect("JSON in tests/reference")
});

/// A reference number by its path, as `tank_filling/band`.
pub fn number(path: &str) -> f64 {
    let pointer = format!("/{path}");
    REFERENCE.pointer(&pointer).and_then(Value::as_f64).unwrap_or_else(|| panic!("no {path}"))
}

pub fn nitrogen() -> Species {
    Species { gas_constant: number("nitrogen/gas_constant"), cp: number("nitrogen/cp") }
}

/// Nitrogen in vacuum, adiabatic, no leak, no windows.
pub fn supply() -> GasSupply {
    GasSupply {
        species: nitrogen(),
        initial_mass: 0.0,
        windows: Vec::new(),
        ambient_pressure: 0.0,
        heat_transfer: HeatTransfer::Coefficient(0.0),
        leak_area: 0.0,
        discharge_coefficient: 0.6,
    }
}

pub fn adaptive(tolerance: f64) -> Control {
    Control { stepping: Stepping::Adaptive(tolerance), step_limit: 10_000_000 }
}

pub fn fixed(step: f64) -> Control {
    Control { stepping: Stepping::Fixed(step), step_limit: 10_000_000 }
}

/// A piston on V = A z + V0 without an end.
pub fn tube(area: f64, offset: f64, mass: f64, gas: Gas) -> Piston {
    let volume = VolumeLaw::Uniform { area, offset };
    Piston { volume, mass, weight: 0.0, end: EndFilm::none(), gas }
}

pub const PAPER_FILM: Film = Film {
    youngs_modulus: 3.45e9,
    poisson_ratio: 0.3,
    density: 1400.0,
    thickness: 25.4e-6,
    compression: 0.0,
    viscosity: 0.1,
    temperature: 293.0,
};

pub fn window(from: f64, to: f64, rate: f64) -> InflowWindow {
    InflowWindow { from, to, mass_flow_rate: rate, temperature: 293.0 }
}

/// The paper's capsule, bottom ring fixed, in orbit, no gas; half a second at 0.5 ms.
pub fn paper_scene() -> Scene {
    Scene {
        design: paper_design(),
        film: PAPER_FILM,
        gas: GasSupply { heat_transfer: HeatTransfer::Coefficient(0.3), ..supply() },
        supports: vec![Support { on: SupportLocation::BottomRing, fix: "xyz".to_owned() }],
        contact: Contact { distance: None, friction: 0.0, adhesion: 0.0 },
        gravity: 0.0,
        release_time: 0.0,
        solver: Solver {
            model: ModelKind::Piston,
            end_time: 0.5,
            stepping: Stepping::Adaptive(DEFAULT_TOLERANCE),
            step_limit: 10_000_000,
        },
        outputs: Outputs { sample_interval: 5e-4, frames: 0, thresholds: Thresholds::default() },
        seed: 0,
    }
}

pub fn run(scene: &Scene) -> Deployment {
    models::solve(InstructionSet::detect(), scene, None, &mut Unobserved)
        .expect("a scene that can be run")
}
