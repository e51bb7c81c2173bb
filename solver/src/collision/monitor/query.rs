//! What a search looks for: passages on a motion, or intersections at a frame; and the tests of each.

use super::primitives::{EDGES, NODES, Primitives};
use super::separation::{
    Motion, close_edge_elements_now, close_edges, close_elements, close_elements_now, close_nodes,
    gaps_of_edge_elements_now, gaps_of_edges, gaps_of_elements, gaps_of_elements_now,
    gaps_of_nodes,
};
use crate::geometry::topology::Topology;
use crate::platform::simd::InstructionSet;

/// Pairs of primitives. Of passages: nodes and elements ([`NODES`]), edges and edges ([`EDGES`], the lower number
/// first). Of intersections: edges and elements ([`EDGE_ELEMENTS`]); the other list is empty.
pub type Pairs = [Vec<[u32; 2]>; 2];

/// Pairs of an edge and an element.
pub const EDGE_ELEMENTS: usize = 0;

/// The gaps of pairs of primitives, m.
pub type Gaps = [Vec<f64>; 2];

/// What a search looks for.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum QueryKind {
    /// Passages on the straight motion between two frames.
    Passages,
    /// Intersections at the first frame.
    Intersections,
}

impl QueryKind {
    /// Adds the primitives of two elements that can meet to `pairs`.
    pub fn push_pairs(
        self,
        primitives: &Primitives,
        topology: &Topology,
        elements: [u32; 2],
        pairs: &mut Pairs,
    ) {
        match self {
            Self::Passages => primitives.push_passages(topology, elements, pairs),
            Self::Intersections => {
                primitives.push_intersections(topology, elements, &mut pairs[EDGE_ELEMENTS]);
            }
        }
    }

    /// Adds the pairs that no plane separates to `close`.
    pub fn filter(
        self,
        set: InstructionSet,
        topology: &Topology,
        pairs: &Pairs,
        motion: &Motion<'_>,
        close: &mut Pairs,
    ) {
        match self {
            Self::Passages => {
                close_nodes(set, topology, &pairs[NODES], motion, &mut close[NODES]);
                close_edges(set, topology, &pairs[EDGES], motion, &mut close[EDGES]);
            }
            Self::Intersections => {
                let close = &mut close[EDGE_ELEMENTS];
                close_edge_elements_now(set, topology, &pairs[EDGE_ELEMENTS], motion, close);
            }
        }
    }

    /// Replaces `gaps` by how much the gap of each pair exceeds the distance of the motion, m.
    pub fn measure(
        self,
        set: InstructionSet,
        topology: &Topology,
        pairs: &Pairs,
        motion: &Motion<'_>,
        gaps: &mut Gaps,
    ) {
        gaps.iter_mut().for_each(Vec::clear);
        match self {
            Self::Passages => {
                gaps_of_nodes(set, topology, &pairs[NODES], motion, &mut gaps[NODES]);
                gaps_of_edges(set, topology, &pairs[EDGES], motion, &mut gaps[EDGES]);
            }
            Self::Intersections => {
                let gaps = &mut gaps[EDGE_ELEMENTS];
                gaps_of_edge_elements_now(set, topology, &pairs[EDGE_ELEMENTS], motion, gaps);
            }
        }
    }

    /// [`Self::filter`] for pairs of elements.
    pub fn filter_elements(
        self,
        set: InstructionSet,
        topology: &Topology,
        elements: &[[u32; 2]],
        motion: &Motion<'_>,
        close: &mut Vec<[u32; 2]>,
    ) {
        match self {
            Self::Passages => close_elements(set, topology, elements, motion, close),
            Self::Intersections => close_elements_now(set, topology, elements, motion, close),
        }
    }

    /// [`Self::measure`] for pairs of elements.
    pub fn measure_elements(
        self,
        set: InstructionSet,
        topology: &Topology,
        elements: &[[u32; 2]],
        motion: &Motion<'_>,
        gaps: &mut Vec<f64>,
    ) {
        gaps.clear();
        match self {
            Self::Passages => gaps_of_elements(set, topology, elements, motion, gaps),
            Self::Intersections => gaps_of_elements_now(set, topology, elements, motion, gaps),
        }
    }
}
