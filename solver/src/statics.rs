//! Static states of film: where it rests under a fixed overpressure, its weight and its supports.

pub mod dense;
pub mod factor;
pub mod newton;
pub mod order;
pub mod tangent;
pub mod unknowns;

pub use newton::{
    Iteration, Loaded, Rest, Settling, StaticFailure, StaticFailureKind, Watch, equilibrium,
};
