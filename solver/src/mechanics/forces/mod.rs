//! Forces on the film, each with its energy or its power.
//!
//! One loop over the elements adds their forces to the nodes, in the order of the elements: the same
//! state gives the same bits. The loop allocates nothing.

pub mod closure;
pub mod damping;
pub mod membrane;
pub mod pressure;
pub mod tangent;
