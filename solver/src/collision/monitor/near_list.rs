//! The near list: pairs that can pass while every node stays within a reach of a reference frame.
//!
//! ```text
//! r = clamp(4 m, e/100, e/10)
//! ```
//!
//! Symbols: r reach, m; m largest motion of a node in the block for which the list is made, the mean
//! motion of the film taken off ([`super::motion`]), m; e mean edge length, m. Film that moves further
//! in one block than r has no list.

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

/// Pairs that can pass near a reference frame.
#[derive(Debug, Clone, PartialEq)]
pub struct NearList {
    /// Mean edge length, m.
    edge_length: f64,
    /// Positions of the reference frame, m.
    reference: Field,
    /// r, m; negative while there is no list.
    reach: f64,
    pairs: PassagePairs,
}

impl NearList {
    /// No list yet. `positions` (m) give the mean edge length.
    pub fn new(topology: &Topology, positions: &Field) -> Self {
        let length =
            |[a, b]: &[u32; 2]| (positions.get(*a as usize) - positions.get(*b as usize)).norm();
        let sum: f64 = topology.edges.iter().map(length).sum();
        Self {
            edge_length: sum / topology.edges.len() as f64,
            reference: positions.clone(),
            reach: -1.0,
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
        let reach = REACH_PER_MOTION * largest_motion(from, to);
        let reach = reach.max(MIN_REACH * self.edge_length).min(MAX_REACH * self.edge_length);
        let covered = largest_motion(from, to) <= reach;
        if !covered {
            self.reach = -1.0;
            return None;
        }
        self.reference.copy_from(from);
        self.reach = reach;
        search.find(topology, [&self.reference; 2], reach, &mut self.pairs);
        Some(&self.pairs)
    }
}
