//! The interface of every integrator of film.
//!
//! ```text
//! advance(state at t, system, interval) → state at the end of the interval
//! ```
//!
//! An integrator has a state of its own (velocities between two times, the last step, its plan), which it can
//! give away as text for a checkpoint. It keeps the energy accounting of the run, with an entry for what its
//! numerics dissipate. It reads no clock: a budget bounds its steps.

use core::fmt;

use crate::geometry::field::Field;
use crate::integrators::StoredIntegrator;
use crate::integrators::energy_accounting::EnergyAccounting;
use crate::output::events::Event;
use crate::output::ledger::Ledger;
use crate::output::outcome::Failure;
use crate::platform::stopwatch::Stopwatch;
use crate::scene::timeline::Phase;
use crate::system::{FilmState, FilmSystem, Workspace};

/// An interval of time in which the phase is constant. Its end is reached exactly.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Interval<'a> {
    /// Its end, s.
    pub target: f64,
    /// Inflow, and whether the film is packed.
    pub phase: &'a Phase,
}

/// What an integrator may use, and to whom it reports.
pub struct Budget<'a> {
    /// Steps that may be taken before the integrator pauses; it subtracts those it takes.
    pub steps: &'a mut u64,
    /// Accepted steps since time 0 at which the run fails with `step_limit`.
    pub step_limit: u64,
    /// Checks every accepted step.
    pub audit: &'a mut dyn StepAudit,
    /// Learns when each stage of a step begins.
    pub stopwatch: &'a mut dyn Stopwatch,
    /// Receives the decisions of the step controller.
    pub events: &'a mut Vec<Event>,
}

impl Budget<'_> {
    /// The same budget, lent to a call.
    pub fn reborrow(&mut self) -> Budget<'_> {
        Budget {
            steps: &mut *self.steps,
            step_limit: self.step_limit,
            audit: &mut *self.audit,
            stopwatch: &mut *self.stopwatch,
            events: &mut *self.events,
        }
    }
}

/// How an accepted step moves the nodes: a x' = b x − c x⁻ + h u. Rigid motion, supports and impulses are part
/// of u; vertices that belong to no film are not.
#[derive(Debug, Clone, Copy)]
pub struct StepMotion<'a> {
    /// Time at its start, s.
    pub start: f64,
    /// h, s.
    pub length: f64,
    /// x: positions at its start, m.
    pub from: &'a Field,
    /// u: velocities that move the nodes, m/s.
    pub velocities: &'a Field,
    /// a, b and c. With c 0 the positions x⁻ before the last step do not matter.
    pub coefficients: [f64; 3],
}

/// Checks accepted steps, whatever the integrator.
pub trait StepAudit: fmt::Debug {
    /// Learns how an accepted step moves the nodes, before [`Self::record`].
    fn moved(&mut self, motion: StepMotion<'_>) -> Result<(), Failure>;

    /// Records the state after a step.
    fn record(&mut self, system: &FilmSystem, state: &FilmState) -> Result<(), Failure>;

    /// Looks at the state at the end of an interval that lies within a step: the checks of the recorded steps can
    /// wait for the end of that step.
    fn look(&mut self, system: &FilmSystem, state: &FilmState);

    /// Completes the checks of all recorded steps, at the end of an interval.
    fn complete(&mut self, system: &FilmSystem, state: &FilmState) -> Result<(), Failure>;
}

/// Where [`Integrator::advance`] ended.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Advance {
    /// At the end of the interval.
    Reached,
    /// Within the interval: the steps of the budget are used. The next call continues with the same bits.
    Paused,
}

/// What an integrator computed at the time of its state.
#[derive(Debug, Clone, Copy)]
pub struct Computed<'a> {
    /// Forces on the nodes, dissipative ones included, strain and stress, the search for contacts.
    pub workspace: &'a Workspace,
    /// Energy accounting since time 0.
    pub accounting: &'a EnergyAccounting,
}

/// An integrator of film in time.
pub trait Integrator: fmt::Debug + Send {
    /// Advances the state to the end of the interval, or until the budget is used. All fields of the state
    /// are then at the same time.
    ///
    /// # Errors
    /// [`Failure`]: the state is that of the last step, accepted or not.
    fn advance(
        &mut self,
        state: &mut FilmState,
        system: &FilmSystem,
        interval: Interval<'_>,
        budget: Budget<'_>,
    ) -> Result<Advance, Failure>;

    /// The length of the next step if nothing bounds it but this method, s.
    fn next_step(&self, system: &FilmSystem, state: &FilmState) -> f64;

    /// What the method computed at the state's time.
    fn computed(&self) -> Computed<'_>;

    /// The energy ledger of the film. [`EnergyAccounting::ledger`] needs only the energies that the method
    /// conserves.
    fn ledger(&self, system: &FilmSystem, state: &FilmState) -> Ledger;

    /// Private state for a checkpoint; `None` for an integrator that cannot be resumed.
    fn stored(&self) -> Option<StoredIntegrator>;

    /// A copy.
    fn boxed(&self) -> Box<dyn Integrator>;
}
