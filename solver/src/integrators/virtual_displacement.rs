//! Pseudo-random numbers of nodes for the audits: weights of sums and virtual displacements.
//!
//! They are a function of the number of the node alone, so an audit of a resumed run has the same ones. Weights that
//! follow no pattern let no symmetry of the film hide an error.

use nalgebra::Vector3;

use crate::platform::random::{hash, unit};

/// A number of a node in [−1, 1): of its own number and an axis.
fn random(node: usize, axis: u64) -> f64 {
    2.0 * unit(hash(0, 4 * node as u64 + axis + 1)) - 1.0
}

/// Weight of a node, ½ to 1½.
pub(super) fn weight(node: usize) -> f64 {
    1.0 + 0.5 * random(node, 0)
}

/// A displacement of a node with components in [−1, 1), m.
pub(super) fn displacement(node: usize) -> Vector3<f64> {
    Vector3::new(random(node, 1), random(node, 2), random(node, 3))
}
