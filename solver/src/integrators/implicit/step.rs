//! One step: motion with the gas and the creep of its end ([`Increment`]), then gas and creep along the motion.
//!
//! ```text
//! motion:              p(V) = p* (V*/V)^γ,  P = P*
//! gas and creep:       the step again from its start, along x → x'
//!
//! work of a force = ∫ f·dx along the straight motion, by Simpson's rule on four parts
//! material loss   = Σ ψ(x, P) − ψ(x, P + ΔP) in the middle of each part
//! numerical dissipation = work of all forces − Δ(kinetic energy)
//! ```
//!
//! So a step that is long against inflow and creep ends in balance with them. Works are integrals of forces, with a pressure that is linear in time, and stored
//! energies are functions of the state: the ledger compares the two.

use super::Implicit;
use super::increment::Increment;
use super::method::Method;
use super::newton::Limits;
use crate::geometry::field::Field;
use crate::integrators::energy_accounting::EnergyAccounting;
use crate::mechanics::forces::membrane::CreepStrain;
use crate::scene::inflow::Inflow;
use crate::system::{FilmState, FilmSystem, PressureLoad};

/// Parts of a step on which works are integrated by Simpson's rule. Chosen: forces of film bend where it gets taut or
/// slack, and an evaluation costs far less than a Newton step.
const PARTS: u32 = 4;

/// State and accounting after a step, and its error.
pub(super) struct Stepped {
    pub(super) state: FilmState,
    pub(super) accounting: EnergyAccounting,
    /// Mean error, m, and its order.
    pub(super) error: (f64, i32),
    /// Coefficients of the method.
    pub(super) coefficients: [f64; 3],
}

/// Work of all forces but inertia, and of contact alone, along displacements, J.
#[derive(Debug, Clone, Copy, Default)]
struct Power {
    all: f64,
    contact: f64,
}

impl Power {
    fn add(&mut self, weight: f64, other: Self) {
        self.all += weight * other.all;
        self.contact += weight * other.contact;
    }
}

impl Implicit {
    /// The step from a state to the time `end` (s); `None` if Newton's method finds no solution.
    pub(super) fn try_step(
        &mut self,
        system: &FilmSystem,
        from: &FilmState,
        end: f64,
        inflow: Inflow,
        iterations: u32,
    ) -> Option<Stepped> {
        let length = end - from.time;
        let mut state = from.clone();
        let mut accounting = self.motion.accounting;
        state.time = end;

        let method = Method::new(from, self.motion.last.as_ref(), length);
        let weight = method.inertia(system.mass_damping, &mut self.target);
        method.predict(&mut self.predicted);
        let size = system.model.size();
        let displacement = self.motion.control.newton_displacement(size);
        let first = self.motion.control.first_displacement();
        let limits = Limits { displacement, first, iterations };
        let target = &self.target;
        let mut increment = Increment { system, from, state, inflow, end, weight, target };
        let workspace = &mut self.workspace;
        let (after, count) =
            self.newton.solve(&mut increment, &self.predicted, limits, workspace)?;
        let mut state = increment.state;
        self.iterations = count;

        let positions = core::mem::take(&mut self.newton.positions);
        for node in 0..positions.len() {
            state.velocities.set(node, method.velocity(node, positions.get(node)));
        }
        self.hold(system, from, &mut state);
        let error = method.error(&system.model.mass, &positions, &self.predicted);
        let (order, coefficients) = (method.error_order(), method.coefficients());
        let contacts = self.workspace.contact.as_ref().map(|contact| contact.trial.clone());
        let step = (length, inflow);
        self.add_works(
            system,
            (from, &mut state),
            (&positions, step),
            after.volume,
            &mut accounting,
        );
        if let Some(contacts) = contacts {
            state.contact = contacts;
        }
        accounting.film_stress = accounting.film_stress.max(after.largest_stress);
        self.newton.positions = positions;
        accounting.steps += 1;
        if let Some(contact) = &self.workspace.contact {
            accounting.broad_phase_rebuilds = contact.progress.rebuilds;
        }
        Some(Stepped { state, accounting, error: (error, order), coefficients })
    }

    /// Held components rest, and planes move with their nodes.
    fn hold(&self, system: &FilmSystem, from: &FilmState, state: &mut FilmState) {
        for (node, moves) in self.newton.system.unknowns.of_node.iter().enumerate() {
            if moves.is_empty() {
                state.velocities.set(node, from.velocities.get(node) * 0.0);
            }
        }
        for (body, speed) in system.supports.bodies.iter().zip(&mut state.planes) {
            if let Some(node) = body.nodes.first() {
                *speed = body.plane.normal.dot(&state.velocities.get(*node as usize));
            }
        }
    }

    /// Adds the works of a step to these positions (m) with this volume (m³), and makes positions, creep strain and gas
    /// those of the state.
    fn add_works(
        &mut self,
        system: &FilmSystem,
        (from, state): (&FilmState, &mut FilmState),
        (positions, (length, inflow)): (&Field, (f64, Inflow)),
        volume: f64,
        accounting: &mut EnergyAccounting,
    ) {
        let start = &from.positions;
        (state.gas, state.volume, state.pressure) = (from.gas, from.volume, from.pressure);
        let gas = system.gas_step(from, volume, length, inflow);
        let pressures = (from.pressure, gas.map_or(from.pressure, |gas| gas.pressure));
        let mut creep = from.creep.clone();
        CreepStrain::relax(&system.model, (start, positions), length, &mut creep);
        let mut between = start.clone();
        // Power and stored energy at a share of the way, with the creep strain of another one.
        let mut at = |implicit: &mut Self, share: f64, of_creep: f64| {
            for node in 0..between.len() {
                let (x, y) = (start.get(node), positions.get(node));
                between.set(node, x + (y - x) * share);
            }
            for ((now, from), to) in state.creep.iter_mut().zip(&from.creep).zip(&creep) {
                *now = [0, 1].map(|half| from[half].between(&to[half], of_creep));
            }
            let workspace = &mut implicit.workspace;
            let evaluation = system.evaluate(state, &between, state.time, workspace);
            let pressure = pressures.0 + share * (pressures.1 - pressures.0);
            (implicit.power(system, pressure, (start, positions)), evaluation.strain)
        };
        let mut work = Power::default();
        let mut loss = 0.0;
        for point in 0..=2 * PARTS {
            let share = |point: u32| f64::from(point) / f64::from(2 * PARTS);
            if point % 2 == 0 {
                let end = point == 0 || point == 2 * PARTS;
                let (power, _) = at(self, share(point), share(point));
                work.add(if end { 1.0 } else { 2.0 }, power);
            } else if creep.is_empty() {
                let (power, _) = at(self, share(point), share(point));
                work.add(4.0, power);
            } else {
                let (before, stored) = at(self, share(point), share(point - 1));
                let (after, remaining) = at(self, share(point), share(point + 1));
                work.add(2.0, before);
                work.add(2.0, after);
                loss += stored - remaining;
            }
        }
        let [all, contact] = [work.all, work.contact].map(|sum| sum / f64::from(6 * PARTS));
        let (mut damped, mut planes) = (0.0, 0.0);
        for (node, mass) in system.model.mass.iter().enumerate() {
            let moved = positions.get(node) - start.get(node);
            let mean = (from.velocities.get(node) + state.velocities.get(node)) * 0.5;
            damped += system.mass_damping * mass * mean.dot(&moved);
        }
        for body in &system.supports.bodies {
            let Some(node) = body.nodes.first() else { continue };
            let node = *node as usize;
            let travel = body.plane.normal.dot(&(positions.get(node) - start.get(node)));
            planes += body.plane.force * travel;
        }
        let kinetic = system.kinetic_energy(state) - system.kinetic_energy(from);
        let works = &mut accounting.works;
        works.contact += contact;
        works.support += planes;
        works.damping += damped;
        works.material_loss += loss;
        works.numerical_dissipation += all + planes - damped - kinetic;
        if let PressureLoad::Overpressure(pressure) = system.pressure_load {
            works.gas += pressure * (volume - state.volume);
        }
        accounting.commit_gas(system, state, gas, volume);
        state.positions.copy_from(positions);
        state.creep = creep;
    }

    /// Work of the forces in the workspace under a pressure (Pa) along the way between two fields of positions, J.
    fn power(&self, system: &FilmSystem, pressure: f64, (from, to): (&Field, &Field)) -> Power {
        let overpressure = system.overpressure_at(pressure);
        let forces = &self.workspace.forces;
        let mut power = Power::default();
        for node in 0..from.len() {
            let moved = to.get(node) - from.get(node);
            power.all += system.node_force(forces, overpressure, node).dot(&moved);
            power.contact += forces.contact.get(node).dot(&moved);
        }
        power
    }
}
