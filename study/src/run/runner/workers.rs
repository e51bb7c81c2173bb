//! The workers of a run: they compute and send messages.

use std::sync::atomic::{AtomicUsize, Ordering};
use std::sync::mpsc::SyncSender;
use std::sync::{Arc, Mutex, MutexGuard, PoisonError};
use std::time::{Duration, Instant};

use billow_solver::models::run::Progress;
use billow_solver::output::outcome::Deployment;
use rayon::ThreadPool;

use super::attempt_log::AttemptLog;
use crate::job::control::{Control, Order, Task};
use crate::job::executor::{Executor, Outcome, execute_guarded};
use crate::job::limits::{JobLimits, Limit};
use crate::job::memory::estimate;
use crate::job::row::Cells;
use crate::job::{Job, Parameters};
use crate::platform::error::{Error, Result};
use crate::run::event::Event;
use crate::run::reservation::{Reservation, Reservations};
use crate::store::history_file;

/// Time between two progress messages of one thread, at least. Chosen: faster than a reader notices.
const MIN_SAMPLE_INTERVAL: Duration = Duration::from_millis(100);
/// Time between two checkpoints of a job over the time that one takes, at least. Chosen: checkpoints then
/// cost at most 1 % of a run.
const MIN_CHECKPOINT_RATIO: u32 = 100;

/// A message of a worker.
pub enum Message {
    /// A job started.
    Started {
        /// Index in the list of jobs.
        index: usize,
        /// Number of the thread, from 0.
        thread: usize,
    },
    /// Progress of a job.
    Sample {
        /// Number of the thread, from 0.
        thread: usize,
        /// Simulated time, height and pressure.
        progress: Progress,
    },
    /// A message for the user.
    Note(String),
    /// A job ended. A cancelled job gives no message.
    Ended(Box<Ended>),
    /// The attempt at a job cannot be recorded, so the worker ended.
    Failed(Error),
}

/// A job that ended.
pub struct Ended {
    /// Index in the list of jobs.
    pub index: usize,
    /// Number of the thread, from 0.
    pub thread: usize,
    /// Its row.
    pub cells: Cells,
    /// The result of a job that ran.
    pub deployment: Option<Box<Deployment>>,
    /// Its memory, held until the result is stored.
    pub reservation: Reservation,
}

/// The event of a message; `None` for an ended job, whose event follows when it is stored.
pub fn event(
    message: &Message,
    jobs: &[Job],
    label: &dyn Fn(&Parameters) -> String,
) -> Option<Event> {
    match message {
        Message::Started { index, thread } => {
            let job = &jobs[*index];
            let label = label(&job.parameters);
            Some(Event::JobStarted { id: job.id.clone(), label, thread: *thread })
        }
        Message::Sample { thread, progress } => {
            Some(Event::JobSample { thread: *thread, progress: *progress })
        }
        Message::Note(text) => Some(Event::Note(text.clone())),
        Message::Ended(_) | Message::Failed(_) => None,
    }
}

/// What the workers compute, and with what.
pub struct WorkerPool<'a, 'w> {
    /// The threads.
    pub pool: &'a ThreadPool,
    /// Computes the jobs.
    pub executor: &'a dyn Executor,
    /// The jobs.
    pub jobs: &'a [Job],
    /// Their limits.
    pub limits: JobLimits,
    /// The memory that they share.
    pub memory: &'a Arc<Reservations>,
    /// Their attempts and checkpoints.
    pub log: &'a AttemptLog<'w>,
    /// Time between two checkpoints of a job, at least.
    pub checkpoint_interval: Duration,
    /// Whether the run ends now.
    pub ending: &'a (dyn Fn() -> bool + Sync),
}

impl WorkerPool<'_, '_> {
    /// Runs all jobs on the pool, in their order, until all are done or the run ends. The dropped sender
    /// signals to the receiver that no message follows.
    pub fn work(&self, sender: SyncSender<Message>) {
        let next = AtomicUsize::new(0);
        self.pool.broadcast(|context| {
            let thread = context.index();
            while !(self.ending)() {
                let index = next.fetch_add(1, Ordering::Relaxed);
                let Some(job) = self.jobs.get(index) else { break };
                let Some((refused, reservation)) = self.admit(job) else { break };
                // Sending fails when the receiver stopped after an error.
                if sender.send(Message::Started { index, thread }).is_err() {
                    break;
                }
                let outcome = refused.map_or_else(|| self.run(job, thread, &sender), Ok);
                let (message, is_error) = match outcome.map(|outcome| finish(job, outcome)) {
                    Ok(None) => continue,
                    Ok(Some((cells, deployment))) => {
                        let ended = Ended { index, thread, cells, deployment, reservation };
                        (Message::Ended(Box::new(ended)), false)
                    }
                    Err(error) => (Message::Failed(error), true),
                };
                if sender.send(message).is_err() || is_error {
                    return;
                }
            }
        });
        drop(sender);
    }

    /// Runs a job, after its attempt is recorded.
    fn run(&self, job: &Job, thread: usize, sender: &SyncSender<Message>) -> Result<Outcome> {
        let control = &JobControl { workers: self, job, thread, sender, clock: Clock::start() };
        self.log.start(&job.id)?;
        let checkpoint = self.log.checkpoint(&job.id).unwrap_or_else(|error| {
            control.note(format!("{error}; the job starts from its beginning"));
            None
        });
        let task = Task { job, limits: self.limits, checkpoint, control };
        Ok(execute_guarded(self.executor, &task))
    }

    /// Reserves the memory of a job, and says how it ended if it does not run. `None` when the run ends.
    fn admit(&self, job: &Job) -> Option<(Option<Outcome>, Reservation)> {
        let needed = estimate(&job.scene).total;
        let given = self.limits.memory.filter(|limit| needed > *limit);
        let given = given.map(|limit| Limit::Memory { limit, needed });
        let available = || self.memory.refuses(needed);
        let limit = given.or_else(|| Some(Limit::Available { limit: available()?, needed }));
        let reserved = if limit.is_none() { needed } else { 0 };
        let reservation = self.memory.reserve(reserved, self.ending)?;
        Some((limit.map(Outcome::Limited), reservation))
    }
}

/// The runner of one job.
struct JobControl<'a, 'w> {
    workers: &'a WorkerPool<'a, 'w>,
    job: &'a Job,
    thread: usize,
    sender: &'a SyncSender<Message>,
    clock: Mutex<Clock>,
}

/// When a job was last asked for something.
struct Clock {
    sample: Instant,
    checkpoint: Instant,
    /// Time that the last checkpoint took.
    cost: Duration,
}

impl Clock {
    fn start() -> Mutex<Self> {
        let now = Instant::now();
        Mutex::new(Self { sample: now, checkpoint: now, cost: Duration::ZERO })
    }
}

impl JobControl<'_, '_> {
    fn clock(&self) -> MutexGuard<'_, Clock> {
        self.clock.lock().unwrap_or_else(PoisonError::into_inner)
    }
}

impl Control for JobControl<'_, '_> {
    fn order(&self) -> Order {
        if (self.workers.ending)() {
            return Order::End;
        }
        let mut clock = self.clock();
        let pause = self.workers.checkpoint_interval.max(clock.cost * MIN_CHECKPOINT_RATIO);
        if clock.checkpoint.elapsed() < pause {
            return Order::Continue;
        }
        clock.checkpoint = Instant::now();
        Order::Store
    }

    fn progress(&self, progress: Progress) {
        let mut clock = self.clock();
        if clock.sample.elapsed() >= MIN_SAMPLE_INTERVAL {
            clock.sample = Instant::now();
            // A sample is dropped when the channel is full.
            let _ = self.sender.try_send(Message::Sample { thread: self.thread, progress });
        }
    }

    fn store(&self, text: &str, _time: f64) {
        if let Err(error) = self.workers.log.store(&self.job.id, text) {
            self.note(format!("{error}; the job goes on"));
        }
        let mut clock = self.clock();
        clock.cost = clock.checkpoint.elapsed();
        clock.checkpoint = Instant::now();
    }

    fn note(&self, text: String) {
        // Not worth waiting for when the channel is full.
        let _ = self.sender.try_send(Message::Note(text));
    }
}

/// Row and result of a job that ended; `None` for a cancelled one.
fn finish(job: &Job, outcome: Outcome) -> Option<(Cells, Option<Box<Deployment>>)> {
    let hash = match &outcome {
        Outcome::Ran { deployment, .. } => Some(history_file::content_hash(deployment)),
        _ => None,
    };
    let cells = Cells::of(job, &outcome, hash.as_deref())?;
    let deployment = match outcome {
        Outcome::Ran { deployment, .. } => Some(deployment),
        _ => None,
    };
    Some((cells, deployment))
}
