//! How far two parts of a film have moved towards each other at most.
//!
//! ```text
//! way(G, H) = |ū_G − ū_H| + max |u_i − ū_G| + max |u_j − ū_H|       nodes i of G, j of H
//! ```
//!
//! Symbols: u displacement of a node, ū its mean over a zone, m. No distance between film of G and film
//! of H has shrunk by more. Neighbouring film moves together, so this is far less than twice the
//! largest displacement anywhere.

use nalgebra::Vector3;

use super::hierarchy::Hierarchy;
use crate::geometry::field::Field;

/// Most zones of a film.
const MOST: usize = 32;
/// Share by which rounding could shorten a way at most.
const ROUNDING: f64 = 1.0 + 1e-9;

/// A film in zones: subtrees of its patches.
#[derive(Debug, Clone, PartialEq)]
pub struct MotionClusters {
    /// Number of zones, a power of two: nodes `count..2 count` of the tree.
    count: usize,
    /// Nodes of the film in each.
    nodes: Vec<Vec<u32>>,
}

impl MotionClusters {
    /// The zones of a film.
    pub fn new(patches: &Hierarchy) -> Self {
        let count = MOST.min(patches.leaves());
        let under = patches.leaves() / count;
        let nodes = (0..count).map(|zone| {
            let leaves = patches.leaves() + zone * under..patches.leaves() + (zone + 1) * under;
            let mut nodes: Vec<u32> =
                leaves.flat_map(|leaf| patches.corners(leaf)).copied().collect();
            nodes.sort_unstable();
            nodes.dedup();
            nodes
        });
        Self { count, nodes: nodes.collect() }
    }

    /// Number of pairs of zones, those of a zone with itself counted.
    pub fn pairs(&self) -> usize {
        self.count * (self.count + 1) / 2
    }

    /// The number of a pair of zones, the lower first.
    #[inline]
    fn number(&self, one: usize, two: usize) -> usize {
        // So many come before the first of `one`.
        one * (2 * self.count - one + 1) / 2 + two - one
    }

    /// First node of the tree that is a zone.
    pub fn first(&self) -> usize {
        self.count
    }

    /// The pair of zones two nodes of the tree lie in; they must be zones or below.
    #[inline]
    pub fn pair(&self, a: usize, b: usize) -> usize {
        let zone = |node: usize| (node >> (node.ilog2() - self.count.ilog2())) - self.count;
        let (a, b) = (zone(a), zone(b));
        self.number(a.min(b), a.max(b))
    }

    /// Adds to `ways`, a number for each pair of zones, how far the two have come towards each other at
    /// most between two places of all nodes, m; gives the largest displacement of a node, m.
    pub fn travel(&self, from: &Field, to: &Field, ways: &mut [f64]) -> f64 {
        let mut own = Vec::with_capacity(self.count);
        let mut largest = 0.0_f64;
        for nodes in &self.nodes {
            let way = |node: &u32| to.get(*node as usize) - from.get(*node as usize);
            let sum: Vector3<f64> = nodes.iter().map(way).sum();
            let mean = if nodes.is_empty() { sum } else { sum / nodes.len() as f64 };
            let apart = nodes.iter().map(|node| (way(node) - mean).norm_squared());
            let apart = apart.fold(0.0, f64::max).sqrt();
            largest = largest.max(mean.norm() + apart);
            own.push((mean, apart));
        }
        for (one, (mean, apart)) in own.iter().enumerate() {
            for (two, (other, far)) in own.iter().enumerate().skip(one) {
                let way = (mean - other).norm() + apart + far;
                ways[self.number(one, two)] += way * ROUNDING;
            }
        }
        largest
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    proptest! {
        /// No two nodes of two zones come nearer by more than is told.
        #[test]
        fn ways_are_bounds(
            from in prop::collection::vec(prop::array::uniform3(-1.0..1.0_f64), 12),
            ways in prop::collection::vec(prop::array::uniform3(-1.0..1.0_f64), 12),
            drift in prop::array::uniform3(-9.0..9.0_f64),
        ) {
            let sides = [[0, 1, 2], [3, 4, 5], [6, 7, 8], [9, 10, 11]];
            let patches = Hierarchy::new(12, &sides, &sides, 12);
            let zones = MotionClusters::new(&patches);
            let from: Vec<Vector3<f64>> = from.into_iter().map(Vector3::from).collect();
            let to: Vec<Vector3<f64>> = from
                .iter()
                .zip(ways)
                .map(|(x, way)| x + Vector3::from(way) + Vector3::from(drift))
                .collect();
            let mut ways = vec![0.0; zones.pairs()];
            zones.travel(&Field::of(&from), &Field::of(&to), &mut ways);
            for a in patches.leaves()..patches.tree() {
                for b in a..patches.tree() {
                    let way = ways[zones.pair(a, b)];
                    for p in patches.corners(a).iter().map(|node| *node as usize) {
                        for q in patches.corners(b).iter().map(|node| *node as usize) {
                            let closer = ((to[p] - from[p]) - (to[q] - from[q])).norm();
                            prop_assert!(closer <= way, "{closer} {way}");
                        }
                    }
                }
            }
        }
    }
}
