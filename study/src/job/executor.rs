//! Computes the jobs of a batch. The trait lets a test replace the solver.

use std::cell::RefCell;
use std::panic::{self, AssertUnwindSafe};
use std::sync::Once;
use std::time::Instant;

use billow_solver::models;
use billow_solver::models::film::LadderState;
use billow_solver::models::run::{Observer, Progress};
use billow_solver::output::measures::{self, NoReference};
use billow_solver::output::outcome::{Deployment, Stop};
use billow_solver::platform::simd::InstructionSet;
use billow_solver::scene::error::SceneError;
use billow_solver::scene::timeline::Timeline;

use crate::job::references::References;
use crate::job::{Job, JobId};

/// Computes jobs.
pub trait Executor: Sync {
    /// Number of jobs that one call should get.
    fn batch(&self) -> usize {
        1
    }

    /// Static equilibria of designs for which some were computed since the last call, to be stored for
    /// later runs.
    fn references(&self) -> Vec<(JobId, Vec<LadderState>)> {
        Vec::new()
    }

    /// Runs a batch and returns one outcome per job, in the order of `jobs`. `observer` gets the
    /// index of a job in the batch and its progress; when it returns `false`, the job must end as
    /// cancelled.
    fn execute(&self, jobs: &[&Job], observer: &ProgressObserver<'_>) -> Vec<Outcome>;
}

/// Receives the progress of running jobs and can cancel them: see [`Executor::execute`].
pub type ProgressObserver<'a> = dyn Fn(usize, Progress) -> bool + Sync + 'a;

/// How a job ended.
#[derive(Debug, Clone, PartialEq)]
pub enum Outcome {
    /// The model ran, to its end time or to a failure.
    Ran {
        /// The result.
        deployment: Box<Deployment>,
        /// Wall time of the run without its static equilibria, s. It decides nothing.
        seconds: f64,
    },
    /// The model refused the scene.
    Refused(SceneError),
    /// The program panicked with this message.
    Panicked(String),
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
    fn references(&self) -> Vec<(JobId, Vec<LadderState>)> {
        self.references.take_new()
    }

    fn execute(&self, jobs: &[&Job], observer: &ProgressObserver<'_>) -> Vec<Outcome> {
        let run = |(index, job): (usize, &&Job)| {
            let start = Instant::now();
            let mut samples = JobObserver { index, observer };
            let mut deployment = match models::solve(self.instruction_set, &job.scene, &mut samples)
            {
                Ok(deployment) => deployment,
                Err(error) => return Outcome::Refused(error),
            };
            let seconds = start.elapsed().as_secs_f64();
            if deployment.stop == Stop::Cancelled
                || self.judge(job, &mut deployment, &|progress| observer(index, progress))
                    == Err(NoReference::Stopped)
            {
                return Outcome::Cancelled;
            }
            Outcome::Ran { deployment: Box::new(deployment), seconds }
        };
        jobs.iter().enumerate().map(run).collect()
    }
}

impl Solver {
    /// Compares a run with the static equilibria of its design. A failed run has no final shape, and needs
    /// the design shape only.
    ///
    /// # Errors
    /// [`NoReference::Stopped`] if `observer` ended the search.
    fn judge(
        &self,
        job: &Job,
        deployment: &mut Deployment,
        observer: &dyn Fn(Progress) -> bool,
    ) -> Result<(), NoReference> {
        let timeline = Timeline::new(&job.scene);
        let ended = Progress {
            time: job.scene.solver.end_time,
            end_time: job.scene.solver.end_time,
            z_centre: deployment.history.column("z_centre").last().copied().unwrap_or(0.0),
            pressure: deployment.measures.final_pressure.unwrap_or(0.0),
        };
        let overpressure = measures::final_overpressure(&deployment.history, &timeline)
            .filter(|_| deployment.stop == Stop::Done);
        let continues = &mut || observer(ended);
        let found =
            self.references.of(self.instruction_set, &job.scene, overpressure, continues)?;
        if let Some(reference) = found {
            deployment.judge(&reference, &timeline);
        }
        Ok(())
    }
}

/// Gives the samples of one job to the observer of its batch.
struct JobObserver<'a> {
    index: usize,
    observer: &'a ProgressObserver<'a>,
}

impl Observer for JobObserver<'_> {
    fn sample(&mut self, progress: Progress) -> bool {
        (self.observer)(self.index, progress)
    }
}

/// Runs a batch and turns panics into outcomes. When a batch of several jobs panics, its jobs are
/// run again one by one, so that only the jobs that panic are lost.
pub fn execute_guarded(
    executor: &dyn Executor,
    jobs: &[&Job],
    observer: &ProgressObserver<'_>,
) -> Vec<Outcome> {
    match catch_panic(|| executor.execute(jobs, observer)) {
        Ok(outcomes) if outcomes.len() == jobs.len() => outcomes,
        Ok(outcomes) => {
            let message =
                format!("executor returned {} outcomes for {} jobs", outcomes.len(), jobs.len());
            vec![Outcome::Panicked(message); jobs.len()]
        }
        Err(message) if jobs.len() == 1 => vec![Outcome::Panicked(message)],
        Err(_) => {
            let alone = |(index, job): (usize, &&Job)| {
                let observer = |_: usize, progress| observer(index, progress);
                execute_guarded(executor, &[*job], &observer)
            };
            jobs.iter().enumerate().flat_map(alone).collect()
        }
    }
}

thread_local! {
    /// `Some` while this thread runs a batch: receives the panic message.
    static MESSAGE: RefCell<Option<String>> = const { RefCell::new(None) };
}

/// Runs `work` and returns its result, or the message of its panic.
fn catch_panic<T>(work: impl FnOnce() -> T) -> Result<T, String> {
    static HOOK: Once = Once::new();
    HOOK.call_once(|| {
        let previous = panic::take_hook();
        // The message becomes a table cell. Printing it would break the progress bars.
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
