//! One step: gas exchange and creep, motion, creep and gas exchange (G. Strang's splitting, order 2).
//!
//! ```text
//! ½ h: inflow, leak, heat at fixed volume       creep at fixed positions
//!   h: motion with closed gas and fixed creep   work of a force: Simpson's rule on four parts
//! ½ h: creep; inflow, leak, heat
//!
//! numerical dissipation = work of all forces − Δ(kinetic energy)
//! ```
//!
//! Works are integrals of forces, and stored energies are functions of the state: the ledger compares the two.

use super::Implicit;
use super::method::Method;
use super::newton::{Increment, Limits};
use crate::geometry::field::Field;
use crate::integrators::energy_accounting::EnergyAccounting;
use crate::mechanics::forces::membrane::CreepStrain;
use crate::scene::inflow::Inflow;
use crate::system::{Evaluation, FilmState, FilmSystem, PressureLoad};

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
        exchange(system, &mut state, &mut accounting, 0.5 * length, inflow);
        self.creep(system, &mut state, &mut accounting, 0.5 * length);
        state.time = end;

        let method = Method::new(from, self.motion.last.as_ref(), length);
        let weight = method.inertia(system.mass_damping, &mut self.target);
        method.predict(&mut self.predicted);
        let size = system.model.size();
        let displacement = self.motion.control.newton_displacement(size);
        let first = self.motion.control.first_displacement();
        let limits = Limits { displacement, first, iterations };
        let increment = Increment { system, state: &state, end, weight, target: &self.target };
        let workspace = &mut self.workspace;
        let (after, count) = self.newton.solve(&increment, &self.predicted, limits, workspace)?;
        self.iterations = count;

        let positions = core::mem::take(&mut self.newton.positions);
        for node in 0..positions.len() {
            state.velocities.set(node, method.velocity(node, positions.get(node)));
        }
        self.hold(system, from, &mut state);
        let error = method.error(&system.model.mass, &positions, &self.predicted);
        let (order, coefficients) = (method.error_order(), method.coefficients());
        self.add_works(system, (from, &mut state), &positions, &after, &mut accounting);
        accounting.film_stress = accounting.film_stress.max(after.largest_stress);
        self.newton.positions = positions;

        self.creep(system, &mut state, &mut accounting, 0.5 * length);
        exchange(system, &mut state, &mut accounting, 0.5 * length, inflow);
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

    /// Adds the works of a step to these positions (m), evaluated as `after`, and makes them those of the state.
    fn add_works(
        &mut self,
        system: &FilmSystem,
        (from, state): (&FilmState, &mut FilmState),
        positions: &Field,
        after: &Evaluation,
        accounting: &mut EnergyAccounting,
    ) {
        let start = &from.positions;
        // At the end first: the workspace has its forces, and the contacts to be committed.
        let last = self.power(system, after, (start, positions));
        let contacts = self.workspace.contact.as_ref().map(|contact| contact.trial.clone());
        let mut between = start.clone();
        let mut at = |implicit: &mut Self, share: f64| {
            for node in 0..between.len() {
                let (x, y) = (start.get(node), positions.get(node));
                between.set(node, x + (y - x) * share);
            }
            let workspace = &mut implicit.workspace;
            let evaluation = system.evaluate(state, &between, state.time, workspace);
            implicit.power(system, &evaluation, (start, positions))
        };
        // Simpson's rule on each part: the ends of the parts count twice, but for the first and the last.
        let (mut work, mut contact) = (last.all, last.contact);
        for point in 0..2 * PARTS {
            let power = at(self, f64::from(point) / f64::from(2 * PARTS));
            let weight = if point == 0 { 1.0 } else { f64::from(2 + 2 * (point % 2)) };
            work += weight * power.all;
            contact += weight * power.contact;
        }
        let (work, contact) = (work / f64::from(6 * PARTS), contact / f64::from(6 * PARTS));
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
        works.numerical_dissipation += work + planes - damped - kinetic;
        if let PressureLoad::Overpressure(pressure) = system.pressure_load {
            works.gas += pressure * (after.volume - state.volume);
        }
        let gas = system.expansion(state, after.volume);
        accounting.commit_gas(system, state, gas, after.volume);
        state.positions.copy_from(positions);
        if let Some(contacts) = contacts {
            state.contact = contacts;
        }
    }

    /// Work of the forces in the workspace along the way between two fields of positions, J.
    fn power(
        &self,
        system: &FilmSystem,
        evaluation: &Evaluation,
        (from, to): (&Field, &Field),
    ) -> Power {
        let overpressure = system.overpressure_at(evaluation.gas_pressure);
        let forces = &self.workspace.forces;
        let mut power = Power::default();
        for node in 0..from.len() {
            let moved = to.get(node) - from.get(node);
            power.all += system.node_force(forces, overpressure, node).dot(&moved);
            power.contact += forces.contact.get(node).dot(&moved);
        }
        power
    }

    /// Lets the film creep at its positions for `length` (s): what its stored energy loses is the material loss.
    fn creep(
        &mut self,
        system: &FilmSystem,
        state: &mut FilmState,
        accounting: &mut EnergyAccounting,
        length: f64,
    ) {
        if state.creep.is_empty() {
            return;
        }
        let mut stored = |state: &FilmState| {
            system.evaluate(state, &state.positions, state.time, &mut self.workspace).strain
        };
        let before = stored(state);
        let mut creep = core::mem::take(&mut state.creep);
        CreepStrain::relax(&system.model, &state.positions, length, &mut creep);
        state.creep = creep;
        accounting.works.material_loss += before - stored(state);
    }
}

/// Inflow, leak and heat for `length` (s) at a fixed volume.
fn exchange(
    system: &FilmSystem,
    state: &mut FilmState,
    accounting: &mut EnergyAccounting,
    length: f64,
    inflow: Inflow,
) {
    let volume = state.volume;
    let gas = system.gas_step(state, volume, length, inflow);
    accounting.commit_gas(system, state, gas, volume);
}
