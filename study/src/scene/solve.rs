//! Solves one scene: motion, with checkpoints, or static equilibrium.

use std::path::PathBuf;
use std::time::Instant;

use billow_solver::integrators::StoredFilm;
use billow_solver::mechanics::material::MAX_STRESS_RATIO;
use billow_solver::mechanics::resultants::largest_stress;
use billow_solver::models::film::FilmRun;
use billow_solver::models::run::{Answer, Model, Observer, Pause, Progress, Run};
use billow_solver::output::checkpoint::{Checkpoint, CheckpointError};
use billow_solver::output::outcome::{Deployment, FailureKind, Stop as End};
use billow_solver::scene::timeline::Timeline;
use billow_solver::statics::{self, StaticError, StaticFailureKind, StaticSolution};

use crate::job::Status;
use crate::job::pace::Pace;
use crate::platform::error::{Error, InputError, Result};
use crate::platform::files::{Files, disk_error, write_output};
use crate::platform::stop::Stop;
use crate::scene::file::SceneFile;

/// When a run is stored, where, and which checkpoint it resumes from.
#[derive(Debug, Clone, Default)]
pub struct Pauses {
    /// File of the checkpoint.
    pub checkpoint: Option<PathBuf>,
    /// Number of steps between two checkpoints.
    pub every: Option<u64>,
    /// Number of steps after which this call ends.
    pub stop_after: Option<u64>,
    /// Checkpoint to resume from.
    pub resume: Option<PathBuf>,
}

/// A solved scene.
#[derive(Debug)]
pub struct Solved {
    /// How it ended.
    pub status: Status,
    /// The state at the end.
    pub end: Ended,
    /// Wall time of this call, s. No result depends on it.
    pub wall_seconds: f64,
}

/// The state at the end.
#[derive(Debug)]
pub enum Ended {
    /// A run: the film and its outputs.
    Motion(Box<(FilmRun, Deployment)>),
    /// Static equilibrium.
    Equilibrium(Box<StaticSolution>),
    /// Static equilibrium was not found.
    NoEquilibrium(statics::StaticFailure),
}

/// The next step for a checkpoint that cannot be used.
const START_AGAIN: &str = "\n  next: start again without --resume";

/// Solves a scene on this number of threads; the result does not depend on it. A signal ends the run,
/// after a checkpoint where one is asked for.
///
/// # Errors
/// When a checkpoint cannot be read or written, or belongs to another scene; when a signal arrives.
pub fn solve(
    scene: &SceneFile,
    pauses: &Pauses,
    files: &dyn Files,
    stop: &Stop,
    report: &mut dyn FnMut(Progress),
) -> Result<Solved> {
    let start = Instant::now();
    let (status, end) = if scene.film.solver.statics {
        equilibrium(scene, stop)?
    } else {
        motion(scene, pauses, files, stop, report)?
    };
    Ok(Solved { status, end, wall_seconds: start.elapsed().as_secs_f64() })
}

fn equilibrium(scene: &SceneFile, stop: &Stop) -> Result<(Status, Ended)> {
    match statics::solve(&scene.film, None, &mut || stop.requested().is_none()) {
        Ok(solution) => {
            // Closed film turned inside out has an equilibrium too, but not the wanted one.
            let inside_out = scene.film.shell.is_closed() && solution.volume <= 0.0;
            let stress = largest_stress(&solution.model, &solution.positions);
            let status = if inside_out {
                Status::Failed(FailureKind::InvertedVolume)
            } else if stress > MAX_STRESS_RATIO * solution.model.material.youngs_modulus {
                Status::Failed(FailureKind::Overstretched)
            } else {
                Status::Done
            };
            Ok((status, Ended::Equilibrium(Box::new(solution))))
        }
        Err(StaticError::NoState(failure)) => match (failure.kind, stop.requested()) {
            (StaticFailureKind::Stopped, Some(signal)) => {
                Err(Error::Interrupted { signal, next: "nothing is stored".to_owned() })
            }
            _ => Ok((Status::NoEquilibrium, Ended::NoEquilibrium(failure))),
        },
        Err(error) => Err(refused("", "solver.static", &error.to_string(), "").into()),
    }
}

fn refused(value: &str, key: &str, problem: &str, hint: &str) -> InputError {
    InputError {
        file: "solve".to_owned(),
        key: key.to_owned(),
        value: value.to_owned(),
        problem: problem.to_owned(),
        allowed: String::new(),
        hint: hint.to_owned(),
    }
}

/// Observes a run: reports its samples, stores its state, ends it.
struct Pausing<'a> {
    scene: &'a SceneFile,
    pauses: &'a Pauses,
    files: &'a dyn Files,
    stop: &'a Stop,
    report: &'a mut dyn FnMut(Progress),
    pace: Pace,
    /// Steps since time 0 at the start of this call, at the last checkpoint, at the last pause.
    first: u64,
    stored: u64,
    now: u64,
    /// Why the run ended at a pause.
    ended: Option<PauseEnd>,
}

/// Why a run ended at a pause.
enum PauseEnd {
    /// The number of steps of this call is reached.
    StopAfter,
    /// A signal arrived.
    Signal(i32),
    /// The checkpoint cannot be written.
    Failed(Error),
}

impl Observer for Pausing<'_> {
    fn sample(&mut self, progress: Progress) -> bool {
        (self.report)(progress);
        true
    }

    fn steps(&mut self) -> u64 {
        let remaining = |limit: Option<u64>, since: u64| {
            limit.map(|limit| limit.saturating_sub(self.now - since))
        };
        let (stop_after, every) = (self.pauses.stop_after, self.pauses.every);
        let limits = [remaining(stop_after, self.first), remaining(every, self.stored)];
        limits.into_iter().flatten().fold(self.pace.steps(), u64::min)
    }

    fn pause(&mut self, steps: u64) -> Answer {
        self.pace.asked();
        self.now = steps;
        let reached = |limit: Option<u64>, since: u64| limit.is_some_and(|n| steps - since >= n);
        self.ended = match self.stop.requested() {
            Some(signal) => Some(PauseEnd::Signal(signal)),
            None => reached(self.pauses.stop_after, self.first).then_some(PauseEnd::StopAfter),
        };
        let due = self.ended.is_some() || reached(self.pauses.every, self.stored);
        match (due, &self.pauses.checkpoint) {
            (true, Some(_)) => Answer::Store,
            _ if self.ended.is_some() => Answer::End,
            _ => Answer::Continue,
        }
    }

    fn store(&mut self, pause: &Pause<'_>) -> bool {
        (self.now, self.stored) = (pause.steps, pause.steps);
        if let (Some(path), Some(text)) =
            (&self.pauses.checkpoint, (pause.text)(&self.scene.fingerprint))
        {
            let failed = |problem: String| Error::Disk { path: path.clone(), problem };
            let written = text.map_err(|error| failed(error.to_string())).and_then(|text| {
                write_output(self.files, path, text.as_bytes())
                    .map_err(|error| disk_error(path, &error))
            });
            if let Err(error) = written {
                self.ended = Some(PauseEnd::Failed(error));
            }
        }
        self.ended.is_none()
    }
}

fn motion(
    scene: &SceneFile,
    pauses: &Pauses,
    files: &dyn Files,
    stop: &Stop,
    report: &mut dyn FnMut(Progress),
) -> Result<(Status, Ended)> {
    let timeline = Timeline::of_film(&scene.film);
    let (mut model, run) = begin(scene, pauses, files)?;
    let first = model.steps();
    let pace = Pace::new();
    let (now, stored) = (first, first);
    let mut observer =
        Pausing { scene, pauses, files, stop, report, pace, first, stored, now, ended: None };
    let mut deployment = run.complete(&mut model, &timeline, &mut observer);
    // A run that ended before its checkpoint needs none.
    let ended = observer.ended.filter(|_| deployment.stop == End::Cancelled);
    let paused = matches!(ended, Some(PauseEnd::StopAfter));
    match ended {
        Some(PauseEnd::Failed(error)) => return Err(error),
        Some(PauseEnd::Signal(signal)) => {
            let next = match &pauses.checkpoint {
                Some(path) => {
                    let (steps, path) = (model.steps(), path.display());
                    format!("step {steps} is stored; resume with --resume {path}")
                }
                None => "nothing is stored; use --checkpoint FILE to store the state".to_owned(),
            };
            return Err(Error::Interrupted { signal, next });
        }
        Some(PauseEnd::StopAfter) | None => {}
    }
    scene.recorded.name(&mut deployment.tracks);
    let status = match &deployment.stop {
        _ if paused => Status::Paused,
        End::Done => Status::Done,
        End::Cancelled => Status::Cancelled,
        End::Failed(failure) => Status::Failed(failure.kind),
    };
    Ok((status, Ended::Motion(Box::new((model, deployment)))))
}

/// The run at its start, or at its checkpoint.
fn begin(scene: &SceneFile, pauses: &Pauses, files: &dyn Files) -> Result<(FilmRun, Run)> {
    let rings = scene.rings.clone();
    let invalid = |error: billow_solver::scene::error::SceneError| {
        Error::from(refused("", "", &error.to_string(), ""))
    };
    let Some(path) = &pauses.resume else {
        let model = FilmRun::seated(&scene.film, rings, &scene.seating).map_err(invalid)?;
        return Ok((model, Run::default()));
    };
    let refuse = |problem: String| Error::Disk { path: path.clone(), problem };
    let bytes = files.read(path).map_err(|error| {
        let next = "give the file that --checkpoint wrote, or start again without --resume";
        refuse(format!("cannot read the checkpoint: {error}\n  next: {next}"))
    })?;
    let text = String::from_utf8(bytes)
        .map_err(|_| refuse(format!("is not a checkpoint: not UTF-8{START_AGAIN}")))?;
    let stored = Checkpoint::<StoredFilm, Run>::from_text(&text, &scene.fingerprint);
    let checkpoint = stored.map_err(|error| {
        let next = match error {
            CheckpointError::Scene => {
                "\n  next: resume with the scene, files and --set of the checkpoint"
            }
            CheckpointError::Version { .. } | CheckpointError::Physics { .. } => {
                "\n  next: resume with the billow that wrote it, or start again without --resume"
            }
            CheckpointError::Invalid(_) => START_AGAIN,
        };
        refuse(format!("{error}{next}"))
    })?;
    FilmRun::resume(&scene.film, rings, &scene.seating, checkpoint)
        .map_err(|error| refuse(format!("{error}{START_AGAIN}")))
}
