//! Time integration.
//!
//! [`dormand_prince`]: Runge-Kutta of order 5(4) for small smooth systems. [`explicit`]: central
//! differences for film and its gas.

pub mod dormand_prince;
pub mod explicit;
