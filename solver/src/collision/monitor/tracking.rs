//! The search of the monitor from frame to frame: it tests a pair again when the motion since its last test may
//! have closed its gap.
//!
//! ```text
//! elements that share a node     a constant list; due by the deformation of both elements
//! other elements                 the near list; due by the motion of both elements
//!                                film that moves too far for a near list: a search of the frames
//! ```
//!
//! The pairs found are those that may meet. Whether they do is decided elsewhere, from positions alone.

use super::apart::ApartPairs;
use super::boxes::BATCH;
use super::near_list::NearList;
use super::paths::{ElementPaths, Paths};
use super::primitives::adjacent_elements;
use super::query::{Gaps, Pairs, QueryKind};
use super::search::{PairSearch, clear, motion_between};
use super::separation::{Motion, measure_pairs};
use crate::geometry::field::Field;
use crate::geometry::topology::Topology;
use crate::platform::simd::InstructionSet;

/// Finds the pairs that may meet, from frame to frame.
#[derive(Debug, Clone, PartialEq)]
pub struct PairTracker {
    /// The search without history.
    pub search: PairSearch,
    paths: ElementPaths,
    /// Pairs of elements that share a node.
    adjacent: ApartPairs,
    near: NearList,
    /// Pairs of elements without a common node that no plane separated on the last motion, or when they were last due.
    pub elements: Vec<[u32; 2]>,
    // Scratch memory: numbers of due pairs.
    due: Vec<u32>,
    scratch: Scratch,
}

impl PairTracker {
    /// Starts at these positions (m).
    pub fn new(
        kind: QueryKind,
        topology: &Topology,
        positions: &Field,
        instruction_set: InstructionSet,
    ) -> Self {
        let mut adjacent = ApartPairs::default();
        adjacent.replace(topology.triangles.len(), |pairs| {
            adjacent_elements(topology, |pair| pairs.push(pair));
        });
        Self {
            search: PairSearch::new(kind, topology, instruction_set),
            paths: ElementPaths::new(topology.triangles.len()),
            adjacent,
            near: NearList::new(topology, positions),
            elements: Vec::new(),
            due: Vec::new(),
            scratch: Scratch::default(),
        }
    }

    /// Takes account of the motion from one frame to the next. Call it for every motion.
    pub fn advance(&mut self, topology: &Topology, from: &Field, to: &Field) {
        self.paths.add(self.search.instruction_set, &topology.triangles, from, to);
    }

    /// Replaces `close` by the pairs that may meet on the last motion of [`Self::advance`]: passages on the straight
    /// motion between its two frames, intersections at its last frame.
    pub fn find(&mut self, topology: &Topology, [from, to]: [&Field; 2], close: &mut Pairs) {
        clear(close);
        let motion = match self.search.kind {
            QueryKind::Passages => motion_between(from, to, 0.0),
            QueryKind::Intersections => motion_between(to, to, 0.0),
        };
        self.find_adjacent(topology, &motion, close);
        let Self { near, search, paths, .. } = self;
        let covered =
            near.covers(topology, [from, to], &paths.position, |frame, reach, most, found| {
                search.find_elements_near(topology, frame, reach, most, found)
            });
        if covered {
            self.find_near(topology, &motion, close);
        } else {
            self.search.find_distant(topology, &motion, &mut self.elements, close);
        }
    }

    /// Replaces `close` by the pairs that may meet at the last frame of [`Self::advance`]. Of elements without a common
    /// node only those in `elements` may.
    pub fn find_among(
        &mut self,
        topology: &Topology,
        frame: &Field,
        elements: &[[u32; 2]],
        close: &mut Pairs,
    ) {
        clear(close);
        let motion = motion_between(frame, frame, 0.0);
        self.find_adjacent(topology, &motion, close);
        self.search.find_primitives(topology, elements, &motion, close);
    }

    /// Replaces `close` by the pairs that may meet on the straight motion between two frames if every node deviates
    /// from it by at most `reach` (m): without history, from these frames alone.
    pub fn find_without_history(
        &mut self,
        topology: &Topology,
        [from, to]: [&Field; 2],
        reach: f64,
        close: &mut Pairs,
    ) {
        clear(close);
        let motion = motion_between(from, to, reach);
        self.search.find_primitives(topology, self.adjacent.pairs(), &motion, close);
        self.search.find_distant(topology, &motion, &mut self.elements, close);
    }

    /// Tests the due pairs of elements that share a node: primitive by primitive, since such elements always touch.
    fn find_adjacent(&mut self, topology: &Topology, motion: &Motion<'_>, close: &mut Pairs) {
        let Self { search, paths, adjacent, due, scratch, .. } = self;
        adjacent.due(&paths.shape, due);
        scratch.test(search, topology, adjacent, &paths.shape, due, motion, close);
    }

    /// Tests the due pairs of the near list: first the elements, then the primitives of those that no plane separates.
    fn find_near(&mut self, topology: &Topology, motion: &Motion<'_>, close: &mut Pairs) {
        let Self { search, paths, near: NearList { pairs, separated, .. }, .. } = self;
        let Self { due, elements, scratch, .. } = self;
        let (paths, [gaps, _]) = (&paths.position, &mut scratch.gaps);
        pairs.due(paths, due);
        elements.clear();
        elements.extend(due.iter().map(|number| pairs.pairs()[*number as usize]));
        gaps.clear();
        let kind = search.kind.elements();
        measure_pairs(search.instruction_set, kind, topology, elements, motion, gaps);
        let mut gaps = gaps.iter();
        due.retain(|number| {
            let gap = gaps.next().copied().unwrap_or(f64::NAN);
            // Written so that NaN is close.
            let apart = gap > 0.0;
            separated[*number as usize] = apart;
            if apart {
                pairs.defer(*number, paths, gap);
            }
            !apart
        });
        elements.clear();
        let kept = pairs.pairs().iter().zip(&*separated).filter(|(_, separated)| !**separated);
        elements.extend(kept.map(|(pair, _)| pair));
        scratch.test(search, topology, pairs, paths, due, motion, close);
    }
}

/// Scratch memory: the primitives of pairs of elements, the ends of each pair's, and their gaps.
#[derive(Debug, Clone, PartialEq, Default)]
struct Scratch {
    pairs: Pairs,
    ends: Vec<[usize; 2]>,
    gaps: Gaps,
}

impl Scratch {
    /// Tests the primitives of due pairs. Adds those that no plane separates to `close`, and defers each pair by the
    /// smallest gap of its primitives.
    #[expect(clippy::too_many_arguments, reason = "the lists of two callers")]
    fn test(
        &mut self,
        search: &PairSearch,
        topology: &Topology,
        elements: &mut ApartPairs,
        paths: &Paths,
        due: &[u32],
        motion: &Motion<'_>,
        close: &mut Pairs,
    ) {
        let Self { pairs, ends, gaps } = self;
        let PairSearch { kind, instruction_set, primitives, .. } = search;
        for batch in due.chunks(BATCH) {
            clear(pairs);
            ends.clear();
            for number in batch {
                kind.push_pairs(primitives, topology, elements.pairs()[*number as usize], pairs);
                ends.push([pairs[0].len(), pairs[1].len()]);
            }
            kind.measure(*instruction_set, topology, pairs, motion, gaps);
            let mut start = [0; 2];
            for (number, end) in batch.iter().zip(&*ends) {
                let mut least = f64::INFINITY;
                for list in 0..2 {
                    for index in start[list]..end[list] {
                        let gap = gaps[list][index];
                        // Written so that NaN is close.
                        if gap > 0.0 {
                            least = least.min(gap);
                        } else {
                            least = f64::NEG_INFINITY;
                            close[list].push(pairs[list][index]);
                        }
                    }
                }
                elements.defer(*number, paths, least);
                start = *end;
            }
        }
    }
}
