//! What a user writes: study files, scene files, their keys, units and expressions, and the JSON
//! Schema of both file kinds.

pub mod expression;
pub mod fraction;
pub mod json;
pub mod keys;
pub(crate) mod object;
pub(crate) mod overrides;
pub(crate) mod place;
pub(crate) mod plausible;
pub mod schema;
pub(crate) mod sections;
pub(crate) mod settings;
pub(crate) mod source;
pub(crate) mod standard_flow;
pub(crate) mod strategy;
pub mod study_file;
pub(crate) mod supports;
pub mod syntax;
pub mod units;
pub mod value;
