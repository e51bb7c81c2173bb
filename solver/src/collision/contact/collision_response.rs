//! Keeps film from passing through film in the step to come.
//!
//! ```text
//! approach  w = n·Σ w_i v_i < u      impulse  j = (u − w)/(Σ w_i² n·P n/m_i)      v_i += j w_i P n/m_i
//! speed a pair must have at least   u = max(−w⁻, 0) first, then −s (d − f)/Δt
//! ```
//!
//! Symbols: w⁻ the approach before the kick; s the share of its distance d above a floor f a pair may
//! still close in the step Δt: none for some rounds; where many pairs press each other and plates close
//! on them that has no solution, and they may close by half and more. Below the floor, a hundredth of
//! the contact distance, they part again. Momentum is kept but where a support holds.
//!
//! An impulse is a force over one kick, so what it takes is its trapezoid, −½ J·(v⁻ + v⁺): nothing where
//! it only bears what presses on a pair at rest, and nothing where a pair parts as fast as it came. So
//! film too fast for the contact force bounces off, and only what more pairs than one want of a node at
//! once costs energy.

use nalgebra::Vector3;

use super::ccd::clear_until;
use super::{CandidatePair, ContactModel, ContactState, Pair, at};
use crate::geometry::field::Field;
use crate::mechanics::film_model::FilmModel;
use crate::mechanics::supports::Supports;

/// A pair that cannot close more than this share of its distance needs no sweep.
const SAFE: f64 = 0.8;
/// Share of its distance a pair keeps in any step.
pub(super) const KEPT: f64 = 0.1;
/// Rounds of impulses before relative motion is taken out altogether.
const ROUNDS: u32 = 60;
/// Rounds in a turn, at most.
const MOST_ROUNDS: u32 = 120;

/// Least distance pairs are left, as a share of the contact distance.
const FLOOR: f64 = 0.01;
/// Share of what is missing to it by which a pair parts in a step.
const OUT: f64 = 0.2;

/// Share of its distance a pair may close after an impulse, by the turn and the round in it.
fn closing(turn: u32, round: u32) -> f64 {
    match (turn, round) {
        (0, 0..12) => 0.0,
        (0..8, 0..36) => 0.5,
        _ => 0.8,
    }
}

/// What the guard changed in a step: node and impulse, N s.
pub type Impulses = Vec<(usize, Vector3<f64>)>;

/// Energy impulses took from film whose velocities (m/s) were `before` the kick and are `after`
/// them, J.
pub fn taken(stopped: &Impulses, before: &Field, after: &Field) -> f64 {
    let work =
        |(node, push): &(usize, Vector3<f64>)| push.dot(&(before.get(*node) + after.get(*node)));
    -0.5 * stopped.iter().map(work).sum::<f64>()
}

impl ContactModel {
    /// Takes out of the velocities (m/s) whatever would carry a near pair through itself in a drift of
    /// `length` (s) in which no node moves farther than `way` (m), and adds the impulses to `stopped`.
    /// `before`: velocities before the kick, m/s;
    /// `turn`: how often plates have changed velocities in this step.
    ///
    /// # Errors
    /// The pair that could not be kept apart.
    #[expect(clippy::too_many_arguments, reason = "one pass over what moves")]
    pub fn guard(
        &self,
        model: &FilmModel,
        supports: &Supports,
        places: &Field,
        before: &Field,
        velocities: &mut Field,
        length: f64,
        near: &[CandidatePair],
        way: f64,
        meeting: &mut ContactState,
        turn: u32,
        stopped: &mut Impulses,
    ) -> Result<(), Pair> {
        // Each of two sides moves by at most 1.5 ways relative to the mean of the four nodes.
        let calm = SAFE * self.bounds / 3.01;
        for round in 0..MOST_ROUNDS {
            let mut touched = None;
            for own in near {
                // No two nodes of it can have that much relative motion; while nothing is changed.
                if own.gap * calm > way && touched.is_none() && round == 0 {
                    continue;
                }
                let nodes = own.pair.nodes(&self.topology);
                let moves = at(velocities, nodes).map(|velocity| velocity * length);
                let x = at(places, nodes);
                let until = self.clear_until(own.pair, own.gap, &x, &moves);
                if until >= 1.0 {
                    continue;
                }
                touched = Some(own.pair);
                meeting.impulses += 1;
                let kicked = at(velocities, nodes);
                let share = closing(turn, round);
                let floor = FLOOR * self.distance_of(own.pair.kind);
                let least = |gap: f64, came: f64| {
                    let back = if turn == 0 && round == 0 { (-came).max(0.0) } else { f64::MIN };
                    let share = if gap > floor { share } else { OUT };
                    back.max(share * (floor - gap) / length)
                };
                // Where it only turns into the other on the way, the line between them there counts.
                let there = || core::array::from_fn(|k| x[k] + moves[k] * until);
                let mut bounced = |x: &[Vector3<f64>; 4]| {
                    bounce(model, supports, own.pair, nodes, x, before, least, velocities)
                };
                if round >= ROUNDS || !(bounced(&x) || bounced(&there())) {
                    stick(model, supports, nodes, velocities);
                }
                for (node, kicked) in nodes.iter().zip(kicked) {
                    let push =
                        (velocities.get(*node as usize) - kicked) * model.mass[*node as usize];
                    stopped.push((*node as usize, push));
                }
            }
            if touched.is_none() {
                return Ok(());
            }
            if round + 1 == MOST_ROUNDS
                && let Some(pair) = touched
            {
                return Err(pair);
            }
        }
        Ok(())
    }

    /// Part of the motion, 0 to 1, until which a pair certainly keeps its share of the distance.
    fn clear_until(
        &self,
        pair: Pair,
        gap: f64,
        x: &[Vector3<f64>; 4],
        moves: &[Vector3<f64>; 4],
    ) -> f64 {
        let left = pair.left();
        let mean = (moves[0] + moves[1] + moves[2] + moves[3]) * 0.25;
        let largest = |side: &[Vector3<f64>]| {
            side.iter().map(|u| (u - mean).norm_squared()).fold(0.0, f64::max).sqrt()
        };
        let speed = largest(&moves[..left]) + largest(&moves[left..]);
        if speed < SAFE * gap * self.bounds {
            return 1.0;
        }
        clear_until(x, moves, left, KEPT * gap, |x| pair.closest(x))
    }
}

/// Gives a pair at least the speed of parting (m/s), along the line between its closest points at `x`,
/// that `least` names for its gap (m) and its speed of parting before the kick (m/s); whether that
/// changed anything.
#[expect(clippy::too_many_arguments, reason = "one pair and what it is made of")]
fn bounce(
    model: &FilmModel,
    supports: &Supports,
    pair: Pair,
    nodes: [u32; 4],
    x: &[Vector3<f64>; 4],
    before: &Field,
    least: impl Fn(f64, f64) -> f64,
    velocities: &mut Field,
) -> bool {
    let closest = pair.closest(x);
    let gap = closest.squared.sqrt();
    let normal = closest.between / gap;
    let mobile = nodes.map(|node| {
        let node = node as usize;
        supports.projector(node) * normal * model.inverse_mass[node]
    });
    let (mut approach, mut came, mut mobility) = (0.0, 0.0, 0.0);
    for k in 0..4 {
        let weight = closest.weights[k];
        approach += weight * normal.dot(&velocities.get(nodes[k] as usize));
        came += weight * normal.dot(&before.get(nodes[k] as usize));
        mobility += weight * weight * normal.dot(&mobile[k]);
    }
    let missing = least(gap, came) - approach;
    let helps = missing > 0.0 && mobility > 0.0;
    if !helps {
        return false;
    }
    let impulse = missing / mobility;
    for k in 0..4 {
        let node = nodes[k] as usize;
        let push = mobile[k] * (impulse * closest.weights[k]);
        velocities.set(node, velocities.get(node) + push);
    }
    true
}

/// Gives four nodes their common velocity, in what is free.
fn stick(model: &FilmModel, supports: &Supports, nodes: [u32; 4], velocities: &mut Field) {
    let (mut momentum, mut mass) = (Vector3::zeros(), 0.0);
    for node in nodes {
        let node = node as usize;
        momentum += velocities.get(node) * model.mass[node];
        mass += model.mass[node];
    }
    let common = momentum / mass;
    for node in nodes {
        let node = node as usize;
        let old = velocities.get(node);
        let new = old + supports.projector(node) * (common - old);
        velocities.set(node, new);
    }
}
