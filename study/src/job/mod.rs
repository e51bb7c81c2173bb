//! A job: one scene to run. Its id is the hash of all that decides its result.

pub mod attempt;
pub mod control;
pub mod cost;
pub mod executor;
pub mod id;
pub mod limits;
pub mod memory;
pub mod pace;
pub mod point;
pub mod proportion;
pub mod references;
pub mod result_limit;
pub mod row;
pub mod status;
pub mod suggestions;
pub mod surroundings;

pub use id::{JobId, canonical_json};
pub use point::{Job, Parameters, label};
pub use status::Status;
