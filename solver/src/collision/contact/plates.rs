//! Rigid plates: planes film lies against, standing, moving as prescribed, or lifted at a time.
//!
//! ```text
//! d = n·(x − p(t))         force k (o − d)²/(2 o) n while d < o, as between films
//! ```
//!
//! Symbols: n unit normal towards the film, p a point of the plate, o the contact distance, or the gap a
//! node had from the start, growing with it. A plate has no mass: what it does is the work of its
//! force along its own way.

use nalgebra::Vector3;
use serde::{Deserialize, Serialize};

use super::collision_response::{Impulses, KEPT};
use crate::geometry::field::Field;
use crate::mechanics::film_model::FilmModel;
use crate::mechanics::supports::Supports;
use crate::scene::plate::Plate;

/// How far behind a plate rounding may leave a node that lies on it, m.
const ROUNDING: f64 = 1e-12;

/// What changes of a plate.
#[derive(Debug, Clone, PartialEq, Default, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Pressed {
    /// o of each node, m.
    pub offsets: Vec<f64>,
    /// Force of the film on it along its normal, N.
    pub force: f64,
    /// Energy stored between it and the film, J.
    pub energy: f64,
}

impl Plate {
    /// Where its point is at `time` (s), m.
    fn place(&self, time: f64) -> Vector3<f64> {
        self.motion.map_or(self.point, |motion| motion.position(self.point, time))
    }

    /// n·x of the plate at `time` (s), m.
    fn height(&self, time: f64) -> f64 {
        self.normal.dot(&self.place(time))
    }

    /// Smallest distance of any node, m.
    pub fn smallest_gap(&self, places: &Field, time: f64) -> f64 {
        let height = self.height(time);
        places.iter().map(|x| self.normal.dot(&x) - height).fold(f64::INFINITY, f64::min)
    }

    /// What it starts with, at a contact distance (m).
    pub fn start(&self, places: &Field, distance: f64) -> Pressed {
        let height = self.height(0.0);
        let own = |x: Vector3<f64>| (self.normal.dot(&x) - height).min(distance);
        Pressed { offsets: places.iter().map(own).collect(), force: 0.0, energy: 0.0 }
    }

    /// Adds its forces (N) at `time` (s); `stiffness`: k over mass, 1/s².
    #[expect(clippy::too_many_arguments, reason = "one pass over what a plate meets")]
    pub fn push(
        &self,
        places: &Field,
        model: &FilmModel,
        time: f64,
        distance: f64,
        stiffness: f64,
        pressed: &mut Pressed,
        forces: &mut Field,
    ) {
        (pressed.force, pressed.energy) = (0.0, 0.0);
        if time >= self.removal_time {
            return;
        }
        let height = self.height(time);
        for node in 0..places.len() {
            let gap = self.normal.dot(&places.get(node)) - height;
            let offset = &mut pressed.offsets[node];
            *offset = offset.max(gap.min(distance));
            let deep = *offset - gap;
            if deep > 0.0 {
                let own = stiffness * model.mass[node] / *offset;
                let push = 0.5 * own * deep * deep;
                forces.set(node, forces.get(node) + self.normal * push);
                pressed.force += push;
                pressed.energy += own * deep * deep * deep / 6.0;
            }
        }
    }

    /// Stops nodes that would pass through in a drift from `time` over `length` (s), and adds the
    /// impulses to `stopped`.
    #[expect(clippy::too_many_arguments, reason = "one pass over what a plate meets")]
    pub fn guard(
        &self,
        places: &Field,
        model: &FilmModel,
        supports: &Supports,
        velocities: &mut Field,
        time: f64,
        length: f64,
        stopped: &mut Impulses,
    ) {
        if time >= self.removal_time {
            return;
        }
        let (height, after) = (self.height(time), self.height(time + length));
        for node in 0..places.len() {
            let place = self.normal.dot(&places.get(node));
            let gap = place - height;
            let velocity = velocities.get(node);
            let left = place + self.normal.dot(&velocity) * length - after;
            let least = KEPT * gap;
            // Rounding alone is no approach.
            if left < least * (1.0 - 1e-9) && gap >= -ROUNDING {
                let wish = self.normal * ((least - left) / length);
                let change = supports.projector(node) * wish;
                // A node held there stays there.
                if change.norm_squared() > 0.0 {
                    velocities.set(node, velocity + change);
                    stopped.push((node, change * model.mass[node]));
                }
            }
        }
    }

    /// Its way along the normal from one time to another (s), m.
    pub fn way(&self, from: f64, to: f64) -> f64 {
        self.height(to) - self.height(from)
    }
}
