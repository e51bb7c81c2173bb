//! Which program computes a result: version, commit, physics version.

/// Version of the program.
pub const PROGRAM_VERSION: &str = env!("CARGO_PKG_VERSION");

/// Commit of the source; "unknown" outside a repository, with "+" when the tree had changes.
pub const COMMIT: &str = env!("BILLOW_COMMIT");

/// Version of the physics: part of every job id.
pub const PHYSICS_VERSION: u32 = billow_solver::PHYSICS_VERSION;
