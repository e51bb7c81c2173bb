//! Broad phase: finds the pairs of film primitives that may be close, without testing every pair in
//! every step.
//!
//! - [`hierarchy`] is a bounding-volume hierarchy over the elements. Its tree is constant.
//! - [`kdop`] bounds each tree node by a k-DOP and gives lower bounds of distances.
//! - [`clusters`] bounds how far two parts of the film have approached each other; [`adjacent`] does
//!   so for elements that share a node.
//! - [`scheduler`] keeps every pair of tree nodes pending in a [`queue`] until its parts have
//!   approached by the distance between them.
//! - [`collision_mesh`] holds the constant data of all of these, and visits all pairs within a radius at once.

pub mod adjacent;
mod bisection;
pub mod clusters;
pub mod collision_mesh;
pub mod hierarchy;
pub mod kdop;
pub mod query;
pub mod queue;
pub mod scheduler;
