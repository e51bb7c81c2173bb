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

use super::model::ContactModel;
use super::state::PlateState;
use crate::geometry::field::Field;
use crate::mechanics::film_model::FilmModel;
use crate::scene::plate::Plate;

impl Plate {
    /// Position of the plate's point at `time` (s), m.
    fn position(&self, time: f64) -> Vector3<f64> {
        self.motion.map_or(self.point, |motion| motion.position(self.point, time))
    }

    /// n·p at `time` (s), m.
    pub fn height(&self, time: f64) -> f64 {
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

    /// The state of the plate at these positions (m) of the film at `time` (s), of that before, `last`,
    /// into `next`; adds its forces on the film (N) to `forces`.
    pub fn state_at(
        &self,
        contact_model: &ContactModel,
        film: &FilmModel,
        (positions, time): (&Field, f64),
        last: &PlateState,
        (next, forces): (&mut PlateState, &mut Field),
    ) {
        (next.force, next.energy) = (0.0, 0.0);
        if time >= self.removal_time {
            next.offsets.clear();
            return;
        }
        next.offsets.resize(positions.len(), 0.0);
        let ContactModel { distance, stiffness_per_mass, .. } = *contact_model;
        let height = self.height(time);
        for node in 0..positions.len() {
            let gap = self.normal.dot(&positions.get(node)) - height;
            let offset = last.offsets[node].max(gap.min(distance));
            next.offsets[node] = offset;
            let penetration = offset - gap;
            if penetration > 0.0 {
                let stiffness_per_offset = stiffness_per_mass * film.mass[node] / offset;
                let force = 0.5 * stiffness_per_offset * penetration * penetration;
                forces.set(node, forces.get(node) + self.normal * force);
                next.force += force;
                next.energy += stiffness_per_offset * penetration * penetration * penetration / 6.0;
            }
        }
    }
}
