//! The search of the monitor: pairs of primitives that may meet on a straight motion of all nodes.
//!
//! ```text
//! boxes of two elements overlap  →  no plane separates the elements  →  no plane separates the primitives
//! ```
//!
//! Every node may also deviate from its straight motion by a reach. The search has no history: the same
//! frames give the same pairs. It shares no code with the broad phase and the distances of contact.

use super::boxes::{BATCH, BoxPairs};
use super::primitives::{MAX_CROSSING_DISTANCE, Primitives};
use super::query::{Pairs, QueryKind};
use super::separation::{Motion, PairTest, filter_pairs};
use crate::geometry::field::Field;
use crate::geometry::topology::Topology;
use crate::platform::simd::InstructionSet;

/// Distance at which a pair counts as apart, over the largest distance of a node from the origin: the
/// tolerance of crossing edges, times the sum of their lengths. It also covers rounding.
const APART_PER_SIZE: f64 = 4.0 * MAX_CROSSING_DISTANCE;

/// The motion between two frames with this reach (m) of every node. For the motion around one frame, give it twice.
pub fn motion_between<'a>(from: &'a Field, to: &'a Field, reach: f64) -> Motion<'a> {
    let size = if core::ptr::eq(from, to) { from.size() } else { from.size().max(to.size()) };
    Motion { from, to, distance: 2.0 * reach + APART_PER_SIZE * size }
}

/// Removes all pairs.
pub fn clear(pairs: &mut Pairs) {
    pairs.iter_mut().for_each(Vec::clear);
}

/// Finds pairs of elements without a common node that may meet, and the pairs of their primitives; holds scratch
/// memory.
#[derive(Debug, Clone, PartialEq)]
pub struct PairSearch {
    /// What it looks for.
    pub kind: QueryKind,
    /// Instruction set. Every one gives the same pairs.
    pub instruction_set: InstructionSet,
    /// Primitives of the mesh.
    pub primitives: Primitives,
    boxes: BoxPairs,
    pairs: Pairs,
}

impl PairSearch {
    /// The search on a mesh.
    pub fn new(kind: QueryKind, topology: &Topology, instruction_set: InstructionSet) -> Self {
        Self {
            kind,
            instruction_set,
            primitives: Primitives::new(topology),
            boxes: BoxPairs::default(),
            pairs: Pairs::default(),
        }
    }

    /// Adds the pairs of elements without a common node that may meet while every node is within `reach` (m) of its
    /// place in a frame to `found`. Returns the number of pairs whose boxes overlap; adds nothing and returns `None`
    /// if they are more than `most`.
    pub fn find_elements_near(
        &mut self,
        topology: &Topology,
        frame: &Field,
        reach: f64,
        most: usize,
        found: &mut Vec<[u32; 2]>,
    ) -> Option<usize> {
        let Self { instruction_set, boxes, .. } = self;
        let motion = motion_between(frame, frame, reach);
        let (triangles, half) = (&topology.triangles, 0.5 * motion.distance);
        let (set, kind, before) = (*instruction_set, PairTest::ElementsNow, found.len());
        let overlapping = boxes.find(set, triangles, &[frame], half, most, |pairs| {
            filter_pairs(set, kind, topology, pairs, &motion, found);
        });
        if overlapping.is_none() {
            found.truncate(before);
        }
        overlapping
    }

    /// Replaces `elements` by the pairs of elements without a common node that may meet on a motion, and adds those of
    /// their primitives to `close`.
    pub fn find_distant(
        &mut self,
        topology: &Topology,
        motion: &Motion<'_>,
        elements: &mut Vec<[u32; 2]>,
        close: &mut Pairs,
    ) {
        let Self { kind, instruction_set, boxes, .. } = self;
        let frames = [motion.from, motion.to];
        let frames = if *kind == QueryKind::Passages { &frames[..] } else { &frames[..1] };
        let half = 0.5 * motion.distance;
        elements.clear();
        let (set, kind) = (*instruction_set, kind.elements());
        boxes.find(set, &topology.triangles, frames, half, usize::MAX, |pairs| {
            filter_pairs(set, kind, topology, pairs, motion, elements);
        });
        self.find_primitives(topology, elements, motion, close);
    }

    /// Adds the pairs of primitives of these elements that may meet on a motion to `close`.
    pub fn find_primitives(
        &mut self,
        topology: &Topology,
        elements: &[[u32; 2]],
        motion: &Motion<'_>,
        close: &mut Pairs,
    ) {
        let Self { kind, instruction_set, primitives, pairs, .. } = self;
        for batch in elements.chunks(BATCH) {
            clear(pairs);
            for elements in batch {
                kind.push_pairs(primitives, topology, *elements, pairs);
            }
            kind.filter(*instruction_set, topology, pairs, motion, close);
        }
    }
}
