//! Vector instructions, checksums of texts, a stopwatch interface, a floating-point throughput probe, and
//! fault injection.
//! Nothing here knows the physics.

pub mod fault_injection;
pub mod probe;
pub mod seal;
pub mod simd;
pub mod stopwatch;
