//! One scene without a study: its file, its run, its summary.

pub mod check;
pub mod file;
mod next_steps;
pub mod solve;
pub mod summary;
