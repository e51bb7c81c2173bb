//! The near list: pairs that can pass while every node stays within a reach of a reference frame.
//!
//! ```text
//! r = min(clamp(4 m, e/100, e/10), l)
//! ```
//!
//! Symbols: r reach, m; m largest motion of a node in the block for which the list is made, the mean
//! motion of the film taken off ([`super::motion`]), m; e mean edge length, m; l limit of the reach, m.
//! Film that moves further in one block than r has no list.
//!
//! In film packed in many layers an element is near hundreds of others. The limit is halved where the
//! search finds more than some pairs of elements an element, and doubled again where it finds few.

use super::motion::largest_motion;
use super::primitives::PassagePairs;
use super::search::PassageSearch;
use crate::geometry::field::Field;
use crate::geometry::topology::Topology;

/// Reach over the motion in the block for which the list is made. Chosen.
const REACH_PER_MOTION: f64 = 4.0;

/// Smallest reach over the mean edge length. Chosen.
const MIN_REACH: f64 = 0.01;

/// Largest reach over the mean edge length. Chosen.
const MAX_REACH: f64 = 0.1;

/// Smallest limit of the reach over the mean edge length. Chosen: film that is packed closer has no list.
const LEAST_REACH: f64 = 1e-4;

/// Pairs of elements with overlapping boxes for each element, at most. Chosen: film of few layers has 3 to 20.
const MAX_PAIRS: usize = 64;

/// Part of the most pairs below which the limit of the reach is doubled. Chosen: a twice larger reach then
/// seldom finds too many.
const FEW_PAIRS: f64 = 0.25;

/// Pairs that can pass near a reference frame.
#[derive(Debug, Clone, PartialEq)]
pub struct NearList {
    /// Mean edge length, m.
    edge_length: f64,
    /// Positions of the reference frame, m.
    reference: Field,
    /// r, m; negative while there is no list.
    reach: f64,
    /// l, m.
    limit: f64,
    pairs: PassagePairs,
}

impl NearList {
    /// No list yet. `positions` (m) give the mean edge length.
    pub fn new(topology: &Topology, positions: &Field) -> Self {
        let length =
            |[a, b]: &[u32; 2]| (positions.get(*a as usize) - positions.get(*b as usize)).norm();
        let sum: f64 = topology.edges.iter().map(length).sum();
        let edge_length = sum / topology.edges.len() as f64;
        Self {
            edge_length,
            reference: positions.clone(),
            reach: -1.0,
            limit: MAX_REACH * edge_length,
            pairs: PassagePairs::default(),
        }
    }

    /// The pairs that can pass on the straight motion between two frames, and others; `None` if the film
    /// moves too far for a list.
    pub fn pairs_of(
        &mut self,
        topology: &Topology,
        search: &mut PassageSearch,
        [from, to]: [&Field; 2],
    ) -> Option<&PassagePairs> {
        let covers = |frame: &Field| largest_motion(&self.reference, frame) <= self.reach;
        if self.reach > 0.0 && covers(to) && covers(from) {
            return Some(&self.pairs);
        }
        let motion = largest_motion(from, to);
        let wanted = REACH_PER_MOTION * motion;
        let wanted = wanted.max(MIN_REACH * self.edge_length).min(MAX_REACH * self.edge_length);
        self.reference.copy_from(from);
        let most = MAX_PAIRS * topology.triangles.len();
        loop {
            self.reach = wanted.min(self.limit);
            // Written so that NaN has no list.
            let covered = motion <= self.reach;
            if !covered {
                // The next block may have a larger reach than the last one that was tried.
                self.limit = (2.0 * self.limit).min(MAX_REACH * self.edge_length);
                self.reach = -1.0;
                return None;
            }
            let frames = [&self.reference; 2];
            let Some(elements) = search.find(topology, frames, self.reach, most, &mut self.pairs)
            else {
                let least = LEAST_REACH * self.edge_length;
                if self.reach <= least {
                    self.reach = -1.0;
                    return None;
                }
                self.limit = (0.5 * self.reach).max(least);
                continue;
            };
            if (elements as f64) < FEW_PAIRS * most as f64 {
                self.limit = (2.0 * self.limit).min(MAX_REACH * self.edge_length);
            }
            return Some(&self.pairs);
        }
    }
}
