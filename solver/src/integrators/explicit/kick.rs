//! The kick of a step: forces change velocities, and supports constrain them.
//!
//! ```text
//! v⁺ = v⁻ + P ((keep − 1) v⁻ + gain f/m)            free nodes; P: projector on free directions
//! u⁺ = u⁻ + (keep − 1) u⁻ + gain (F + Σ f·n)/M      rigid plane of normal n, mass M, force F
//! v⁺ = (x_prescribed − x)/Δt                        prescribed components
//! ```
//!
//! keep and gain: [`kick_factors`].

use super::Explicit;
use super::update::{KickParameters, kick_nodes};
use crate::geometry::field::Field;
use crate::mechanics::forces::damping::kick_factors;
use crate::mechanics::supports::{PrescribedNodes, RigidPlane};
use crate::platform::fault_injection::Term;
use crate::system::{FilmState, FilmSystem, bind};

impl Explicit {
    /// Kicks the velocities over `kick` (s), by the further energies over `term_kick` (s), before a drift of `length`
    /// (s) that ends at the time `end` (s). Adds the works of mass damping and of moving supports.
    pub(super) fn kick(
        &mut self,
        system: &FilmSystem,
        state: &FilmState,
        (kick, term_kick): (f64, f64),
        length: f64,
        end: f64,
    ) {
        let mut next = core::mem::take(&mut self.next);
        let mut planes = core::mem::take(&mut self.motion.planes);
        self.kick_free(system, state, (kick, term_kick), &mut next, &mut planes);
        if self.motion.last_step == 0.0 {
            self.motion.accounting.works.numerical_dissipation +=
                self.starting_loss(system, &next, &planes);
        }
        if system.mass_damping > 0.0 {
            self.motion.accounting.works.damping += self.damping_work(system, kick, &next, &planes);
        }
        for mover in &system.supports.movers {
            self.motion.accounting.works.support +=
                self.prescribe(system, state, mover, &mut next, length, end);
        }
        for (body, velocity) in system.supports.bodies.iter().zip(&planes) {
            self.motion.accounting.works.support += body.plane.force * velocity * length;
        }
        self.motion.planes = planes;
        self.next = core::mem::replace(&mut self.motion.velocities, next);
    }

    /// Velocities after a kick, without prescribed motion: of nodes in `next`, of planes in place.
    fn kick_free(
        &self,
        system: &FilmSystem,
        state: &FilmState,
        (kick, term_kick): (f64, f64),
        next: &mut Field,
        planes: &mut [f64],
    ) {
        let damping = system.mass_damping * system.fault_factor(Term::MassDamping);
        let (keep, gain) = kick_factors(damping, kick);
        let gain = gain * system.fault_factor(Term::Kick);
        let term_gain = kick_factors(damping, term_kick).1;
        let (supports, model) = (&system.supports, &system.model);
        let (forces, velocities) = (&self.workspace.forces, &self.motion.velocities);
        let overpressure = system.overpressure(state);
        let change = |node: usize| {
            let force = system.node_force(forces, overpressure, node);
            let change =
                velocities.get(node) * (keep - 1.0) + force * (gain * model.inverse_mass[node]);
            if system.energy_terms.is_empty() {
                return change;
            }
            change + forces.terms.get(node) * ((term_gain - gain) * model.inverse_mass[node])
        };
        let kick_parameters = KickParameters {
            overpressure,
            gravity: system.gravity,
            weight_factor: system.fault_factor(Term::Gravity),
            velocity_factor: keep,
            acceleration_factor: gain,
            contact_active: self.workspace.contact_active(),
        };
        let set = system.instruction_set;
        kick_nodes(set, model, forces, &kick_parameters, &supports.free, velocities, next);
        if term_gain != 0.0 && !system.energy_terms.is_empty() {
            for node in 0..model.nodes() {
                let gained = forces.terms.get(node) * (term_gain * model.inverse_mass[node]);
                next.set(node, next.get(node) + gained.component_mul(&supports.free.get(node)));
            }
        }
        for (node, projector) in &supports.oblique {
            let node = *node as usize;
            next.set(node, velocities.get(node) + projector * change(node));
        }
        for (body, velocity) in supports.bodies.iter().zip(planes) {
            let force = body.plane.force
                + system.force_on(forces, overpressure, body)
                    * system.fault_factor(Term::PlaneForce);
            *velocity += *velocity * (keep - 1.0) + force * (gain / body.mass(model));
            bind(body, *velocity, next);
        }
    }

    /// Energy that the first kick from rest, or after a pause, takes, J: ½ Σ m |v⁺ − v|².
    ///
    /// The kinetic energy ½ Σ m v⁻·v⁺ needs a velocity half a step ago. The start has that of its own
    /// time instead, so the trapezoid of the first step exceeds the change of kinetic energy by this.
    fn starting_loss(&self, system: &FilmSystem, next: &Field, planes: &[f64]) -> f64 {
        let (velocities, mass) = (&self.motion.velocities, &system.model.mass);
        let change = |node: usize| next.get(node) - velocities.get(node);
        let mut loss: f64 =
            mass.iter().enumerate().map(|(node, mass)| mass * change(node).norm_squared()).sum();
        for mover in &system.supports.movers {
            for node in &mover.nodes {
                let node = *node as usize;
                loss -= mass[node] * (mover.held * change(node)).norm_squared();
            }
        }
        for (body, after) in system.supports.bodies.iter().zip(planes) {
            let before = plane_velocity(body, velocities).unwrap_or(*after);
            loss += body.plane.mass * (after - before) * (after - before);
        }
        0.5 * loss
    }

    /// Energy dissipated by mass damping in a kick, J.
    fn damping_work(&self, system: &FilmSystem, kick: f64, next: &Field, planes: &[f64]) -> f64 {
        let (velocities, model) = (&self.motion.velocities, &system.model);
        let free_of = |node: usize| system.supports.free.get(node);
        let mut damped = 0.0;
        for node in 0..model.nodes() {
            let mean = (next.get(node) + velocities.get(node)) * 0.5;
            let free = mean.component_mul(&free_of(node));
            damped += model.mass[node] * free.norm_squared();
        }
        for (node, projector) in &system.supports.oblique {
            let node = *node as usize;
            let mean = (next.get(node) + velocities.get(node)) * 0.5;
            let counted = mean.component_mul(&free_of(node));
            let free = (projector * mean).norm_squared() - counted.norm_squared();
            damped += model.mass[node] * free;
        }
        for (body, after) in system.supports.bodies.iter().zip(planes) {
            let before = plane_velocity(body, velocities).unwrap_or(*after);
            let mean = 0.5 * (before + after);
            damped += body.mass(model) * mean * mean;
        }
        system.mass_damping * kick * damped
    }

    /// Gives prescribed components the velocity that reaches their prescribed position at the time `end`
    /// (s). Returns the work of that change of velocity, J.
    fn prescribe(
        &self,
        system: &FilmSystem,
        state: &FilmState,
        mover: &PrescribedNodes,
        next: &mut Field,
        length: f64,
        end: f64,
    ) -> f64 {
        let mut work = 0.0;
        for (node, position) in mover.positions(end) {
            let node = node as usize;
            let displacement = position - state.positions.get(node);
            let held = mover.held * (displacement / length);
            let old = mover.held * self.motion.velocities.get(node);
            let free = next.get(node) - mover.held * next.get(node);
            next.set(node, free + held);
            work += 0.5 * system.model.mass[node] * (held.norm_squared() - old.norm_squared());
        }
        work
    }

    /// Power of all forces of the film along prescribed velocities, W.
    pub(super) fn support_power(&self, system: &FilmSystem, state: &FilmState) -> f64 {
        let (forces, overpressure) = (&self.workspace.forces, system.overpressure(state));
        let mut power = 0.0;
        for mover in &system.supports.movers {
            for node in &mover.nodes {
                let node = *node as usize;
                let velocity = mover.held * self.motion.velocities.get(node);
                power += system.node_force(forces, overpressure, node).dot(&velocity);
            }
        }
        power
    }

    /// Sets the velocities of the state to those of its time: those half a step ago, kicked over half a
    /// step.
    pub(super) fn synchronise(&self, system: &FilmSystem, state: &mut FilmState) {
        let mut velocities = core::mem::take(&mut state.velocities);
        let mut planes = core::mem::take(&mut state.planes);
        planes.copy_from_slice(&self.motion.planes);
        let kick = (0.5 * self.motion.last_step, self.motion.terms.owed);
        self.kick_free(system, state, kick, &mut velocities, &mut planes);
        (state.velocities, state.planes) = (velocities, planes);
    }

    /// Kinetic energy, J: ½ Σ m v⁻·v⁺, the form that central differences conserve.
    pub(super) fn kinetic_energy(&self, system: &FilmSystem, state: &FilmState) -> f64 {
        let Self { motion, .. } = self;
        let (mut next, mut planes) = (Field::zeros(system.model.nodes()), motion.planes.clone());
        let kick = (motion.last_step, 2.0 * motion.terms.owed);
        self.kick_free(system, state, kick, &mut next, &mut planes);
        let node = |node: usize| {
            system.model.mass[node] * motion.velocities.get(node).dot(&next.get(node))
        };
        let bodies = system.supports.bodies.iter();
        let plane: f64 = bodies
            .zip(motion.planes.iter().zip(&planes))
            .map(|(body, (before, after))| body.plane.mass * before * after)
            .sum();
        0.5 * ((0..system.model.nodes()).map(node).sum::<f64>() + plane)
    }
}

/// The velocity (m/s) of a rigid plane along its normal, which all its nodes have; `None` without nodes.
fn plane_velocity(body: &RigidPlane, velocities: &Field) -> Option<f64> {
    let node = *body.nodes.first()? as usize;
    Some(velocities.get(node).dot(&body.plane.normal))
}
