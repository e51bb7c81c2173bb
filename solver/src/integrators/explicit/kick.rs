//! The kick of a step: forces change velocities, and supports constrain them.
//!
//! ```text
//! v⁺ = v⁻ + P ((keep − 1) v⁻ + gain f/m)            free nodes; P: projector on free directions
//! u⁺ = u⁻ + (keep − 1) u⁻ + gain (F + Σ f·n)/M      rigid plane of normal n, mass M, force F
//! v⁺ = (x_prescribed − x)/Δt                        prescribed components
//! ```
//!
//! keep and gain: [`kick_factors`].

use nalgebra::{Matrix3, Vector3};

use super::Explicit;
use super::update::{KickParameters, kick_nodes};
use crate::geometry::field::Field;
use crate::mechanics::forces::damping::kick_factors;
use crate::mechanics::forces::membrane::NORMAL_TO_GRADIENT;
use crate::mechanics::supports::{PrescribedNodes, RigidPlane};
use crate::platform::fault_injection::Term;

impl Explicit {
    /// Kicks the velocities over `kick` (s), before a drift of `length` (s) that ends at the time `end`
    /// (s). Adds the works of mass damping and of moving supports.
    pub(super) fn kick(&mut self, kick: f64, length: f64, end: f64) {
        let mut next = core::mem::take(&mut self.next);
        let mut planes = core::mem::take(&mut self.state.planes);
        self.kick_free(kick, &mut next, &mut planes);
        if self.state.last_step == 0.0 {
            self.state.works.numerical_dissipation += self.starting_loss(&next, &planes);
        }
        if self.parameters.mass_damping > 0.0 {
            self.state.works.damping += self.damping_work(kick, &next, &planes);
        }
        for mover in &self.parameters.supports.movers {
            self.state.works.support += self.prescribe(mover, &mut next, length, end);
        }
        for (body, velocity) in self.parameters.supports.bodies.iter().zip(&planes) {
            self.state.works.support += body.plane.force * velocity * length;
        }
        self.state.planes = planes;
        self.next = core::mem::replace(&mut self.state.velocities, next);
    }

    /// Velocities after a kick, without prescribed motion: of nodes in `next`, of planes in place.
    fn kick_free(&self, kick: f64, next: &mut Field, planes: &mut [f64]) {
        let damping =
            self.parameters.mass_damping * self.parameters.fault_factor(Term::MassDamping);
        let (keep, gain) = kick_factors(damping, kick);
        let gain = gain * self.parameters.fault_factor(Term::Kick);
        let supports = &self.parameters.supports;
        let change = |node: usize| {
            let velocity = self.state.velocities.get(node);
            let gained = self.force(node) * (gain * self.model.inverse_mass[node]);
            velocity * (keep - 1.0) + gained
        };
        let kick_parameters = KickParameters {
            overpressure: self.overpressure(),
            gravity: self.parameters.gravity,
            weight_factor: self.parameters.fault_factor(Term::Gravity),
            velocity_factor: keep,
            acceleration_factor: gain,
            contact_active: self.contact_active(),
        };
        let (instruction_set, velocities) =
            (self.parameters.instruction_set, &self.state.velocities);
        kick_nodes(
            instruction_set,
            &self.model,
            &self.forces,
            &kick_parameters,
            &supports.free,
            velocities,
            next,
        );
        for (node, projector) in &supports.oblique {
            let node = *node as usize;
            next.set(node, self.state.velocities.get(node) + projector * change(node));
        }
        for (body, velocity) in supports.bodies.iter().zip(planes) {
            let force = body.plane.force
                + self.force_on(body) * self.parameters.fault_factor(Term::PlaneForce);
            *velocity += *velocity * (keep - 1.0) + force * (gain / body.mass(&self.model));
            bind(body, *velocity, next);
        }
    }

    /// Force of the film on a rigid plane along the plane's normal, N.
    pub fn force_on(&self, body: &RigidPlane) -> f64 {
        body.nodes.iter().map(|node| self.force(*node as usize).dot(&body.plane.normal)).sum()
    }

    /// Gives the nodes of every rigid plane the velocity of their plane.
    pub(super) fn bind_to_planes(&mut self) {
        for (body, velocity) in self.parameters.supports.bodies.iter().zip(&self.state.planes) {
            bind(body, *velocity, &mut self.state.velocities);
        }
    }

    /// Energy that the first kick from rest, or after a pause, takes, J: ½ Σ m |v⁺ − v|².
    ///
    /// The kinetic energy ½ Σ m v⁻·v⁺ needs a velocity half a step ago. The start has that of its own
    /// time instead, so the trapezoid of the first step exceeds the change of kinetic energy by this.
    fn starting_loss(&self, next: &Field, planes: &[f64]) -> f64 {
        let change = |node: usize| next.get(node) - self.state.velocities.get(node);
        let mut loss: f64 = (0..self.model.nodes())
            .map(|node| self.model.mass[node] * change(node).norm_squared())
            .sum();
        for mover in &self.parameters.supports.movers {
            for node in &mover.nodes {
                let node = *node as usize;
                loss -= self.model.mass[node] * (mover.held * change(node)).norm_squared();
            }
        }
        for (body, after) in self.parameters.supports.bodies.iter().zip(planes) {
            // Every node of a plane has the plane's velocity.
            let before = body.nodes.first().map_or(*after, |node| {
                self.state.velocities.get(*node as usize).dot(&body.plane.normal)
            });
            loss += body.plane.mass * (after - before) * (after - before);
        }
        0.5 * loss
    }

    /// Energy dissipated by mass damping in a kick, J.
    fn damping_work(&self, kick: f64, next: &Field, planes: &[f64]) -> f64 {
        let mut damped = 0.0;
        for node in 0..self.model.nodes() {
            let mean = (next.get(node) + self.state.velocities.get(node)) * 0.5;
            let free = mean.component_mul(&self.parameters.supports.free.get(node));
            damped += self.model.mass[node] * free.norm_squared();
        }
        for (node, projector) in &self.parameters.supports.oblique {
            let node = *node as usize;
            let mean = (next.get(node) + self.state.velocities.get(node)) * 0.5;
            let counted = mean.component_mul(&self.parameters.supports.free.get(node));
            let free = (projector * mean).norm_squared() - counted.norm_squared();
            damped += self.model.mass[node] * free;
        }
        for (body, after) in self.parameters.supports.bodies.iter().zip(planes) {
            // Every node of a plane has the plane's velocity.
            let before = body.nodes.first().map_or(*after, |node| {
                self.state.velocities.get(*node as usize).dot(&body.plane.normal)
            });
            let mean = 0.5 * (before + after);
            damped += body.mass(&self.model) * mean * mean;
        }
        self.parameters.mass_damping * kick * damped
    }

    /// Gives prescribed components the velocity that reaches their prescribed position at the time `end`
    /// (s). Returns the work of that change of velocity, J.
    fn prescribe(&self, mover: &PrescribedNodes, next: &mut Field, length: f64, end: f64) -> f64 {
        let mut work = 0.0;
        for (node, position) in mover.positions(end) {
            let node = node as usize;
            let displacement = position - self.state.positions.get(node);
            let held = mover.held * (displacement / length);
            let old = mover.held * self.state.velocities.get(node);
            let free = next.get(node) - mover.held * next.get(node);
            next.set(node, free + held);
            work += 0.5 * self.model.mass[node] * (held.norm_squared() - old.norm_squared());
        }
        work
    }

    /// Power of all forces of the film along prescribed velocities, W.
    pub(super) fn support_power(&self) -> f64 {
        let mut power = 0.0;
        for mover in &self.parameters.supports.movers {
            for node in &mover.nodes {
                let node = *node as usize;
                power += self.force(node).dot(&(mover.held * self.state.velocities.get(node)));
            }
        }
        power
    }

    /// Velocities of nodes and planes after a kick over `kick` (s), without prescribed motion.
    fn after_kick(&self, kick: f64) -> (Field, Vec<f64>) {
        let mut next = Field::zeros(self.model.nodes());
        let mut planes = self.state.planes.clone();
        self.kick_free(kick, &mut next, &mut planes);
        (next, planes)
    }

    /// Velocities of the nodes now, m/s: those half a step ago, kicked over half a step.
    pub fn velocities(&self) -> Field {
        self.after_kick(0.5 * self.state.last_step).0
    }

    /// Kinetic energy, J: ½ Σ m v⁻·v⁺, the form that central differences conserve.
    pub fn kinetic_energy(&self) -> f64 {
        let (next, planes) = self.after_kick(self.state.last_step);
        let node = |node: usize| {
            self.model.mass[node] * self.state.velocities.get(node).dot(&next.get(node))
        };
        let bodies = self.parameters.supports.bodies.iter();
        let plane: f64 = bodies
            .zip(self.state.planes.iter().zip(&planes))
            .map(|(body, (before, after))| body.plane.mass * before * after)
            .sum();
        0.5 * ((0..self.model.nodes()).map(node).sum::<f64>() + plane)
    }

    /// Force of the film on a support that holds `nodes` along `held`, N, and its moment about the origin,
    /// N m. Inertia is not included, nor is the pressure on closing faces on a wall.
    pub fn reaction(&self, nodes: &[u32], held: &Matrix3<f64>) -> [Vector3<f64>; 2] {
        let mut sum = [Vector3::zeros(); 2];
        let on_walls = self.model.closure_nodes.on_walls(&self.state.positions);
        for node in nodes {
            let wall = on_walls.get(node).map_or_else(Vector3::zeros, |normal| *normal);
            let node = *node as usize;
            let on_wall = wall * (self.overpressure() * NORMAL_TO_GRADIENT);
            let force = held * (self.force(node) - on_wall);
            sum[0] += force;
            sum[1] += self.state.positions.get(node).cross(&force);
        }
        sum
    }
}

/// Gives the nodes of a rigid plane the plane's velocity along its normal.
fn bind(body: &RigidPlane, velocity: f64, velocities: &mut Field) {
    for node in &body.nodes {
        let node = *node as usize;
        let before = velocities.get(node);
        let normal = body.plane.normal;
        velocities.set(node, before + normal * (velocity - normal.dot(&before)));
    }
}
