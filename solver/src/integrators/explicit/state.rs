//! All that changes while film moves.

use serde::{Deserialize, Serialize};

use super::Quiescence;
use crate::collision::contact::ContactState;
use crate::geometry::field::Field;
use crate::mechanics::forces::membrane::ViscousHistory;
use crate::mechanics::gas::GasState;
use crate::output::ledger::GasBalance;

/// All that changes while film moves. With the constants of the run it says all that follows.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct State {
    /// Time, s.
    pub time: f64,
    /// Node places, m.
    pub places: Field,
    /// Node velocities half a step ago, m/s; those of the start before the first step.
    pub velocities: Field,
    /// What the film's elements remember of the last step, as its passes want it.
    pub past: Vec<[ViscousHistory; 2]>,
    /// Velocities of the rigid planes along their normals, as those of the nodes, m/s.
    pub planes: Vec<f64>,
    /// Length of the last step, s; 0 before the first.
    pub last_step: f64,
    /// V, m³.
    pub volume: f64,
    /// p inside (gas) or overpressure, Pa.
    pub pressure: f64,
    /// Gas inside.
    pub gas: GasState,
    /// Accepted steps.
    pub steps: u64,
    /// Largest principal second Piola-Kirchhoff stress so far, Pa.
    pub film_stress: f64,
    /// Works so far.
    pub works: Works,
    /// Gas balances so far.
    pub books: GasBalance,
    /// Σ m x at the start, kg m.
    pub start_moment: [f64; 3],
    /// Contact of film with film.
    pub meeting: ContactState,
    /// Whether film is calm.
    pub calm: Quiescence,
    /// The way to the target being headed for, where a run was paused on it.
    pub stretch: Option<StepInterval>,
}

/// Works so far, J.
#[derive(Debug, Clone, Copy, PartialEq, Default, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Works {
    /// Of the gas, or the overpressure, on the film.
    pub gas: f64,
    /// Of the ambient pressure on the film.
    pub ambient: f64,
    /// Of what holds or pushes the film and moves.
    pub support: f64,
    /// Of contact on the film.
    pub contact: f64,
    /// Taken by viscosity.
    pub viscous: f64,
    /// Taken by mass damping.
    pub damping: f64,
}

/// The way to the next target, in equal steps; what stirs calm film begins another.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct StepInterval {
    /// Its beginning, s.
    pub start: f64,
    /// Its end, s.
    pub target: f64,
    /// Length of a step, s.
    pub length: f64,
    /// Number of steps.
    pub count: f64,
    /// Steps taken.
    pub index: f64,
    /// Whether they are those of calm film.
    pub calm: bool,
}

impl StepInterval {
    /// Equal steps from `start` to `target` (s), none longer than `longest`; `None` where a step
    /// would not advance time.
    pub(super) fn new(start: f64, target: f64, longest: f64, calm: bool) -> Option<Self> {
        if target <= start {
            return Some(Self { start, target, length: 0.0, count: 0.0, index: 0.0, calm });
        }
        let count = ((target - start) / longest * (1.0 - 1e-12)).ceil().max(1.0);
        let length = (target - start) / count;
        // Written so that what is no number is refused too.
        let advances = start + length > start;
        advances.then_some(Self { start, target, length, count, index: 0.0, calm })
    }

    /// When the next step ends, s; `None` after the last.
    pub(super) fn next_end(&self) -> Option<f64> {
        let after = self.index + 1.0;
        if after > self.count {
            None
        } else if after < self.count {
            Some(self.start + after * self.length)
        } else {
            Some(self.target)
        }
    }
}

impl State {
    /// The start at time 0.
    pub(super) fn start(
        places: Field,
        velocities: Field,
        past: Vec<[ViscousHistory; 2]>,
        planes: Vec<f64>,
        gas: GasState,
    ) -> Self {
        Self {
            time: 0.0,
            places,
            velocities,
            past,
            planes,
            last_step: 0.0,
            volume: 0.0,
            pressure: 0.0,
            gas,
            steps: 0,
            film_stress: 0.0,
            works: Works::default(),
            books: GasBalance::default(),
            start_moment: [0.0; 3],
            meeting: ContactState::default(),
            calm: Quiescence::default(),
            stretch: None,
        }
    }
}
