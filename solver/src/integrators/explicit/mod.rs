//! Central differences for film and its gas.
//!
//! ```text
//! f = f_film + f_contact + (p − p_ambient) ∂V/∂x + m g      at time n
//! v⁺ = v⁻ + h a,  h = (Δt⁻ + Δt)/2                        half-step velocities
//! x ← x + Δt v⁺;  the gas steps from V to V'              time n + 1
//!
//! Δt ≤ CFL (√(1+ζ²) − ζ) 2/√(ω_film² + ω_gas²)             stable step; quiescent film: `quiescence`
//! kinetic energy at n: ½ Σ m v⁻·v⁺
//! ```
//!
//! Each work is the trapezoid rule of its own force along its own displacement, ½ (fⁿ + fⁿ⁺¹)·Δx; the
//! work of numerical damping agrees with that up to third order in Δt
//! ([`crate::mechanics::forces::damping`]). With equal steps these works and the kinetic energy above
//! add up exactly. So a ledger residual has one of two causes: a force that is not the derivative of its
//! energy, or a step that turns an element too far. The gas does the work ½ (pⁿ + pⁿ⁺¹) ΔV, and the
//! ledger of the film takes the same number.
//!
//! Between two targets all steps are equal, so a run reaches every target exactly and without a tiny
//! last step. One exception: contact with a quiescent film shortens the steps from there on.
//! Private to the method are the velocities half a step ago, the last step, the numerical stress and the plan
//! of steps ([`StoredExplicit`]): with the film's state they continue a run with the same bits, from any
//! step. At the end of an interval the state has the velocities of its own time.

use crate::collision::contact::SearchProgress;
use crate::geometry::field::Field;
use crate::integrators::energy_accounting::EnergyAccounting;
use crate::integrators::interface::{Advance, Budget, Computed, Integrator, Interval, StepMotion};
use crate::integrators::{IntegratorEntry, StoredIntegrator};
use crate::mechanics::energy_term::Yielding;
use crate::mechanics::film_model::FilmModel;
use crate::mechanics::forces::damping::stable_share;
use crate::mechanics::forces::membrane::stored_energy;
use crate::mechanics::forces::pressure::gas_frequency_squared;
use crate::output::ledger::Ledger;
use crate::output::outcome::{AuditKind, Failure};
use crate::platform::fault_injection::Term;
use crate::platform::stopwatch::Stage;
use crate::scene::inflow::Inflow;
use crate::system::{FilmState, FilmSystem, PressureLoad, Workspace};

use motion::{Motion, TermClock};
use update::{drift_nodes, sparse_power};

mod collisions;
mod contact_step;
mod kick;
pub mod motion;
mod quiescence;
mod stability;
pub mod update;

pub use motion::StoredExplicit;
pub use quiescence::Quiescence;

/// The row in the table of integrators.
pub(super) const ENTRY: IntegratorEntry = IntegratorEntry {
    name: "explicit",
    meaning: "central differences with the stable step",
    start: |system, state, workspace, cfl| Box::new(Explicit::start(system, state, workspace, cfl)),
    has_friction: true,
    refuses: |_| None,
};

/// Upper bound of step × largest film frequency for a step that leaves creep and damping unchanged. Such
/// steps lie between targets that differ by rounding. Chosen: far below any step of a run (about 1).
const MAX_TINY_STEP: f64 = 1e-6;

/// Central differences.
#[derive(Debug, Clone)]
pub struct Explicit {
    /// CFL number: the step as a fraction of the stable step.
    cfl: f64,
    /// What changes and is private to the method.
    motion: Motion,
    /// Forces now, and the search for contacts.
    workspace: Workspace,
    /// Largest principal stress now, Pa.
    largest_stress: f64,
    /// Scratch: the velocities after a kick; then those before it.
    next: Field,
}

impl Explicit {
    /// Starts at a state.
    pub fn start(system: &FilmSystem, state: &FilmState, workspace: Workspace, cfl: f64) -> Self {
        let accounting = EnergyAccounting::start(system, state);
        let motion = Motion::start(state, accounting);
        let mut explicit = Self::with(system, state, workspace, motion, cfl);
        explicit.motion.accounting.start_energy = explicit.ledger(system, state).stored();
        explicit
    }

    /// Continues a run at a state, with the accounting so far and the largest kinetic energy (J) of the run.
    pub(super) fn continue_run(
        system: &FilmSystem,
        state: &FilmState,
        accounting: EnergyAccounting,
        largest_kinetic_energy: f64,
        cfl: f64,
    ) -> Self {
        let mut motion = Motion::start(state, accounting);
        motion.quiescence = Quiescence::continued(largest_kinetic_energy, state.time);
        Self::with(system, state, Workspace::new(system, state), motion, cfl)
    }

    pub(super) fn add_numerical_dissipation(&mut self, energy: f64) {
        self.motion.accounting.works.numerical_dissipation += energy;
    }

    /// Resumes at a state with what was stored there. The run continues with the same bits.
    pub fn resume(
        system: &FilmSystem,
        state: &FilmState,
        stored: StoredExplicit,
        cfl: f64,
    ) -> Self {
        let StoredExplicit { motion, histories, path_length } = stored;
        let rebuilds = motion.accounting.broad_phase_rebuilds;
        let mut workspace =
            Workspace::resumed(system, state, SearchProgress { path_length, rebuilds });
        workspace.histories = histories;
        Self::with(system, state, workspace, motion, cfl)
    }

    fn with(
        system: &FilmSystem,
        state: &FilmState,
        mut workspace: Workspace,
        motion: Motion,
        cfl: f64,
    ) -> Self {
        let sums = workspace.forces_at(system, state, Some(0.0));
        let next = Field::zeros(system.model.nodes());
        Self { cfl, motion, workspace, largest_stress: sums.largest_stress, next }
    }

    fn advance_steps(
        &mut self,
        state: &mut FilmState,
        system: &FilmSystem,
        Interval { target, phase }: Interval<'_>,
        budget: &mut Budget<'_>,
    ) -> Result<Advance, Failure> {
        let mut interval = match self.motion.step_interval.take() {
            Some(interval) => interval,
            None => self
                .plan_interval(system, state, target, phase, budget.events)
                .ok_or_else(|| no_advance(state))?,
        };
        while let Some(end) = interval.next_end() {
            if *budget.steps == 0 {
                self.motion.step_interval = Some(interval);
                return Ok(Advance::Paused);
            }
            if self.motion.accounting.steps >= budget.step_limit {
                let place = format!("after {} accepted steps", self.motion.accounting.steps);
                return Err(failure(state, AuditKind::StepLimit, &place));
            }
            *budget.steps -= 1;
            interval.index += 1;
            if phase.packed && system.contact.is_none() {
                self.wait(system, state, interval.length, phase.inflow);
                state.time = end;
            } else {
                let remaining = interval.count - interval.index + 1;
                self.step(system, state, (interval.length, remaining), end, phase.inflow, budget)?;
                state.time = end;
                budget.audit.record(system, state)?;
            }
            self.motion.accounting.steps += 1;
            if self.activity_detected(system, state, &interval)
                || self.step_too_long(system, state, &interval)
            {
                self.motion.terms.steps = 0;
                interval = self
                    .replan_interval(system, state, interval.target, budget.events)
                    .ok_or_else(|| no_advance(state))?;
            }
        }
        system.term_forces(&state.positions, &state.yielded, &mut self.workspace.forces);
        budget.stopwatch.begins(Stage::Audit);
        budget.audit.complete(system, state)?;
        Ok(Advance::Reached)
    }

    /// The longest step of film in motion now, s: CFL number times stable step.
    fn stable_step(&self, system: &FilmSystem, state: &FilmState) -> f64 {
        self.max_step(system, state, self.cfl, true)
    }

    /// The longest step at this CFL number now, s; with `contact_active` also stable under contact forces.
    fn max_step(
        &self,
        system: &FilmSystem,
        state: &FilmState,
        cfl: f64,
        contact_active: bool,
    ) -> f64 {
        let film = system.model.largest_frequency();
        let gas = match system.pressure_load {
            PressureLoad::Gas(gas) => {
                let stiffness = gas.gamma() * state.pressure;
                let (supports, forces) = (&system.supports, &self.workspace.forces);
                gas_frequency_squared(&system.model, supports, forces, stiffness, state.volume)
            }
            PressureLoad::Overpressure(_) => 0.0,
        };
        let terms = system.energy_terms.iter();
        let gas = terms.fold(gas, |sum, term| sum + term.frequency_squared(&system.model.mass));
        let factor = stable_share(system.numerical_damping) * 2.0;
        let max_step = cfl * factor / (self.stretched_squared(system) + gas).sqrt();
        match system.contact.as_ref().filter(|_| contact_active) {
            // Contact bounds stability only: the CFL number already keeps the step well below it.
            Some(contact_model) => {
                let contact = contact_model.added_frequency_squared();
                max_step.min(factor / (film * film + gas + contact).sqrt())
            }
            None => max_step,
        }
    }

    /// A step in which no node moves: packed film without contact.
    fn wait(&mut self, system: &FilmSystem, state: &mut FilmState, length: f64, inflow: Inflow) {
        (self.motion.last_step, self.motion.terms) = (0.0, TermClock::default());
        let (volume, gas) = (state.volume, system.gas_step(state, state.volume, length, inflow));
        self.motion.accounting.commit_gas(system, state, gas, volume);
    }

    /// A step of `length` (s) that ends at the time `end` (s). `remaining`: the planned
    /// steps of this length, with this one.
    fn step(
        &mut self,
        system: &FilmSystem,
        state: &mut FilmState,
        (length, remaining): (f64, u64),
        end: f64,
        inflow: Inflow,
        budget: &mut Budget<'_>,
    ) -> Result<(), Failure> {
        let stopwatch = &mut *budget.stopwatch;
        stopwatch.begins(Stage::Update);
        let kick = 0.5 * (self.motion.last_step + length);
        let term_kick = self.motion.terms.step(system, length, remaining);
        if term_kick != 0.0 {
            // The trapezoid of the motion since the last kick holds what is released beyond the work. Before the first
            // kick nothing has moved.
            let Yielding { work, released } = system.let_terms_yield(state);
            self.motion.accounting.works.material_loss +=
                if self.motion.last_step > 0.0 { work } else { released };
            system.term_forces(&state.positions, &state.yielded, &mut self.workspace.forces);
        }
        self.kick(system, state, (kick, term_kick), length, end);
        self.collision_step(system, state, kick, length, stopwatch)?;
        stopwatch.begins(Stage::Update);
        self.half_step_works(system, state, length);
        let drift = length * system.fault_factor(Term::Drift);
        let velocities = &self.motion.velocities;
        budget.audit.moved(StepMotion {
            start: state.time,
            length,
            from: &state.positions,
            velocities,
            coefficients: [1.0, 1.0, 0.0],
        })?;
        let max_speed_squared =
            drift_nodes(system.instruction_set, velocities, drift, &mut state.positions);
        self.add_plate_work(system, state, end);
        // In a tiny step the rounding of a stress would count as a stress rate.
        let tiny = length * system.model.largest_frequency() < MAX_TINY_STEP;
        let elapsed = if tiny { 0.0 } else { length };
        let sums = self.workspace.step_forces(system, state, elapsed, end, stopwatch);
        self.largest_stress = sums.largest_stress;
        stopwatch.begins(Stage::Gas);
        self.add_plate_work(system, state, end);
        let volume = sums.six_volumes / 6.0;
        let max_speed = max_speed_squared.sqrt();
        self.check_finite(system, state, max_speed * drift, volume)?;
        let accounting = &mut self.motion.accounting;
        let factor = system.fault_factor(Term::NumericalWork);
        accounting.works.numerical_dissipation += sums.numerical_dissipation * factor;
        accounting.works.material_loss += sums.material_loss;
        accounting.film_stress = accounting.film_stress.max(sums.largest_stress);
        if matches!(system.pressure_load, PressureLoad::Gas(_)) && volume <= 0.0 {
            return Err(self.inverted_volume(system, state));
        }
        let gas = system.gas_step(state, volume, length, inflow);
        self.motion.accounting.commit_gas(system, state, gas, volume);
        stopwatch.begins(Stage::Update);
        self.half_step_works(system, state, length);
        self.motion.last_step = length;
        stopwatch.begins(Stage::Audit);
        self.check_source(system, state, max_speed)?;
        self.check_stretch(system, state)
    }

    /// Adds half a step's work of the forces now along the velocities now: of contact, of moving supports,
    /// and of a fixed overpressure. Called before and after the drift, so each work is a trapezoid.
    fn half_step_works(&mut self, system: &FilmSystem, state: &FilmState, length: f64) {
        let half = 0.5 * length;
        let (forces, velocities) = (&self.workspace.forces, &self.motion.velocities);
        if self.workspace.contact_active() {
            let power = sparse_power(system.instruction_set, &forces.contact, velocities);
            self.motion.accounting.works.contact += half * power;
        }
        let support = self.support_power(system, state);
        let works = &mut self.motion.accounting.works;
        works.support -= half * support;
        if let PressureLoad::Overpressure(pressure) = system.pressure_load {
            let velocities = &self.motion.velocities;
            let volume_rate: f64 = (0..system.model.nodes())
                .map(|node| self.workspace.forces.area(node).dot(&velocities.get(node)))
                .sum();
            works.gas += half * pressure * volume_rate;
        }
    }
}

/// A failure at the time of a state.
fn failure(state: &FilmState, audit: AuditKind, place: &str) -> Failure {
    Failure::new(audit, state.time, place)
}

fn no_advance(state: &FilmState) -> Failure {
    failure(state, AuditKind::StepLimit, "the step is too small to advance time")
}

impl Integrator for Explicit {
    fn advance(
        &mut self,
        state: &mut FilmState,
        system: &FilmSystem,
        interval: Interval<'_>,
        mut budget: Budget<'_>,
    ) -> Result<Advance, Failure> {
        let advanced = self.advance_steps(state, system, interval, &mut budget);
        self.synchronise(system, state);
        advanced
    }

    fn next_step(&self, system: &FilmSystem, state: &FilmState) -> f64 {
        self.stable_step(system, state)
    }

    fn computed(&self) -> Computed<'_> {
        Computed { workspace: &self.workspace, accounting: &self.motion.accounting }
    }

    fn ledger(&self, system: &FilmSystem, state: &FilmState) -> Ledger {
        let strain = stored_energy(&system.model, &state.creep, &self.workspace.histories);
        let kinetic = self.kinetic_energy(system, state);
        self.motion.accounting.ledger(system, state, kinetic, strain)
    }

    fn stored(&self) -> Option<StoredIntegrator> {
        Some(StoredIntegrator::Explicit(Box::new(StoredExplicit {
            motion: self.motion.clone(),
            histories: self.workspace.histories.clone(),
            path_length: self.workspace.path_length(),
        })))
    }

    fn boxed(&self) -> Box<dyn Integrator> {
        Box::new(self.clone())
    }
}
