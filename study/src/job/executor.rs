//! Computes the jobs of a batch. The trait lets a test replace the solver.

use std::cell::RefCell;
use std::panic::{self, AssertUnwindSafe};
use std::sync::Once;
use std::time::Instant;

use billow_solver::models::run::{Observer, Progress};
use billow_solver::models::{self};
use billow_solver::output::measures::Reference;
use billow_solver::output::outcome::{Deployment, Stop};
use billow_solver::platform::workers::Workers;
use billow_solver::scene::error::SceneError;

use crate::job::references::References;
use crate::job::{Job, JobId};

/// Computes jobs.
pub trait Executor: Sync {
    /// Number of jobs that one call should get.
    fn batch(&self) -> usize {
        1
    }

    /// Static references computed since the last call, to be stored for later runs.
    fn references(&self) -> Vec<(JobId, Reference)> {
        Vec::new()
    }

    /// Runs a batch and returns one outcome per job, in the order of `jobs`. `observer` gets the
    /// index of a job in the batch and its progress; when it returns `false`, the job must end as
    /// cancelled. A job may use up to `threads` threads; their number changes no bit of a result.
    fn execute(
        &self,
        jobs: &[&Job],
        threads: usize,
        observer: &ProgressObserver<'_>,
    ) -> Vec<Outcome>;
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
        /// Wall time of the run without its static reference, s. It decides nothing.
        seconds: f64,
        /// Why there is no verdict, when the model needs a reference and has none.
        note: Option<String>,
    },
    /// The model refused the scene.
    Refused(SceneError),
    /// The program panicked with this message.
    Panicked(String),
    /// The job was cancelled. Nothing of it is a result.
    Cancelled,
}

/// The solver on this machine, one job after the other.
#[derive(Debug, Default)]
pub struct Solver {
    /// Static references known so far.
    pub references: References,
}

impl Executor for Solver {
    fn references(&self) -> Vec<(JobId, Reference)> {
        self.references.take_new()
    }

    fn execute(
        &self,
        jobs: &[&Job],
        threads: usize,
        observer: &ProgressObserver<'_>,
    ) -> Vec<Outcome> {
        let run = |(index, job): (usize, &&Job)| {
            let start = Progress {
                time: 0.0,
                end_time: job.scene.solver.end_time,
                z_centre: job.scene.design.stowed_height,
                pressure: 0.0,
            };
            let goes_on = &mut || observer(index, start);
            let (reference, note) = self.references.of(&job.scene, goes_on);
            let start = Instant::now();
            let (workers, mut samples) = (Workers::of(threads), JobObserver { index, observer });
            match models::solve_with(workers, &job.scene, reference, &mut samples) {
                Ok(deployment) if deployment.stop == Stop::Cancelled => Outcome::Cancelled,
                Ok(deployment) => Outcome::Ran {
                    deployment: Box::new(deployment),
                    seconds: start.elapsed().as_secs_f64(),
                    note,
                },
                Err(error) => Outcome::Refused(error),
            }
        };
        jobs.iter().enumerate().map(run).collect()
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
    threads: usize,
    observer: &ProgressObserver<'_>,
) -> Vec<Outcome> {
    match catch_panic(|| executor.execute(jobs, threads, observer)) {
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
                execute_guarded(executor, &[*job], threads, &observer)
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
    result.map_err(|panic| {
        // The message of a panic in a second thread stays in that thread; the payload has it, too.
        let text = || panic.downcast_ref::<String>().map(String::as_str);
        let payload = panic.downcast_ref::<&str>().copied().or_else(text);
        if message.is_empty() { payload.unwrap_or("no message").to_owned() } else { message }
    })
}
