//! Computes a job. The trait lets a test replace the solver.

use std::cell::RefCell;
use std::panic::{self, AssertUnwindSafe};
use std::sync::Once;

use billow_solver::models::{self, ResumeError, Stored};
use billow_solver::output::measures::{self, NoReference};
use billow_solver::output::outcome::{Deployment, Stop};
use billow_solver::platform::simd::InstructionSet;
use billow_solver::scene::error::SceneError;
use billow_solver::scene::timeline::Timeline;

use crate::job::attempt::{Attempt, Ending};
use crate::job::control::Task;
use crate::job::limits::Limit;
use crate::job::references::References;
use crate::job::{Job, JobId};

/// Computes jobs.
pub trait Executor: Sync {
    /// Runs a job and returns how it ended.
    fn execute(&self, task: &Task<'_>) -> Outcome;
}

/// How a job ended.
#[derive(Debug, Clone, PartialEq)]
pub enum Outcome {
    /// The model ran, to its end time or to a failure.
    Ran {
        /// The result.
        deployment: Box<Deployment>,
        /// Wall time of the run without its static equilibria, s, since its last start or resume. It
        /// decides nothing.
        seconds: f64,
        /// Steps in that time.
        steps: u64,
    },
    /// The model refused the scene.
    Refused(SceneError),
    /// The program panicked with this message.
    Panicked(String),
    /// The job reached a limit of the study.
    Limited(Limit),
    /// The process died in two attempts at the job, in the last one without another job beside it.
    Crashed,
    /// The job was cancelled. Nothing of it is a result.
    Cancelled,
}

/// The solver on this machine, one job after the other.
#[derive(Debug)]
pub struct Solver {
    /// Instruction set. Every one gives the same bits.
    pub instruction_set: InstructionSet,
    /// Static references known so far.
    pub references: References,
}

impl Executor for Solver {
    fn execute(&self, task: &Task<'_>) -> Outcome {
        let mut attempt = Attempt::new(task);
        let mut deployment = match self.solve(task, &mut attempt) {
            Ok(deployment) => deployment,
            Err(error) => return Outcome::Refused(error),
        };
        let (seconds, steps) = attempt.cost(deployment.steps);
        if deployment.stop == Stop::Cancelled
            || self.judge(task.job, &mut deployment, &mut || attempt.continues())
                == Err(NoReference::Stopped)
        {
            return match attempt.ending() {
                Some(Ending::Limited(limit)) => Outcome::Limited(limit),
                Some(Ending::Stopped) | None => Outcome::Cancelled,
            };
        }
        Outcome::Ran { deployment: Box::new(deployment), seconds, steps }
    }
}

impl Solver {
    /// Runs the model: from the checkpoint if there is a valid one, else from the start.
    fn solve(&self, task: &Task<'_>, attempt: &mut Attempt<'_>) -> Result<Deployment, SceneError> {
        let Job { id, scene, .. } = task.job;
        if let Some(text) = &task.checkpoint {
            let stored = Stored { fingerprint: id.as_str(), text };
            match models::resume(self.instruction_set, scene, &stored, attempt) {
                Ok(deployment) => return Ok(deployment),
                // A scene that cannot be started either is refused below.
                Err(error) => task.control.note(unusable(id, &error)),
            }
        }
        models::solve(self.instruction_set, scene, attempt)
    }

    /// Compares a run with the static equilibria of its design. A failed run has no final shape, and needs
    /// the design shape only.
    fn judge(
        &self,
        job: &Job,
        deployment: &mut Deployment,
        continues: &mut dyn FnMut() -> bool,
    ) -> Result<(), NoReference> {
        let timeline = Timeline::new(&job.scene);
        let overpressure = measures::final_overpressure(&deployment.history, &timeline)
            .filter(|_| deployment.stop == Stop::Done);
        let found =
            self.references.of(self.instruction_set, &job.scene, overpressure, continues)?;
        if let Some(reference) = found {
            deployment.judge(&reference, &timeline);
        }
        Ok(())
    }
}

/// The note about a checkpoint that cannot be used.
fn unusable(id: &JobId, error: &ResumeError) -> String {
    format!("checkpoint of job {}: {error}; the job starts from its beginning", id.short())
}

/// Runs a job and turns a panic into its outcome.
pub fn execute_guarded(executor: &dyn Executor, task: &Task<'_>) -> Outcome {
    catch_panic(|| executor.execute(task)).unwrap_or_else(Outcome::Panicked)
}

thread_local! {
    /// `Some` while this thread runs a job: receives the panic message.
    static MESSAGE: RefCell<Option<String>> = const { RefCell::new(None) };
}

/// Runs `work` and returns its result, or the message of its panic.
fn catch_panic<T>(work: impl FnOnce() -> T) -> Result<T, String> {
    static HOOK: Once = Once::new();
    HOOK.call_once(|| {
        let previous = panic::take_hook();
        // The message becomes a table cell. Printing it would break the line of progress.
        panic::set_hook(Box::new(move |info| {
            let kept = MESSAGE.with_borrow_mut(|message| {
                let Some(message) = message else { return false };
                let payload = info.payload_as_str().unwrap_or("no message");
                *message = info.location().map_or_else(
                    || payload.to_owned(),
                    |location| format!("{payload} ({}:{})", location.file(), location.line()),
                );
                true
            });
            if !kept {
                previous(info);
            }
        }));
    });
    MESSAGE.set(Some(String::new()));
    let result = panic::catch_unwind(AssertUnwindSafe(work));
    let message = MESSAGE.take().unwrap_or_default();
    result.map_err(|_| if message.is_empty() { "no message".to_owned() } else { message })
}
