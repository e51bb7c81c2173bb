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
use billow_solver::models::film::FilmRun;
use billow_solver::models::run::{self, Model, Observer, Progress, Run};
use billow_solver::output::frames::Frame;
use billow_solver::output::ledger::residuals;
use billow_solver::output::outcome::{Deployment, Stop as End};
use billow_solver::scene::timeline::Timeline;
use billow_solver::statics::{StaticFailureKind, Tolerances, settle};
use billow_solver::system::{FilmSystem, PressureLoad};
use serde::{Deserialize, Serialize};

use super::Method;
use super::scenes::{Prepared, StabilityScene, Values, Vessel};
use crate::cases::Rig;
use billow_study::job::Status;
use billow_study::platform::stop::Stop;

/// What is asked of a cell.
#[derive(Clone)]
pub struct Question {
    /// Scene.
    pub scene: &'static StabilityScene,
    /// Method.
    pub method: Method,
    /// Values of all parameters of the scene.
    pub values: Values,
}

impl Question {
    /// The text that names the run: equal runs of several maps are one cell.
    pub fn key(&self) -> String {
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
pub struct Cell {
    /// [`Question::key`].
    pub key: String,
    /// Name of the status.
    pub status: String,
    /// The audit that ended the run; empty for a run that reached its end.
    pub audit: String,
    /// Where it failed, in words; empty for a run that reached its end.
    pub place: String,
    /// Time at which the run failed or ended, s.
    pub time: f64,
    /// Time that the run was to reach, s.
    pub end_time: f64,
    /// Accepted steps; of statics Newton steps.
    pub steps: u64,
    /// Largest ledger residual, of statics the residual force over the load; null where it is not a number.
    pub residual: Option<f64>,
    /// The step of the stable bound (CFL number 1) times ω/2 of a linear scene: what a step of 1 is as a fraction of
    /// 2/ω; null for a scene that is not linear.
    pub theory: Option<f64>,
}

impl Cell {
    /// Whether the run reached its end.
    pub fn is_done(&self) -> bool {
        self.status == Status::Done.name()
    }

    /// Whether it is a failure of the run or a refusal.
    pub fn fails(&self) -> bool {
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
pub fn run(rig: &Rig, question: &Question, stop: &Stop) -> Option<Cell> {
    let status = Status::Invalid.name().to_owned();
    let blank = Cell { key: question.key(), status, ..Cell::default() };
    let body = || answer(rig, question, stop, &blank);
    match catch_unwind(AssertUnwindSafe(body)) {
        Ok(Ok(cell)) => cell,
        Ok(Err(problem)) => Some(Cell { audit: "scene_check".to_owned(), place: problem, ..blank }),
        Err(_) => Some(Cell {
            status: Status::Panicked.name().to_owned(),
            audit: "panic".to_owned(),
            ..blank
        }),
    }
}

fn answer(
    rig: &Rig,
    question: &Question,
    stop: &Stop,
    blank: &Cell,
) -> Result<Option<Cell>, String> {
    let mut listener = Listener(stop);
    match (question.scene.build)(rig, question.method, &question.values)? {
        Prepared::Film(mut film, timeline, omega) => {
            let start = film.view().ledger();
            let step = film.view().next_step() / film.film.settings().cfl;
            let deployment = run::run(&mut *film, &timeline, &mut listener);
            let last = residuals(&[start, film.view().ledger()]).pop();
            let theory = omega.map(|omega| 0.5 * step * omega);
            let blank = Cell { theory, end_time: timeline.end_time, ..blank.clone() };
            Ok(judged(&deployment, last, blank))
        }
        Prepared::Model(scene) => {
            let deployment = models::solve(rig.instruction_set, &scene, &mut listener)
                .map_err(|error| error.to_string())?;
            let blank = Cell { end_time: scene.solver.end_time, ..blank.clone() };
            Ok(judged(&deployment, None, blank))
        }
        Prepared::Statics(vessel) => Ok(settled(rig, &vessel, stop, blank.clone())),
    }
}

/// The cell of a search for a static equilibrium.
fn settled(rig: &Rig, vessel: &Vessel, stop: &Stop, blank: Cell) -> Option<Cell> {
    let load = PressureLoad::Overpressure(vessel.overpressure);
    let film = FilmSystem {
        supports: vessel.supports.clone(),
        instruction_set: rig.instruction_set,
        ..FilmSystem::free(vessel.model.clone(), load)
    };
    let observer = &mut |_: &_| match stop.requested() {
        None => ControlFlow::Continue(()),
        Some(_) => ControlFlow::Break(()),
    };
    let finite = |residual: f64| Some(residual).filter(|value| value.is_finite());
    match settle(&film, &vessel.positions, None, &Tolerances::default(), observer) {
        Ok(found) => Some(Cell {
            status: Status::Done.name().to_owned(),
            steps: found.iterations.into(),
            residual: finite(found.residual),
            ..blank
        }),
        Err(failure) => {
            let audit = match failure.kind {
                StaticFailureKind::Stopped => return None,
                StaticFailureKind::IterationLimit => "iteration_limit",
                StaticFailureKind::Stalled => "stalled",
                StaticFailureKind::NotFinite => "not_finite",
            };
            Some(Cell {
                status: Status::NoEquilibrium.name().to_owned(),
                audit: audit.to_owned(),
                place: failure.to_string(),
                steps: failure.iterations.into(),
                residual: finite(failure.residual),
                ..blank
            })
        }
    }
}

/// The cell of a run; `last`: ledger residual of its last state.
fn judged(deployment: &Deployment, last: Option<f64>, blank: Cell) -> Option<Cell> {
    let samples = deployment.history.column("ledger_residual").iter().copied();
    let largest =
        samples.chain(last).fold(0.0, |a: f64, b| if b > a || b.is_nan() { b } else { a });
    let residual = Some(largest).filter(|value| value.is_finite());
    let cell = Cell { residual, steps: deployment.steps, ..blank };
    match &deployment.stop {
        End::Cancelled => None,
        End::Done => {
            Some(Cell { status: Status::Done.name().to_owned(), time: cell.end_time, ..cell })
        }
        End::Failed(failure) => Some(Cell {
            status: Status::Failed(failure.kind).name().to_owned(),
            audit: failure.audit.name().to_owned(),
            place: failure.place.clone(),
            time: failure.time,
            ..cell
        }),
    }
}

/// A shape of a run, and what the ledger says there.
pub struct Shape {
    /// The shape.
    pub frame: Frame,
    /// Ledger residual.
    pub residual: f64,
}

/// Shapes of the run of a cell, evenly spaced in steps up to the last state, and the film they belong to. `None`
/// for a scene without motion of film, or one that cannot be built.
pub fn shapes(
    rig: &Rig,
    question: &Question,
    cell: &Cell,
    count: u64,
) -> Option<(FilmRun, Vec<Shape>)> {
    let built = (question.scene.build)(rig, question.method, &question.values).ok()?;
    let Prepared::Film(mut film, timeline, _) = built else { return None };
    let shapes = pauses(&mut film, &timeline, cell.steps, count);
    Some((*film, shapes))
}

/// Shapes at pauses of a run: a pause changes no bit of it.
fn pauses(film: &mut FilmRun, timeline: &Timeline, steps: u64, count: u64) -> Vec<Shape> {
    let start = film.view().ledger();
    let shape = |film: &FilmRun| {
        let residual = residuals(&[start, film.view().ledger()]).pop().unwrap_or(0.0);
        film.frame().map(|frame| Shape { frame, residual })
    };
    let mut shapes: Vec<Shape> = shape(film).into_iter().collect();
    let (mut progress, stop) = (Run::default(), Stop::new());
    for part in 1..count {
        let due = (steps * part / (count - 1)).saturating_sub(film.steps());
        // The last part goes on to the failure.
        let due = if part + 1 == count { due + 1 } else { due.max(1) };
        let ended = progress.advance(film, timeline, due, &mut Listener(&stop));
        shapes.extend(shape(film));
        if ended.is_some() {
            break;
        }
    }
    shapes.retain(|shape| shape.frame.positions.iter().flatten().all(|x| x.is_finite()));
    shapes
}
