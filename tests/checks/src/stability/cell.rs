//! One cell of a map: a run, how it ended, and which audit ended it.
//!
//! ```text
//! ledger residual of a cell = max(largest at its samples, that of its last state)
//! statics:                    residual force over the load; steps are those of Newton's method
//! ```

use std::panic::{AssertUnwindSafe, catch_unwind};

use billow_solver::models;
use billow_solver::models::run;
use billow_solver::output::ledger::residuals;
use billow_solver::output::outcome::{Deployment, Stop};
use billow_solver::statics::{StaticFailureKind, Tolerances, settle};
use billow_solver::system::FilmSystem;
use billow_study::job::Status;

use super::Method;
use super::scenes::{Prepared, StabilityScene, Values};
use crate::cases::prelude::*;

/// What a cell found.
#[derive(Debug, Clone)]
pub(super) struct Cell {
    pub(super) status: Status,
    /// The audit that ended the run; empty for a run that reached its end.
    pub(super) audit: &'static str,
    /// Where it failed, in words; empty for a run that reached its end.
    pub(super) place: String,
    /// Time at which the run failed or ended, s.
    pub(super) time: f64,
    /// Accepted steps; of statics Newton steps.
    pub(super) steps: u64,
    /// Largest ledger residual, of statics the residual force over the load; `None` where it is not a number.
    pub(super) residual: Option<f64>,
    /// The step of the stable bound (CFL number 1) times ω/2 of a linear scene: what a step of 1 is as a fraction of
    /// 2/ω; `None` for a scene that is not linear.
    pub(super) theory: Option<f64>,
}

impl Cell {
    /// A cell of this status, ended by this audit.
    fn ended(status: Status, audit: &'static str) -> Self {
        let (place, time, steps) = (String::new(), 0.0, 0);
        Self { status, audit, place, time, steps, residual: None, theory: None }
    }
}

/// Runs a cell: a scene with a method and the values of all its parameters.
pub(super) fn run(rig: &Rig, scene: &StabilityScene, method: Method, values: &Values) -> Cell {
    match catch_unwind(AssertUnwindSafe(|| answer(rig, scene, method, values))) {
        Ok(Ok(cell)) => cell,
        Ok(Err(problem)) => {
            Cell { place: problem.to_string(), ..Cell::ended(Status::Invalid, "scene_check") }
        }
        Err(_) => Cell::ended(Status::Panicked, "panic"),
    }
}

fn answer(rig: &Rig, scene: &StabilityScene, method: Method, values: &Values) -> Result<Cell> {
    match (scene.prepare)(rig, method, values)? {
        Prepared::Film(mut film, timeline, omega) => {
            let start = film.view().ledger();
            let step = film.view().next_step() / film.film.settings().cfl;
            let deployment = run::run(&mut *film, &timeline, &mut Unobserved);
            let last = residuals(&[start, film.view().ledger()]).pop();
            let theory = omega.map(|omega| 0.5 * step * omega);
            Ok(Cell { theory, ..judged(&deployment, last, timeline.end_time) })
        }
        Prepared::Model(scene) => {
            let deployment = models::solve(rig.instruction_set, &scene, &mut Unobserved)?;
            Ok(judged(&deployment, None, scene.solver.end_time))
        }
        Prepared::Statics(film, positions) => {
            let film = FilmSystem { instruction_set: rig.instruction_set, ..*film };
            let settled = settle(&film, &positions, None, &Tolerances::default(), &mut || true);
            let (cell, steps, residual) = match settled {
                Ok(found) => (Cell::ended(Status::Done, ""), found.iterations, found.residual),
                Err(failure) => {
                    let audit = match failure.kind {
                        StaticFailureKind::IterationLimit => "iteration_limit",
                        StaticFailureKind::NotFinite => "not_finite",
                        StaticFailureKind::Stalled | StaticFailureKind::Stopped => "stalled",
                    };
                    let cell = Cell::ended(Status::NoEquilibrium, audit);
                    let place = failure.to_string();
                    (Cell { place, ..cell }, failure.iterations, failure.residual)
                }
            };
            let residual = Some(residual).filter(|residual| residual.is_finite());
            Ok(Cell { steps: steps.into(), residual, ..cell })
        }
    }
}

/// The cell of a run until `end_time` (s); `last`: ledger residual of its last state.
fn judged(deployment: &Deployment, last: Option<f64>, end_time: f64) -> Cell {
    let samples = deployment.history.column("ledger_residual").iter().copied();
    let largest = samples.chain(last).fold(0.0, worse);
    let cell = match &deployment.stop {
        Stop::Failed(failure) => Cell {
            place: failure.place.clone(),
            time: failure.time,
            ..Cell::ended(Status::Failed(failure.kind), failure.audit.name())
        },
        Stop::Done | Stop::Cancelled => Cell { time: end_time, ..Cell::ended(Status::Done, "") },
    };
    let residual = Some(largest).filter(|value| value.is_finite());
    Cell { residual, steps: deployment.steps, ..cell }
}
