//! The constant data of collision detection on one mesh.

use super::adjacent::AdjacentPairs;
use super::hierarchy::Hierarchy;
use super::query::QueryKind;
use crate::geometry::field::Field;
use crate::geometry::topology::Topology;

/// Width of a bin of a monitor's scheduler, as a share of the size of the film. Chosen: a pair is looked at
/// again at the earliest when the film has approached by this much.
const BIN_WIDTH: f64 = 2e-3;

/// Upper bound of that width, as a share of the mean height of the elements. Chosen: in a stack of many narrow layers
/// a bin then holds few of the other layers of an element, not all of them.
const MAX_BIN_WIDTH: f64 = 0.25;

/// Lower bound of that width, as a share of the size of the film, for elements without height. Chosen.
const MIN_BIN_WIDTH: f64 = 1e-6;

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

    /// Width of a bin for a scheduler that looks for pairs that touch, from these positions (m), m. It
    /// decides the cost of a query and its memory, not its answer.
    pub fn bin_width(&self, positions: &Field) -> f64 {
        let height = |corners: &[u32; 3]| {
            let [a, b, c] = corners.map(|node| positions.get(node as usize));
            let edges = [b - a, c - b, a - c];
            let longest = edges.iter().fold(0.0, |longest: f64, edge| longest.max(edge.norm()));
            if longest > 0.0 { edges[0].cross(&edges[1]).norm() / longest } else { 0.0 }
        };
        let triangles = &self.topology.triangles;
        let mean = triangles.iter().map(height).sum::<f64>() / triangles.len() as f64;
        let size = positions.size();
        (BIN_WIDTH * size).min((MAX_BIN_WIDTH * mean).max(MIN_BIN_WIDTH * size))
    }

    /// Candidate pairs of elements that share a node.
    pub fn adjacent_pairs(&self, kind: QueryKind) -> &AdjacentPairs {
        match kind {
            QueryKind::Collision => &self.adjacent_pairs[0],
            QueryKind::Intersection => &self.adjacent_pairs[1],
        }
    }
}
