//! Which pairs are near.
//!
//! ```text
//! looked at again when  path = path then + (d − o)/2     ([`crate::proximity::lookout`])
//! ```
//!
//! o: the distance at which a pair begins to matter. What is near follows from the places alone, up
//! to pairs that are farther apart than they matter: no result depends on when it was looked for.

use super::gaps::{edge_gaps, element_gaps};
use super::{Kind, Law, Meeting, Near, Pair, at};
use crate::proximity::boxes::Boxes;
use crate::proximity::lookout::{Couple, Lookout, Rule, Sought, nearer};
use crate::state::Field;

/// Path of a bin of the lookout, as a share of the contact distance.
const BIN: f64 = 0.1;
/// A pair that may be in contact within this path is near, as a share of the contact distance.
const SOON: f64 = 0.25;
/// A pair that cannot be in contact before this path is near no longer.
const LEAVE: f64 = 0.75;
/// Patches of film are taken apart so much path before they have to, as a share of the mean edge length.
const AHEAD: f64 = 1.0 / 32.0;
/// Path after which all is looked for anew, in mean edge lengths: what came near once and went far
/// away need not be followed pair by pair for ever.
const RENEW: f64 = 4.0;

/// What is near now, and what will have to be looked at when.
#[derive(Debug, Clone, PartialEq)]
pub struct Search {
    lookout: Lookout,
    /// Pairs looked at every step, in order.
    pub near: Vec<Near>,
    /// Smallest distance of any near pair now, m; infinite where none is near.
    pub smallest_gap: f64,
}

impl Search {
    /// Looks at nothing yet; at this path (m).
    pub fn new(law: &Law, path: f64) -> Self {
        let lookout = Lookout::new(Sought::Meetings, BIN * law.distance, path);
        Self { lookout, near: Vec::new(), smallest_gap: f64::INFINITY }
    }
}

impl Law {
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
        let boxes = Boxes::new(&self.topology.patches, places);
        nearer(Sought::Meetings, &self.topology, &boxes, radius, |couple, pair| {
            if let Some(pair) = self.pair(couple, pair) {
                let gap = self.gap(pair, places);
                if gap < radius {
                    found(pair, gap);
                }
            }
        });
    }

    /// The pair of two primitives; none of edges where edges do not meet.
    fn pair(&self, couple: Couple, [first, second]: [u32; 2]) -> Option<Pair> {
        match couple {
            Couple::NodeElement => Some(Pair { kind: Kind::NodeTriangle, first, second }),
            Couple::EdgeEdge => self.edges.then_some(Pair { kind: Kind::EdgeEdge, first, second }),
            Couple::EdgeElement => None,
        }
    }

    /// Paths after which pairs at these places (m) may matter, the path now being so long (m).
    fn dues(
        &self,
        places: &Field,
        path: f64,
        couple: Couple,
        pairs: &[[u32; 2]],
        dues: &mut Vec<f64>,
    ) {
        let kind = match couple {
            Couple::NodeElement => {
                element_gaps(self.path, &self.topology, places, pairs, dues);
                Kind::NodeTriangle
            }
            Couple::EdgeEdge if self.edges => {
                edge_gaps(self.path, &self.topology, places, pairs, dues);
                Kind::EdgeEdge
            }
            Couple::EdgeEdge | Couple::EdgeElement => {
                return dues.resize(pairs.len(), f64::INFINITY);
            }
        };
        for due in dues {
            *due = path + self.free_path(kind, *due);
        }
    }

    /// Prepares for a step in which no node moves farther than `way` (m): fetches the pairs that could
    /// come near.
    pub fn prepare(&self, places: &Field, meeting: &mut Meeting, search: &mut Search, way: f64) {
        let (path, until) = (meeting.path, meeting.path + way);
        meeting.path = until;
        #[expect(clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "saturates")]
        let renewals = 1 + (until / (RENEW * self.edge_length)) as u64;
        if renewals > meeting.searches {
            meeting.searches = renewals;
            *search = Search { smallest_gap: search.smallest_gap, ..Search::new(self, path) };
        }
        self.fetch(places, [path, until], search);
    }

    /// What is near at these places (m), the path being so long (m).
    pub fn look(&self, places: &Field, path: f64) -> Search {
        let mut search = Search::new(self, path);
        self.fetch(places, [path, path], &mut search);
        search
    }

    /// Fetches what may come near while the path goes from one length to another (m).
    fn fetch(&self, places: &Field, [path, until]: [f64; 2], search: &mut Search) {
        let rule = Rule {
            keep: self.distance + self.adhesion.range,
            bounds: self.bounds,
            ahead: AHEAD * self.edge_length,
        };
        let Search { lookout, near, .. } = search;
        let before = near.len();
        let soon = until + SOON * self.distance;
        let due = |couple: Couple, pairs: &[[u32; 2]], dues: &mut Vec<f64>| {
            self.dues(places, path, couple, pairs, dues);
        };
        lookout.fetch(&self.topology, places, [path, until, soon], &rule, due, |couple, pair| {
            let pair = self.pair(couple, pair);
            near.extend(pair.map(|pair| Near { pair, gap: self.gap(pair, places) }));
        });
        if near.len() > before {
            near[before..].sort_unstable_by_key(|own| own.pair);
            // Two runs in order: merged in one pass.
            near.sort_by_key(|own| own.pair);
        }
    }

    /// Lets the near pairs go that cannot matter for a while.
    pub(super) fn let_go(&self, path: f64, search: &mut Search) {
        let Search { lookout, near, .. } = search;
        near.retain(|own| {
            let free = self.free_path(own.pair.kind, own.gap);
            let stays = free < LEAVE * self.distance;
            if !stays {
                let couple = match own.pair.kind {
                    Kind::NodeTriangle => Couple::NodeElement,
                    Kind::EdgeEdge => Couple::EdgeEdge,
                };
                lookout.wait(couple, [own.pair.first, own.pair.second], path + free);
            }
            stays
        });
    }
}
