//! What central differences keep from one step to the next, beside the state of the film.

use serde::{Deserialize, Serialize};

use super::Quiescence;
use crate::geometry::field::Field;
use crate::integrators::energy_accounting::EnergyAccounting;
use crate::mechanics::forces::membrane::ElementHistory;
use crate::system::{FilmState, FilmSystem};

/// Everything of central differences that a checkpoint stores.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct StoredExplicit {
    /// Velocities, steps, accounting.
    pub motion: Motion,
    /// Strains, stresses and numerical stresses of every element at the end of the last step, in the layout
    /// of the element loop.
    pub histories: Vec<[ElementHistory; 2]>,
    /// Path length of the search for contacts, m.
    pub path_length: f64,
}

impl StoredExplicit {
    /// Whether it can be of this system.
    pub(in crate::integrators) fn fits(&self, system: &FilmSystem) -> bool {
        let Field { x, y, z } = &self.motion.velocities;
        [x, y, z].iter().all(|column| column.len() == system.model.nodes())
            && self.motion.planes.len() == system.supports.bodies.len()
            && self.histories.len() == system.model.constants.len()
    }
}

/// Velocities between two times, and the plan of steps.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Motion {
    /// Velocities of the nodes half a step ago, m/s; before the first step those of the start.
    pub velocities: Field,
    /// Velocities of the rigid planes along their normals half a step ago, m/s.
    pub planes: Vec<f64>,
    /// Length of the last step, s; 0 before the first.
    pub last_step: f64,
    /// When the further energies kick.
    pub terms: TermClock,
    /// Whether the film is quiescent, and since when.
    pub quiescence: Quiescence,
    /// The current step interval, if the run was paused within one.
    pub step_interval: Option<StepInterval>,
    /// Energy accounting since time 0.
    pub accounting: EnergyAccounting,
}

/// The kicks of the further energies. They are slow, so one kick serves several steps: it covers half of the steps
/// before it and half of those after it.
#[derive(Debug, Clone, Copy, PartialEq, Default, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct TermClock {
    /// Time that has passed and no kick has covered, s; negative while a kick covers time to come.
    pub owed: f64,
    /// Steps until the next kick.
    pub steps: u64,
}

/// Upper bound of the time between two kicks of the terms, times a bound of their frequency. Chosen: a 30th of a
/// period.
const MAX_TERM_PHASE: f64 = 0.2;
/// Upper bound of that time times the largest frequency of the film. Kicks in time with a mode of the film would drive
/// it: they come faster than any, with a tenth to spare.
const MAX_FILM_PHASE: f64 = 0.9 * 2.0 * core::f64::consts::PI;

impl TermClock {
    /// The time (s) that a kick at the start of a step of this length (s) covers, 0 between two kicks, and the clock
    /// after the step. `remaining`: the steps of this length that are planned, with this one.
    pub(super) fn step(&mut self, system: &FilmSystem, length: f64, remaining: u64) -> f64 {
        if system.energy_terms.is_empty() {
            return 0.0;
        }
        let mut kick = 0.0;
        if self.steps == 0 {
            self.steps = term_steps(system, length).min(remaining);
            let half = 0.5 * self.steps as f64 * length;
            kick = self.owed + half;
            self.owed = -half;
        }
        self.owed += length;
        self.steps -= 1;
        kick
    }
}

/// Steps of a length (s) from one kick of the terms to the next. One where a term is fast, a support needs its forces at
/// each step, or motion is damped.
fn term_steps(system: &FilmSystem, length: f64) -> u64 {
    let supports = &system.supports;
    let slow = system.energy_terms.iter().all(|term| term.is_slow());
    if !slow
        || !supports.movers.is_empty()
        || !supports.bodies.is_empty()
        || system.mass_damping > 0.0
    {
        return 1;
    }
    let terms = system.energy_terms.iter();
    let squared: f64 = terms.map(|term| term.frequency_squared(&system.model.mass)).sum();
    let phase =
        (squared.sqrt() / MAX_TERM_PHASE).max(system.model.largest_frequency() / MAX_FILM_PHASE);
    #[expect(
        clippy::cast_possible_truncation,
        clippy::cast_sign_loss,
        reason = "at least 1; saturates"
    )]
    let steps = (1.0 / (phase * length)).max(1.0) as u64;
    steps
}

impl Motion {
    /// The motion at a state.
    pub(super) fn start(state: &FilmState, accounting: EnergyAccounting) -> Self {
        Self {
            velocities: state.velocities.clone(),
            planes: state.planes.clone(),
            last_step: 0.0,
            terms: TermClock::default(),
            quiescence: Quiescence::default(),
            step_interval: None,
            accounting,
        }
    }
}

/// Equal steps from now to the next target. The integrator plans a new interval earlier if a
/// quiescent film becomes active.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct StepInterval {
    /// Time of its start, s.
    pub start: f64,
    /// Time of its end, s.
    pub target: f64,
    /// Length of a step, s.
    pub length: f64,
    /// Number of steps in the interval.
    pub count: u64,
    /// Number of steps taken.
    pub index: u64,
    /// Whether the steps are the longer ones of a quiescent film.
    pub quiescent: bool,
}

impl StepInterval {
    /// Equal steps from `start` to `target` (s), each at most `max_step` (s). `None` if a step would
    /// not advance time.
    pub(in crate::integrators) fn new(
        start: f64,
        target: f64,
        max_step: f64,
        quiescent: bool,
    ) -> Option<Self> {
        if target <= start {
            return Some(Self { start, target, length: 0.0, count: 0, index: 0, quiescent });
        }
        let count = ((target - start) / max_step * (1.0 - 1e-12)).ceil().max(1.0);
        let length = (target - start) / count;
        // Written so that NaN is refused too.
        let advances = start + length > start;
        // A count beyond u64 saturates: no run takes that number of steps.
        #[expect(clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "at least 1")]
        let count = count as u64;
        advances.then_some(Self { start, target, length, count, index: 0, quiescent })
    }

    /// Time at which the next step ends, s; `None` after the last step.
    pub(in crate::integrators) fn next_end(&self) -> Option<f64> {
        if self.index >= self.count {
            return None;
        }
        let next = self.index + 1;
        let last = next == self.count;
        Some(if last { self.target } else { self.start + next as f64 * self.length })
    }
}
