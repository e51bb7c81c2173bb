//! The paper's capsule: its film, its gas, its fold and its scene, for reference cases, tests and
//! benchmarks.
//!
//! Geometry and film are those of the paper the program reproduces: a cone of radii 0.5 and 0.365 m
//! and height 1 m, N 6, M 3, of polyester film 25.4 µm (1 mil) thick. The same numbers stand in
//! `tests/reference`, with the closed forms that use them; a test holds both against each other.

use nalgebra::Vector3;

use super::film_scene::{Filling, FilmOutputs, FilmScene, FilmSolver};
use super::{
    Contact, Film, GasSupply, HeatTransfer, InflowWindow, IntegratorKind, ModelKind, Outputs,
    Scene, Solver, Species, Stepping, Support, SupportLocation, Thresholds,
};
use crate::geometry::fold::{Caps, Chirality, Fit, FoldDesign};
use crate::geometry::shell::Shell;
use crate::platform::simd::InstructionSet;

/// Radius of the bottom ring, m. Source: the paper.
pub const BOTTOM_RADIUS: f64 = 0.5;
/// Radius of the top ring, m. Source: the paper.
pub const TOP_RADIUS: f64 = 0.365;
/// Erected height, m. Source: the paper.
pub const HEIGHT: f64 = 1.0;
/// Height of the stowed pattern, m. Chosen: the film is strained by less than 3e-5 in it.
pub const STOWED_HEIGHT: f64 = 0.04;
/// Inflow of the paper's deployment, kg/s.
pub const MASS_FLOW_RATE: f64 = 5e-3;
/// Temperature of film and inflow, K. Chosen: room temperature; the paper gives none.
pub const TEMPERATURE: f64 = 293.0;

/// Largest loss factor of the film. Assumed: the paper gives none; polyimide films at room temperature
/// have 0.003 to 0.03.
pub const LOSS_FACTOR: f64 = 0.015;
/// Frequency of the largest loss factor, Hz. Assumed: that of the capsule's structural vibrations.
pub const LOSS_FREQUENCY: f64 = 1000.0;
/// Numerical damping ratio. Chosen by the runs of docs/experiments.md.
pub const NUMERICAL_DAMPING: f64 = 1e-4;

impl Film {
    /// The paper's film as a tension field (c = 0), with the default loss and numerical damping.
    ///
    /// E 3.45e9 Pa, ν 0.3, ρ 1400 kg/m³, t 25.4 µm. Source: the paper. Its loss is assumed: see
    /// [`LOSS_FACTOR`].
    pub const PAPER: Self = Self {
        youngs_modulus: 3.45e9,
        poisson_ratio: 0.3,
        density: 1400.0,
        thickness: 25.4e-6,
        compression: 0.0,
        bending: false,
        creases: None,
        yield_moment: None,
        numerical_damping: NUMERICAL_DAMPING,
        temperature: TEMPERATURE,
        loss_factor: LOSS_FACTOR,
        loss_frequency: LOSS_FREQUENCY,
    };

    /// [`Film::PAPER`] without loss and without numerical damping.
    pub const PAPER_ELASTIC: Self =
        Self { numerical_damping: 0.0, loss_factor: 0.0, ..Self::PAPER };
}

/// No gas yet, nitrogen to come: adiabatic, in vacuum, no leak, no inflow window.
pub fn nitrogen_supply() -> GasSupply {
    GasSupply {
        species: Species::NITROGEN,
        initial_mass: 0.0,
        windows: Vec::new(),
        ambient_pressure: 0.0,
        heat_transfer: HeatTransfer::Coefficient(0.0),
        leak_area: 0.0,
        vent: None,
        discharge_coefficient: 0.6,
    }
}

/// An inflow of this rate (kg/s) from one time (s) to another, at the temperature of the film.
pub fn window(from: f64, to: f64, rate: f64) -> InflowWindow {
    InflowWindow { from, to, mass_flow_rate: rate, temperature: TEMPERATURE }
}

/// The paper's fold design, fit `cone`: N 6, M 3, polygonal caps, n elements along each edge.
pub fn design(subdivisions: u32) -> FoldDesign {
    FoldDesign {
        fit: Fit::Cone,
        panels: 6,
        storeys: 3,
        bottom_radius: BOTTOM_RADIUS,
        top_radius: Some(TOP_RADIUS),
        height: Some(HEIGHT),
        half_angle: None,
        alpha1_over_phi: None,
        chirality: Chirality::Same,
        stowed_height: STOWED_HEIGHT,
        subdivisions,
        caps: Caps::Polygon,
    }
}

/// The paper's capsule in orbit on its bottom ring, until `end_time` (s), without gas: model
/// `piston`, sampled every 0.5 ms, a heat transfer coefficient of 0.3 W/(m² K).
pub fn empty_capsule(subdivisions: u32, end_time: f64) -> Scene {
    Scene {
        design: design(subdivisions).into(),
        film: Film::PAPER,
        gas: GasSupply { heat_transfer: HeatTransfer::Coefficient(0.3), ..nitrogen_supply() },
        supports: vec![Support { on: SupportLocation::BottomRing, fix: "xyz".to_owned() }],
        contact: Contact { distance: None, friction: 0.0, adhesion: 0.0 },
        gravity: 0.0,
        release_time: 0.0,
        solver: Solver {
            integrator: IntegratorKind::default(),
            model: ModelKind::Piston,
            end_time,
            // The default of `integrators::dormand_prince`.
            stepping: Stepping::Adaptive(1e-9),
            step_limit: 10_000_000,
        },
        outputs: Outputs { sample_interval: 5e-4, frames: 0, thresholds: Thresholds::default() },
        seed: 0,
        imperfection_amplitude: None,
    }
}

/// [`empty_capsule`] with the paper's inflow, 5 g/s from 0 to 1.5 s.
pub fn capsule(subdivisions: u32, end_time: f64) -> Scene {
    let mut scene = empty_capsule(subdivisions, end_time);
    scene.gas.windows = vec![window(0.0, 1.5, MASS_FLOW_RATE)];
    scene
}

/// Film of any shape in orbit: at rest, free, without pressure and without contact.
pub fn free_film(shell: Shell, film: Film) -> FilmScene {
    FilmScene {
        shell,
        velocities: Vec::new(),
        film,
        filling: Filling::Pressure(0.0),
        supports: Vec::new(),
        gravity: Vector3::zeros(),
        release_time: 0.0,
        solver: FilmSolver {
            integrator: IntegratorKind::default(),
            // The default of `integrators::explicit`.
            cfl: 0.45,
            end_time: 0.0,
            statics: false,
            mass_damping: 0.0,
            step_limit: u64::MAX,
            instruction_set: InstructionSet::detect(),
        },
        outputs: FilmOutputs {
            sample_interval: 1e-3,
            nodes: Vec::new(),
            elements: Vec::new(),
            frames: 0,
        },
        contact: None,
    }
}
