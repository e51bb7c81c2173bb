//! Forces on film, each with its energy or its power beside it.
//!
//! One pass over the elements adds what each gives to its nodes, in the order of elements, so the same
//! state gives the same bits. Nothing is allocated in it.

pub mod damping;
pub mod membrane;
pub mod pressure;
