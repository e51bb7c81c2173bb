//! An integrator that works up to a time and has a fault from there on.
//!
//! It wraps an integrator of the solver and lets it take one step at a time. A fault is a change of the system that
//! the integrator sees, for one step or from then on, or one change of what a checkpoint holds. The energy
//! accounting and the audits of the run go on: to them the fault is a defect of the program, not a new start.

use billow_solver::integrators::{Advance, Budget, Computed, Integrator, Interval, entry};
use billow_solver::output::outcome::Failure;

use super::stored::ahead;
use crate::prelude::*;

/// What is wrong.
#[derive(Debug, Clone, Copy)]
pub enum Change {
    /// Nothing.
    Nothing,
    /// The system that the integrator sees, from a step on. The change is given the state there; `false` if it can
    /// be made only in a later one.
    System(fn(&mut FilmSystem, &FilmState) -> bool),
    /// The system that the integrator sees, in one step.
    OneStep(fn(&mut FilmSystem)),
    /// What a checkpoint holds, once between two steps.
    Stored(fn(&mut StoredFilm, &FilmSystem)),
    /// The positions after one step: the nodes move twice as far as they should.
    DoubledStep,
}

/// An integrator with a fault.
#[derive(Debug)]
pub struct Injected {
    inner: Box<dyn Integrator>,
    cfl: f64,
    change: Change,
    /// Time from which the fault is there, s.
    time: f64,
    /// Whether nothing remains to be injected.
    over: bool,
    /// The system with the fault.
    faulty: Option<Box<FilmSystem>>,
}

/// A run at time 0 whose integrator has a fault from a time (s) on.
pub fn injected(mut run: FilmRun, change: Change, time: f64) -> FilmRun {
    let (system, state, settings) = run.film.clone().into_parts();
    let (state, workspace) =
        FilmState::start(&system, state.positions, state.velocities, state.gas);
    let inner = (entry(settings.integrator).start)(&system, &state, workspace, settings.cfl);
    let injected = Injected { inner, cfl: settings.cfl, change, time, over: false, faulty: None };
    run.film = FilmSimulation::of(system, state, settings, Box::new(injected));
    run
}

/// Moves positions away from others as far again.
fn double(positions: &mut Field, before: &Field) {
    for node in 0..positions.len() {
        positions.set(node, positions.get(node) * 2.0 - before.get(node));
    }
}

impl Injected {
    fn seen<'a>(&'a self, system: &'a FilmSystem) -> &'a FilmSystem {
        self.faulty.as_deref().unwrap_or(system)
    }

    /// At most one step. Returns whether it took one, and what the integrator says.
    fn step(
        &mut self,
        state: &mut FilmState,
        system: &FilmSystem,
        interval: Interval<'_>,
        budget: &mut Budget<'_>,
    ) -> Result<(bool, Advance), Failure> {
        let mut one = 1;
        let seen = self.faulty.as_deref().unwrap_or(system);
        let lent = Budget { steps: &mut one, ..budget.reborrow() };
        let advance = self.inner.advance(state, seen, interval, lent)?;
        let stepped = one == 0;
        *budget.steps -= u64::from(stepped);
        Ok((stepped, advance))
    }

    /// Changes what a checkpoint holds.
    fn edit(
        &mut self,
        state: &mut FilmState,
        system: &FilmSystem,
        edit: impl FnOnce(&mut StoredFilm),
    ) {
        let integrator = self.inner.stored().expect("an integrator that can be stored");
        let mut stored = StoredFilm { state: state.clone(), integrator };
        edit(&mut stored);
        *state = stored.state;
        self.inner = stored.integrator.resume(system, state, self.cfl);
    }

    /// Injects what is wrong before a step.
    fn before_step(&mut self, state: &mut FilmState, system: &FilmSystem) {
        let mut faulty = Box::new(system.clone());
        match self.change {
            Change::Nothing => self.over = true,
            Change::System(change) => {
                if change(&mut faulty, state) {
                    self.faulty = Some(faulty);
                    self.over = true;
                }
            }
            Change::OneStep(change) => {
                change(&mut faulty);
                self.faulty = Some(faulty);
            }
            Change::Stored(change) => {
                self.edit(state, system, |stored| change(stored, system));
                self.over = true;
            }
            Change::DoubledStep => {}
        }
    }

    /// Injects what is wrong after the step that began with these positions.
    fn after_step(&mut self, state: &mut FilmState, system: &FilmSystem, before: &Field) {
        self.over = true;
        self.faulty = None;
        if matches!(self.change, Change::DoubledStep) {
            let mut inside = false;
            self.edit(state, system, |stored| {
                // The step may go beyond the time of the state.
                if let Some(ahead) = ahead(&mut stored.integrator) {
                    double(&mut ahead.to.0.positions, &ahead.from.0.positions);
                    inside = true;
                }
            });
            if !inside {
                double(&mut state.positions, before);
            }
        }
    }
}

impl Integrator for Injected {
    fn advance(
        &mut self,
        state: &mut FilmState,
        system: &FilmSystem,
        interval: Interval<'_>,
        mut budget: Budget<'_>,
    ) -> Result<Advance, Failure> {
        while !self.over && *budget.steps > 0 {
            let due = state.time >= self.time;
            if due {
                self.before_step(state, system);
            }
            let before = state.positions.clone();
            let (stepped, advance) = self.step(state, system, interval, &mut budget)?;
            let waits = matches!(self.change, Change::System(_));
            if due && stepped && !self.over && !waits {
                self.after_step(state, system, &before);
            }
            if advance == Advance::Reached {
                return Ok(advance);
            }
        }
        let seen = self.faulty.as_deref().unwrap_or(system);
        self.inner.advance(state, seen, interval, budget)
    }

    fn next_step(&self, system: &FilmSystem, state: &FilmState) -> f64 {
        self.inner.next_step(self.seen(system), state)
    }

    fn computed(&self) -> Computed<'_> {
        self.inner.computed()
    }

    fn ledger(&self, system: &FilmSystem, state: &FilmState) -> Ledger {
        self.inner.ledger(self.seen(system), state)
    }

    fn stored(&self) -> Option<StoredIntegrator> {
        None
    }

    fn boxed(&self) -> Box<dyn Integrator> {
        Box::new(Self { inner: self.inner.boxed(), faulty: self.faulty.clone(), ..*self })
    }
}
