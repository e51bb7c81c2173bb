//! The constant data of collision detection on one mesh.

use super::adjacent::AdjacentPairs;
use super::hierarchy::Hierarchy;
use super::query::QueryKind;
use crate::geometry::topology::Topology;

/// A mesh prepared for collision detection; constant.
#[derive(Debug, Clone, PartialEq)]
pub struct CollisionMesh {
    /// Edges and incidences.
    pub topology: Topology,
    /// Bounding-volume hierarchy over the elements.
    pub hierarchy: Hierarchy,
    /// Candidate pairs of elements that share a node, for collision and for intersection queries.
    adjacent_pairs: [AdjacentPairs; 2],
}

impl CollisionMesh {
    /// Prepares the mesh of `triangles` over `nodes` nodes.
    pub fn new(nodes: usize, triangles: &[[u32; 3]]) -> Self {
        let topology = Topology::new(nodes, triangles);
        let hierarchy =
            Hierarchy::new(nodes, triangles, &topology.element_edges, topology.edges.len());
        let adjacent_pairs = [QueryKind::Collision, QueryKind::Intersection]
            .map(|kind| AdjacentPairs::new(kind, nodes, &hierarchy));
        Self { topology, hierarchy, adjacent_pairs }
    }

    /// Candidate pairs of elements that share a node.
    pub fn adjacent_pairs(&self, kind: QueryKind) -> &AdjacentPairs {
        match kind {
            QueryKind::Collision => &self.adjacent_pairs[0],
            QueryKind::Intersection => &self.adjacent_pairs[1],
        }
    }
}
