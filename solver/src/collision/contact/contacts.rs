//! Which near pairs are contacts, and what they do.
//!
//! A contact is remembered while its features stay within the distance, even where it exerts nothing:
//! its offset grows with its gap, never shrinks, so no change of it costs or creates energy.

use nalgebra::Vector3;
use serde::{Deserialize, Serialize};

use super::candidates::CandidateList;
use super::distance::Closest;
use super::topology::Feature;
use super::{CandidatePair, ContactModel, ContactState, Kind, Pair, at};
use crate::geometry::field::Field;

/// One contact.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Contact {
    /// The pair; of the elements of a feature the lowest.
    pub pair: Pair,
    /// The feature the node is nearest to; 0 of two edges.
    pub feature: Feature,
    /// o, m.
    pub offset: f64,
    /// k, N/m.
    pub stiffness: f64,
    /// d when last looked at, m.
    pub gap: f64,
    /// Largest adhesive force, N.
    pub adhesion: f64,
    /// Energy now, J.
    pub energy: f64,
}

impl Contact {
    /// Energy stored at a gap (m), J.
    pub fn stored(&self, gap: f64) -> f64 {
        let pressed = (self.offset - gap).max(0.0);
        self.stiffness * pressed * pressed * pressed / (6.0 * self.offset)
    }

    /// The adhesive force at a gap (m) less than `range` (m) beyond the offset, N.
    pub fn pull(&self, gap: f64, range: f64) -> f64 {
        let part = (gap - self.offset) / range;
        if self.adhesion > 0.0 && part > 0.0 && part < 1.0 {
            4.0 * self.adhesion * part * (1.0 - part)
        } else {
            0.0
        }
    }

    /// The force that pushes the pair apart at a gap (m), N.
    pub fn force(&self, gap: f64) -> f64 {
        let pressed = (self.offset - gap).max(0.0);
        0.5 * self.stiffness * pressed * pressed / self.offset
    }
}

/// A feature within reach of a node, by one of its elements: feature, pair, gap now and before, m.
pub(super) type Found = (Feature, Pair, f64, f64);

/// Most elements looked at for one node; beyond, the farther ones of the list are left to the guard.
const MOST: usize = 64;

impl ContactModel {
    /// Finds the contacts at these places (m), adds their forces (N) to `forces`; gives their energy, J.
    /// `mass`: of each node, kg.
    pub fn meet(
        &self,
        places: &Field,
        mass: &[f64],
        forces: &mut Field,
        meeting: &mut ContactState,
        search: &mut CandidateList,
    ) -> f64 {
        self.measure(places, search);
        let CandidateList { near, smallest_gap, gaps, found, .. } = &mut *search;
        let mut old =
            core::mem::replace(&mut meeting.contacts, core::mem::take(&mut meeting.spare));
        meeting.contacts.clear();
        let mut from = 0;
        while from < near.len() {
            let mut to = from + 1;
            let first = near[from].pair;
            if first.kind == Kind::NodeTriangle {
                while to < near.len()
                    && near[to].pair.kind == first.kind
                    && near[to].pair.first == first.first
                {
                    to += 1;
                }
                let own = &mut near[from..to];
                self.meet_node(places, mass, own, &gaps[from..to], found, &old, meeting);
            } else {
                self.meet_edges(places, mass, &mut near[from], gaps[from], &old, meeting);
            }
            from = to;
        }
        // Of pairs farther apart only some are near, by when they were looked at.
        let pressed = near.iter().filter(|own| own.gap < self.distance_of(own.pair.kind));
        *smallest_gap = pressed.map(|own| own.gap).fold(f64::INFINITY, f64::min);
        self.let_go(meeting.path, search);
        old.clear();
        meeting.spare = old;
        self.push(places, forces, meeting)
    }

    /// Contacts of one node with the features nearest to it; `gaps`: distances of its pairs now, m.
    #[expect(clippy::too_many_arguments, reason = "one pass over what is near")]
    fn meet_node(
        &self,
        places: &Field,
        mass: &[f64],
        near: &mut [CandidatePair],
        gaps: &[f64],
        found: &mut Vec<Found>,
        old: &[Contact],
        meeting: &mut ContactState,
    ) {
        let node = near[0].pair.first;
        found.clear();
        let far = self.distance + self.adhesion.range;
        let square = far * far;
        for (own, gap) in near.iter_mut().zip(gaps) {
            let before = core::mem::replace(&mut own.gap, *gap);
            // Their squares may still tell otherwise, by a rounding.
            if *gap > far * (1.0 + 1e-9) || found.len() == MOST {
                continue;
            }
            let closest = own.pair.closest(&at(places, own.pair.nodes(&self.topology)));
            if closest.squared < square {
                let [_, a, b, c] = closest.weights;
                let feature = self.topology.feature(own.pair.second, [a, b, c]);
                found.push((feature, own.pair, own.gap, before));
            }
        }
        let mine = range_of(old, Kind::NodeTriangle, node);
        let agreed_on = |feature: Feature| {
            let agreed = found.iter().filter(|other| other.0 == feature).count();
            agreed == self.topology.elements_at(feature) as usize
        };
        for (k, entry) in found.iter().enumerate() {
            let (feature, pair, gap, before) = *entry;
            let first = !found[..k].iter().any(|other| other.0 == feature);
            if !first || !agreed_on(feature) {
                continue;
            }
            let left = || {
                let bordering = mine.iter().filter(|old| {
                    self.topology.border(old.feature, feature) && !agreed_on(old.feature)
                });
                bordering.max_by(|a, b| (a.offset - a.gap).total_cmp(&(b.offset - b.gap)))
            };
            let (offset, stiffness) =
                if let Some(own) = mine.iter().find(|old| old.feature == feature) {
                    (own.offset, own.stiffness)
                } else if let Some(left) = left() {
                    // It slid over a border: as deep as it was, so that nothing is gained by it.
                    (gap + (left.offset - left.gap).max(0.0), left.stiffness)
                } else {
                    (self.first_offset(pair.kind, before, gap), self.pair_stiffness(pair, mass))
                };
            let offset = offset.max(gap.min(self.distance));
            // Half: where two films lie on each other the nodes of both pull, each for its share of area.
            let adhesion = 0.5 * self.adhesion.pressure * mass[node as usize] / self.area_density;
            let contact = Contact { pair, feature, offset, stiffness, gap, adhesion, energy: 0.0 };
            meeting.contacts.push(contact);
        }
    }

    /// The contact of two edges, if they are one.
    fn meet_edges(
        &self,
        places: &Field,
        mass: &[f64],
        own: &mut CandidatePair,
        gap: f64,
        old: &[Contact],
        meeting: &mut ContactState,
    ) {
        let before = core::mem::replace(&mut own.gap, gap);
        let distance = self.distance_of(Kind::EdgeEdge);
        if gap >= distance {
            return;
        }
        let closest = own.pair.closest(&at(places, own.pair.nodes(&self.topology)));
        let inside = closest.weights.iter().all(|weight| *weight != 0.0);
        if !inside {
            return;
        }
        let kept = old.binary_search_by_key(&own.pair, |old| old.pair).ok().map(|at| &old[at]);
        let (offset, stiffness) = kept.map_or_else(
            || {
                let kind = Kind::EdgeEdge;
                (self.first_offset(kind, before, own.gap), self.pair_stiffness(own.pair, mass))
            },
            |kept| (kept.offset, kept.stiffness),
        );
        let offset = offset.max(own.gap.min(distance));
        let (pair, gap) = (own.pair, own.gap);
        let contact =
            Contact { pair, feature: 0, offset, stiffness, gap, adhesion: 0.0, energy: 0.0 };
        meeting.contacts.push(contact);
    }

    /// The offset of a new contact: the whole distance where it came from beyond it, its gap where it
    /// became one sideways.
    fn first_offset(&self, kind: Kind, before: f64, gap: f64) -> f64 {
        let distance = self.distance_of(kind);
        if before >= distance { distance } else { gap.min(distance) }
    }

    /// k of a pair, N/m: from its masses in the middle of its primitives.
    fn pair_stiffness(&self, pair: Pair, mass: &[f64]) -> f64 {
        let mass = pair.nodes(&self.topology).map(|node| mass[node as usize]);
        let mobility = match pair.kind {
            Kind::NodeTriangle => {
                1.0 / mass[0] + (1.0 / mass[1] + 1.0 / mass[2] + 1.0 / mass[3]) / 9.0
            }
            Kind::EdgeEdge => mass.iter().map(|mass| 0.25 / mass).sum(),
        };
        self.stiffness / mobility
    }

    /// Adds the contacts' forces; gives their energy, J.
    fn push(&self, places: &Field, forces: &mut Field, meeting: &mut ContactState) -> f64 {
        let mut energy = 0.0;
        for contact in &mut meeting.contacts {
            let nodes = contact.pair.nodes(&self.topology);
            let Closest { weights, between, squared } = contact.pair.closest(&at(places, nodes));
            let gap = squared.sqrt();
            contact.energy = 0.0;
            let push = contact.force(gap) - contact.pull(gap, self.adhesion.range);
            if push != 0.0 && gap > 0.0 {
                let force: Vector3<f64> = between * (push / gap);
                for (node, weight) in nodes.iter().zip(weights) {
                    let node = *node as usize;
                    forces.set(node, forces.get(node) + force * weight);
                }
                contact.energy = contact.stored(gap);
                energy += contact.energy;
            }
        }
        energy
    }
}

/// The contacts of one node, or lower edge.
fn range_of(contacts: &[Contact], kind: Kind, first: u32) -> &[Contact] {
    let key = |contact: &Contact| (contact.pair.kind, contact.pair.first);
    let from = contacts.partition_point(|contact| key(contact) < (kind, first));
    let to = contacts.partition_point(|contact| key(contact) <= (kind, first));
    &contacts[from..to]
}
