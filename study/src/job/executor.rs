//! Where the jobs of a batch are computed: behind one trait, so that a fake can take its place.

use std::cell::RefCell;
use std::panic::{self, AssertUnwindSafe};
use std::sync::Once;
use std::time::Instant;

use billow_solver::models::run::{Observer, Progress};
use billow_solver::models::{self};
use billow_solver::output::measures::Reference;
use billow_solver::output::outcome::{Deployment, Stop};
use billow_solver::platform::simd::InstructionSet;
use billow_solver::scene::error::SceneError;

use crate::job::references::References;
use crate::job::{Job, JobId};

/// Computes jobs.
pub trait Executor: Sync {
    /// How many jobs it likes to get at once.
    fn batch(&self) -> usize {
        1
    }

    /// Static states found since the last call, to be kept for later runs.
    fn references(&self) -> Vec<(JobId, Reference)> {
        Vec::new()
    }

    /// Runs a batch: one outcome a job, in the order of `jobs`. `watch` is told the position in
    /// the batch and where that job stands; when it says `false` the job is to end as cancelled.
    fn execute(&self, jobs: &[&Job], watch: &Watch<'_>) -> Vec<Outcome>;
}

/// Sees the samples of running jobs, and may end them.
pub type Watch<'a> = dyn Fn(usize, Progress) -> bool + Sync + 'a;

/// How a job ended.
#[derive(Debug, Clone, PartialEq)]
pub enum Outcome {
    /// It ran, to its end or to a typed stop.
    Ran {
        /// What it left.
        deployment: Box<Deployment>,
        /// Wall time, s, without that of the static states. A cost, never a reason.
        seconds: f64,
        /// Why there is no verdict where there should be one.
        note: Option<String>,
    },
    /// The model refused the scene.
    Refused(SceneError),
    /// It panicked, with this message.
    Panicked(String),
    /// It was asked to stop; nothing of it is a result.
    Cancelled,
}

/// The solver on this machine, one job at a time.
#[derive(Debug)]
pub struct Solver {
    /// Instruction set. Every one gives the same bits.
    pub instruction_set: InstructionSet,
    /// Static states known so far.
    pub references: References,
}

impl Executor for Solver {
    fn references(&self) -> Vec<(JobId, Reference)> {
        self.references.take_fresh()
    }

    fn execute(&self, jobs: &[&Job], watch: &Watch<'_>) -> Vec<Outcome> {
        let run = |(position, job): (usize, &&Job)| {
            let end_time = job.scene.solver.end_time;
            let start = Progress {
                time: 0.0,
                end_time,
                z_centre: job.scene.design.stowed_height,
                pressure: 0.0,
            };
            let goes_on = &mut || watch(position, start);
            let (reference, note) = self.references.of(self.instruction_set, &job.scene, goes_on);
            let start = Instant::now();
            let mut watcher = Watcher { position, watch };
            match models::solve(self.instruction_set, &job.scene, reference, &mut watcher) {
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

struct Watcher<'a> {
    position: usize,
    watch: &'a Watch<'a>,
}

impl Observer for Watcher<'_> {
    fn sample(&mut self, progress: Progress) -> bool {
        (self.watch)(self.position, progress)
    }
}

/// Runs a batch so that no panic leaves it. When a batch of several panics its jobs are run one by
/// one, and only those that panic again are lost to it.
pub fn execute_guarded(executor: &dyn Executor, jobs: &[&Job], watch: &Watch<'_>) -> Vec<Outcome> {
    match guarded(|| executor.execute(jobs, watch)) {
        Ok(outcomes) if outcomes.len() == jobs.len() => outcomes,
        Ok(outcomes) => {
            let message =
                format!("executor gave {} outcomes to {} jobs", outcomes.len(), jobs.len());
            vec![Outcome::Panicked(message); jobs.len()]
        }
        Err(message) if jobs.len() == 1 => vec![Outcome::Panicked(message)],
        Err(_) => {
            let alone = |(position, job): (usize, &&Job)| {
                let watch = |_: usize, progress| watch(position, progress);
                execute_guarded(executor, &[*job], &watch)
            };
            jobs.iter().enumerate().flat_map(alone).collect()
        }
    }
}

thread_local! {
    /// `Some` while this thread runs guarded code: where its panic message goes.
    static MESSAGE: RefCell<Option<String>> = const { RefCell::new(None) };
}

fn guarded<T>(work: impl FnOnce() -> T) -> Result<T, String> {
    static HOOK: Once = Once::new();
    HOOK.call_once(|| {
        let previous = panic::take_hook();
        // The message becomes a table cell; printed, it would tear the progress bars.
        panic::set_hook(Box::new(move |info| {
            let kept = MESSAGE.with_borrow_mut(|message| {
                let Some(message) = message else { return false };
                let payload = info.payload_as_str().unwrap_or("no message");
                *message = info.location().map_or_else(
                    || payload.to_owned(),
                    |at| format!("{payload} ({}:{})", at.file(), at.line()),
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
