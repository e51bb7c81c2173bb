//! Explicit steps while film moves, implicit ones while it hardly does: packed, holding, filling.
//!
//! ```text
//! explicit → implicit    kinetic energy < 1 % of its largest for T = 1000 stable steps, and a first step has a solution
//!                        velocities ← (x(t) − x(t − T))/T
//! implicit → explicit    kinetic energy > 3 %, or the steps would be shorter than 500 stable steps
//! ```
//!
//! The decisions are taken at the end of an interval or of an implicit step; each is an event of the history. An
//! implicit step that leaves these bounds is discarded, and explicit steps begin at its start. Implicit steps start with
//! the mean velocities of the time T: a vibration that is fast against an implicit step would only be damped by
//! it, and its velocity at one moment says nothing about the step. Its energy is numerical dissipation, at most 1 % of
//! the largest kinetic energy a change. After an attempt without success the next one waits, at first 0.1 s.

use serde::{Deserialize, Serialize};

use crate::geometry::field::Field;
use crate::integrators::explicit::Explicit;
use crate::integrators::implicit::{GiveUpLimits, Implicit, Newton, Progress, StepControl};
use crate::integrators::interface::{Advance, Budget, Computed, Integrator, Interval};
use crate::integrators::{IntegratorEntry, StoredIntegrator, implicit};
use crate::output::events::{Event, EventKind};
use crate::output::ledger::Ledger;
use crate::output::outcome::Failure;
use crate::scene::timeline::Phase;
use crate::system::{FilmState, FilmSystem, Workspace};

/// The row in the table of integrators.
pub(super) const ENTRY: IntegratorEntry = IntegratorEntry {
    name: "hybrid",
    meaning: "explicit while film moves, implicit while it hardly does",
    start: |system, state, workspace, cfl| Box::new(Hybrid::start(system, state, workspace, cfl)),
    has_friction: implicit::ENTRY.has_friction,
    refuses: implicit::ENTRY.refuses,
};

/// Upper bound of the kinetic energy over its largest value at which film hardly moves. Chosen.
const REST: f64 = 0.01;
/// Kinetic energy over its largest value above which film moves. Chosen above [`REST`], so that the integrators do not
/// alternate.
const MOTION: f64 = 0.03;
/// First implicit step, and the smallest that pays, in stable steps. Measured: an implicit step costs as much as
/// 500 explicit ones at n 4, 900 at n 8.
const FIRST_STEPS: f64 = 1000.0;
const PAYING_STEPS: f64 = 500.0;
/// Factor on the allowed error of an implicit step. Chosen: 1 mm of a capsule of 1 m.
const ERROR_FACTOR: f64 = 10.0;
/// Time to the next attempt, s, its growth after an attempt without success, and its bound. Chosen.
const FIRST_PAUSE: f64 = 0.1;
const PAUSE_GROWTH: f64 = 1.5;
const LONGEST_PAUSE: f64 = 0.5;

/// Which integrator is at work.
#[derive(Debug, Clone)]
enum Active {
    Explicit(Box<Explicit>),
    Implicit(Box<Implicit>),
}

/// When the hybrid changes.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Policy {
    /// Largest kinetic energy so far, J.
    pub largest_kinetic_energy: f64,
    /// Time of the next attempt, s.
    pub next_attempt: f64,
    /// Pause before it, s.
    pub pause: f64,
    /// Stable step of explicit film at the last change, s.
    pub stable_step: f64,
}

/// Where film was when it began to move little.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct QuietStart {
    /// Time, s.
    pub time: f64,
    /// Positions, m.
    pub positions: Field,
}

/// Everything of the hybrid that a checkpoint stores.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct StoredHybrid {
    /// When it changes.
    pub policy: Policy,
    /// Where explicit film began to move little; `None` while it moves.
    pub quiet_start: Option<QuietStart>,
    /// The integrator at work: explicit or implicit.
    pub active: StoredIntegrator,
    /// Positions that the order of elimination is of, m.
    pub ordered_at: Field,
}

impl StoredHybrid {
    /// Whether it can be of this system.
    pub(in crate::integrators) fn fits(&self, system: &FilmSystem) -> bool {
        !matches!(self.active, StoredIntegrator::Hybrid(_)) && self.active.fits(system)
    }
}

/// Explicit and implicit steps.
#[derive(Debug, Clone)]
pub struct Hybrid {
    cfl: f64,
    policy: Policy,
    quiet_start: Option<QuietStart>,
    active: Active,
    /// Positions that the order of elimination is of, m.
    ordered_at: Field,
    /// Scratch of the next implicit steps.
    newton: Option<Box<Newton>>,
}

impl Hybrid {
    /// Starts at a state, explicitly.
    pub fn start(system: &FilmSystem, state: &FilmState, workspace: Workspace, cfl: f64) -> Self {
        let policy = Policy {
            largest_kinetic_energy: system.kinetic_energy(state),
            next_attempt: state.time,
            pause: FIRST_PAUSE,
            stable_step: 0.0,
        };
        let explicit = Explicit::start(system, state, workspace, cfl);
        let (active, ordered_at) = (Active::Explicit(Box::new(explicit)), state.positions.clone());
        Self { cfl, policy, quiet_start: None, active, ordered_at, newton: None }
    }

    /// Resumes at a state with what was stored there. The run continues with the same bits.
    pub fn resume(system: &FilmSystem, state: &FilmState, stored: StoredHybrid, cfl: f64) -> Self {
        let active = match stored.active {
            StoredIntegrator::Explicit(stored) => {
                Active::Explicit(Box::new(Explicit::resume(system, state, *stored, cfl)))
            }
            StoredIntegrator::Implicit(stored) => {
                Active::Implicit(Box::new(Implicit::resume(system, state, *stored)))
            }
            StoredIntegrator::Hybrid(_) => unreachable!("it does not fit"),
        };
        let StoredHybrid { policy, quiet_start, ordered_at, .. } = stored;
        Self { cfl, policy, quiet_start, active, ordered_at, newton: None }
    }

    fn active(&self) -> &dyn Integrator {
        match &self.active {
            Active::Explicit(explicit) => &**explicit,
            Active::Implicit(implicit) => &**implicit,
        }
    }

    /// Whether film has moved little for the time of a first implicit step, so that one can be tried now. `stable`:
    /// stable step, s.
    fn is_quiet(
        &mut self,
        state: &FilmState,
        system: &FilmSystem,
        phase: &Phase,
        stable: f64,
    ) -> bool {
        let kinetic = system.kinetic_energy(state);
        let policy = &mut self.policy;
        policy.largest_kinetic_energy = policy.largest_kinetic_energy.max(kinetic);
        let waits = phase.packed && system.contact.is_none();
        let slow = kinetic < REST * policy.largest_kinetic_energy;
        if waits || !slow {
            self.quiet_start = None;
            return false;
        }
        let first = FIRST_STEPS * stable;
        let early = state.time + first < policy.next_attempt;
        if early || phase.end < state.time + first {
            return false;
        }
        let start = self.quiet_start.get_or_insert_with(|| QuietStart {
            time: state.time,
            positions: state.positions.clone(),
        });
        let due = state.time >= policy.next_attempt;
        due && state.time - start.time >= first
    }

    /// Tries implicit steps from here on, if the film moves little and a step could go beyond the interval.
    fn attempt(
        &mut self,
        state: &mut FilmState,
        system: &FilmSystem,
        interval: Interval<'_>,
        budget: &mut Budget<'_>,
    ) -> Result<(), Failure> {
        let Active::Explicit(explicit) = &self.active else { return Ok(()) };
        let stable = explicit.next_step(system, state);
        let (before, accounting) =
            (explicit.ledger(system, state), *explicit.computed().accounting);
        if !self.is_quiet(state, system, interval.phase, stable) {
            return Ok(());
        }
        let Some(start) = self.quiet_start.take() else { return Ok(()) };
        self.policy.stable_step = stable;
        let slow = with_mean_velocities(system, state, &start);
        let control = StepControl::error(self.cfl, system.model.size(), ERROR_FACTOR);
        let newton = match self.newton.take() {
            Some(newton) => *newton,
            None => Newton::new(system, state, self.ordered_at.clone()),
        };
        let scratch = (Workspace::new(system, state), newton);
        let steps = (control, FIRST_STEPS * stable);
        let mut implicit = Implicit::from(system, &slow, scratch, steps, accounting);
        let after = implicit.ledger(system, &slow).stored();
        implicit.add_numerical_dissipation(before.stored() - after);
        if implicit.begin(system, &slow, interval.phase, self.give_up_limits(), budget.audit)? {
            self.policy.pause = FIRST_PAUSE;
            self.active = Active::Implicit(Box::new(implicit));
            *state = slow;
            budget.events.push(Event { time: state.time, kind: EventKind::Implicit });
        } else {
            self.newton = Some(Box::new(implicit.into_newton()));
            self.policy.next_attempt = state.time + self.policy.pause;
            self.policy.pause = (PAUSE_GROWTH * self.policy.pause).min(LONGEST_PAUSE);
        }
        Ok(())
    }

    /// Explicit steps from here on.
    fn give_up(&mut self, state: &FilmState, system: &FilmSystem, events: &mut Vec<Event>) {
        let Active::Implicit(implicit) = &self.active else { return };
        let accounting = *implicit.computed().accounting;
        let before = implicit.ledger(system, state).stored();
        let largest = self.policy.largest_kinetic_energy;
        let mut explicit = Explicit::continue_run(system, state, accounting, largest, self.cfl);
        let after = explicit.ledger(system, state).stored();
        explicit.add_numerical_dissipation(before - after);
        self.policy.next_attempt = state.time + self.policy.pause;
        let active = Active::Explicit(Box::new(explicit));
        if let Active::Implicit(implicit) = core::mem::replace(&mut self.active, active) {
            self.newton = Some(Box::new(implicit.into_newton()));
        }
        events.push(Event { time: state.time, kind: EventKind::Explicit });
    }

    fn give_up_limits(&self) -> GiveUpLimits {
        GiveUpLimits {
            step: PAYING_STEPS * self.policy.stable_step,
            kinetic: MOTION * self.policy.largest_kinetic_energy,
        }
    }
}

/// A state with the mean velocities (m/s) since an earlier one.
fn with_mean_velocities(system: &FilmSystem, state: &FilmState, start: &QuietStart) -> FilmState {
    let mut slow = state.clone();
    let length = state.time - start.time;
    for node in 0..slow.velocities.len() {
        let moved = state.positions.get(node) - start.positions.get(node);
        slow.velocities.set(node, moved / length);
    }
    for (body, speed) in system.supports.bodies.iter().zip(&mut slow.planes) {
        if let Some(node) = body.nodes.first() {
            *speed = body.plane.normal.dot(&slow.velocities.get(*node as usize));
        }
    }
    slow
}

impl Integrator for Hybrid {
    fn advance(
        &mut self,
        state: &mut FilmState,
        system: &FilmSystem,
        interval: Interval<'_>,
        mut budget: Budget<'_>,
    ) -> Result<Advance, Failure> {
        loop {
            let give_up = self.give_up_limits();
            match &mut self.active {
                Active::Explicit(explicit) => {
                    let advance = explicit.advance(state, system, interval, budget.reborrow())?;
                    if advance == Advance::Reached {
                        self.attempt(state, system, interval, &mut budget)?;
                    }
                    return Ok(advance);
                }
                Active::Implicit(implicit) => {
                    let progress = implicit.advance_within(
                        state,
                        system,
                        interval,
                        &mut budget,
                        Some(give_up),
                    )?;
                    match progress {
                        Progress::Advanced(advance) => return Ok(advance),
                        Progress::GaveUp => self.give_up(state, system, budget.events),
                    }
                }
            }
        }
    }

    fn next_step(&self, system: &FilmSystem, state: &FilmState) -> f64 {
        self.active().next_step(system, state)
    }

    fn computed(&self) -> Computed<'_> {
        self.active().computed()
    }

    fn ledger(&self, system: &FilmSystem, state: &FilmState) -> Ledger {
        self.active().ledger(system, state)
    }

    fn stored(&self) -> Option<StoredIntegrator> {
        let active = self.active().stored()?;
        let (policy, ordered_at) = (self.policy, self.ordered_at.clone());
        let quiet_start = self.quiet_start.clone();
        let stored = StoredHybrid { policy, quiet_start, active, ordered_at };
        Some(StoredIntegrator::Hybrid(Box::new(stored)))
    }

    fn boxed(&self) -> Box<dyn Integrator> {
        Box::new(self.clone())
    }
}
