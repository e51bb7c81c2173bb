//! Checks of the solver that do not ship with the program: reference cases, map of failure, benchmark,
//! convergence with the mesh, work and precision of scenes with an exact answer.

/// Prints a line on stderr, as the standard macro of this name does, which ends the program when stderr
/// is closed or full. This one loses the line instead.
macro_rules! eprintln {
    ($($part:tt)*) => {
        billow_study::platform::output::message(format_args!($($part)*))
    };
}

pub mod bench;
pub mod cases;
pub mod convergence;
pub mod exact;
pub mod output;
pub mod stability;
