//! BDF2 for film and its gas: steps far longer than the stable step of central differences.
//!
//! ```text
//! positions after a step: minimum of Π(x) + ½ w |x − x̂|²_M       `method`, by Newton's method `newton`
//! ```
//!
//! Pressure, gas (as a stiffness of rank one), contact, plates and further terms are implicit; inflow, leak, heat and
//! creep follow the motion (`increment`, `step`). The length of a step follows from its error ([`step_control`]). Steps
//! end at samples; those of the hybrid may go beyond, within their phase, and the state is interpolated
//! (`dense_output`). No film passes through film: every Newton step and the whole motion of a step are bounded by the
//! safe step of contact. Numerical damping is not needed, and not used. Friction, moving supports and moving plates are refused.

use crate::collision::contact::SearchProgress;
use crate::geometry::field::Field;
use crate::integrators::energy_accounting::EnergyAccounting;
use crate::integrators::interface::{
    Advance, Budget, Computed, Integrator, Interval, StepAudit, StepMotion,
};
use crate::integrators::{IntegratorEntry, Refusal, StoredIntegrator};
use crate::output::ledger::Ledger;
use crate::output::outcome::{AuditKind, Failure};
use crate::platform::stopwatch::Stage;
use crate::scene::inflow::Inflow;
use crate::scene::plate::Plate;
use crate::scene::timeline::Phase;
use crate::system::{Evaluation, FilmState, FilmSystem, Workspace};

pub(super) use newton::Newton;
use step::Stepped;

mod dense_output;
mod increment;
mod linear_system;
mod method;
pub mod motion;
mod newton;
mod step;
pub mod step_control;

pub use method::LastStep;
pub use motion::{ImplicitMotion, PendingStep, StoredImplicit};
pub use step_control::StepControl;

/// The row in the table of integrators.
pub(super) const ENTRY: IntegratorEntry = IntegratorEntry {
    name: "implicit",
    meaning: "BDF2 with Newton's method, steps by their error",
    start: |system, state, workspace, cfl| {
        let control = StepControl::error(cfl, system.model.size(), 1.0);
        Box::new(Implicit::start(system, state, workspace, control))
    },
    has_friction: false,
    refuses,
};

/// First step over the stable step of explicit film: 2/ω. Chosen: its error is far below any tolerance.
const FIRST_STEP: f64 = 5.0;
/// Most Newton steps, and those of a run that can be given up. Chosen: a shorter step, or explicit ones, cost less.
const MAX_ITERATIONS: u32 = 25;
const GIVE_UP_ITERATIONS: u32 = 12;
/// Smallest step over 1/ω: shorter ones need no implicit method. Chosen.
const MIN_STEP: f64 = 0.02;

/// Why an implicit run gives a system back: then another integrator does better.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct GiveUpLimits {
    /// Smallest step that pays, s.
    pub(super) step: f64,
    /// Largest kinetic energy, J.
    pub(super) kinetic: f64,
}

/// Where [`Implicit::advance_within`] ended.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Progress {
    /// As [`Advance`].
    Advanced(Advance),
    /// Before the end of the interval, at the end of a step: a limit of [`GiveUpLimits`] is exceeded.
    GaveUp,
}

/// BDF2 with Newton's method.
#[derive(Debug, Clone)]
pub struct Implicit {
    motion: ImplicitMotion,
    workspace: Workspace,
    /// Energies of the state.
    evaluation: Evaluation,
    newton: Newton,
    /// Newton steps of the last step.
    iterations: u32,
    // Scratch: x̂ and the predicted displacements of a step.
    target: Field,
    predicted: Field,
}

/// Why film cannot be integrated implicitly, but for friction; `None` if it can.
fn refuses(system: &FilmSystem) -> Option<Refusal> {
    let contact = system.contact.as_ref();
    // Its steps are elastic: a fold beyond its yield moment would creep by the same length in a step of any length.
    let yields = system.energy_terms.iter().any(|term| term.yield_values() > 0);
    let moving = |plates: &[Plate]| plates.iter().any(|plate| plate.motion.is_some());
    let refused = [
        (contact.is_some_and(|model| moving(&model.plates)), "moving plates", "plates at rest"),
        (yields, "yield", "no film.yield_moment"),
        (!system.supports.movers.is_empty(), "moving supports", "supports at rest"),
    ];
    let refused = refused.into_iter().find(|(present, ..)| *present);
    refused.map(|(_, unknown, allowed)| Refusal { unknown, allowed })
}

impl Implicit {
    /// Starts at a state.
    pub fn start(
        system: &FilmSystem,
        state: &FilmState,
        workspace: Workspace,
        control: StepControl,
    ) -> Self {
        let accounting = EnergyAccounting::start(system, state);
        let next_step = match control {
            StepControl::Fixed(step) => step,
            StepControl::Error(_) => FIRST_STEP * 2.0 / system.model.largest_frequency(),
        };
        let newton = Newton::new(system, state, state.positions.clone());
        let steps = (control, next_step);
        let mut implicit = Self::from(system, state, (workspace, newton), steps, accounting);
        implicit.motion.accounting.start_energy = implicit.ledger(system, state).stored();
        implicit
    }

    /// Continues a run at a state, with a first step of this length (s).
    pub(super) fn from(
        system: &FilmSystem,
        state: &FilmState,
        scratch: (Workspace, Newton),
        (control, next_step): (StepControl, f64),
        accounting: EnergyAccounting,
    ) -> Self {
        let phase = (false, f64::NAN);
        let motion =
            ImplicitMotion { control, last: None, next_step, phase, ahead: None, accounting };
        Self::with(system, state, scratch, motion)
    }

    /// Its scratch of Newton's method, for another run of the same system.
    pub(super) fn into_newton(self) -> Newton {
        self.newton
    }

    /// Resumes at a state with what was stored there. The run continues with the same bits.
    pub fn resume(system: &FilmSystem, state: &FilmState, stored: StoredImplicit) -> Self {
        let StoredImplicit { motion, path_length, ordered_at } = stored;
        let rebuilds = motion.accounting.broad_phase_rebuilds;
        let workspace = Workspace::resumed(system, state, SearchProgress { path_length, rebuilds });
        let newton = Newton::new(system, state, ordered_at);
        Self::with(system, state, (workspace, newton), motion)
    }

    fn with(
        system: &FilmSystem,
        state: &FilmState,
        (mut workspace, newton): (Workspace, Newton),
        motion: ImplicitMotion,
    ) -> Self {
        let evaluation = system.evaluate(state, &state.positions, state.time, &mut workspace);
        let zeros = || Field::zeros(system.model.nodes());
        let (target, predicted) = (zeros(), zeros());
        Self { motion, workspace, evaluation, newton, iterations: 0, target, predicted }
    }

    /// Advances as [`Integrator::advance`]; gives up where its steps do not pay.
    pub(super) fn advance_within(
        &mut self,
        state: &mut FilmState,
        system: &FilmSystem,
        Interval { target, phase }: Interval<'_>,
        budget: &mut Budget<'_>,
        give_up: Option<GiveUpLimits>,
    ) -> Result<Progress, Failure> {
        while state.time < target {
            if let Some(ahead) = self.motion.ahead.take() {
                if ahead.to.0.time > target {
                    (*state, self.motion.accounting) = ahead.at(system, target);
                    self.evaluate(system, state);
                    state.volume = self.evaluation.volume;
                    state.pressure = system.pressure(state.gas, state.volume);
                    self.workspace.commit_contact(state);
                    self.motion.ahead = Some(ahead);
                } else {
                    (*state, self.motion.accounting) = ahead.to;
                }
                budget.audit.record(system, state)?;
                continue;
            }
            if *budget.steps == 0 {
                self.evaluate(system, state);
                return Ok(Progress::Advanced(Advance::Paused));
            }
            if self.motion.accounting.steps >= budget.step_limit {
                let place = format!("after {} accepted steps", self.motion.accounting.steps);
                return Err(failure(state, &place));
            }
            *budget.steps -= 1;
            budget.stopwatch.begins(Stage::Update);
            self.motion.begin_phase(phase.packed, phase.inflow);
            if phase.packed && system.contact.is_none() {
                self.wait(system, state, target, phase.inflow);
                budget.audit.record(system, state)?;
                continue;
            }
            let limit = if give_up.is_some() { phase.end.max(target) } else { target };
            let Some(stepped) = self.step(system, state, (target, limit), phase.inflow, give_up)
            else {
                self.evaluate(system, state);
                if give_up.is_some() {
                    return Ok(Progress::GaveUp);
                }
                return Err(failure(state, "no step of the implicit method has a solution"));
            };
            self.go_ahead(state, stepped, budget.audit)?;
        }
        budget.stopwatch.begins(Stage::Audit);
        if self.motion.ahead.is_some() {
            budget.audit.look(system, state);
        } else {
            self.evaluate(system, state);
            budget.audit.complete(system, state)?;
        }
        Ok(Progress::Advanced(Advance::Reached))
    }

    /// Energies and forces of the state.
    fn evaluate(&mut self, system: &FilmSystem, state: &FilmState) {
        let workspace = &mut self.workspace;
        self.evaluation = system.evaluate(state, &state.positions, state.time, workspace);
    }

    /// Packed film without contact does not move: the gas alone goes on.
    fn wait(&mut self, system: &FilmSystem, state: &mut FilmState, end: f64, inflow: Inflow) {
        let length = end - state.time;
        let gas = system.gas_step(state, state.volume, length, inflow);
        let volume = state.volume;
        self.motion.accounting.commit_gas(system, state, gas, volume);
        self.motion.accounting.steps += 1;
        state.time = end;
    }

    /// One accepted step from a state, at most to a limit (s); `None` if there is none that pays.
    fn step(
        &mut self,
        system: &FilmSystem,
        state: &FilmState,
        (target, limit): (f64, f64),
        inflow: Inflow,
        give_up: Option<GiveUpLimits>,
    ) -> Option<Stepped> {
        let control = self.motion.control;
        let mut length = self.motion.next_step.min(control.longest());
        let iterations = if give_up.is_some() { GIVE_UP_ITERATIONS } else { MAX_ITERATIONS };
        let smallest =
            give_up.map_or(MIN_STEP / system.model.largest_frequency(), |give_up| give_up.step);
        loop {
            let end = next_end(state.time, length, target, limit);
            let planned = end - state.time;
            let advances = end > state.time;
            if !advances {
                return None;
            }
            let stepped = self.try_step(system, state, end, inflow, iterations);
            let (accepted, next) = match &stepped {
                None => (false, control.shorter(planned)?),
                Some(Stepped { error: (error, order), .. }) => {
                    control.next(planned, *error, *order)
                }
            };
            if let Some(give_up) = give_up
                && let Some(stepped) = &stepped
                && system.kinetic_energy(&stepped.state) > give_up.kinetic
            {
                return None;
            }
            if !accepted {
                length = next;
                if length < smallest {
                    return None;
                }
                continue;
            }
            // A step that a limit shortened says little about the next one.
            let shortened = planned < 0.99 * self.motion.next_step && planned < length;
            self.motion.next_step = if shortened { next.max(length) } else { next };
            self.motion.last = Some(LastStep {
                positions: state.positions.clone(),
                velocities: state.velocities.clone(),
                length: planned,
            });
            return stepped;
        }
    }

    /// Makes a step that is accepted the one that goes beyond the state.
    fn go_ahead(
        &mut self,
        state: &FilmState,
        stepped: Stepped,
        audit: &mut dyn StepAudit,
    ) -> Result<(), Failure> {
        audit.moved(StepMotion {
            start: state.time,
            length: stepped.state.time - state.time,
            from: &state.positions,
            velocities: &stepped.state.velocities,
            coefficients: stepped.coefficients,
        })?;
        let from = (state.clone(), self.motion.accounting);
        let to = (stepped.state, stepped.accounting);
        self.motion.ahead = Some(Box::new(PendingStep { from, to }));
        Ok(())
    }

    /// Takes a first step beyond the state; whether there is one that pays.
    pub(super) fn begin(
        &mut self,
        system: &FilmSystem,
        state: &FilmState,
        phase: &Phase,
        give_up: GiveUpLimits,
        audit: &mut dyn StepAudit,
    ) -> Result<bool, Failure> {
        self.motion.begin_phase(phase.packed, phase.inflow);
        let limits = (state.time, phase.end);
        let Some(stepped) = self.step(system, state, limits, phase.inflow, Some(give_up)) else {
            return Ok(false);
        };
        self.go_ahead(state, stepped, audit)?;
        self.evaluate(system, state);
        Ok(true)
    }

    pub(super) fn add_numerical_dissipation(&mut self, energy: f64) {
        self.motion.accounting.works.numerical_dissipation += energy;
    }
}

/// End of a step of about `length` (s), s: within a limit, without a tiny last step. Where the limit is the target,
/// steps up to it are equal.
fn next_end(time: f64, length: f64, target: f64, limit: f64) -> f64 {
    let remaining = limit - time;
    if remaining <= length * (1.0 + 1e-9) {
        return limit;
    }
    if limit <= target {
        return time + remaining / (remaining / length * (1.0 - 1e-9)).ceil();
    }
    if remaining < 2.0 * length { time + 0.5 * remaining } else { time + length }
}

fn failure(state: &FilmState, place: &str) -> Failure {
    Failure::new(AuditKind::StepLimit, state.time, place)
}

impl Integrator for Implicit {
    fn advance(
        &mut self,
        state: &mut FilmState,
        system: &FilmSystem,
        interval: Interval<'_>,
        mut budget: Budget<'_>,
    ) -> Result<Advance, Failure> {
        match self.advance_within(state, system, interval, &mut budget, None)? {
            Progress::Advanced(advance) => Ok(advance),
            Progress::GaveUp => unreachable!("without limits it does not give up"),
        }
    }

    fn next_step(&self, _: &FilmSystem, _: &FilmState) -> f64 {
        self.motion.next_step
    }

    fn computed(&self) -> Computed<'_> {
        Computed { workspace: &self.workspace, accounting: &self.motion.accounting }
    }

    fn ledger(&self, system: &FilmSystem, state: &FilmState) -> Ledger {
        let kinetic = system.kinetic_energy(state);
        self.motion.accounting.ledger(system, state, kinetic, self.evaluation.strain)
    }

    fn stored(&self) -> Option<StoredIntegrator> {
        Some(StoredIntegrator::Implicit(Box::new(StoredImplicit {
            motion: self.motion.clone(),
            path_length: self.workspace.path_length(),
            ordered_at: self.newton.ordered_at.clone(),
        })))
    }

    fn boxed(&self) -> Box<dyn Integrator> {
        Box::new(self.clone())
    }
}
