//! One scene without a study: the scene file, its run, its summary.

pub mod file;
pub mod solve;
pub mod summary;
