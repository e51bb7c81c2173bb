//! What a run of film needs, of any shape: a capsule's scene becomes one, and so does any mesh.
//!
//! Plain data, resolved: nodes by number, SI, nothing called "auto". [`crate::models::film`] runs
//! it.

use nalgebra::Vector3;

use super::film_support::FilmSupport;
use super::monitor_settings::MonitorSettings;
use super::plate::Plate;
use crate::geometry::shell::Shell;
use crate::platform::simd::InstructionSet;
use crate::scene::{Contact, Film, GasSupply};

/// Everything one run of film needs.
#[derive(Debug, Clone, PartialEq)]
pub struct FilmScene {
    /// The film: where it starts, where it is free of stress.
    pub shell: Shell,
    /// Velocity of each node at the start, m/s; none for a start at rest.
    pub velocities: Vec<Vector3<f64>>,
    /// Material.
    pub film: Film,
    /// What presses from inside.
    pub filling: Filling,
    /// What holds the film, or moves it.
    pub supports: Vec<FilmSupport>,
    /// Film against film; `None` lets film pass through film.
    pub contact: Option<FilmContact>,
    /// Acceleration of gravity, m/s².
    pub gravity: Vector3<f64>,
    /// Until when every node is held where it starts and only the gas goes on, s.
    pub release_time: f64,
    /// How it is computed.
    pub solver: FilmSolver,
    /// What is followed.
    pub outputs: FilmOutputs,
}

/// What presses from inside.
#[derive(Debug, Clone, PartialEq)]
pub enum Filling {
    /// This overpressure, Pa, whatever the volume; the film may be open.
    Pressure(f64),
    /// Gas in the closed volume.
    Gas {
        /// The gas, and what enters and leaves it.
        supply: GasSupply,
        /// Its temperature at the start, K.
        initial_temperature: f64,
    },
}

/// How film meets film.
#[derive(Debug, Clone, PartialEq)]
pub struct FilmContact {
    /// Contact distance, m; `None`: 0.4 of the smallest gap at the start
    /// ([`crate::collision::contact::ContactModel::of_film`]).
    pub distance: Option<f64>,
    /// Coulomb friction coefficient.
    pub friction: f64,
    /// Pull-off pressure of adhesion, Pa.
    pub adhesion: f64,
    /// Its range beyond the contact distance, m; `None`: the contact distance.
    pub adhesion_range: Option<f64>,
    /// Rigid plates the film lies against.
    pub plates: Vec<Plate>,
    /// How closely passages are watched for.
    pub watch: MonitorSettings,
}

impl FilmContact {
    /// The contact a capsule's scene names.
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
            watch: MonitorSettings::FRAMES,
        }
    }
}

/// How film is computed.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct FilmSolver {
    /// Share of the stable step, above 0, at most 1.
    pub cfl: f64,
    /// Simulated time, s; no meaning for statics.
    pub end_time: f64,
    /// Look for the state of rest under the pressure instead of moving; needs [`Filling::Pressure`].
    pub statics: bool,
    /// Mass damping c, 1/s.
    pub mass_damping: f64,
    /// Accepted steps after which a run stops with `step_limit`.
    pub step_limit: u64,
    /// Instruction set; the bits are the same on each.
    pub instruction_set: InstructionSet,
}

/// What is followed of a run.
#[derive(Debug, Clone, PartialEq)]
pub struct FilmOutputs {
    /// Time between samples, s.
    pub sample_interval: f64,
    /// Nodes whose places are followed.
    pub nodes: Vec<u32>,
    /// Elements whose stress resultants are followed.
    pub elements: Vec<u32>,
    /// Shapes kept ([`crate::output::frames`]); 0 for none.
    pub frames: u32,
}
