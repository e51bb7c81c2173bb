//! The search of the monitor: pairs of primitives that may meet on a straight motion of all nodes.
//!
//! ```text
//! boxes of two elements overlap  →  no plane separates the elements  →  no plane separates the primitives
//! ```
//!
//! Every node may also deviate from its straight motion by a reach. The search has no history: the same
//! frames give the same pairs. It shares no code with the broad phase and the distances of contact.

use super::boxes::BoxPairs;
use super::primitives::{
    EDGES, MAX_CROSSING_DISTANCE, NODES, PassagePairs, Primitives, adjacent_elements,
};
use super::separation::{Motion, close_edge_elements, close_edges, close_elements, close_nodes};
use crate::geometry::field::Field;
use crate::geometry::topology::Topology;
use crate::platform::simd::InstructionSet;

/// Distance at which a pair counts as apart, over the largest distance of a node from the origin: the
/// tolerance of crossing edges, times the sum of their lengths. It also covers rounding.
const APART_PER_SIZE: f64 = 4.0 * MAX_CROSSING_DISTANCE;

/// Pairs of elements whose primitives are tested together. Chosen: their memory is small against that of
/// a film.
const BATCH: usize = 4096;

/// Finds pairs of elements that may meet; holds scratch memory.
#[derive(Debug, Clone, PartialEq, Default)]
struct ElementSearch {
    boxes: BoxPairs,
    close: Vec<[u32; 2]>,
}

impl ElementSearch {
    /// The pairs of elements without a common node that may meet; `None` if the boxes of more than `most`
    /// pairs overlap.
    fn find(
        &mut self,
        instruction_set: InstructionSet,
        topology: &Topology,
        motion: &Motion<'_>,
        most: usize,
    ) -> Option<&[[u32; 2]]> {
        let reach = 0.5 * motion.distance;
        let frames = [motion.from, motion.to];
        let frames = if core::ptr::eq(motion.from, motion.to) { &frames[..1] } else { &frames };
        self.close.clear();
        if !self.boxes.find(instruction_set, &topology.triangles, frames, reach, most) {
            return None;
        }
        close_elements(instruction_set, topology, &self.boxes.pairs, motion, &mut self.close);
        Some(&self.close)
    }
}

/// The motion between two frames with this reach (m) of every node.
fn motion_between<'a>(from: &'a Field, to: &'a Field, reach: f64) -> Motion<'a> {
    let size = if core::ptr::eq(from, to) { from.size() } else { from.size().max(to.size()) };
    Motion { from, to, distance: 2.0 * reach + APART_PER_SIZE * size }
}

/// Removes all pairs.
fn clear(pairs: &mut PassagePairs) {
    pairs.iter_mut().for_each(Vec::clear);
}

/// Adds the pairs that no plane separates to `close`.
fn keep_close(
    instruction_set: InstructionSet,
    topology: &Topology,
    pairs: &PassagePairs,
    motion: &Motion<'_>,
    close: &mut PassagePairs,
) {
    close_nodes(instruction_set, topology, &pairs[NODES], motion, &mut close[NODES]);
    close_edges(instruction_set, topology, &pairs[EDGES], motion, &mut close[EDGES]);
}

/// Replaces `close` by those of the pairs that may pass on the straight motion between two frames.
pub fn filter_passages(
    instruction_set: InstructionSet,
    topology: &Topology,
    pairs: &PassagePairs,
    [from, to]: [&Field; 2],
    close: &mut PassagePairs,
) {
    clear(close);
    keep_close(instruction_set, topology, pairs, &motion_between(from, to, 0.0), close);
}

/// Finds the pairs that may pass through each other.
#[derive(Debug, Clone, PartialEq)]
pub struct PassageSearch {
    instruction_set: InstructionSet,
    primitives: Primitives,
    /// Pairs of elements that share a node; constant.
    adjacent: PassagePairs,
    elements: ElementSearch,
    /// Scratch memory: pairs of elements that share no node.
    distant: PassagePairs,
}

impl PassageSearch {
    /// The search on a mesh.
    pub fn new(topology: &Topology, instruction_set: InstructionSet) -> Self {
        let primitives = Primitives::new(topology);
        let mut adjacent = PassagePairs::default();
        adjacent_elements(topology, |pair| primitives.push_passages(topology, pair, &mut adjacent));
        adjacent.iter_mut().for_each(Vec::shrink_to_fit);
        Self {
            instruction_set,
            primitives,
            adjacent,
            elements: ElementSearch::default(),
            distant: PassagePairs::default(),
        }
    }

    /// Replaces `found` by the pairs that may pass on the straight motion between two frames, if every
    /// node may deviate from it by `reach` (m). For the motion around one frame, give it twice.
    ///
    /// Returns the number of pairs of elements whose boxes overlap; finds nothing and returns `None` if
    /// they are more than `most`.
    pub fn find(
        &mut self,
        topology: &Topology,
        [from, to]: [&Field; 2],
        reach: f64,
        most: usize,
        found: &mut PassagePairs,
    ) -> Option<usize> {
        let Self { instruction_set, primitives, adjacent, elements, distant } = self;
        let motion = motion_between(from, to, reach);
        clear(found);
        let close = elements.find(*instruction_set, topology, &motion, most)?;
        keep_close(*instruction_set, topology, adjacent, &motion, found);
        for batch in close.chunks(BATCH) {
            clear(distant);
            for pair in batch {
                primitives.push_passages(topology, *pair, distant);
            }
            keep_close(*instruction_set, topology, distant, &motion, found);
        }
        Some(elements.boxes.pairs.len())
    }
}

/// Finds the edges and elements that may intersect.
#[derive(Debug, Clone, PartialEq)]
pub struct IntersectionSearch {
    instruction_set: InstructionSet,
    primitives: Primitives,
    /// Edges and elements of elements that share a node; constant.
    adjacent: Vec<[u32; 2]>,
    elements: ElementSearch,
    /// Scratch memory: edges and elements of elements that share no node.
    distant: Vec<[u32; 2]>,
}

impl IntersectionSearch {
    /// The search on a mesh.
    pub fn new(topology: &Topology, instruction_set: InstructionSet) -> Self {
        let primitives = Primitives::new(topology);
        let mut adjacent = Vec::new();
        adjacent_elements(topology, |pair| {
            primitives.push_intersections(topology, pair, &mut adjacent);
        });
        adjacent.shrink_to_fit();
        Self {
            instruction_set,
            primitives,
            adjacent,
            elements: ElementSearch::default(),
            distant: Vec::new(),
        }
    }

    /// Replaces `found` by the pairs that may intersect while every node is within `reach` (m) of these positions (m).
    /// `false`, and nothing found, if the boxes of more than `most` pairs of elements overlap.
    pub fn find(
        &mut self,
        topology: &Topology,
        positions: &Field,
        reach: f64,
        most: usize,
        found: &mut Vec<[u32; 2]>,
    ) -> bool {
        let Self { instruction_set, primitives, adjacent, elements, distant } = self;
        let motion = motion_between(positions, positions, reach);
        found.clear();
        let Some(close) = elements.find(*instruction_set, topology, &motion, most) else {
            return false;
        };
        close_edge_elements(*instruction_set, topology, adjacent, &motion, found);
        for batch in close.chunks(BATCH) {
            distant.clear();
            for pair in batch {
                primitives.push_intersections(topology, *pair, distant);
            }
            close_edge_elements(*instruction_set, topology, distant, &motion, found);
        }
        true
    }
}
