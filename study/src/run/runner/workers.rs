//! The workers of a run: they compute and send messages. They do not touch the disk.

use std::sync::atomic::{AtomicUsize, Ordering};
use std::sync::mpsc::SyncSender;
use std::sync::{Mutex, PoisonError};
use std::time::{Duration, Instant};

use billow_solver::models::run::Progress;
use billow_solver::output::outcome::Deployment;
use rayon::ThreadPool;

use crate::job::executor::{Executor, Outcome, execute_guarded};
use crate::job::row::Cells;
use crate::job::{self, Job};
use crate::run::event::Event;
use crate::store::history_file;

/// Time between two progress messages of one thread, at least. Chosen: faster than a reader notices.
const MIN_SAMPLE_INTERVAL: Duration = Duration::from_millis(100);

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
    /// A job ended. A cancelled job gives no message.
    Ended(Box<Ended>),
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
}

/// The event of a message; `None` for an ended job, whose event follows when it is stored.
pub fn event(message: &Message, jobs: &[Job]) -> Option<Event> {
    match message {
        Message::Started { index, thread } => {
            let job = &jobs[*index];
            let label = job::label(&job.parameters);
            Some(Event::JobStarted { id: job.id.clone(), label, thread: *thread })
        }
        Message::Sample { thread, progress } => {
            Some(Event::JobSample { thread: *thread, progress: *progress })
        }
        Message::Ended(_) => None,
    }
}

/// Runs all jobs on a pool, batch by batch in their order, until all are done or `ending` returns
/// `true`. The dropped sender signals to the receiver that no message follows.
pub fn work(
    pool: &ThreadPool,
    executor: &dyn Executor,
    jobs: &[Job],
    ending: &(dyn Fn() -> bool + Sync),
    sender: SyncSender<Message>,
) {
    let next = AtomicUsize::new(0);
    let batch = executor.batch().max(1);
    pool.broadcast(|context| {
        let thread = context.index();
        while !ending() {
            let first = next.fetch_add(batch, Ordering::Relaxed);
            let Some(rest) = jobs.get(first..).filter(|rest| !rest.is_empty()) else { break };
            let refs: Vec<&Job> = rest.iter().take(batch).collect();
            // Sending fails when the receiver stopped after an error.
            if sender.send(Message::Started { index: first, thread }).is_err() {
                break;
            }
            let last_sample = Mutex::new(Instant::now());
            let observer = |_: usize, progress: Progress| {
                let mut last_sample = last_sample.lock().unwrap_or_else(PoisonError::into_inner);
                if last_sample.elapsed() >= MIN_SAMPLE_INTERVAL {
                    *last_sample = Instant::now();
                    // A sample is dropped when the channel is full.
                    let _ = sender.try_send(Message::Sample { thread, progress });
                }
                !ending()
            };
            let outcomes = execute_guarded(executor, &refs, &observer);
            for (offset, outcome) in outcomes.into_iter().enumerate() {
                let Some(ended) = finish(first + offset, thread, refs[offset], outcome) else {
                    continue;
                };
                if sender.send(Message::Ended(Box::new(ended))).is_err() {
                    return;
                }
            }
        }
    });
    drop(sender);
}

/// Row and result of a job that ended; `None` for a cancelled one.
fn finish(index: usize, thread: usize, job: &Job, outcome: Outcome) -> Option<Ended> {
    let hash = match &outcome {
        Outcome::Ran { deployment, .. } => Some(history_file::content_hash(deployment)),
        Outcome::Refused(_) | Outcome::Panicked(_) | Outcome::Cancelled => None,
    };
    let cells = Cells::of(job, &outcome, hash.as_deref())?;
    let deployment = match outcome {
        Outcome::Ran { deployment, .. } => Some(deployment),
        Outcome::Refused(_) | Outcome::Panicked(_) | Outcome::Cancelled => None,
    };
    Some(Ended { index, thread, cells, deployment })
}
