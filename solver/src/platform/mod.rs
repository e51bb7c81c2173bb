//! Vector instructions, pseudo-random numbers, checksums of texts, a stopwatch interface, and fault injection.
//! Nothing here knows the physics.

pub mod fault_injection;
pub mod random;
pub mod seal;
pub mod simd;
pub mod stopwatch;
