//! What a search looks for: passages on a motion, or intersections at a frame; and the tests of each.

use super::primitives::Primitives;
use super::separation::{Motion, PairTest, filter_pairs, measure_pairs};
use crate::geometry::topology::Topology;
use crate::platform::simd::InstructionSet;

/// Pairs of primitives. Of passages: nodes and elements ([`NODES`](super::primitives::NODES)), edges and edges ([`EDGES`](super::primitives::EDGES), the lower number
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
    /// The pairs of primitives in each list of [`Pairs`].
    fn primitives(self) -> &'static [PairTest] {
        match self {
            Self::Passages => &[PairTest::NodeElement, PairTest::Edges],
            Self::Intersections => &[PairTest::EdgeElementNow],
        }
    }

    /// The pairs of elements.
    pub fn elements(self) -> PairTest {
        match self {
            Self::Passages => PairTest::Elements,
            Self::Intersections => PairTest::ElementsNow,
        }
    }

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
        for (kind, (pairs, close)) in self.primitives().iter().zip(pairs.iter().zip(close)) {
            filter_pairs(set, *kind, topology, pairs, motion, close);
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
        for (kind, (pairs, gaps)) in self.primitives().iter().zip(pairs.iter().zip(gaps)) {
            gaps.clear();
            measure_pairs(set, *kind, topology, pairs, motion, gaps);
        }
    }
}
