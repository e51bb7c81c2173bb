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
    /// Whether the film is quiescent, and since when.
    pub quiescence: Quiescence,
    /// The current step interval, if the run was paused within one.
    pub step_interval: Option<StepInterval>,
    /// Energy accounting since time 0.
    pub accounting: EnergyAccounting,
}

impl Motion {
    /// The motion at a state.
    pub(super) fn start(state: &FilmState, accounting: EnergyAccounting) -> Self {
        Self {
            velocities: state.velocities.clone(),
            planes: state.planes.clone(),
            last_step: 0.0,
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
