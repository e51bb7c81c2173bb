//! One substep: prediction, projections, new velocities, gas, works.
//!
//! ```text
//! x* = x + h (v + P (keep − 1) v + gain W f_ext)         prescribed components: x* of their motion
//! Δp = (p − p_ambient − k ∂V·(x* − x))/(1 + h gain k ∂V·W ∂V)        k = γ p/V;  p ≥ 0
//! x* ← x* + h gain W ∂V Δp                               a fixed overpressure: Δp is that
//! support work = ½ m (|v'|² − |v|²) − ½ (f + f')·Δx      over prescribed components
//! ```
//!
//! keep and gain: [`kick_factors`].

use super::contacts::{keep_apart, project_contacts};
use super::sweep::{Law, settle, sweep};
use super::{Xpbd, failure};
use crate::geometry::field::Field;
use crate::integrators::interface::{Budget, StepMotion};
use crate::mechanics::forces::damping::kick_factors;
use crate::output::outcome::{AuditKind, Failure};
use crate::platform::fault_injection::Term;
use crate::platform::stopwatch::{Stage, Stopwatch};
use crate::scene::inflow::Inflow;
use crate::system::{FilmState, FilmSystem, PressureLoad};

/// Upper bound of S1/E: film at three times its length, as for central differences.
const MAX_STRESS_RATIO: f64 = 4.0;

impl Xpbd {
    /// A substep of `length` (s) that ends at the time `end` (s).
    pub(super) fn step(
        &mut self,
        system: &FilmSystem,
        state: &mut FilmState,
        (length, end): (f64, f64),
        inflow: Inflow,
        budget: &mut Budget<'_>,
    ) -> Result<(), Failure> {
        let stopwatch = &mut *budget.stopwatch;
        stopwatch.begins(Stage::Update);
        self.predict(system, state, length, end);
        stopwatch.begins(Stage::Membrane);
        let law = Law { material: &system.model.material, creep: &system.model.creep };
        let set = system.instruction_set;
        let (batches, multipliers) = (&self.batches, &mut self.multipliers);
        let next = &mut self.next;
        let predicted = system.fault.is_some().then(|| next.clone());
        let columns = &mut [&mut next.x[..], &mut next.y[..], &mut next.z[..]];
        sweep(set, batches, law, &state.creep, length, columns, multipliers);
        if let Some(predicted) = predicted {
            inject_fault(system, &predicted, next);
        }
        stopwatch.begins(Stage::Pairs);
        project_contacts(system, state, &self.mobility, (length, end), &mut self.next);
        for node in 0..system.model.nodes() {
            self.displacements.set(node, self.next.get(node) - state.positions.get(node));
        }
        self.separate(system, state, (length, end), stopwatch)?;

        stopwatch.begins(Stage::Update);
        let before = self.prescribed_work(system, state);
        self.accounting.works.support -= 0.5 * before + prescribed_energy(system, state);
        for (plate, plate_state) in plates(system).zip(&state.contact.plates) {
            let work = 0.5 * plate_state.force * plate.displacement(state.time, end);
            self.accounting.works.support += work;
        }
        for node in 0..system.model.nodes() {
            state.velocities.set(node, self.displacements.get(node) / length);
        }
        budget.audit.moved(StepMotion {
            start: state.time,
            length,
            from: &state.positions,
            velocities: &state.velocities,
            coefficients: [1.0, 1.0, 0.0],
        })?;
        for node in 0..system.model.nodes() {
            let displacement = self.displacements.get(node);
            state.positions.set(node, state.positions.get(node) + displacement);
        }
        system.place_closing_nodes(&mut state.positions);
        let start = core::mem::replace(&mut state.time, end);

        stopwatch.begins(Stage::Membrane);
        let positions = &mut state.positions;
        let columns = &[&mut positions.x[..], &mut positions.y[..], &mut positions.z[..]];
        let (batches, multipliers) = (&self.batches, &self.multipliers);
        let settled = settle(set, batches, law, &mut state.creep, length, columns, multipliers);
        self.residual.add(settled.residual, settled.size);
        self.accounting.works.material_loss += settled.material_loss;
        let sums = self.workspace.forces_at(system, state, None);
        self.workspace.commit_contact(state);

        stopwatch.begins(Stage::Gas);
        let after = self.prescribed_work(system, state);
        self.accounting.works.support += prescribed_energy(system, state) - 0.5 * after;
        for (plate, plate_state) in plates(system).zip(&state.contact.plates) {
            let work = 0.5 * plate_state.force * plate.displacement(start, end);
            self.accounting.works.support += work;
        }
        let volume = sums.six_volumes / 6.0;
        if !volume.is_finite() {
            return Err(failure(state, AuditKind::FiniteMotion, "the volume is not finite"));
        }
        match system.pressure_load {
            PressureLoad::Gas(_) if volume <= 0.0 => {
                return Err(failure(state, AuditKind::Volume, "gas volume"));
            }
            PressureLoad::Overpressure(pressure) => {
                self.accounting.works.gas += pressure * (volume - state.volume);
            }
            PressureLoad::Gas(_) => {}
        }
        let gas = system.gas_step(state, volume, length, inflow);
        self.accounting.commit_gas(system, state, gas, volume);
        stopwatch.begins(Stage::Audit);
        self.accounting.film_stress = self.accounting.film_stress.max(sums.largest_stress);
        let ratio = sums.largest_stress / system.model.material.youngs_modulus;
        if ratio > MAX_STRESS_RATIO {
            let place = format!("largest principal stress {ratio:.2} times Young's modulus");
            return Err(failure(state, AuditKind::Stretch, &place));
        }
        Ok(())
    }

    /// Sets the predicted positions of a substep of `length` (s) that ends at the time `end` (s). Adds the work of
    /// mass damping.
    fn predict(&mut self, system: &FilmSystem, state: &FilmState, length: f64, end: f64) {
        let damping = system.mass_damping * system.fault_factor(Term::MassDamping);
        let (keep, gain) = kick_factors(damping, length);
        let gravity = system.gravity * system.fault_factor(Term::Gravity);
        let forces = &self.workspace.forces;
        let mut damped = 0.0;
        for node in 0..system.model.nodes() {
            let (mass, velocity) = (system.model.mass[node], state.velocities.get(node));
            let mut force = gravity * mass;
            if !system.energy_terms.is_empty() {
                force += forces.terms.get(node);
            }
            let mut change = self.mobility.of(node, force * gain);
            if damping > 0.0 {
                change += self.mobility.of(node, velocity * (mass * (keep - 1.0)));
                let mean = self.mobility.of(node, (velocity + change * 0.5) * mass);
                damped += mass * mean.norm_squared();
            }
            self.next.set(node, state.positions.get(node) + (velocity + change) * length);
        }
        self.accounting.works.damping += damping * length * damped;
        for mover in &system.supports.movers {
            for (node, position) in mover.positions(end) {
                let node = node as usize;
                let predicted = self.next.get(node);
                self.next.set(node, predicted + mover.held * (position - predicted));
            }
        }
        self.push(system, state, gain * length);
        system.place_closing_nodes(&mut self.next);
    }

    /// Adds to the predicted positions what the pressure does in a substep of this `squared` length (s²).
    fn push(&mut self, system: &FilmSystem, state: &FilmState, squared: f64) {
        let forces = &self.workspace.forces;
        let nodes = 0..system.model.nodes();
        let mut overpressure = system.overpressure(state);
        if let PressureLoad::Gas(gas) = system.pressure_load {
            let stiffness = gas.gamma() * state.pressure / state.volume;
            let (mut expansion, mut mobility) = (0.0, 0.0);
            for node in nodes.clone() {
                let area = forces.area(node);
                expansion += area.dot(&(self.next.get(node) - state.positions.get(node)));
                mobility += area.dot(&self.mobility.of(node, area));
            }
            let vacuum = overpressure - state.pressure;
            let after = overpressure - stiffness * expansion;
            overpressure = (after / (1.0 + squared * stiffness * mobility)).max(vacuum);
        }
        for node in nodes {
            let moved = self.mobility.of(node, forces.area(node) * (overpressure * squared));
            self.next.set(node, self.next.get(node) + moved);
        }
    }

    /// Checks the displacements of a substep and keeps film apart.
    fn separate(
        &mut self,
        system: &FilmSystem,
        state: &FilmState,
        (length, end): (f64, f64),
        stopwatch: &mut dyn Stopwatch,
    ) -> Result<(), Failure> {
        let squares = self.displacements.iter().map(|u| u.norm_squared());
        // NaN counts as the largest.
        let largest = squares.fold(0.0, |a: f64, b| if b <= a { a } else { b }).sqrt();
        let within = largest <= system.model.size();
        if !within {
            let place = "a node moves farther than the size of the film in one substep";
            return Err(failure(state, AuditKind::FiniteMotion, place));
        }
        let (Some(model), Some(contact)) = (&system.contact, &mut self.workspace.contact) else {
            return Ok(());
        };
        stopwatch.begins(Stage::Search);
        contact.list.prepare_step(model, &state.positions, &mut contact.progress, largest);
        self.accounting.broad_phase_rebuilds = contact.progress.rebuilds;
        stopwatch.begins(Stage::Pairs);
        let candidates = &contact.list.candidates;
        let (mobility, moves) = (&self.mobility, &mut self.displacements);
        let separation = keep_apart(system, state, mobility, candidates, (largest, end), moves);
        self.accounting.collision_dissipation += separation.dissipation / (length * length);
        self.accounting.collision_impulses += separation.pairs;
        Ok(())
    }

    /// Work of all forces now along the prescribed components of the displacements, J.
    fn prescribed_work(&self, system: &FilmSystem, state: &FilmState) -> f64 {
        let overpressure = system.overpressure(state);
        let mut work = 0.0;
        for mover in &system.supports.movers {
            for node in &mover.nodes {
                let node = *node as usize;
                let displacement = mover.held * self.displacements.get(node);
                let force = system.node_force(&self.workspace.forces, overpressure, node);
                work += force.dot(&displacement);
            }
        }
        work
    }
}

/// Applies a deliberate fault to what the projections of the elements moved: tests only.
fn inject_fault(system: &FilmSystem, predicted: &Field, next: &mut Field) {
    let factor = system.fault_factor(Term::Elastic);
    for node in 0..next.len() {
        let from = predicted.get(node);
        next.set(node, from + (next.get(node) - from) * factor);
    }
}

/// Kinetic energy of the prescribed components, J.
fn prescribed_energy(system: &FilmSystem, state: &FilmState) -> f64 {
    let mut energy = 0.0;
    for mover in &system.supports.movers {
        for node in &mover.nodes {
            let node = *node as usize;
            let held = mover.held * state.velocities.get(node);
            energy += 0.5 * system.model.mass[node] * held.norm_squared();
        }
    }
    energy
}

/// The plates of a system.
fn plates(system: &FilmSystem) -> impl Iterator<Item = &crate::scene::plate::Plate> {
    system.contact.iter().flat_map(|model| &model.plates)
}
