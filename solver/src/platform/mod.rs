//! What the solver takes from the machine and from its tests: vector instructions, a
//! stopwatch the caller may hold, work of known size, faults injected on purpose.

pub mod fault_injection;
pub mod probe;
pub mod simd;
pub mod stopwatch;
