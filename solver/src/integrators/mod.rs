//! Time integration: [`dormand_prince`] for small smooth systems, [`explicit`] central differences for
//! film.

pub mod dormand_prince;
pub mod explicit;
