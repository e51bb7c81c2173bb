//! The list of pairs that may be in contact in the next step.
//!
//! ```text
//! a pair is measured again when   path length = path length then + (d − r)/2
//! ```
//!
//! Symbols: d gap of the pair when it was measured, r distance at which contact or adhesion begins, m.
//! Two points approach each other by at most twice the largest displacement of any node.
//!
//! Each pair is in one of three structures: the candidate list, which is measured in every step, a
//! queue of pending pairs, or the broad phase ([`crate::collision::broad_phase::scheduler`]). Pairs that
//! matter are always in the list, whatever the history. Other pairs in the list exert no force. So no
//! result depends on when a pair was measured.

use serde::{Deserialize, Serialize};

use super::broad_phase_fault::BroadPhaseFault;
use super::model::ContactModel;
use super::pair::{CandidatePair, Pair, PairKind};
use crate::collision::broad_phase::queue::PairQueue;
use crate::collision::broad_phase::scheduler::{CandidateScheduler, ProximityQuery};
use crate::geometry::field::Field;
use crate::geometry::topology::Feature;

/// Width of a bin of the pending queues, as a share of the contact distance. Chosen: a pair is
/// measured at most a tenth of the contact distance early.
const PENDING_BIN_WIDTH: f64 = 0.1;

/// Number of bins of a pending queue; a power of two. Chosen: together they span about a hundred
/// contact distances of path length; a pair that is due later is measured early, which costs little.
const PENDING_BINS: usize = 1024;

/// A pair that can matter within this path length becomes a candidate; as a share of the contact
/// distance. Chosen: below [`RELEASE_PATH`], so that pairs do not enter and leave again and again.
const ADMISSION_PATH: f64 = 0.25;

/// A candidate that cannot matter within this path length leaves the list; as a share of the contact
/// distance. Chosen, see [`ADMISSION_PATH`].
const RELEASE_PATH: f64 = 0.75;

/// Smallest path length between two queries of the broad phase, as a share of the mean edge length.
/// Chosen: longer intervals put more pairs into the queues, shorter ones query more often.
const MIN_QUERY_INTERVAL: f64 = 1.0 / 20.0;

/// Upper bound of that path length, as a multiple of the contact distance. Chosen: in a stack of many layers an
/// edge is far longer than the distance of two layers. A query then reaches about ten layers, not all
/// of them, so that the number of pairs grows with the number of layers and not with its square.
const MAX_QUERY_INTERVAL: f64 = 256.0;

/// Path length between two rebuilds of the list without history, in mean edge lengths. Chosen: pairs
/// that were close once and are now far apart leave the queues then; without rebuilds their number
/// would only grow.
const REBUILD_PATH: f64 = 4.0;

/// A feature within contact range of a node, found through one of the elements that contain it.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct FeatureHit {
    /// The feature.
    pub feature: Feature,
    /// The node and the element.
    pub pair: Pair,
    /// Gap now, m.
    pub gap: f64,
    /// Gap at the update before, m.
    pub previous_gap: f64,
}

/// How far the search for candidates has come; with the positions it determines when it starts again.
#[derive(Debug, Clone, Copy, PartialEq, Default, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct SearchProgress {
    /// Sum over the steps of an upper bound of the largest displacement of any node, m.
    pub path_length: f64,
    /// Number of times that the candidates were built without history, the first included.
    pub rebuilds: u64,
}

/// Pairs that may be in contact in the next step, and when the others must be measured.
#[derive(Debug, Clone, PartialEq)]
pub struct CandidateList {
    /// The broad phase: pairs that are far apart.
    scheduler: CandidateScheduler,
    /// Positions at its last query, m.
    query_positions: Field,
    /// Path length up to which its last query is valid, m.
    query_valid_until: f64,
    /// Pending pairs of each kind, due at a path length.
    pending: [PairQueue; 2],
    /// Pairs that are measured in every step, in the order of [`Pair`].
    pub candidates: Vec<CandidatePair>,
    /// Smallest gap of the pairs closer than their contact distance, m; infinite if there is none.
    /// Pairs beyond the contact distance are not considered.
    pub smallest_gap: f64,
    /// Whether contact or a plate may have exerted a force at the last update; `true` before the first.
    pub contact_active: bool,
    // Scratch memory: pairs, their gaps, and the features within range of a node.
    due: Vec<[u32; 2]>,
    pub(super) gaps: Vec<f64>,
    pub(super) hits: Vec<FeatureHit>,
}

/// Smallest path length between two queries of the broad phase, m.
fn query_interval(model: &ContactModel) -> f64 {
    (MIN_QUERY_INTERVAL * model.edge_length).min(MAX_QUERY_INTERVAL * model.distance)
}

impl ContactModel {
    /// Path length until a pair with this gap (m) can matter, m; negative if it may matter already.
    fn free_path_length(&self, kind: PairKind, gap: f64) -> f64 {
        let adhesion_range = match kind {
            PairKind::NodeElement => self.adhesion.range,
            PairKind::EdgeEdge => 0.0,
        };
        0.5 * self.bound_factor() * (gap - self.distance_of(kind) - adhesion_range)
    }
}

impl CandidateList {
    /// The list at these positions (m) and this path length (m).
    pub fn build(model: &ContactModel, positions: &Field, path_length: f64) -> Self {
        let bin_width = 0.5 * query_interval(model);
        let queue =
            || PairQueue::new(PENDING_BIN_WIDTH * model.distance, PENDING_BINS, path_length);
        let mut list = Self {
            scheduler: CandidateScheduler::new(&model.mesh, bin_width, model.instruction_set),
            query_positions: positions.clone(),
            query_valid_until: f64::NEG_INFINITY,
            pending: [queue(), queue()],
            candidates: Vec::new(),
            smallest_gap: f64::INFINITY,
            contact_active: true,
            due: Vec::new(),
            gaps: Vec::new(),
            hits: Vec::new(),
        };
        if let Some(BroadPhaseFault::SkippedPart(part)) = model.broad_phase_fault {
            list.scheduler.skip_part(&model.mesh, part);
        }
        list.collect(model, positions, [path_length, path_length]);
        list
    }

    /// Removes all pairs from list and queues; the broad phase starts again. Memory is kept.
    fn reset(&mut self, positions: &Field, path_length: f64) {
        self.scheduler.reset();
        self.query_positions.copy_from(positions);
        self.query_valid_until = f64::NEG_INFINITY;
        self.pending.iter_mut().for_each(|queue| queue.restart(path_length));
        self.candidates.clear();
    }

    /// Prepares for a step in which no node moves by more than `max_displacement` (m): adds the pairs
    /// that can come into contact, and adds `max_displacement` to the path length.
    pub fn prepare_step(
        &mut self,
        model: &ContactModel,
        positions: &Field,
        progress: &mut SearchProgress,
        max_displacement: f64,
    ) {
        let (from, to) = (progress.path_length, progress.path_length + max_displacement);
        progress.path_length = to;
        #[expect(clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "saturates")]
        let rebuilds = 1 + (to / (REBUILD_PATH * model.edge_length)) as u64;
        if rebuilds > progress.rebuilds {
            progress.rebuilds = rebuilds;
            self.reset(positions, from);
        }
        self.collect(model, positions, [from, to]);
    }

    /// Adds the pairs that can matter while the path length grows from one value to another (m).
    fn collect(&mut self, model: &ContactModel, positions: &Field, [from, to]: [f64; 2]) {
        if model.queues_stopped(to) {
            return;
        }
        let before = self.candidates.len();
        let admission_limit = to + ADMISSION_PATH * model.distance;
        let Self { scheduler, pending, candidates, due, gaps, .. } = self;
        let mut admit_or_defer =
            |pending: &mut [PairQueue; 2], kind: PairKind, [first, second]: [u32; 2], gap: f64| {
                let due = from + model.free_path_length(kind, gap);
                if due > admission_limit {
                    pending[kind as usize].push(due, [first, second]);
                } else {
                    candidates.push(CandidatePair { pair: Pair { kind, first, second }, gap });
                }
            };
        for kind in PairKind::ALL {
            due.clear();
            gaps.clear();
            pending[kind as usize].pop_until(to, due);
            model.append_gaps(positions, kind, due, gaps);
            for (pair, gap) in due.iter().zip(&*gaps) {
                admit_or_defer(pending, kind, *pair, *gap);
            }
        }
        let max_displacement = query_interval(model).max(2.0 * (to - from));
        if to > self.query_valid_until {
            scheduler.advance(&model.mesh, &self.query_positions, positions);
            self.query_positions.copy_from(positions);
            self.query_valid_until = from + max_displacement;
            scheduler.query_within(
                &model.mesh,
                positions,
                ProximityQuery {
                    max_displacement,
                    radius: model.distance + model.adhesion.range,
                    bound_factor: model.bound_factor(),
                },
                |kind, pairs, gaps| model.append_gaps(positions, kind, pairs, gaps),
                |kind, pair, gap| admit_or_defer(pending, kind, pair, gap),
            );
        }
        let candidates = &mut self.candidates;
        if let Some(BroadPhaseFault::LostPair(lost)) = model.broad_phase_fault {
            candidates.retain(|candidate| candidate.pair != lost);
        }
        if candidates.len() > before {
            candidates[before..].sort_unstable_by_key(|candidate| candidate.pair);
            // Two sorted runs: the stable sort merges them in one pass.
            candidates.sort_by_key(|candidate| candidate.pair);
        }
    }

    /// Measures the gaps of the candidates at these positions (m), in their order, into `gaps`.
    pub(super) fn measure(&mut self, model: &ContactModel, positions: &Field) {
        let Self { candidates, due, gaps, .. } = self;
        gaps.clear();
        for kind in PairKind::ALL {
            due.clear();
            let of_kind = candidates.iter().filter(|candidate| candidate.pair.kind == kind);
            due.extend(of_kind.map(|candidate| [candidate.pair.first, candidate.pair.second]));
            model.append_gaps(positions, kind, due, gaps);
        }
    }

    /// Moves candidates that cannot matter soon from the list to the pending queues.
    pub(super) fn release_distant(&mut self, model: &ContactModel, path_length: f64) {
        let Self { pending, candidates, .. } = self;
        candidates.retain(|candidate| {
            let pair = candidate.pair;
            let free = model.free_path_length(pair.kind, candidate.gap);
            let stays = free < RELEASE_PATH * model.distance;
            if !stays {
                pending[pair.kind as usize].push(path_length + free, [pair.first, pair.second]);
            }
            stays
        });
    }
}

#[cfg(test)]
mod tests {
    use nalgebra::Vector3;
    use proptest::prelude::*;

    use super::*;
    use crate::collision::broad_phase::collision_mesh::CollisionMesh;
    use crate::platform::simd::InstructionSet;

    proptest! {
        /// Whatever the motion, every pair within the contact distance is a candidate.
        #[test]
        fn no_pair_in_contact_is_missing_from_the_candidates(
            positions in prop::collection::vec(prop::array::uniform3(-1.0..1.0_f64), 18),
            motions in prop::collection::vec(
                prop::collection::vec(prop::array::uniform3(-0.1..0.1_f64), 18),
                1..40,
            ),
        ) {
            let triangles =
                [[0, 1, 2], [2, 1, 3], [4, 5, 6], [7, 8, 9], [10, 11, 12], [13, 14, 15], [13, 16, 17]];
            let mesh = CollisionMesh::new(18, &triangles);
            let model = ContactModel::new(mesh, 0.05, 1.0, 0.7, InstructionSet::detect());
            let mut x: Vec<Vector3<f64>> = positions.into_iter().map(Vector3::from).collect();
            let mut progress = SearchProgress { path_length: 0.0, rebuilds: 1 };
            let mut list = CandidateList::build(&model, &Field::of(&x), 0.0);
            for motion in motions {
                let from = Field::of(&x);
                let longest = motion.iter().map(|u| Vector3::from(*u).norm()).fold(0.0, f64::max);
                list.prepare_step(&model, &from, &mut progress, longest);
                for (x, u) in x.iter_mut().zip(motion) {
                    *x += Vector3::from(u);
                }
                let to = Field::of(&x);
                let mut missing = Vec::new();
                model.pairs_within(&to, model.distance, |pair, gap| {
                    if gap < model.distance_of(pair.kind)
                        && list.candidates.binary_search_by_key(&pair, |candidate| candidate.pair).is_err()
                    {
                        missing.push(pair);
                    }
                });
                prop_assert!(missing.is_empty(), "{missing:?}");
                list.measure(&model, &to);
                for (candidate, gap) in list.candidates.iter_mut().zip(&list.gaps) {
                    candidate.gap = *gap;
                }
                list.release_distant(&model, progress.path_length);
            }
        }
    }
}
