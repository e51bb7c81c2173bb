//! What is known about the error of a result: the table of mesh errors, and which scenes it covers.
//!
//! The table is made by `billow-checks converge --table` from the study mesh-error, its widths by `billow-checks
//! held-back --table` too, and is part of the program. It has entries of every model; rows carry those of film,
//! `billow plan --accuracy` names them all. No clock and no machine has a part in it, so a choice that reads it is
//! the same everywhere.

pub mod assumed;
pub mod choice;
pub mod coordinates;
pub mod entry;
pub mod features;
pub mod promised;
pub mod row;
pub mod table;
#[cfg(test)]
mod tests;

pub use assumed::{ASSUMED_KEYS, AssumedRanges, assumed_value};
pub use choice::{Choice, choice, choices};
pub use coordinates::Coordinates;
pub use entry::{Entry, Method, RelativeError};
pub use features::{Coverage, Features};
pub use promised::{
    NO_ERROR_REASON, NO_ERROR_REASON_MEANING, PROMISED, Promised, error_columns, is_error_column,
};
pub use row::{RowErrors, is_of_pilots, is_unknown, of_pilots, together};
pub use table::MeshErrors;
