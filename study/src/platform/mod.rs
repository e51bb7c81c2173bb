//! The machine: files, signals, version of the program, errors.

pub mod error;
pub mod exit_code;
pub mod files;
pub mod provenance;
pub mod stop;
