//! Pairs of primitives that contact acts on.

use nalgebra::Vector3;
use serde::{Deserialize, Serialize};

pub use crate::collision::broad_phase::query::PairKind;

use super::distance::{Closest, point_triangle, segment_segment};
use crate::geometry::topology::Topology;

/// Two primitives that can collide: a node and an element, or two edges, the lower number first.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Serialize, Deserialize)]
pub struct Pair {
    /// Kind.
    pub kind: PairKind,
    /// Node, or lower edge.
    pub first: u32,
    /// Element, or higher edge.
    pub second: u32,
}

impl Pair {
    /// Its four nodes. The first [`Self::nodes_of_first`] of them belong to the first primitive.
    #[inline(always)]
    #[expect(clippy::inline_always, reason = "inside the kernels of distances")]
    pub fn nodes(self, topology: &Topology) -> [u32; 4] {
        match self.kind {
            PairKind::NodeElement => {
                let [a, b, c] = topology.triangles[self.second as usize];
                [self.first, a, b, c]
            }
            PairKind::EdgeEdge => {
                let [a, b] = topology.edges[self.first as usize];
                let [c, d] = topology.edges[self.second as usize];
                [a, b, c, d]
            }
        }
    }

    /// Number of nodes of the first primitive.
    pub fn nodes_of_first(self) -> usize {
        match self.kind {
            PairKind::NodeElement => 1,
            PairKind::EdgeEdge => 2,
        }
    }

    /// Closest points of the pair whose nodes have the positions `x` (m).
    #[inline]
    pub fn closest(self, x: &[Vector3<f64>; 4]) -> Closest {
        match self.kind {
            PairKind::NodeElement => point_triangle(x),
            PairKind::EdgeEdge => segment_segment(x),
        }
    }
}

/// A pair that may be in contact soon.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct CandidatePair {
    /// The pair.
    pub pair: Pair,
    /// Its gap when it was measured last, m.
    pub gap: f64,
}
