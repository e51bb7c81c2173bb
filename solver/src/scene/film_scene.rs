//! The scene of a film of any shape. The scene of a capsule is converted to one, and so is a mesh.
//!
//! Plain data: nodes by index, SI units, no value is "auto". [`crate::models::film`] runs it.

use nalgebra::Vector3;

use super::film_support::FilmSupport;
use super::monitor_settings::MonitorSettings;
use super::plate::Plate;
use super::{Contact, Film, GasSupply, IntegratorKind};
use crate::geometry::shell::Shell;
use crate::platform::simd::InstructionSet;

/// Everything one run of film needs.
#[derive(Debug, Clone, PartialEq)]
pub struct FilmScene {
    /// Initial shape and stress-free reference of the film.
    pub shell: Shell,
    /// Initial velocity of each node, m/s; empty for a start at rest.
    pub velocities: Vec<Vector3<f64>>,
    /// Material.
    pub film: Film,
    /// Pressure load or gas.
    pub filling: Filling,
    /// Supports of the film.
    pub supports: Vec<FilmSupport>,
    /// Contact of film with film; `None` lets film pass through film.
    pub contact: Option<FilmContact>,
    /// Acceleration of gravity, m/s².
    pub gravity: Vector3<f64>,
    /// End of packing, s. Until this time, film with contact is between two fixed plates above and below
    /// it; film without contact is fixed at its initial position, and only the gas evolves.
    pub release_time: f64,
    /// Solution parameters.
    pub solver: FilmSolver,
    /// What is recorded.
    pub outputs: FilmOutputs,
}

/// Load on the inside of the film.
#[derive(Debug, Clone, PartialEq)]
pub enum Filling {
    /// Constant overpressure, Pa, independent of the volume; the film may be open.
    Pressure(f64),
    /// Gas in the closed volume.
    Gas {
        /// The gas, its inflow and its leak.
        supply: GasSupply,
        /// Initial temperature of the gas, K.
        initial_temperature: f64,
    },
}

/// Contact of film with film and with plates.
#[derive(Debug, Clone, PartialEq)]
pub struct FilmContact {
    /// Contact distance, m; `None` for 0.4 times the smallest initial gap that is not that of a single spot. A capsule
    /// has a default of its design ([`crate::models::film::capsule::resolved_contact`]).
    pub distance: Option<f64>,
    /// Coulomb friction coefficient.
    pub friction: f64,
    /// Pull-off pressure of adhesion, Pa.
    pub adhesion: f64,
    /// Range of adhesion beyond the contact distance, m; `None` for the contact distance.
    pub adhesion_range: Option<f64>,
    /// Rigid plates that touch the film.
    pub plates: Vec<Plate>,
    /// Pairs of elements without contact: they touch or cross at the start.
    pub ignored: Vec<[u32; 2]>,
    /// Settings of the tunnelling monitor.
    pub monitor: MonitorSettings,
}

impl FilmContact {
    /// The contact of a capsule's scene.
    pub fn of(contact: &Contact) -> Self {
        let Contact { distance, friction, adhesion } = *contact;
        Self { distance, friction, adhesion, ..Self::default() }
    }
}

impl Default for FilmContact {
    fn default() -> Self {
        Self {
            distance: None,
            friction: 0.0,
            adhesion: 0.0,
            adhesion_range: None,
            plates: Vec::new(),
            ignored: Vec::new(),
            monitor: MonitorSettings::FRAMES,
        }
    }
}

/// Solution parameters.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct FilmSolver {
    /// Integrator.
    pub integrator: IntegratorKind,
    /// Fraction of the stable step (CFL number), above 0, at most 1.
    pub cfl: f64,
    /// Simulated time, s; statics ignores it.
    pub end_time: f64,
    /// Whether to compute the static equilibrium instead of the motion; requires
    /// [`Filling::Pressure`].
    pub statics: bool,
    /// Mass damping c, 1/s.
    pub mass_damping: f64,
    /// Maximum number of accepted steps; a run that reaches it stops with `step_limit`.
    pub step_limit: u64,
    /// Instruction set; each gives the same bits.
    pub instruction_set: InstructionSet,
}

/// What is recorded of a run.
#[derive(Debug, Clone, PartialEq)]
pub struct FilmOutputs {
    /// Time between samples, s.
    pub sample_interval: f64,
    /// Nodes whose positions are recorded.
    pub nodes: Vec<u32>,
    /// Elements whose membrane forces are recorded.
    pub elements: Vec<u32>,
    /// Number of frames (shapes) to keep ([`crate::output::frames`]); 0 for none.
    pub frames: u32,
}
