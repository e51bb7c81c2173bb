//! The constant data of collision detection on one mesh.

use super::adjacent::AdjacentPairs;
use super::hierarchy::Hierarchy;
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
