//! Which candidates are contacts, and the forces of the contacts.
//!
//! A contact is kept while its features are within the contact distance, even if it exerts no force.
//! Its offset grows with its gap and never shrinks, so a change of the offset neither costs nor
//! creates energy.

use nalgebra::Vector3;

use super::candidates::{CandidateList, FeatureHit};
use super::distance::Closest;
use super::force_law::Contact;
use super::model::ContactModel;
use super::pair::{CandidatePair, Pair, PairKind};
use crate::geometry::field::Field;
use crate::geometry::topology::Feature;

/// Largest number of elements within range of one node that can exert contact forces on it. Chosen:
/// it bounds the work per node, which grows with the square of this number; film this crowded around
/// a node is not expected.
///
/// If more elements are within range, the first 64 in the order of element numbers count, whatever
/// their distance. The others, and features that are only partly among the first 64, exert no force
/// on this node in this step. This is safe: their pairs stay in the candidate list with their
/// current gaps, and the collision response tests every candidate before nodes move, so no film
/// passes. The energy stored in a contact that is dropped this way is missing from then on; it shows
/// as unrecovered contact energy. When the pair counts again, it is a new contact whose offset is its
/// gap, so no energy is created.
const MAX_HITS_PER_NODE: usize = 64;

/// Relative tolerance of the first range test, which compares gaps where the final test compares
/// their squares. Chosen: far above the rounding error of a square root.
const RANGE_TOLERANCE: f64 = 1e-9;

/// What an update of the contacts reads.
struct Update<'a> {
    /// Positions of the nodes, m.
    positions: &'a Field,
    /// Mass of each node, kg.
    mass: &'a [f64],
    /// Contacts at the last update, in order.
    previous: &'a [Contact],
}

impl ContactModel {
    /// The contacts at these positions (m), of those at the last positions, `previous`; adds their forces
    /// (N) to `forces`. `mass`: mass of each node, kg. `path_length` (m): that of the search so far.
    pub fn contacts_at(
        &self,
        positions: &Field,
        mass: &[f64],
        previous: &[Contact],
        path_length: f64,
        list: &mut CandidateList,
        (contacts, forces): (&mut Vec<Contact>, &mut Field),
    ) {
        list.measure(self, positions);
        let CandidateList { candidates, smallest_gap, gaps, hits, .. } = &mut *list;
        contacts.clear();
        let update = Update { positions, mass, previous };
        let mut start = 0;
        while start < candidates.len() {
            let mut end = start + 1;
            let first = candidates[start].pair;
            if first.kind == PairKind::NodeElement {
                while end < candidates.len()
                    && candidates[end].pair.kind == first.kind
                    && candidates[end].pair.first == first.first
                {
                    end += 1;
                }
                let of_node = &mut candidates[start..end];
                let gaps = &gaps[start..end];
                self.update_node_contacts(&update, of_node, gaps, hits, contacts);
            } else {
                let candidate = &mut candidates[start];
                self.update_edge_contact(&update, candidate, gaps[start], contacts);
            }
            start = end;
        }
        // Which pairs beyond the contact distance are in the list depends on when they were measured,
        // so they must not enter a result.
        let in_contact = candidates
            .iter()
            .filter(|candidate| candidate.gap < self.distance_of(candidate.pair.kind));
        *smallest_gap = in_contact.map(|candidate| candidate.gap).fold(f64::INFINITY, f64::min);
        list.release_distant(self, path_length);
        self.add_contact_forces(positions, forces, contacts);
    }

    /// Adds the contacts of one node to `contacts`. `candidates` are all candidates of this node,
    /// `gaps` their gaps now, m.
    fn update_node_contacts(
        &self,
        update: &Update<'_>,
        candidates: &mut [CandidatePair],
        gaps: &[f64],
        hits: &mut Vec<FeatureHit>,
        contacts: &mut Vec<Contact>,
    ) {
        let node = candidates[0].pair.first;
        self.find_features_in_range(update.positions, candidates, gaps, hits);
        let previous = contacts_of(update.previous, PairKind::NodeElement, node);
        // Every element that contains the feature must have it as its closest feature.
        let is_nearest = |feature: Feature| {
            let agreeing = hits.iter().filter(|hit| hit.feature == feature).count();
            agreeing == self.mesh.topology.elements_at(feature) as usize
        };
        for (index, hit) in hits.iter().enumerate() {
            let FeatureHit { feature, pair, gap, previous_gap } = *hit;
            let is_first = !hits[..index].iter().any(|other| other.feature == feature);
            if !is_first || !is_nearest(feature) {
                continue;
            }
            let slid_from = || {
                let neighbours = previous.iter().filter(|old| {
                    self.mesh.topology.share_node(old.feature, feature) && !is_nearest(old.feature)
                });
                neighbours.max_by(|a, b| (a.offset - a.gap).total_cmp(&(b.offset - b.gap)))
            };
            let (offset, stiffness) =
                if let Some(same) = previous.iter().find(|old| old.feature == feature) {
                    (same.offset, same.stiffness)
                } else if let Some(old) = slid_from() {
                    // It slid across a border: it keeps its penetration, so that no energy is gained.
                    (gap + (old.offset - old.gap).max(0.0), old.stiffness)
                } else {
                    let offset = self.initial_offset(pair.kind, previous_gap, gap);
                    (offset, self.pair_stiffness(pair, update.mass))
                };
            let offset = offset.max(gap.min(self.distance));
            // The nodes of both films pull where two films touch, each for the film area of the node:
            // each contributes one half.
            let adhesion =
                0.5 * self.adhesion.pressure * update.mass[node as usize] / self.area_density;
            let contact = Contact { pair, feature, offset, stiffness, gap, adhesion, energy: 0.0 };
            contacts.push(contact);
        }
    }

    /// Updates the gaps of the candidates of one node, and replaces the content of `hits` by the
    /// closest feature of each of the first [`MAX_HITS_PER_NODE`] elements within range of the node.
    fn find_features_in_range(
        &self,
        positions: &Field,
        candidates: &mut [CandidatePair],
        gaps: &[f64],
        hits: &mut Vec<FeatureHit>,
    ) {
        hits.clear();
        let topology = &self.mesh.topology;
        let range = self.distance + self.adhesion.range;
        let squared_range = range * range;
        for (candidate, gap) in candidates.iter_mut().zip(gaps) {
            let previous_gap = core::mem::replace(&mut candidate.gap, *gap);
            if *gap > range * (1.0 + RANGE_TOLERANCE) || hits.len() == MAX_HITS_PER_NODE {
                continue;
            }
            let pair = candidate.pair;
            let closest = pair.closest(&positions.at(pair.nodes(topology)));
            if closest.squared < squared_range {
                let [_, a, b, c] = closest.weights;
                let feature = topology.feature(pair.second, [a, b, c]);
                hits.push(FeatureHit { feature, pair, gap: candidate.gap, previous_gap });
            }
        }
    }

    /// Adds the contact of two edges to `contacts` if they are closer than their contact distance and
    /// their closest points lie inside both.
    fn update_edge_contact(
        &self,
        update: &Update<'_>,
        candidate: &mut CandidatePair,
        gap: f64,
        contacts: &mut Vec<Contact>,
    ) {
        let previous_gap = core::mem::replace(&mut candidate.gap, gap);
        let distance = self.distance_of(PairKind::EdgeEdge);
        if gap >= distance {
            return;
        }
        let pair = candidate.pair;
        let closest = pair.closest(&update.positions.at(pair.nodes(&self.mesh.topology)));
        let inside = closest.weights.iter().all(|weight| *weight != 0.0);
        if !inside {
            return;
        }
        let previous = update.previous.binary_search_by_key(&pair, |old| old.pair).ok();
        let (offset, stiffness) = previous.map(|index| &update.previous[index]).map_or_else(
            || {
                let offset = self.initial_offset(PairKind::EdgeEdge, previous_gap, gap);
                (offset, self.pair_stiffness(pair, update.mass))
            },
            |old| (old.offset, old.stiffness),
        );
        let offset = offset.max(gap.min(distance));
        let contact =
            Contact { pair, feature: 0, offset, stiffness, gap, adhesion: 0.0, energy: 0.0 };
        contacts.push(contact);
    }

    /// Offset of a new contact, m: the contact distance if the pair was beyond it before, its gap if it
    /// was closer and became a contact by sliding sideways.
    fn initial_offset(&self, kind: PairKind, previous_gap: f64, gap: f64) -> f64 {
        let distance = self.distance_of(kind);
        if previous_gap >= distance { distance } else { gap.min(distance) }
    }

    /// Stiffness k of a pair, N/m: κ ω² times its reduced mass, which is that of closest points in the
    /// middle of both primitives.
    fn pair_stiffness(&self, pair: Pair, mass: &[f64]) -> f64 {
        let mass = pair.nodes(&self.mesh.topology).map(|node| mass[node as usize]);
        // Inverse of the reduced mass, 1/kg: Σ w²/m with w = 1, ⅓ or ½.
        let mobility = match pair.kind {
            PairKind::NodeElement => {
                1.0 / mass[0] + (1.0 / mass[1] + 1.0 / mass[2] + 1.0 / mass[3]) / 9.0
            }
            PairKind::EdgeEdge => mass.iter().map(|mass| 0.25 / mass).sum(),
        };
        self.stiffness_per_mass / mobility
    }

    /// Adds the forces of the contacts (N) to `forces`, and sets their stored energies.
    fn add_contact_forces(&self, positions: &Field, forces: &mut Field, contacts: &mut [Contact]) {
        for contact in contacts {
            let nodes = contact.pair.nodes(&self.mesh.topology);
            let Closest { weights, between, squared } = contact.pair.closest(&positions.at(nodes));
            let gap = squared.sqrt();
            contact.energy = 0.0;
            let magnitude =
                contact.repulsive_force(gap) - contact.adhesive_force(gap, self.adhesion.range);
            if magnitude != 0.0 && gap > 0.0 {
                let force: Vector3<f64> = between * (magnitude / gap);
                for (node, weight) in nodes.iter().zip(weights) {
                    let node = *node as usize;
                    forces.set(node, forces.get(node) + force * weight);
                }
                contact.energy = contact.stored_energy(gap);
            }
        }
    }
}

/// The contacts whose first primitive (node, or lower edge) is `first`. `contacts` are in order.
fn contacts_of(contacts: &[Contact], kind: PairKind, first: u32) -> &[Contact] {
    let key = |contact: &Contact| (contact.pair.kind, contact.pair.first);
    let start = contacts.partition_point(|contact| key(contact) < (kind, first));
    let end = contacts.partition_point(|contact| key(contact) <= (kind, first));
    &contacts[start..end]
}
