//! The workers of a run: they compute, and tell; they never touch the disk.

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

/// Least time between two samples told of one thread.
const SAMPLE_INTERVAL: Duration = Duration::from_millis(100);

/// What a worker tells.
pub enum Message {
    /// A job began.
    Started {
        /// Position in the list of jobs.
        index: usize,
        /// Thread, from 0.
        thread: usize,
    },
    /// A job stands here.
    Sample {
        /// Thread, from 0.
        thread: usize,
        /// Where it stands.
        progress: Progress,
    },
    /// A job ended. Cancelled ones are not told.
    Ended(Box<Ended>),
}

/// A job that ended.
pub struct Ended {
    /// Position in the list of jobs.
    pub index: usize,
    /// Thread, from 0.
    pub thread: usize,
    /// Its row.
    pub cells: Cells,
    /// What it left, if it ran.
    pub deployment: Option<Box<Deployment>>,
}

/// The event a message is for others; `None` for an ended job, which is told once it is stored.
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

/// Runs all jobs on a pool, batch by batch in their order, until none is left or `ending` says so.
/// Dropping the sender at the end tells the receiver that nothing more comes.
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
            // A receiver that is gone has met an error of its own; the work is then for nothing.
            if sender.send(Message::Started { index: first, thread }).is_err() {
                break;
            }
            let told = Mutex::new(Instant::now());
            let watch = |_: usize, progress: Progress| {
                let mut told = told.lock().unwrap_or_else(PoisonError::into_inner);
                if told.elapsed() >= SAMPLE_INTERVAL {
                    *told = Instant::now();
                    // A full channel has better things to carry than a sample.
                    let _ = sender.try_send(Message::Sample { thread, progress });
                }
                !ending()
            };
            let outcomes = execute_guarded(executor, &refs, &watch);
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

/// Row and hash of a job that ended; `None` for a cancelled one.
fn finish(index: usize, thread: usize, job: &Job, outcome: Outcome) -> Option<Ended> {
    let mut cells = Cells::of(job, &outcome)?;
    let deployment = match outcome {
        Outcome::Ran { deployment, .. } => {
            cells.set("content_hash", history_file::content_hash(&deployment));
            Some(deployment)
        }
        Outcome::Refused(_) | Outcome::Panicked(_) | Outcome::Cancelled => None,
    };
    Some(Ended { index, thread, cells, deployment })
}
