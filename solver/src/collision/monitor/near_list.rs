//! The near list: pairs of elements that can meet while every node stays within a reach of a reference frame.
//!
//! ```text
//! r = min(clamp(8 m, e/100, e/4), l)
//! ```
//!
//! Symbols: r reach, m; m largest motion of a node in the block for which the list is made, the mean
//! motion of the film taken off ([`super::motion`]), m; e mean edge length, m; l limit of the reach, m.
//! Film that moves further than r/2 in one block has no list. After a list that served few blocks the next one is
//! made some blocks later: where film goes on to move, a list costs more than it saves.
//!
//! In film packed in many layers an element is near hundreds of others. The limit is halved where the
//! search finds more than some pairs of elements an element, and doubled again where it finds few.

use super::apart::ApartPairs;
use super::motion::largest_motion;
use super::paths::Paths;
use crate::geometry::field::Field;
use crate::geometry::topology::Topology;

/// Reach over the motion in the block for which the list is made. Chosen.
const REACH_PER_MOTION: f64 = 8.0;

/// Smallest reach over the mean edge length. Chosen.
const MIN_REACH: f64 = 0.01;

/// Largest reach over the mean edge length. Chosen.
const MAX_REACH: f64 = 0.25;

/// Smallest limit of the reach over the mean edge length. Chosen: film that is packed closer has no list.
const LEAST_REACH: f64 = 1e-4;

/// Smallest reach over the motion in one block. Chosen.
const MIN_BLOCKS: f64 = 2.0;

/// Number of blocks that a list must serve to be worth its cost. Chosen.
const MIN_SERVED: u32 = 5;

/// Smallest and largest number of blocks without a list after one that served fewer. Chosen.
const PAUSE: [u32; 2] = [4, 32];

/// Pairs of elements with overlapping boxes for each element, at most. Chosen: film of few layers has 3 to 20.
const MAX_PAIRS: usize = 48;

/// Part of the most pairs below which the limit of the reach is doubled. Chosen: a twice larger reach then
/// seldom finds too many.
const FEW_PAIRS: f64 = 0.25;

/// Pairs of elements that can meet near a reference frame.
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
    /// Number of blocks that the list has served.
    served: u32,
    /// Number of blocks without a list after the last one, and those that remain.
    pause: u32,
    remaining: u32,
    /// Bound of all paths up to which every node stays within the reach, m.
    within_until: f64,
    /// The pairs.
    pub pairs: ApartPairs,
    /// Whether a plane separated the elements of each pair at its last test. A pair that none separated waits by the gaps of
    /// its nodes and edges, which can be positive while an edge stands in an element.
    pub separated: Vec<bool>,
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
            served: 0,
            pause: 0,
            remaining: 0,
            within_until: f64::NEG_INFINITY,
            pairs: ApartPairs::default(),
            separated: Vec::new(),
        }
    }

    /// Whether the list has every pair that can meet on the last motion, which is that between two frames; makes a
    /// new list if need be. `false` if the film moves too far for a list. `paths`: of the positions, this motion
    /// included.
    ///
    /// `search` adds the pairs that can meet while every node is within a reach (m) of a frame to an empty
    /// list, and returns the number of pairs whose boxes overlap; `None` if these are more than `most`.
    pub fn covers(
        &mut self,
        topology: &Topology,
        [from, to]: [&Field; 2],
        paths: &Paths,
        mut search: impl FnMut(&Field, f64, usize, &mut Vec<[u32; 2]>) -> Option<usize>,
    ) -> bool {
        if self.reach > 0.0 {
            self.served += 1;
            if paths.bound <= self.within_until {
                return true;
            }
            let deviation = |frame: &Field| largest_motion(&self.reference, frame);
            let (before, now) = (deviation(from), deviation(to));
            // Written so that NaN has no list.
            if before <= self.reach && now <= self.reach {
                self.within_until = paths.bound + (self.reach - now);
                return true;
            }
            self.reach = -1.0;
            self.pause = if self.served > MIN_SERVED {
                0
            } else {
                (2 * self.pause).clamp(PAUSE[0], PAUSE[1])
            };
            self.remaining = self.pause;
        }
        if self.remaining > 0 {
            self.remaining -= 1;
            return false;
        }
        let motion = largest_motion(from, to);
        let wanted = REACH_PER_MOTION * motion;
        let wanted = wanted.max(MIN_REACH * self.edge_length).min(MAX_REACH * self.edge_length);
        self.reference.copy_from(to);
        let most = MAX_PAIRS * topology.triangles.len();
        loop {
            self.reach = wanted.min(self.limit);
            // Written so that NaN has no list.
            let covered = MIN_BLOCKS * motion <= self.reach;
            if !covered {
                // The next block may have a larger reach than the last one that was tried.
                self.limit = (2.0 * self.limit).min(MAX_REACH * self.edge_length);
                self.reach = -1.0;
                return false;
            }
            let found = self.pairs.replace(topology.triangles.len(), |pairs| {
                search(&self.reference, self.reach, most, pairs)
            });
            let Some(overlapping) = found else {
                let least = LEAST_REACH * self.edge_length;
                if self.reach <= least {
                    self.reach = -1.0;
                    return false;
                }
                self.limit = (0.5 * self.reach).max(least);
                continue;
            };
            self.separated.clear();
            self.separated.resize(self.pairs.pairs().len(), false);
            self.within_until = paths.bound + self.reach;
            self.served = 0;
            if (overlapping as f64) < FEW_PAIRS * most as f64 {
                self.limit = (2.0 * self.limit).min(MAX_REACH * self.edge_length);
            }
            return true;
        }
    }
}
