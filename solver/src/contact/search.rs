//! Which pairs are near, and when a far one has to be looked at again.
//!
//! ```text
//! due = travelled + (d − o)/2       two nodes that each move by less than (d − o)/2 stay o apart
//! ```
//!
//! `travelled` grows by the largest node displacement of each step. Far pairs lie in bins by their
//! due number; a bin is opened before a step that could pass it.

use super::{Kind, Law, Meeting, Near, Pair, at};
use crate::state::Field;
use crate::tree::{Bounds, Tree};

/// Bins the travel between two searches is divided into.
const BINS: f64 = 64.0;

impl Law {
    /// How far nodes may travel before the list has to be made anew, m.
    fn reach(&self) -> f64 {
        0.5 * (self.radius - self.distance - self.adhesion.range) * self.bounds
    }

    pub(super) fn bin(&self) -> f64 {
        self.reach() / BINS
    }

    /// The bin that this way (m) falls into; the first where it is past.
    #[expect(clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "saturates at 0")]
    fn bin_of(&self, way: f64) -> usize {
        (way / self.bin()) as usize
    }

    /// Lists all pairs nearer than the radius at these places (m). Contacts stay as they are.
    pub fn search(&self, places: &Field, meeting: &mut Meeting) {
        meeting.travelled = 0.0;
        meeting.reached = 0;
        meeting.near.clear();
        for bin in &mut meeting.far {
            bin.clear();
        }
        meeting.searches += 1;
        self.pairs_within(places, self.radius, |pair, distance| {
            self.place(meeting, pair, distance, 0.0);
        });
        meeting.near.sort_unstable_by_key(|own| own.pair);
    }

    /// Calls `found` with every pair nearer than `radius` (m), and its distance (m).
    pub fn pairs_within(&self, places: &Field, radius: f64, mut found: impl FnMut(Pair, f64)) {
        let topology = &self.topology;
        let square = radius * radius;
        let mut test = |pair: Pair| {
            let near = pair.closest(&at(places, pair.nodes(topology)));
            if near.squared < square {
                found(pair, near.squared.sqrt());
            }
        };
        // Each side is grown by half the radius.
        let half = 0.5 * radius;
        let place = |node: u32| places.get(node as usize);
        let order = &topology.order;
        let nodes = Tree::new(&order.nodes, |node| Bounds::of(&[place(node)]).grown(half));
        let elements = Tree::new(&order.elements, |element| {
            Bounds::of(&topology.triangles[element as usize].map(place)).grown(half)
        });
        nodes.pairs_with(&elements, |node, element| {
            if !topology.triangles[element as usize].contains(&node) {
                test(Pair { kind: Kind::NodeTriangle, first: node, second: element });
            }
        });
        if !self.edges {
            return;
        }
        let edges = Tree::new(&order.edges, |edge| {
            Bounds::of(&topology.edges[edge as usize].map(place)).grown(half)
        });
        edges.pairs(|a, b| {
            let [p, q] = topology.edges[a as usize];
            if !topology.edges[b as usize].iter().any(|node| *node == p || *node == q) {
                test(Pair { kind: Kind::EdgeEdge, first: a.min(b), second: a.max(b) });
            }
        });
    }

    /// Puts a pair this far apart (m) where it belongs, given the displacement of the step to come.
    pub(super) fn place(&self, meeting: &mut Meeting, pair: Pair, distance: f64, step: f64) {
        let due = meeting.travelled
            + 0.5 * self.bounds * (distance - self.distance - self.adhesion.range);
        if due <= meeting.travelled + step + self.bin() {
            meeting.near.push(Near { pair, gap: distance });
            return;
        }
        let bin = self.bin_of(due);
        if meeting.far.len() <= bin {
            meeting.far.resize_with(bin + 1, Vec::new);
        }
        meeting.far[bin].push(pair);
    }

    /// Prepares for a step in which no node moves farther than `step` (m): searches anew where the list
    /// could miss a pair, and fetches the far pairs that could come near.
    pub fn prepare(&self, places: &Field, meeting: &mut Meeting, step: f64) {
        if meeting.searches == 0 || meeting.travelled + step > self.reach() {
            self.search(places, meeting);
        }
        let until = self.bin_of(meeting.travelled + step);
        let before = meeting.near.len();
        while meeting.reached <= until {
            let bin = meeting.reached;
            meeting.reached += 1;
            let Some(pairs) = meeting.far.get_mut(bin).map(core::mem::take) else { continue };
            for pair in pairs {
                let apart = pair.closest(&at(places, pair.nodes(&self.topology)));
                self.place(meeting, pair, apart.squared.sqrt(), step);
            }
        }
        if meeting.near.len() > before {
            meeting.near.sort_unstable_by_key(|own| own.pair);
        }
        meeting.travelled += step;
    }
}
