//! What a user writes: the study file, its keys, units and expressions, and the JSON Schema of both
//! file kinds.

pub mod expression;
pub mod keys;
pub mod schema;
pub(crate) mod settings;
pub(crate) mod source;
pub mod study_file;
pub(crate) mod supports;
pub mod units;
pub mod value;
