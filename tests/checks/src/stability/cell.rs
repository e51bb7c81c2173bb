//! One cell of a map: a run, how it ended, and which audit ended it.
//!
//! ```text
//! ledger residual of a cell = max(largest at its samples, that of its last state)
//! statics:                    residual force over the load; steps are those of Newton's method
//! ```

use core::ops::ControlFlow;
use std::fmt::Write as _;
use std::panic::{AssertUnwindSafe, catch_unwind};

use billow_solver::models;
use billow_solver::models::run::{self, Observer, Progress};
use billow_solver::output::ledger::residuals;
use billow_solver::output::outcome::{Deployment, Stop as End};
use billow_solver::statics::{StaticFailureKind, Tolerances, settle};
use billow_solver::system::FilmSystem;
use serde::{Deserialize, Serialize};

use super::Method;
use super::scenes::{Prepared, StabilityScene, Values};
use crate::cases::{Result, Rig};
use billow_study::job::Status;
use billow_study::platform::stop::Stop;

/// What is asked of a cell.
pub(super) struct Question {
    pub(super) scene: &'static StabilityScene,
    pub(super) method: Method,
    /// Values of all parameters of the scene.
    pub(super) values: Values,
}

impl Question {
    /// The text that names the run: equal runs of several maps are one cell.
    pub(super) fn key(&self) -> String {
        let mut key = format!("{} {}", self.scene.name, self.method.name());
        for (name, value) in &self.values.0 {
            let _ = write!(key, " {name}={value}");
        }
        key
    }
}

/// What a cell found.
#[derive(Debug, Clone, Default, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub(super) struct Cell {
    /// Name of the status.
    pub(super) status: String,
    /// The audit that ended the run; empty for a run that reached its end.
    pub(super) audit: String,
    /// Where it failed, in words; empty for a run that reached its end.
    pub(super) place: String,
    /// Time at which the run failed or ended, s.
    pub(super) time: f64,
    /// Accepted steps; of statics Newton steps.
    pub(super) steps: u64,
    /// Largest ledger residual, of statics the residual force over the load; null where it is not a number.
    pub(super) residual: Option<f64>,
    /// The step of the stable bound (CFL number 1) times ω/2 of a linear scene: what a step of 1 is as a fraction of
    /// 2/ω; null for a scene that is not linear.
    pub(super) theory: Option<f64>,
}

impl Cell {
    /// A cell of this status, ended by this audit.
    fn ended(status: Status, audit: &str) -> Self {
        let [status, audit] = [status.name(), audit].map(str::to_owned);
        Self { status, audit, ..Self::default() }
    }

    /// Whether the run reached its end.
    pub(super) fn is_done(&self) -> bool {
        self.status == Status::Done.name()
    }

    /// Whether it is a failure of the run or a refusal.
    pub(super) fn fails(&self) -> bool {
        Status::from_name(&self.status).is_none_or(Status::is_failure)
    }
}

/// Ends a run when a signal arrives.
struct Listener<'a>(&'a Stop);

impl Observer for Listener<'_> {
    fn sample(&mut self, _: Progress) -> bool {
        self.0.requested().is_none()
    }
}

/// Runs a cell. `None` when a signal ended it.
pub(super) fn run(rig: &Rig, question: &Question, stop: &Stop) -> Option<Cell> {
    match catch_unwind(AssertUnwindSafe(|| answer(rig, question, stop))) {
        Ok(Ok(cell)) => cell,
        Ok(Err(problem)) => {
            Some(Cell { place: problem.to_string(), ..Cell::ended(Status::Invalid, "scene_check") })
        }
        Err(_) => Some(Cell::ended(Status::Panicked, "panic")),
    }
}

fn answer(rig: &Rig, question: &Question, stop: &Stop) -> Result<Option<Cell>> {
    let mut listener = Listener(stop);
    match question.scene.prepare(rig, question.method, &question.values)? {
        Prepared::Film(mut film, timeline, omega) => {
            let start = film.view().ledger();
            let step = film.view().next_step() / film.film.settings().cfl;
            let deployment = run::run(&mut *film, &timeline, &mut listener);
            let last = residuals(&[start, film.view().ledger()]).pop();
            let theory = omega.map(|omega| 0.5 * step * omega);
            let cell = judged(&deployment, last, timeline.end_time);
            Ok(cell.map(|cell| Cell { theory, ..cell }))
        }
        Prepared::Model(scene) => {
            let deployment = models::solve(rig.instruction_set, &scene, &mut listener)?;
            Ok(judged(&deployment, None, scene.solver.end_time))
        }
        Prepared::Statics(film, positions) => {
            let film = FilmSystem { instruction_set: rig.instruction_set, ..*film };
            let observer = &mut |_: &_| match stop.requested() {
                None => ControlFlow::Continue(()),
                Some(_) => ControlFlow::Break(()),
            };
            let finite = |residual: f64| Some(residual).filter(|value| value.is_finite());
            let settled = settle(&film, &positions, None, &Tolerances::default(), observer);
            let failure = match settled {
                Ok(found) => {
                    let (steps, residual) = (found.iterations.into(), finite(found.residual));
                    return Ok(Some(Cell { steps, residual, ..Cell::ended(Status::Done, "") }));
                }
                Err(failure) => failure,
            };
            let audit = match failure.kind {
                StaticFailureKind::Stopped => return Ok(None),
                StaticFailureKind::IterationLimit => "iteration_limit",
                StaticFailureKind::Stalled => "stalled",
                StaticFailureKind::NotFinite => "not_finite",
            };
            Ok(Some(Cell {
                place: failure.to_string(),
                steps: failure.iterations.into(),
                residual: finite(failure.residual),
                ..Cell::ended(Status::NoEquilibrium, audit)
            }))
        }
    }
}

/// The cell of a run until `end_time` (s); `last`: ledger residual of its last state.
fn judged(deployment: &Deployment, last: Option<f64>, end_time: f64) -> Option<Cell> {
    let samples = deployment.history.column("ledger_residual").iter().copied();
    let largest =
        samples.chain(last).fold(0.0, |a: f64, b| if b > a || b.is_nan() { b } else { a });
    let cell = match &deployment.stop {
        End::Cancelled => return None,
        End::Done => Cell { time: end_time, ..Cell::ended(Status::Done, "") },
        End::Failed(failure) => Cell {
            place: failure.place.clone(),
            time: failure.time,
            ..Cell::ended(Status::Failed(failure.kind), failure.audit.name())
        },
    };
    let residual = Some(largest).filter(|value| value.is_finite());
    Some(Cell { residual, steps: deployment.steps, ..cell })
}
