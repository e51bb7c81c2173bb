//! The constant data of collision detection on one mesh, and a search of it without any history.

use super::adjacent::AdjacentPairs;
use super::hierarchy::{Hierarchy, push_child_pairs};
use super::kdop::KDops;
use super::query::{Candidates, PairKind, push_candidates};
use crate::geometry::topology::Topology;

/// A mesh prepared for collision detection; constant.
#[derive(Debug, Clone, PartialEq)]
pub struct CollisionMesh {
    /// Edges and incidences.
    pub topology: Topology,
    /// Bounding-volume hierarchy over the elements.
    pub hierarchy: Hierarchy,
    /// Candidate pairs of elements that share a node.
    pub adjacent_pairs: AdjacentPairs,
}

impl CollisionMesh {
    /// Prepares the mesh of `triangles` over `nodes` nodes.
    pub fn new(nodes: usize, triangles: &[[u32; 3]]) -> Self {
        let topology = Topology::new(nodes, triangles);
        let hierarchy =
            Hierarchy::new(nodes, triangles, &topology.element_edges, topology.edges.len());
        let adjacent_pairs = AdjacentPairs::new(nodes, &hierarchy);
        Self { topology, hierarchy, adjacent_pairs }
    }
}

/// Calls `visit` with every candidate whose leaves have k-DOPs no farther apart than `radius` (m).
/// Candidates that are farther apart than `radius` may be among them; none within it is missing.
pub fn pairs_within_bounds(
    mesh: &CollisionMesh,
    kdops: &KDops,
    radius: f64,
    mut visit: impl FnMut(PairKind, [u32; 2]),
) {
    let first_leaf = mesh.hierarchy.first_leaf();
    let mut stack = vec![[1_u32, 1]];
    let mut candidates = Candidates::default();
    while let Some(pair) = stack.pop() {
        let [a, b] = pair.map(|index| index as usize);
        if a != b && kdops.separation(a, b) > radius {
            continue;
        }
        if a < first_leaf {
            push_child_pairs(pair, &mut stack);
            continue;
        }
        push_candidates(&mesh.hierarchy, a, b, &mut candidates);
        for (kind, pairs) in PairKind::ALL.into_iter().zip(&mut candidates) {
            for pair in pairs.drain(..) {
                visit(kind, pair);
            }
        }
    }
}
