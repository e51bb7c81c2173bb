//! Forces on film, each with its energy or its power beside it.
//!
//! An element pass leaves one force a corner; a node pass sums the corners of each node in the
//! order of elements, so the same state gives the same bits. Nothing is allocated in either.

pub mod damping;
pub mod membrane;
pub mod pressure;
