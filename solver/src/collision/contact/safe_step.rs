//! The share of a straight motion that brings no pair and no plate into contact range of zero.
//!
//! ```text
//! d(t) ≥ 0.1 d(0)       for every candidate pair, and every node and plate, for all t up to the share
//! ```
//!
//! [`super::ccd`] tests one pair. An integrator that moves nodes by at most this share of a displacement
//! lets no film pass through film.

use nalgebra::Vector3;

use super::ccd::{relative_motion, safe_time};
use super::model::ContactModel;
use super::pair::{CandidatePair, Pair};
use crate::geometry::field::Field;

/// Smallest share of its distance that a pair, or a node and a plate, keeps in a step. Chosen: the
/// distance never becomes zero, and only pairs that would nearly touch are held back.
pub const MIN_KEPT_SHARE: f64 = 0.1;

/// A pair that cannot lose this share of its distance is safe without continuous collision
/// detection. Chosen: below 1 − [`MIN_KEPT_SHARE`] = 0.9.
pub const MAX_UNTESTED_APPROACH: f64 = 0.8;

impl ContactModel {
    /// Share of the motion, 0 to 1, during which a pair with this gap (m) certainly keeps
    /// [`MIN_KEPT_SHARE`] of it. `x`: positions of its four nodes, m; `displacements`: of them, m.
    pub fn safe_time_of_pair(
        &self,
        pair: Pair,
        gap: f64,
        x: &[Vector3<f64>; 4],
        displacements: &[Vector3<f64>; 4],
    ) -> f64 {
        let nodes_of_first = pair.nodes_of_first();
        let (_, max_approach) = relative_motion(displacements, nodes_of_first);
        if max_approach < MAX_UNTESTED_APPROACH * gap * self.bound_factor() {
            return 1.0;
        }
        let min_gap = MIN_KEPT_SHARE * gap;
        safe_time(x, displacements, nodes_of_first, min_gap, |x| pair.closest(x))
    }

    /// Share of these displacements (m), 0 to 1, that all nodes can make at once from these positions (m)
    /// while every candidate pair and every node in front of a plate keeps [`MIN_KEPT_SHARE`] of its gap.
    /// Plates are where they are at `time` (s). `candidates` must hold every pair that such a motion can
    /// bring together ([`super::candidates::CandidateList::prepare_step`]).
    pub fn safe_step(
        &self,
        candidates: &[CandidatePair],
        positions: &Field,
        displacements: &Field,
        time: f64,
    ) -> f64 {
        let mut share = 1.0_f64;
        for candidate in candidates {
            let nodes = candidate.pair.nodes(&self.mesh.topology);
            let x = positions.at(nodes);
            let moves = displacements.at(nodes).map(|displacement| displacement * share);
            let gap = candidate.pair.closest(&x).squared.sqrt();
            share *= self.safe_time_of_pair(candidate.pair, gap, &x, &moves);
        }
        for plate in self.plates.iter().filter(|plate| time < plate.removal_time) {
            let height = plate.height(time);
            for (x, displacement) in positions.iter().zip(displacements.iter()) {
                let (gap, approach) =
                    (plate.normal.dot(&x) - height, -plate.normal.dot(&displacement));
                let allowed = (1.0 - MIN_KEPT_SHARE) * gap;
                if gap >= 0.0 && approach * share > allowed {
                    share = allowed / approach;
                }
            }
        }
        share
    }
}
