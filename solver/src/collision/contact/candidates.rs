//! Which pairs are near.
//!
//! ```text
//! looked at again when  path = path then + (d − o)/2     ([`crate::collision::broad_phase::scheduler`])
//! ```
//!
//! o: the distance at which a pair begins to matter. What is near follows from the places alone, up
//! to pairs that are farther apart than they matter: no result depends on when it was looked for.

use super::contacts::Found;
use super::distance_batch::{edge_gaps, element_gaps};
use super::{CandidatePair, ContactModel, ContactState, Kind, Pair, at};
use crate::collision::broad_phase::kdop::KDops;
use crate::collision::broad_phase::queue::PairQueue;
use crate::collision::broad_phase::scheduler::{
    CandidateKind, CandidateScheduler, QueryKind, nearer,
};
use crate::geometry::field::Field;

/// Path of a bin of pairs waiting, as a share of the contact distance.
const BIN: f64 = 0.1;
/// Number of such bins.
const BINS: usize = 1024;
/// A pair that may be in contact within this path is near, as a share of the contact distance.
const SOON: f64 = 0.25;
/// A pair that cannot be in contact before this path is near no longer.
const LEAVE: f64 = 0.75;
/// Path between two looks at patches of film, as a share of the mean edge length.
const AHEAD: f64 = 1.0 / 20.0;
/// Path after which all is looked for anew, in mean edge lengths: what came near once and went far
/// away need not be followed pair by pair for ever.
const RENEW: f64 = 4.0;

/// What is near now, and what will have to be looked at when.
#[derive(Debug, Clone, PartialEq)]
pub struct CandidateList {
    /// Patches of film.
    lookout: CandidateScheduler,
    /// Where the film was when they were looked at, m.
    seen: Field,
    /// Path up to which that was enough, m.
    enough: f64,
    /// Pairs of nodes and elements, and of edges, waiting for the path.
    singles: [PairQueue; 2],
    /// Pairs looked at every step, in order.
    pub near: Vec<CandidatePair>,
    /// Smallest distance of any pair nearer than it is held apart, m; infinite where there is none.
    pub smallest_gap: f64,
    /// Whether contact or a plate pushed when forces were last asked for, or may have.
    pub pushed: bool,
    // Room for pairs, their distances, and what a node has found.
    due: Vec<[u32; 2]>,
    pub(super) gaps: Vec<f64>,
    pub(super) found: Vec<Found>,
}

/// Place of a kind of pairs among the singles.
fn place(kind: Kind) -> usize {
    match kind {
        Kind::NodeTriangle => 0,
        Kind::EdgeEdge => 1,
    }
}

fn kind_of(couple: CandidateKind) -> Kind {
    if couple == CandidateKind::EdgeEdge { Kind::EdgeEdge } else { Kind::NodeTriangle }
}

impl CandidateList {
    /// Has looked at nothing yet; the film is at these places (m), the path so long (m).
    fn new(law: &ContactModel, places: &Field, path: f64) -> Self {
        let width = 0.5 * AHEAD * law.edge_length;
        let bins = || PairQueue::new(BIN * law.distance, BINS, path);
        Self {
            lookout: CandidateScheduler::new(QueryKind::Collision, &law.topology, width),
            seen: places.clone(),
            enough: f64::NEG_INFINITY,
            singles: [bins(), bins()],
            near: Vec::new(),
            smallest_gap: f64::INFINITY,
            pushed: true,
            due: Vec::new(),
            gaps: Vec::new(),
            found: Vec::new(),
        }
    }

    /// Forgets what is near; keeps the room it took.
    fn forget(&mut self, places: &Field, path: f64) {
        self.lookout.forget();
        self.seen.copy_from(places);
        self.enough = f64::NEG_INFINITY;
        self.singles.iter_mut().for_each(|bins| bins.begin(path));
        self.near.clear();
    }
}

impl ContactModel {
    /// Path after which a pair this far apart (m) may matter, m.
    fn free_path(&self, kind: Kind, gap: f64) -> f64 {
        let reach = match kind {
            Kind::NodeTriangle => self.adhesion.range,
            Kind::EdgeEdge => 0.0,
        };
        0.5 * self.bounds * (gap - self.distance_of(kind) - reach)
    }

    /// Distance of a pair at these places (m), m.
    fn gap(&self, pair: Pair, places: &Field) -> f64 {
        pair.closest(&at(places, pair.nodes(&self.topology))).squared.sqrt()
    }

    /// Calls `found` with every pair nearer than `radius` (m), and its distance (m).
    pub fn pairs_within(&self, places: &Field, radius: f64, mut found: impl FnMut(Pair, f64)) {
        let boxes = KDops::new(&self.topology.patches, places);
        nearer(QueryKind::Collision, &self.topology, &boxes, radius, |couple, [first, second]| {
            let pair = Pair { kind: kind_of(couple), first, second };
            let gap = self.gap(pair, places);
            if gap < radius && (self.edges || pair.kind == Kind::NodeTriangle) {
                found(pair, gap);
            }
        });
    }

    /// Adds the distances (m) of pairs of one kind at these places (m) to `gaps`; edges that do not meet
    /// are infinitely far apart.
    fn gaps(&self, places: &Field, kind: Kind, pairs: &[[u32; 2]], gaps: &mut Vec<f64>) {
        match kind {
            Kind::NodeTriangle => element_gaps(self.path, &self.topology, places, pairs, gaps),
            Kind::EdgeEdge if self.edges => {
                edge_gaps(self.path, &self.topology, places, pairs, gaps);
            }
            Kind::EdgeEdge => gaps.resize(gaps.len() + pairs.len(), f64::INFINITY),
        }
    }

    /// Prepares for a step in which no node moves farther than `way` (m): fetches the pairs that could
    /// come near.
    pub fn prepare(
        &self,
        places: &Field,
        meeting: &mut ContactState,
        search: &mut CandidateList,
        way: f64,
    ) {
        let (path, until) = (meeting.path, meeting.path + way);
        meeting.path = until;
        #[expect(clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "saturates")]
        let renewals = 1 + (until / (RENEW * self.edge_length)) as u64;
        if renewals > meeting.searches {
            meeting.searches = renewals;
            search.forget(places, path);
        }
        self.fetch(places, [path, until], search);
    }

    /// What is near at these places (m), the path being so long (m).
    pub fn look(&self, places: &Field, path: f64) -> CandidateList {
        let mut search = CandidateList::new(self, places, path);
        self.fetch(places, [path, path], &mut search);
        search
    }

    /// Fetches what may come near while the path goes from one length to another (m).
    fn fetch(&self, places: &Field, [path, until]: [f64; 2], search: &mut CandidateList) {
        let before = search.near.len();
        let soon = until + SOON * self.distance;
        let CandidateList { lookout, singles, near, due, gaps, .. } = search;
        let mut sort =
            |bins: &mut [PairQueue; 2], kind: Kind, [first, second]: [u32; 2], gap: f64| {
                let due = path + self.free_path(kind, gap);
                if due > soon {
                    bins[place(kind)].put(due, [first, second]);
                } else {
                    near.push(CandidatePair { pair: Pair { kind, first, second }, gap });
                }
            };
        for kind in [Kind::NodeTriangle, Kind::EdgeEdge] {
            due.clear();
            gaps.clear();
            singles[place(kind)].take(until, due);
            self.gaps(places, kind, due, gaps);
            for (pair, gap) in due.iter().zip(&*gaps) {
                sort(singles, kind, *pair, *gap);
            }
        }
        let ahead = (AHEAD * self.edge_length).max(2.0 * (until - path));
        if until > search.enough {
            lookout.travel(&self.topology, &search.seen, places);
            search.seen.copy_from(places);
            search.enough = path + ahead;
            lookout.fetch(
                &self.topology,
                places,
                ahead,
                self.distance + self.adhesion.range,
                self.bounds,
                |couple, pairs, gaps| self.gaps(places, kind_of(couple), pairs, gaps),
                |couple, pair, gap| sort(singles, kind_of(couple), pair, gap),
            );
        }
        let near = &mut search.near;
        if near.len() > before {
            near[before..].sort_unstable_by_key(|own| own.pair);
            // Two runs in order: merged in one pass.
            near.sort_by_key(|own| own.pair);
        }
    }

    /// Distances of the near pairs at these places (m), in their order.
    pub(super) fn measure(&self, places: &Field, search: &mut CandidateList) {
        let CandidateList { near, due, gaps, .. } = search;
        gaps.clear();
        for kind in [Kind::NodeTriangle, Kind::EdgeEdge] {
            due.clear();
            let own = near.iter().filter(|own| own.pair.kind == kind);
            due.extend(own.map(|own| [own.pair.first, own.pair.second]));
            self.gaps(places, kind, due, gaps);
        }
    }

    /// Lets the near pairs go that cannot matter for a while.
    pub(super) fn let_go(&self, path: f64, search: &mut CandidateList) {
        let CandidateList { singles, near, .. } = search;
        near.retain(|own| {
            let free = self.free_path(own.pair.kind, own.gap);
            let stays = free < LEAVE * self.distance;
            if !stays {
                let pair = [own.pair.first, own.pair.second];
                singles[place(own.pair.kind)].put(path + free, pair);
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
    use crate::collision::contact::topology::Topology;

    proptest! {
        /// Whatever the film does, no pair comes within the contact distance unseen.
        #[test]
        fn what_may_touch_is_near(
            places in prop::collection::vec(prop::array::uniform3(-1.0..1.0_f64), 18),
            ways in prop::collection::vec(
                prop::collection::vec(prop::array::uniform3(-0.1..0.1_f64), 18),
                1..40,
            ),
        ) {
            let triangles =
                [[0, 1, 2], [2, 1, 3], [4, 5, 6], [7, 8, 9], [10, 11, 12], [13, 14, 15], [13, 16, 17]];
            let law = ContactModel::new(Topology::new(18, &triangles), 0.05, 1.0, 0.7);
            let mut x: Vec<Vector3<f64>> = places.into_iter().map(Vector3::from).collect();
            let mut meeting = ContactState { searches: 1, ..ContactState::default() };
            let mut search = law.look(&Field::of(&x), 0.0);
            for way in ways {
                let from = Field::of(&x);
                let longest = way.iter().map(|w| Vector3::from(*w).norm()).fold(0.0, f64::max);
                law.prepare(&from, &mut meeting, &mut search, longest);
                for (x, way) in x.iter_mut().zip(way) {
                    *x += Vector3::from(way);
                }
                let to = Field::of(&x);
                let mut unseen = Vec::new();
                law.pairs_within(&to, law.distance, |pair, gap| {
                    if gap < law.distance_of(pair.kind)
                        && search.near.binary_search_by_key(&pair, |own| own.pair).is_err()
                    {
                        unseen.push(pair);
                    }
                });
                prop_assert!(unseen.is_empty(), "{unseen:?}");
                law.measure(&to, &mut search);
                for (own, gap) in search.near.iter_mut().zip(&search.gaps) {
                    own.gap = *gap;
                }
                law.let_go(meeting.path, &mut search);
            }
        }
    }
}
