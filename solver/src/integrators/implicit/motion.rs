//! What the implicit integrator keeps from one step to the next, beside the state of the film.

use serde::{Deserialize, Serialize};

use super::method::LastStep;
use super::step_control::StepControl;
use crate::geometry::field::Field;
use crate::integrators::energy_accounting::EnergyAccounting;
use crate::scene::inflow::Inflow;
use crate::system::{FilmState, FilmSystem};

/// Everything of the method that a checkpoint stores.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct StoredImplicit {
    /// Last step, next step, accounting.
    pub motion: ImplicitMotion,
    /// Path length of the search for contacts, m.
    pub path_length: f64,
    /// Positions that the order of elimination is of, m.
    pub ordered_at: Field,
}

/// Last step, next step, accounting.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct ImplicitMotion {
    /// How the length of steps is chosen.
    pub control: StepControl,
    /// Start of the last step; `None` before the first, and where the forces changed abruptly.
    pub last: Option<LastStep>,
    /// Length of the next step if no phase ends before, s.
    pub next_step: f64,
    /// Whether the film was packed in the last interval, and the mass flow rate (kg/s).
    pub phase: (bool, f64),
    /// The step that goes beyond the state, if there is one.
    pub ahead: Option<Box<PendingStep>>,
    /// Energy accounting since time 0, at the state.
    pub accounting: EnergyAccounting,
}

/// A step that goes beyond the time of the state.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct PendingStep {
    /// State and accounting at its start.
    pub from: (FilmState, EnergyAccounting),
    /// State and accounting at its end.
    pub to: (FilmState, EnergyAccounting),
}

impl StoredImplicit {
    /// Whether it can be of this system.
    pub(in crate::integrators) fn fits(&self, system: &FilmSystem) -> bool {
        let fits = |field: &Field| {
            [&field.x, &field.y, &field.z].iter().all(|c| c.len() == system.model.nodes())
        };
        let Self { motion: ImplicitMotion { last, ahead, .. }, ordered_at, .. } = self;
        fits(ordered_at)
            && last.iter().all(|last| fits(&last.positions) && fits(&last.velocities))
            && ahead.iter().all(|step| step.from.0.fits(system) && step.to.0.fits(system))
    }
}

impl ImplicitMotion {
    /// Forgets the last step where the forces change abruptly: packing or inflow. Returns whether they do.
    pub(super) fn begin_phase(&mut self, packed: bool, inflow: Inflow) -> bool {
        let now = (packed, inflow.mass_flow_rate);
        let same = self.phase.0 == packed && self.phase.1.to_bits() == now.1.to_bits();
        self.phase = now;
        if !same {
            self.last = None;
        }
        !same
    }
}
