//! What made a result: program, commit, physics.

/// Version of the program.
pub const PROGRAM_VERSION: &str = env!("CARGO_PKG_VERSION");

/// Commit the program was built from, "unknown" outside a repository, "+" where the tree held
/// changes.
pub const COMMIT: &str = env!("BILLOW_COMMIT");

/// Version of the physics: part of every job id.
pub const PHYSICS_VERSION: u32 = billow_solver::PHYSICS_VERSION;
