//! Input of one run as plain data: all defaults and units are resolved, no value is "auto".
//!
//! A job id is the hash of a scene's canonical JSON. A new field or another stored name therefore
//! changes job ids, and data without influence on results does not belong in a [`Scene`].

mod capsule;
mod contact;
pub mod error;
mod film;
pub mod film_scene;
pub mod film_support;
mod gas;
pub mod inflow;
pub mod monitor_settings;
pub mod motion;
mod outputs;
pub mod paper;
pub mod plate;
mod solver;
mod support;
pub mod timeline;
mod validate;

pub use capsule::Scene;
pub use contact::Contact;
pub use film::Film;
pub use gas::{GasSupply, HeatTransfer, InflowWindow, Species};
pub use outputs::{MAX_SAMPLES, Outputs, Thresholds};
pub use solver::{DEFAULT_CFL, IntegratorKind, ModelKind, Solver, Stepping};
pub use support::{Support, SupportLocation};
