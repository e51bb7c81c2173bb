//! What the study crate takes from the machine: files, signals, the identity of the program, errors.

pub mod error;
pub mod exit_code;
pub mod files;
pub mod provenance;
pub mod stop;
