//! The machine: files, signals, output streams, version of the program, errors.

pub mod error;
pub mod exit_code;
pub mod files;
pub mod hash;
pub mod memory;
pub mod nearest;
pub mod output;
pub mod provenance;
pub mod quote;
pub mod stop;
