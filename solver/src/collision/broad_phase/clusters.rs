//! Upper bounds of how far two parts of the film have approached each other.
//!
//! ```text
//! b(G, H) = |ū_G − ū_H| + max |u_i − ū_G| + max |u_j − ū_H|       nodes i of G, j of H
//! ```
//!
//! Symbols: u displacement of a node, ū its mean over a motion cluster, m. No distance between a
//! point of cluster G and a point of cluster H has shrunk by more than b. Neighbouring film moves
//! together, so b is far smaller than twice the largest displacement of any node.

use nalgebra::Vector3;

use super::hierarchy::Hierarchy;

/// Largest number of motion clusters; a power of two. Chosen: a compromise between the cost of a query,
/// which grows with the square of this number, and the tightness of the bounds.
const MAX_CLUSTERS: usize = 32;

/// Leaves in a motion cluster, at least. Chosen: in a small film the queues of many clusters cost more than their
/// tighter bounds save. The small meshes of unit tests have several clusters all the same.
const MIN_LEAVES: usize = if cfg!(test) { 1 } else { 512 };

/// Factor on a bound that covers rounding. Chosen: far above the relative error of the sums (about
/// 1e-13 for a cluster of 1000 nodes), far below any effect on cost.
const ROUNDING_FACTOR: f64 = 1.0 + 1e-9;

/// The motion clusters of a film: the subtrees of its hierarchy at one level.
#[derive(Debug, Clone, PartialEq)]
pub struct MotionClusters {
    /// Number of clusters, a power of two. Their tree nodes are `count..2 * count`.
    count: usize,
    /// Mesh nodes of each cluster.
    nodes: Vec<Vec<u32>>,
}

impl MotionClusters {
    /// The motion clusters of a hierarchy.
    pub fn new(hierarchy: &Hierarchy) -> Self {
        Self::of(hierarchy, (hierarchy.first_leaf() / MIN_LEAVES).clamp(1, MAX_CLUSTERS))
    }

    /// This number of motion clusters, a power of two.
    fn of(hierarchy: &Hierarchy, count: usize) -> Self {
        let leaves_per_cluster = hierarchy.first_leaf() / count;
        let nodes = (0..count).map(|cluster| {
            let leaves = hierarchy.first_leaf() + cluster * leaves_per_cluster
                ..hierarchy.first_leaf() + (cluster + 1) * leaves_per_cluster;
            let mut nodes: Vec<u32> =
                leaves.flat_map(|leaf| hierarchy.corners(leaf)).copied().collect();
            nodes.sort_unstable();
            nodes.dedup();
            nodes
        });
        Self { count, nodes: nodes.collect() }
    }

    /// Number of pairs of clusters, including each cluster with itself.
    pub fn pairs(&self) -> usize {
        self.count * (self.count + 1) / 2
    }

    /// Index of the pair of clusters `a` and `b`, `a` not above `b`.
    #[inline]
    fn pair_index(&self, a: usize, b: usize) -> usize {
        // The first term is the number of pairs whose lower cluster is below `a`.
        a * (2 * self.count - a + 1) / 2 + b - a
    }

    /// Tree nodes that are clusters.
    pub fn tree_nodes(&self) -> core::ops::Range<usize> {
        self.count..2 * self.count
    }

    /// Index of the pair of clusters that contain two tree nodes. Each of the two must be a cluster
    /// or a descendant of one.
    #[inline]
    pub fn pair_of(&self, a: usize, b: usize) -> usize {
        let cluster = |node: usize| (node >> (node.ilog2() - self.count.ilog2())) - self.count;
        let (a, b) = (cluster(a), cluster(b));
        self.pair_index(a.min(b), a.max(b))
    }

    /// Adds to `approach_bounds` (m), one entry per pair of clusters, the bound b of these displacements of all nodes
    /// (m).
    pub fn add_approach_bounds(&self, displacements: &[Vector3<f64>], approach_bounds: &mut [f64]) {
        let mut motions = Vec::with_capacity(self.count);
        for nodes in &self.nodes {
            let displacement = |node: &u32| displacements[*node as usize];
            let sum: Vector3<f64> = nodes.iter().map(displacement).sum();
            let mean = if nodes.is_empty() { sum } else { sum / nodes.len() as f64 };
            let squares = nodes.iter().map(|node| (displacement(node) - mean).norm_squared());
            let deviation = squares.fold(0.0, f64::max).sqrt();
            motions.push((mean, deviation));
        }
        for (a, (mean_a, deviation_a)) in motions.iter().enumerate() {
            for (b, (mean_b, deviation_b)) in motions.iter().enumerate().skip(a) {
                let bound = (mean_a - mean_b).norm() + deviation_a + deviation_b;
                approach_bounds[self.pair_index(a, b)] += bound * ROUNDING_FACTOR;
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    proptest! {
        /// No two nodes of two clusters approach each other by more than the bound.
        #[test]
        fn approach_is_never_underestimated(
            displacements in prop::collection::vec(prop::array::uniform3(-1.0..1.0_f64), 12),
            drift in prop::array::uniform3(-9.0..9.0_f64),
            count in prop::sample::select(vec![1, 2, 4]),
        ) {
            let triangles = [[0, 1, 2], [3, 4, 5], [6, 7, 8], [9, 10, 11]];
            let hierarchy = Hierarchy::new(12, &triangles, &triangles, 12);
            let clusters = MotionClusters::of(&hierarchy, count);
            let u: Vec<Vector3<f64>> =
                displacements.into_iter().map(|u| Vector3::from(u) + Vector3::from(drift)).collect();
            let mut bounds = vec![0.0; clusters.pairs()];
            clusters.add_approach_bounds(&u, &mut bounds);
            for a in hierarchy.leaves() {
                for b in a..hierarchy.end() {
                    let bound = bounds[clusters.pair_of(a, b)];
                    for p in hierarchy.corners(a).iter().map(|node| *node as usize) {
                        for q in hierarchy.corners(b).iter().map(|node| *node as usize) {
                            let approach = (u[p] - u[q]).norm();
                            prop_assert!(approach <= bound, "{approach} {bound}");
                        }
                    }
                }
            }
        }
    }
}
