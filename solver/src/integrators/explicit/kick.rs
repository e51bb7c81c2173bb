//! The kick of a step: forces to velocities, past whatever is held.

use nalgebra::{Matrix3, Vector3};

use super::Explicit;
use super::update::{KickParameters, kick_nodes};
use crate::geometry::field::Field;
use crate::mechanics::forces::damping::kick_factors;
use crate::mechanics::supports::{PrescribedNodes, RigidPlane};
use crate::platform::fault_injection::Term;

impl Explicit {
    /// Velocities after a kick over `kick` (s), before a drift of `length` (s) that ends at `until`
    /// (s); counts the works of mass damping and of setting what is moved.
    pub(super) fn kick(&mut self, kick: f64, length: f64, until: f64) {
        let mut next = core::mem::take(&mut self.next);
        let mut planes = core::mem::take(&mut self.state.planes);
        self.kick_free(kick, &mut next, &mut planes);
        if self.setting.mass_damping > 0.0 {
            self.state.works.damping += self.damped(kick, &next, &planes);
        }
        for mover in &self.setting.supports.movers {
            self.state.works.support += self.prescribe(mover, &mut next, length, until);
        }
        for (body, velocity) in self.setting.supports.bodies.iter().zip(&planes) {
            self.state.works.support += body.plane.force * velocity * length;
        }
        self.state.planes = planes;
        self.next = core::mem::replace(&mut self.state.velocities, next);
    }

    /// Velocities after a kick of what is not prescribed; those of planes in place.
    fn kick_free(&self, kick: f64, next: &mut Field, planes: &mut [f64]) {
        let damping = self.setting.mass_damping * self.setting.fault(Term::MassDamping);
        let (keep, gain) = kick_factors(damping, kick);
        let gain = gain * self.setting.fault(Term::Kick);
        let supports = &self.setting.supports;
        let change = |node: usize| {
            let velocity = self.state.velocities.get(node);
            let push = self.force(node) * (gain * self.model.inverse_mass[node]);
            velocity * (keep - 1.0) + push
        };
        let parameters = KickParameters {
            overpressure: self.overpressure(),
            gravity: self.setting.gravity,
            weight_factor: self.setting.fault(Term::Gravity),
            velocity_factor: keep,
            acceleration_factor: gain,
            contact_active: self.contact_active(),
        };
        let (path, velocities) = (self.setting.path, &self.state.velocities);
        kick_nodes(path, &self.model, &self.forces, &parameters, &supports.free, velocities, next);
        for (node, projector) in &supports.oblique {
            let node = *node as usize;
            next.set(node, self.state.velocities.get(node) + projector * change(node));
        }
        for (body, velocity) in supports.bodies.iter().zip(planes) {
            let push =
                body.plane.force + self.force_on(body) * self.setting.fault(Term::PlaneForce);
            *velocity += *velocity * (keep - 1.0) + push * (gain / body.mass(&self.model));
            bind(body, *velocity, next);
        }
    }

    /// Force of the film on a rigid plane along its normal, N.
    pub fn force_on(&self, body: &RigidPlane) -> f64 {
        body.nodes.iter().map(|node| self.force(*node as usize).dot(&body.plane.normal)).sum()
    }

    /// Gives the nodes of rigid planes their velocity.
    pub(super) fn bind_to_planes(&mut self) {
        for (body, velocity) in self.setting.supports.bodies.iter().zip(&self.state.planes) {
            bind(body, *velocity, &mut self.state.velocities);
        }
    }

    /// Energy mass damping takes in a kick, J.
    fn damped(&self, kick: f64, next: &Field, planes: &[f64]) -> f64 {
        let mut damped = 0.0;
        for node in 0..self.model.nodes() {
            let mean = (next.get(node) + self.state.velocities.get(node)) * 0.5;
            let free = mean.component_mul(&self.setting.supports.free.get(node));
            damped += self.model.mass[node] * free.norm_squared();
        }
        for (node, projector) in &self.setting.supports.oblique {
            let node = *node as usize;
            let mean = (next.get(node) + self.state.velocities.get(node)) * 0.5;
            let counted = mean.component_mul(&self.setting.supports.free.get(node));
            let free = (projector * mean).norm_squared() - counted.norm_squared();
            damped += self.model.mass[node] * free;
        }
        for (body, after) in self.setting.supports.bodies.iter().zip(planes) {
            // The velocity before is that of any node bound to it.
            let before = body.nodes.first().map_or(*after, |node| {
                self.state.velocities.get(*node as usize).dot(&body.plane.normal)
            });
            let mean = 0.5 * (before + after);
            damped += body.mass(&self.model) * mean * mean;
        }
        self.setting.mass_damping * kick * damped
    }

    /// Gives what is prescribed the velocity that brings it to its path; the work of doing so, J.
    fn prescribe(&self, mover: &PrescribedNodes, next: &mut Field, length: f64, until: f64) -> f64 {
        let mut work = 0.0;
        for (node, place) in mover.positions(until) {
            let node = node as usize;
            let way = place - self.state.places.get(node);
            let held = mover.held * (way / length);
            let old = mover.held * self.state.velocities.get(node);
            let free = next.get(node) - mover.held * next.get(node);
            next.set(node, free + held);
            work += 0.5 * self.model.mass[node] * (held.norm_squared() - old.norm_squared());
        }
        work
    }

    /// Power of the film's own forces on what is prescribed, W.
    pub(super) fn support_power(&self) -> f64 {
        let mut power = 0.0;
        for mover in &self.setting.supports.movers {
            for node in &mover.nodes {
                let node = *node as usize;
                power += self.force(node).dot(&(mover.held * self.state.velocities.get(node)));
            }
        }
        power
    }

    /// Velocities after a kick over `kick` (s); prescribed ones as they are.
    fn ahead(&self, kick: f64) -> (Field, Vec<f64>) {
        let mut next = Field::zeros(self.model.nodes());
        let mut planes = self.state.planes.clone();
        self.kick_free(kick, &mut next, &mut planes);
        (next, planes)
    }

    /// Velocities of the nodes now, m/s.
    pub fn velocities(&self) -> Field {
        self.ahead(0.5 * self.state.last_step).0
    }

    /// Kinetic energy, J: ½ Σ m v⁻·v⁺, the form leapfrog keeps.
    pub fn kinetic_energy(&self) -> f64 {
        let (next, planes) = self.ahead(self.state.last_step);
        let node = |node: usize| {
            self.model.mass[node] * self.state.velocities.get(node).dot(&next.get(node))
        };
        let bodies = self.setting.supports.bodies.iter();
        let plane: f64 = bodies
            .zip(self.state.planes.iter().zip(&planes))
            .map(|(body, (before, after))| body.plane.mass * before * after)
            .sum();
        0.5 * ((0..self.model.nodes()).map(node).sum::<f64>() + plane)
    }

    /// What the film exerts on nodes held along these directions, and its moment about the origin:
    /// N and N m.
    pub fn reaction(&self, nodes: &[u32], held: &Matrix3<f64>) -> [Vector3<f64>; 2] {
        let mut sum = [Vector3::zeros(); 2];
        for node in nodes {
            let node = *node as usize;
            let force = held * self.force(node);
            sum[0] += force;
            sum[1] += self.state.places.get(node).cross(&force);
        }
        sum
    }
}

/// Gives the nodes of a rigid plane its velocity along its normal.
fn bind(body: &RigidPlane, velocity: f64, velocities: &mut Field) {
    for node in &body.nodes {
        let node = *node as usize;
        let own = velocities.get(node);
        let normal = body.plane.normal;
        velocities.set(node, own + normal * (velocity - normal.dot(&own)));
    }
}
