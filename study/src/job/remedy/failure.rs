//! How a run failed, as far as a remedy depends on it.

use billow_solver::output::outcome::{AuditKind, FailureKind};
use billow_solver::scene::Solver;

use crate::input::value::Value;
use crate::job::Status;
use crate::job::row::{Cells, ColumnId};

/// Peak kinetic energy below which nothing deployed, J. Chosen: a thousandth of the slowest run of the
/// paper.
const MIN_DEPLOYMENT_ENERGY: f64 = 5e-3;

/// How a run ended that did not do what was asked.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Failure {
    /// Its status. A `done` run can still be damped by the numerics.
    pub status: Status,
    /// The audit that ended it; `None` for one that no audit ended, and in results of older versions.
    pub audit: Option<AuditKind>,
    /// Accepted steps; `None` for a run without a history.
    pub steps: Option<u64>,
    /// Whether the kinetic energy stayed so small that nothing deployed.
    pub hardly_moved: bool,
    /// Whether it is marked `numerically_damped`.
    pub numerically_damped: bool,
}

impl Failure {
    /// The failure of a row.
    pub fn of(cells: &Cells) -> Self {
        let audit = cells.text(ColumnId::StopAudit);
        let steps = match cells.get(ColumnId::Steps) {
            Value::Integer(steps) => u64::try_from(*steps).ok(),
            _ => None,
        };
        let energy = cells.number(ColumnId::PeakKineticEnergy);
        Self {
            status: cells.status(),
            audit: AuditKind::ALL.into_iter().find(|kind| kind.name() == audit),
            steps,
            hardly_moved: energy.is_some_and(|energy| energy < MIN_DEPLOYMENT_ENERGY),
            numerically_damped: *cells.get(ColumnId::NumericallyDamped) == Value::Bool(true),
        }
    }

    /// Whether the run is an `energy_drift` of film that hardly moved: the strain energy of the folded mesh is then as
    /// large as all energy that moved.
    pub fn is_without_motion(&self) -> bool {
        self.status == Status::Failed(FailureKind::EnergyDrift) && self.hardly_moved
    }

    /// Whether the run used all steps that it may take. If not, a `step_limit` is a step too small to advance time.
    pub fn used_all_steps(&self, solver: &Solver) -> bool {
        self.status == Status::Failed(FailureKind::StepLimit)
            && self.steps.is_none_or(|steps| steps >= solver.step_limit)
    }
}
