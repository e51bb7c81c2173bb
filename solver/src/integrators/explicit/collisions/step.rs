//! One drift of the nodes, and the impulses that change velocities before it.
//!
//! ```text
//! restitution impulse   j = (u − w)/(Σ w_i² n·P n/m_i)      v_i += j w_i P n/m_i
//! inelastic impulse     v_i += P (v̄ − v_i)                  v̄ = Σ m_i v_i/Σ m_i
//! dissipation           −½ Σ J·(v⁻ + v⁺)
//! ```
//!
//! Symbols: `w_i` weights of the closest points, n unit vector between them, w = n·Σ `w_i` `v_i` their
//! speed of separation, u the speed of separation that the pair must have, m/s; P the projector on the free
//! directions of a node; v⁻ velocity before the kick, v⁺ after all impulses; J impulse, N s.
//!
//! An impulse is a force over one kick, so its dissipation is the trapezoid above. It is zero for an
//! impulse that only bears the load on a pair at rest, and for a pair that separates as fast as it
//! approached.

use nalgebra::Vector3;

use crate::collision::contact::pair::Pair;
use crate::geometry::field::Field;
use crate::mechanics::film_model::FilmModel;
use crate::mechanics::supports::Supports;

/// Impulses in a step: node and impulse, N s.
pub type Impulses = Vec<(usize, Vector3<f64>)>;

/// A drift of the nodes that must not carry film through film or through a plate.
#[derive(Debug)]
pub struct CollisionStep<'a> {
    /// The film.
    pub film: &'a FilmModel,
    /// Supports of the film.
    pub supports: &'a Supports,
    /// Positions at the start of the drift, m.
    pub positions: &'a Field,
    /// Velocities before the kick, m/s.
    pub velocities_before_kick: &'a Field,
    /// Velocities during the drift, m/s; changed by impulses and friction.
    pub velocities: &'a mut Field,
    /// Time at the start of the drift, s.
    pub start: f64,
    /// Duration of the drift, s.
    pub length: f64,
    /// Impulses of collisions so far. Friction is not included.
    pub impulses: Impulses,
}

impl CollisionStep<'_> {
    /// Energy that these impulses dissipate, J, when the step has all of them.
    pub fn dissipation(&self, impulses: &Impulses) -> f64 {
        let (before, after) = (self.velocities_before_kick, &*self.velocities);
        let work = |(node, impulse): &(usize, Vector3<f64>)| {
            impulse.dot(&(before.get(*node) + after.get(*node)))
        };
        -0.5 * impulses.iter().map(work).sum::<f64>()
    }

    /// Gives a pair the speed of separation u (m/s) along the line between its closest points at the
    /// positions `x` (m), if it is slower. `min_speed` gives u for the pair's gap (m) and its speed of
    /// separation before the kick (m/s). Returns whether velocities changed.
    pub(super) fn restitution_impulse(
        &mut self,
        pair: Pair,
        nodes: [u32; 4],
        x: &[Vector3<f64>; 4],
        min_speed: impl Fn(f64, f64) -> f64,
    ) -> bool {
        let closest = pair.closest(x);
        let gap = closest.squared.sqrt();
        let normal = closest.between / gap;
        // P n/m of each node, 1/kg.
        let mobilities = nodes.map(|node| {
            let node = node as usize;
            self.supports.projector(node) * normal * self.film.inverse_mass[node]
        });
        let (mut speed, mut speed_before, mut mobility) = (0.0, 0.0, 0.0);
        for k in 0..4 {
            let weight = closest.weights[k];
            let node = nodes[k] as usize;
            speed += weight * normal.dot(&self.velocities.get(node));
            speed_before += weight * normal.dot(&self.velocities_before_kick.get(node));
            mobility += weight * weight * normal.dot(&mobilities[k]);
        }
        let missing = min_speed(gap, speed_before) - speed;
        let applies = missing > 0.0 && mobility > 0.0;
        if !applies {
            return false;
        }
        let impulse = missing / mobility;
        for k in 0..4 {
            let node = nodes[k] as usize;
            let change = mobilities[k] * (impulse * closest.weights[k]);
            self.velocities.set(node, self.velocities.get(node) + change);
        }
        true
    }

    /// Gives four nodes their common velocity, in their free directions.
    pub(super) fn inelastic_impulse(&mut self, nodes: [u32; 4]) {
        let (mut momentum, mut mass) = (Vector3::zeros(), 0.0);
        for node in nodes {
            let node = node as usize;
            momentum += self.velocities.get(node) * self.film.mass[node];
            mass += self.film.mass[node];
        }
        let common = momentum / mass;
        for node in nodes {
            let node = node as usize;
            let velocity = self.velocities.get(node);
            let change = self.supports.projector(node) * (common - velocity);
            self.velocities.set(node, velocity + change);
        }
    }
}
