//! Pseudo-random numbers of nodes for the audits: weights of sums and virtual displacements.
//!
//! They are a function of the number of the node alone, so an audit of a resumed run has the same ones. Weights that
//! follow no pattern let no symmetry of the film hide an error.

use nalgebra::Vector3;

/// A number of a node in [−1, 1): the hash `SplitMix64` (G. L. Steele et al., "Fast splittable pseudorandom number
/// generators", 2014) of its number and an axis.
fn random(node: usize, axis: u64) -> f64 {
    let mut z = (4 * node as u64 + axis + 1).wrapping_mul(0x9E37_79B9_7F4A_7C15);
    z = (z ^ (z >> 30)).wrapping_mul(0xBF58_476D_1CE4_E5B9);
    z = (z ^ (z >> 27)).wrapping_mul(0x94D0_49BB_1331_11EB);
    z ^= z >> 31;
    (z >> 11) as f64 / (1_u64 << 52) as f64 - 1.0
}

/// Weight of a node, ½ to 1½.
pub(super) fn weight(node: usize) -> f64 {
    1.0 + 0.5 * random(node, 0)
}

/// A displacement of a node with components in [−1, 1), m.
pub(super) fn displacement(node: usize) -> Vector3<f64> {
    Vector3::new(random(node, 1), random(node, 2), random(node, 3))
}
