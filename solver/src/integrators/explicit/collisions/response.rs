//! Prevents film from passing through film in the drift to come.
//!
//! ```text
//! u = −s (d − f)/Δt         and in the first iteration at least max(−w⁻, 0)
//! ```
//!
//! Symbols: u speed of separation that an impulse gives a pair, w⁻ its speed of separation before the
//! kick, m/s; d distance of the pair, f a floor, m; Δt duration of the drift, s; s share of d − f that
//! the pair may still lose in the drift.
//!
//! First the approach is reflected: film too fast for the contact force bounces off without loss. Then
//! all candidates are tested again and again, because an impulse on one pair can make another one
//! collide. Where many pairs press each other, s = 0 for all of them has no solution, so s grows with
//! the number of iterations. Below the floor pairs separate again. If an impulse along the line
//! between the closest points does not help, the pair gets a common velocity. So energy is dissipated
//! only where several pairs act on a node at once, or where reflection does not suffice.

use nalgebra::Vector3;

use super::step::CollisionStep;
use crate::collision::contact::ContactModel;
use crate::collision::contact::pair::{CandidatePair, Pair};
use crate::collision::contact::safe_step::MAX_UNTESTED_APPROACH;

/// How far a pair can approach at most, in units of the largest displacement D of any node. A node
/// moves by at most ¾ D + 3 · ¼ D = 1.5 D relative to the mean of the pair's four nodes, so both
/// primitives together move by at most 3 D; the rest covers rounding.
const MAX_APPROACH_PER_DISPLACEMENT: f64 = 3.01;

/// Largest number of iterations over all candidates in one alternation of pairs and plates. Chosen:
/// it bounds the work in a step that has no solution.
const MAX_ITERATIONS: u32 = 120;

/// Iterations with restitution impulses. In the others pairs get a common velocity. Chosen: half of
/// [`MAX_ITERATIONS`].
const MAX_RESTITUTION_ITERATIONS: u32 = 60;

/// Iterations, in the first alternation, in which pairs must not approach at all (s = 0). Chosen:
/// where many pairs press each other, s = 0 has no solution, so it is tried only for a while.
const NO_APPROACH_ITERATIONS: u32 = 12;

/// Iterations after which pairs may lose more than [`MEDIUM_CLOSING_SHARE`] of their distance. Chosen:
/// it leaves 24 iterations with the larger share before pairs get a common velocity.
const MEDIUM_CLOSING_ITERATIONS: u32 = 36;

/// Alternations in which [`MEDIUM_CLOSING_ITERATIONS`] applies. In later ones pairs may lose
/// [`LARGE_CLOSING_SHARE`] from the first iteration on. Chosen: it leaves most of the alternations of a
/// step to the share that is easiest to satisfy.
const MEDIUM_CLOSING_ALTERNATIONS: u32 = 8;

/// s after the iterations without approach. Chosen: between none and [`LARGE_CLOSING_SHARE`].
const MEDIUM_CLOSING_SHARE: f64 = 0.5;

/// s in all later iterations. Chosen: below 0.9, so that such a pair passes
/// continuous collision detection.
const LARGE_CLOSING_SHARE: f64 = 0.8;

/// Distance f below which pairs separate again, as a share of the contact distance. Chosen: without a
/// floor the distance of a pair that many others press could shrink by nine tenths in every step.
const FLOOR_DISTANCE: f64 = 0.01;

/// Share of f − d by which a pair below the floor separates in a step. Chosen: the pair returns to the
/// floor over several steps, so impulses stay small.
const SEPARATION_SHARE: f64 = 0.2;

/// Share s of its distance above the floor that a pair may still lose after an impulse.
fn closing_share(alternation: u32, iteration: u32) -> f64 {
    if alternation == 0 && iteration < NO_APPROACH_ITERATIONS {
        0.0
    } else if alternation < MEDIUM_CLOSING_ALTERNATIONS && iteration < MEDIUM_CLOSING_ITERATIONS {
        MEDIUM_CLOSING_SHARE
    } else {
        LARGE_CLOSING_SHARE
    }
}

/// The speed of separation that an impulse gives a pair.
struct TargetSpeed {
    /// Whether the approach before the kick is reflected.
    reflects: bool,
    /// Share s that a pair above the floor may lose.
    closing_share: f64,
    /// Floor f, m.
    floor: f64,
    /// Duration of the drift, s.
    length: f64,
}

impl TargetSpeed {
    /// u (m/s) at a gap (m) and a speed of separation before the kick (m/s).
    fn at(&self, gap: f64, speed_before: f64) -> f64 {
        let reflected = if self.reflects { (-speed_before).max(0.0) } else { f64::MIN };
        let share = if gap > self.floor { self.closing_share } else { SEPARATION_SHARE };
        reflected.max(share * (self.floor - gap) / self.length)
    }
}

/// Changes the velocities of `step` by impulses until no candidate loses more than nine tenths of
/// its distance in the drift.
///
/// `max_displacement` (m): upper bound of the displacement of any node before the first impulse of
/// this call. `alternation`: how many times pairs and plates have been resolved in this step. The
/// number of impulses is added to `impulses`.
///
/// # Errors
/// A pair that still collides after the last iteration.
pub(in crate::integrators::explicit) fn resolve_pairs(
    contact_model: &ContactModel,
    step: &mut CollisionStep<'_>,
    candidates: &[CandidatePair],
    max_displacement: f64,
    alternation: u32,
    impulses: &mut u64,
) -> Result<(), Pair> {
    let safe_share =
        MAX_UNTESTED_APPROACH * contact_model.bound_factor() / MAX_APPROACH_PER_DISPLACEMENT;
    let mut collided = None;
    for iteration in 0..MAX_ITERATIONS {
        collided = None;
        for candidate in candidates {
            // `max_displacement` holds only until the first impulse.
            if candidate.gap * safe_share > max_displacement && collided.is_none() && iteration == 0
            {
                continue;
            }
            if resolve_pair(contact_model, step, *candidate, [alternation, iteration]) {
                collided = Some(candidate.pair);
                *impulses += 1;
            }
        }
        if collided.is_none() {
            return Ok(());
        }
    }
    collided.map_or(Ok(()), Err)
}

/// Tests one candidate; if it collides in the drift, applies an impulse. Returns whether it
/// collides.
fn resolve_pair(
    contact_model: &ContactModel,
    step: &mut CollisionStep<'_>,
    candidate: CandidatePair,
    [alternation, iteration]: [u32; 2],
) -> bool {
    let CandidatePair { pair, gap } = candidate;
    let nodes = pair.nodes(&contact_model.mesh.topology);
    let velocities = step.velocities.at(nodes);
    let displacements = velocities.map(|velocity| velocity * step.length);
    let x = step.positions.at(nodes);
    let time = contact_model.safe_time_of_pair(pair, gap, &x, &displacements);
    if time >= 1.0 {
        return false;
    }
    let target = TargetSpeed {
        reflects: alternation == 0 && iteration == 0,
        closing_share: closing_share(alternation, iteration),
        floor: FLOOR_DISTANCE * contact_model.distance_of(pair.kind),
        length: step.length,
    };
    let mut restitution = |x: &[Vector3<f64>; 4]| {
        step.restitution_impulse(pair, nodes, x, |gap, speed| target.at(gap, speed))
    };
    // A pair that only rotates into contact does not approach along its closest points now; the line
    // between the closest points at the end of the safe time counts then.
    let x_later = || core::array::from_fn(|k| x[k] + displacements[k] * time);
    if iteration >= MAX_RESTITUTION_ITERATIONS || !(restitution(&x) || restitution(&x_later())) {
        step.inelastic_impulse(nodes);
    }
    for (node, before) in nodes.iter().zip(velocities) {
        let node = *node as usize;
        let impulse = (step.velocities.get(node) - before) * step.film.mass[node];
        step.impulses.push((node, impulse));
    }
    true
}
