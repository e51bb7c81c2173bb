//! Input of one run as plain data: all defaults and units are resolved, no value is "auto".
//!
//! A job id is the hash of a scene's canonical JSON. A new field or another stored name therefore
//! changes job ids, and data without influence on results does not belong in a [`Scene`].

mod design;
pub mod error;
pub mod film_scene;
pub mod film_support;
pub mod inflow;
mod job;
pub mod monitor_settings;
pub mod motion;
pub mod paper;
pub mod plate;
mod species;
pub mod tank;
pub mod timeline;
mod validate;

pub use design::{Design, MeshDesign, MeshFilm};
pub use job::{
    Contact, Creases, DEFAULT_CFL, Film, GasSupply, HeatTransfer, InflowWindow, IntegratorKind,
    MAX_SAMPLES, ModelKind, Outputs, Scene, Solver, Stepping, Support, SupportLocation, Thresholds,
    Vent,
};
pub use species::Species;
