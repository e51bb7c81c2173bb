//! Contact of film with rigid plates that are fixed, move as prescribed, or are removed at a time.
//!
//! ```text
//! d = n·(x − p(t))         force k (o − d)²/(2 o) n while d < o, as between films
//! ```
//!
//! Symbols: n unit normal of the plate, towards the film; p a point of the plate, m; o offset of the
//! node, m: the contact distance, or the gap that the node had at the start and that grows with it; k
//! stiffness, N/m. A plate has no mass. It does work through its force along its prescribed motion.

use nalgebra::Vector3;

use super::collision_step::{CollisionStep, MIN_KEPT_SHARE};
use super::model::ContactModel;
use super::state::PlateState;
use crate::geometry::field::Field;
use crate::mechanics::film_model::FilmModel;
use crate::scene::plate::Plate;

/// Penetration of a plate by a node up to which it counts as rounding, m. A node farther behind the
/// plate is not stopped. Chosen: far above rounding at a size of metres, far below any film thickness.
const MAX_ROUNDING_PENETRATION: f64 = 1e-12;

/// Relative tolerance of the gap that a node must keep. Chosen: far above rounding, so that rounding
/// alone causes no impulse.
const KEPT_GAP_TOLERANCE: f64 = 1e-9;

impl Plate {
    /// Position of the plate's point at `time` (s), m.
    fn position(&self, time: f64) -> Vector3<f64> {
        self.motion.map_or(self.point, |motion| motion.position(self.point, time))
    }

    /// n·p at `time` (s), m.
    fn height(&self, time: f64) -> f64 {
        self.normal.dot(&self.position(time))
    }

    /// Displacement of the plate along its normal between two times (s), m.
    pub fn displacement(&self, from: f64, to: f64) -> f64 {
        self.height(to) - self.height(from)
    }

    /// Smallest gap of any node at `time` (s), m; negative if a node is behind the plate.
    pub fn smallest_gap(&self, positions: &Field, time: f64) -> f64 {
        let height = self.height(time);
        positions.iter().map(|x| self.normal.dot(&x) - height).fold(f64::INFINITY, f64::min)
    }

    /// State of the plate at time 0, for this contact distance (m).
    pub fn initial_state(&self, positions: &Field, distance: f64) -> PlateState {
        let height = self.height(0.0);
        let offset = |x: Vector3<f64>| (self.normal.dot(&x) - height).min(distance);
        PlateState { offsets: positions.iter().map(offset).collect(), force: 0.0, energy: 0.0 }
    }

    /// Updates the state of the plate at `time` (s) and adds its forces on the film (N) to `forces`.
    pub fn add_contact_forces(
        &self,
        contact_model: &ContactModel,
        film: &FilmModel,
        positions: &Field,
        time: f64,
        state: &mut PlateState,
        forces: &mut Field,
    ) {
        (state.force, state.energy) = (0.0, 0.0);
        if time >= self.removal_time {
            return;
        }
        let ContactModel { distance, stiffness_per_mass, .. } = *contact_model;
        let height = self.height(time);
        for node in 0..positions.len() {
            let gap = self.normal.dot(&positions.get(node)) - height;
            let offset = &mut state.offsets[node];
            *offset = offset.max(gap.min(distance));
            let penetration = *offset - gap;
            if penetration > 0.0 {
                let stiffness_per_offset = stiffness_per_mass * film.mass[node] / *offset;
                let force = 0.5 * stiffness_per_offset * penetration * penetration;
                forces.set(node, forces.get(node) + self.normal * force);
                state.force += force;
                state.energy +=
                    stiffness_per_offset * penetration * penetration * penetration / 6.0;
            }
        }
    }

    /// Changes the velocities of `step` so that no node loses more than nine tenths of its gap to the
    /// plate in the drift.
    pub fn resolve_collisions(&self, step: &mut CollisionStep<'_>) {
        let (start, end) = (step.start, step.start + step.length);
        if start >= self.removal_time {
            return;
        }
        let (height_at_start, height_at_end) = (self.height(start), self.height(end));
        for node in 0..step.positions.len() {
            let height = self.normal.dot(&step.positions.get(node));
            let gap = height - height_at_start;
            let velocity = step.velocities.get(node);
            let gap_at_end = height + self.normal.dot(&velocity) * step.length - height_at_end;
            let min_gap = MIN_KEPT_SHARE * gap;
            if gap_at_end < min_gap * (1.0 - KEPT_GAP_TOLERANCE) && gap >= -MAX_ROUNDING_PENETRATION
            {
                let missing = self.normal * ((min_gap - gap_at_end) / step.length);
                let change = step.supports.projector(node) * missing;
                // A node that a support holds along the normal does not change its velocity.
                if change.norm_squared() > 0.0 {
                    step.velocities.set(node, velocity + change);
                    step.impulses.push((node, change * step.film.mass[node]));
                }
            }
        }
    }
}
