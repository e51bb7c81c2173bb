//! Keeps film from passing through film in the step to come.
//!
//! ```text
//! approach  w = n·Σ w_i v_i < 0          impulse  j = −w/(Σ w_i² n·P n/m_i)          v_i += j w_i P n/m_i
//! ```
//!
//! Momentum is kept but where a support holds. An impulse is a force over one kick, so what it takes is
//! its trapezoid, −½ J·(v⁻ + v⁺): nothing where it only bears what presses on a pair at rest.

use nalgebra::Vector3;

use super::sweep::clear_until;
use super::{Law, Meeting, Pair, at};
use crate::model::FilmModel;
use crate::state::Field;
use crate::supports::Supports;

/// A pair that cannot close more than this share of its distance needs no sweep.
const SAFE: f64 = 0.8;
/// Share of its distance a pair keeps in any step.
const KEPT: f64 = 0.1;
/// Rounds of impulses before relative motion is taken out altogether.
const ROUNDS: u32 = 12;
/// Rounds in all.
const MOST_ROUNDS: u32 = 60;

impl Law {
    /// Takes out of the velocities (m/s) whatever would carry a near pair through itself in a drift of
    /// `length` (s). `before`: velocities before the kick.
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
        meeting: &mut Meeting,
    ) -> Result<(), Pair> {
        let mut stopped = Vec::new();
        for round in 0..MOST_ROUNDS {
            let mut touched = None;
            for k in 0..meeting.near.len() {
                let own = meeting.near[k];
                let nodes = own.pair.nodes(&self.topology);
                let moves = at(velocities, nodes).map(|velocity| velocity * length);
                let x = at(places, nodes);
                if self.is_clear(own.pair, own.gap, &x, &moves) {
                    continue;
                }
                touched = Some(own.pair);
                meeting.impulses += 1;
                let kicked = at(velocities, nodes);
                if round < ROUNDS {
                    bounce(model, supports, own.pair, nodes, &x, velocities);
                } else {
                    stick(model, supports, nodes, velocities);
                }
                for (node, kicked) in nodes.iter().zip(kicked) {
                    let push =
                        (velocities.get(*node as usize) - kicked) * model.mass[*node as usize];
                    stopped.push((*node as usize, push));
                }
            }
            if touched.is_none() {
                let work = |(node, push): &(usize, Vector3<f64>)| {
                    push.dot(&(before.get(*node) + velocities.get(*node)))
                };
                meeting.taken -= 0.5 * stopped.iter().map(work).sum::<f64>();
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

    fn is_clear(
        &self,
        pair: Pair,
        gap: f64,
        x: &[Vector3<f64>; 4],
        moves: &[Vector3<f64>; 4],
    ) -> bool {
        let left = pair.left();
        let mean = (moves[0] + moves[1] + moves[2] + moves[3]) * 0.25;
        let largest = |side: &[Vector3<f64>]| {
            side.iter().map(|u| (u - mean).norm_squared()).fold(0.0, f64::max).sqrt()
        };
        let speed = largest(&moves[..left]) + largest(&moves[left..]);
        if speed < SAFE * gap * self.bounds {
            return true;
        }
        clear_until(x, moves, left, KEPT * gap, |x| pair.closest(x)) >= 1.0
    }
}

/// Takes the approach of a pair out.
fn bounce(
    model: &FilmModel,
    supports: &Supports,
    pair: Pair,
    nodes: [u32; 4],
    x: &[Vector3<f64>; 4],
    velocities: &mut Field,
) {
    let closest = pair.closest(x);
    let normal = closest.between / closest.squared.sqrt();
    let mobile = nodes.map(|node| {
        let node = node as usize;
        supports.projector(node) * normal * model.inverse_mass[node]
    });
    let (mut approach, mut mobility) = (0.0, 0.0);
    for k in 0..4 {
        let weight = closest.weights[k];
        approach += weight * normal.dot(&velocities.get(nodes[k] as usize));
        mobility += weight * weight * normal.dot(&mobile[k]);
    }
    let helps = approach < 0.0 && mobility > 0.0;
    if !helps {
        // It turns into the other on the way: nothing along the line now would stop it.
        stick(model, supports, nodes, velocities);
        return;
    }
    let impulse = -approach / mobility;
    for k in 0..4 {
        let node = nodes[k] as usize;
        let push = mobile[k] * (impulse * closest.weights[k]);
        velocities.set(node, velocities.get(node) + push);
    }
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
