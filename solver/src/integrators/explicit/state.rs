//! Everything that changes while film moves.

use serde::{Deserialize, Serialize};

use super::Quiescence;
use crate::collision::contact::ContactState;
use crate::geometry::field::Field;
use crate::mechanics::forces::membrane::ElementHistory;
use crate::mechanics::gas::GasState;
use crate::output::ledger::GasBalance;

/// Everything that changes while film moves. State, film model and parameters together determine
/// the rest of the run.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct State {
    /// Time, s.
    pub time: f64,
    /// Positions of the nodes, m.
    pub positions: Field,
    /// Velocities of the nodes half a step ago, m/s; before the first step those of the start.
    pub velocities: Field,
    /// Strains and stresses of every element at the end of the last step, in the layout of the element
    /// loop.
    pub element_history: Vec<[ElementHistory; 2]>,
    /// Velocities of the rigid planes along their normals half a step ago, m/s.
    pub planes: Vec<f64>,
    /// Length of the last step, s; 0 before the first.
    pub last_step: f64,
    /// Enclosed volume V, m³.
    pub volume: f64,
    /// Gas: pressure p. Fixed overpressure: that overpressure. Pa.
    pub pressure: f64,
    /// Mass and internal energy of the gas.
    pub gas: GasState,
    /// Accepted steps.
    pub steps: u64,
    /// Largest principal second Piola-Kirchhoff stress so far, Pa.
    pub film_stress: f64,
    /// Works since time 0.
    pub works: Works,
    /// Mass, enthalpy and heat exchanged by the gas since time 0.
    pub gas_balance: GasBalance,
    /// Σ m x at time 0, kg m.
    pub start_moment: [f64; 3],
    /// Kinetic and stored energy at time 0, J.
    pub start_energy: f64,
    /// Contact of film with film and with plates.
    pub contact_state: ContactState,
    /// Whether the film is quiescent, and since when.
    pub quiescence: Quiescence,
    /// The current step interval, if the run was paused within one.
    pub step_interval: Option<StepInterval>,
}

/// Works since time 0, J. Positive: energy given to the film; for the last three: energy dissipated.
#[derive(Debug, Clone, Copy, PartialEq, Default, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Works {
    /// Work of the gas, or of the fixed overpressure, on the film.
    pub gas: f64,
    /// Work of the ambient pressure on the film.
    pub ambient: f64,
    /// Work of moving supports, rigid planes and plates on the film.
    pub support: f64,
    /// Work of contact forces on the film. Minus this is the stored contact energy.
    pub contact: f64,
    /// Energy lost in the material.
    pub material_loss: f64,
    /// Energy taken by numerical damping and by the time step; negative where they gave energy.
    pub numerical_dissipation: f64,
    /// Energy dissipated by mass damping.
    pub damping: f64,
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
    pub(super) fn new(start: f64, target: f64, max_step: f64, quiescent: bool) -> Option<Self> {
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
    pub(super) fn next_end(&self) -> Option<f64> {
        if self.index >= self.count {
            return None;
        }
        let next = self.index + 1;
        let last = next == self.count;
        Some(if last { self.target } else { self.start + next as f64 * self.length })
    }
}

impl State {
    /// The state at time 0.
    pub(super) fn start(
        positions: Field,
        velocities: Field,
        element_history: Vec<[ElementHistory; 2]>,
        planes: Vec<f64>,
        gas: GasState,
    ) -> Self {
        Self {
            time: 0.0,
            positions,
            velocities,
            element_history,
            planes,
            last_step: 0.0,
            volume: 0.0,
            pressure: 0.0,
            gas,
            steps: 0,
            film_stress: 0.0,
            works: Works::default(),
            gas_balance: GasBalance::default(),
            start_moment: [0.0; 3],
            start_energy: 0.0,
            contact_state: ContactState::default(),
            quiescence: Quiescence::default(),
            step_interval: None,
        }
    }
}
