//! Impulses that keep film in front of rigid plates.

use super::step::CollisionStep;
use crate::collision::contact::safe_step::MIN_KEPT_SHARE;
use crate::scene::plate::Plate;

/// Penetration of a plate by a node up to which it counts as rounding, m. A node farther behind the
/// plate is not stopped. Chosen: far above rounding at a size of metres, far below any film thickness.
const MAX_ROUNDING_PENETRATION: f64 = 1e-12;

/// Relative tolerance of the gap that a node must keep. Chosen: far above rounding, so that rounding
/// alone causes no impulse.
const KEPT_GAP_TOLERANCE: f64 = 1e-9;

/// Changes the velocities of `step` so that no node loses more than nine tenths of its gap to the
/// plate in the drift.
pub(in crate::integrators::explicit) fn resolve(plate: &Plate, step: &mut CollisionStep<'_>) {
    let (start, end) = (step.start, step.start + step.length);
    if start >= plate.removal_time {
        return;
    }
    let (height_at_start, height_at_end) = (plate.height(start), plate.height(end));
    for node in 0..step.positions.len() {
        let height = plate.normal.dot(&step.positions.get(node));
        let gap = height - height_at_start;
        let velocity = step.velocities.get(node);
        let gap_at_end = height + plate.normal.dot(&velocity) * step.length - height_at_end;
        let min_gap = MIN_KEPT_SHARE * gap;
        if gap_at_end < min_gap * (1.0 - KEPT_GAP_TOLERANCE) && gap >= -MAX_ROUNDING_PENETRATION {
            let missing = plate.normal * ((min_gap - gap_at_end) / step.length);
            let change = step.supports.projector(node) * missing;
            // A node that a support holds along the normal does not change its velocity.
            if change.norm_squared() > 0.0 {
                step.velocities.set(node, velocity + change);
                step.impulses.push((node, change * step.film.mass[node]));
            }
        }
    }
}
