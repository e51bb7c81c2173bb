//! Running one scene by itself: in motion, with checkpoints, or at rest.

use std::ops::ControlFlow;
use std::path::{Path, PathBuf};
use std::time::Instant;

use billow_solver::models::film::FilmRun;
use billow_solver::models::run::{Model, Observer, Progress, Run};
use billow_solver::output::checkpoint::{Checkpoint, CheckpointError};
use billow_solver::output::outcome::{Deployment, FailureKind, Stop as End};
use billow_solver::platform::workers::Workers;
use billow_solver::scene::timeline::Timeline;
use billow_solver::statics::{self, StaticError, StaticFailureKind, StaticSolution};

use crate::job::Status;
use crate::platform::error::{Error, InputError, Result};
use crate::platform::files::{Files, disk_error, write_atomic};
use crate::platform::stop::Stop;
use crate::scene::file::SceneFile;

/// Where a run pauses, where it is stored and where it goes on from.
#[derive(Debug, Clone, Default)]
pub struct Pauses {
    /// File of the checkpoint.
    pub checkpoint: Option<PathBuf>,
    /// Steps between two checkpoints.
    pub every: Option<u64>,
    /// Steps after which this call ends.
    pub stop_after: Option<u64>,
    /// Checkpoint to go on from.
    pub resume: Option<PathBuf>,
}

/// A scene that was solved.
#[derive(Debug)]
pub struct Solved {
    /// `done`, `paused`, or why there is no result.
    pub status: Status,
    /// The state at the end.
    pub end: Ended,
    /// Wall time of this call, s. A cost, never a reason.
    pub wall_seconds: f64,
}

/// How it was solved, and what it left.
#[derive(Debug)]
pub enum Ended {
    /// In motion.
    Motion(Box<(FilmRun, Deployment)>),
    /// At rest.
    Rest(Box<StaticSolution>),
    /// No state of rest was found.
    NoRest(statics::StaticFailure),
}

/// Steps after which a run looks whether it is to stop.
const LOOK: u64 = 2_000;

/// Solves a scene on so many threads, which change no bit. A signal ends it, after a checkpoint where
/// one is asked for.
///
/// # Errors
/// A checkpoint that cannot be read or written, or is of another scene; a signal.
pub fn solve(
    scene: &SceneFile,
    pauses: &Pauses,
    threads: usize,
    files: &dyn Files,
    stop: &Stop,
    report: &mut dyn FnMut(Progress),
) -> Result<Solved> {
    let start = Instant::now();
    let (status, end) = if scene.film.solver.statics {
        rest(scene, stop)?
    } else {
        motion(scene, pauses, threads, files, stop, report)?
    };
    Ok(Solved { status, end, wall_seconds: start.elapsed().as_secs_f64() })
}

fn rest(scene: &SceneFile, stop: &Stop) -> Result<(Status, Ended)> {
    let mut watch = |_: &statics::Iteration| match stop.requested() {
        Some(_) => ControlFlow::Break(()),
        None => ControlFlow::Continue(()),
    };
    match statics::solve(&scene.film, &mut watch) {
        Ok(solution) => {
            // Closed film turned inside out rests as well, and is no answer.
            let inside_out = scene.film.shell.is_closed() && solution.volume <= 0.0;
            let status =
                if inside_out { Status::Failed(FailureKind::InvertedVolume) } else { Status::Done };
            Ok((status, Ended::Rest(Box::new(solution))))
        }
        Err(StaticError::NoState(failure)) => match (failure.kind, stop.requested()) {
            (StaticFailureKind::Stopped, Some(signal)) => {
                Err(Error::Interrupted { signal, next: "nothing is stored".to_owned() })
            }
            _ => Ok((Status::NoEquilibrium, Ended::NoRest(failure))),
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

/// Tells the caller of every sample.
struct Reporting<'a>(&'a mut dyn FnMut(Progress));

impl Observer for Reporting<'_> {
    fn sample(&mut self, progress: Progress) -> bool {
        (self.0)(progress);
        true
    }
}

fn motion(
    scene: &SceneFile,
    pauses: &Pauses,
    threads: usize,
    files: &dyn Files,
    stop: &Stop,
    report: &mut dyn FnMut(Progress),
) -> Result<(Status, Ended)> {
    let course = Timeline::of_film(&scene.film);
    let (mut model, mut run) = begin(scene, pauses, files)?;
    model.film.share_with(Workers::of(threads));
    let first = model.steps();
    let mut observer = Reporting(report);
    let mut stored = first;
    let end = loop {
        let taken = model.steps() - first;
        let left = |limit: Option<u64>, since: u64| limit.map(|limit| limit.saturating_sub(since));
        let steps = [left(pauses.stop_after, taken), left(pauses.every, model.steps() - stored)]
            .into_iter()
            .flatten()
            .fold(LOOK, u64::min);
        if let Some(end) = run.advance(&mut model, &course, steps, &mut observer) {
            break Some(end);
        }
        let due = pauses.every.is_some_and(|every| model.steps() - stored >= every);
        let over = pauses.stop_after.is_some_and(|limit| model.steps() - first >= limit);
        let signal = stop.requested();
        if let (true, Some(path)) = (due || over || signal.is_some(), &pauses.checkpoint) {
            store(scene, &model, &run, files, path)?;
            stored = model.steps();
        }
        if let Some(signal) = signal {
            let next = match &pauses.checkpoint {
                Some(path) => {
                    let (steps, path) = (model.steps(), path.display());
                    format!("step {steps} is stored; go on with --resume {path}")
                }
                None => "nothing is stored without --checkpoint FILE".to_owned(),
            };
            return Err(Error::Interrupted { signal, next });
        }
        if over {
            break None;
        }
    };
    let paused = end.is_none();
    let mut deployment = run.finish(&model, &course, end.unwrap_or(End::Cancelled));
    scene.followed.name(&mut deployment.tracks);
    let status = match &deployment.stop {
        _ if paused => Status::Paused,
        End::Done => Status::Done,
        End::Cancelled => Status::Cancelled,
        End::Failed(failure) => Status::Failed(failure.kind),
    };
    Ok((status, Ended::Motion(Box::new((model, deployment)))))
}

/// The run at its start, or where its checkpoint left it.
fn begin(scene: &SceneFile, pauses: &Pauses, files: &dyn Files) -> Result<(FilmRun, Run)> {
    let rings = scene.rings.clone();
    let unsound = |error: billow_solver::scene::error::SceneError| {
        Error::from(refused("", "", &error.to_string(), ""))
    };
    let Some(path) = &pauses.resume else {
        let mut model = FilmRun::of(&scene.film, rings).map_err(unsound)?;
        model.film.setting.supports.movers.extend(scene.seating.iter().cloned());
        return Ok((model, Run::default()));
    };
    let refuse = |problem: String| Error::Disk { path: path.clone(), problem };
    let bytes = files.read(path).map_err(|error| {
        let next = "name the file --checkpoint wrote, or start anew without --resume";
        refuse(format!("cannot read the checkpoint: {error}\n  next: {next}"))
    })?;
    let text =
        String::from_utf8(bytes).map_err(|_| refuse("no checkpoint: not UTF-8".to_owned()))?;
    let checkpoint = Checkpoint::from_text(&text, &scene.fingerprint).map_err(|error| {
        let next = match error {
            CheckpointError::Scene => {
                "\n  next: resume with the scene, files and --set it was made with"
            }
            CheckpointError::Newer { .. } | CheckpointError::Physics { .. } => {
                "\n  next: resume with the billow that wrote it, or start anew without --resume"
            }
            CheckpointError::Unsound(_) => "\n  next: start anew without --resume",
        };
        refuse(format!("{error}{next}"))
    })?;
    let mut model = FilmRun::resume(&scene.film, rings, checkpoint.state).map_err(unsound)?;
    model.film.setting.supports.movers.extend(scene.seating.iter().cloned());
    Ok((model, checkpoint.run))
}

fn store(
    scene: &SceneFile,
    model: &FilmRun,
    run: &Run,
    files: &dyn Files,
    path: &Path,
) -> Result<()> {
    let checkpoint = Checkpoint::new(&scene.fingerprint, &model.film.state, run);
    let text = checkpoint
        .to_text()
        .map_err(|error| Error::Disk { path: path.to_owned(), problem: error.to_string() })?;
    write_atomic(files, path, text.as_bytes()).map_err(|error| disk_error(path, &error))
}
