//! Checks of the solver that do not ship with the program: reference cases, map of failure, benchmark,
//! convergence with the mesh, work and precision of scenes with an exact answer.

pub mod bench;
pub mod cases;
pub mod convergence;
pub mod exact;
pub mod output;
pub mod stability;
