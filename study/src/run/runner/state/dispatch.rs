//! Hands jobs to the workers and stores what comes back.

use std::num::NonZero;
use std::sync::atomic::{AtomicBool, Ordering};
use std::sync::mpsc::{self, Receiver, RecvTimeoutError};
use std::time::Duration;

use super::State;
use crate::job::Job;
use crate::platform::error::{Error, Result};
use crate::platform::memory::limits;
use crate::platform::quote;
use crate::run::event::{Event, Reporter};
use crate::run::reservation::Reservations;
use crate::run::runner::quarantine;
use crate::run::runner::workers::{self, Ended, Message, WorkerPool};
use crate::store::journal::Record;

/// Time without a check of the stop request, at most.
const MAX_WAIT: Duration = Duration::from_millis(100);
/// Jobs stored with one sync of the journal, at most. Chosen: a sync takes longer than a small job.
const MAX_JOBS_PER_SYNC: usize = 64;
/// Messages that wait for the storing thread, at most, per worker. When the disk is slow, results then
/// wait in the workers, and memory stays bounded.
const MAX_MESSAGES_PER_WORKER: usize = 4;

impl State<'_, '_> {
    /// Takes the jobs in quarantine out of the missing ones and records their rows.
    pub(super) fn quarantine(
        &mut self,
        missing: &mut Vec<Job>,
        reporter: &mut dyn Reporter,
    ) -> Result<()> {
        let quarantined: Vec<Job> =
            missing.extract_if(.., |job| self.deaths.is_quarantined(&job.id)).collect();
        let root = quote::path(self.run.results.root());
        let Some(note) = quarantine::quarantine_note(quarantined.iter(), self.run.label, &root)
        else {
            return Ok(());
        };
        reporter.event(&Event::Note(note));
        let records: Vec<Record> = quarantined.iter().filter_map(quarantine::record).collect();
        self.log.writer().append(&records)?;
        self.records.extend(records.into_iter().map(|record| (record.job.clone(), record)));
        Ok(())
    }

    /// Runs jobs and stores them as they end: suspects last, each with no other job beside it.
    pub(in crate::run::runner) fn run_jobs(
        &mut self,
        jobs: Vec<Job>,
        reporter: &mut dyn Reporter,
    ) -> Result<()> {
        let (suspects, others): (Vec<Job>, Vec<Job>) =
            jobs.into_iter().partition(|job| self.deaths.is_suspect(&job.id));
        if !others.is_empty() {
            self.run_on(self.run.threads.map_or(0, NonZero::get), &others, reporter)?;
        }
        for suspect in suspects {
            if self.run.stop.requested().is_none() {
                self.run_on(1, &[suspect], reporter)?;
            }
        }
        Ok(())
    }

    /// Runs jobs on this number of threads; 0 for one thread per core.
    fn run_on(&mut self, threads: usize, jobs: &[Job], reporter: &mut dyn Reporter) -> Result<()> {
        // Before the threads start: what they take is in the margin.
        let free = limits();
        let pool = rayon::ThreadPoolBuilder::new()
            .num_threads(threads)
            .thread_name(|thread| format!("billow-{thread}"))
            .build()
            .map_err(|error| Error::Disk {
                path: "threads".into(),
                problem: format!("cannot start: {error}\n  next: ask for fewer with --threads N"),
            })?;
        let memory = Reservations::of(&free, pool.current_num_threads());
        let capacity = MAX_MESSAGES_PER_WORKER * pool.current_num_threads();
        let (sender, receiver) = mpsc::sync_channel(capacity);
        let abort = AtomicBool::new(false);
        let (stop, log) = (&self.run.stop, self.log);
        let ending = || abort.load(Ordering::Relaxed) || stop.requested().is_some();
        let over = AtomicBool::new(false);
        let workers = WorkerPool {
            pool: &pool,
            executor: self.run.executor,
            jobs,
            limits: self.run.limits,
            memory: &memory,
            log,
            checkpoint_interval: self.run.checkpoint_interval,
            ending: &ending,
        };
        std::thread::scope(|scope| {
            scope.spawn(|| workers.work(sender));
            let watch = scope.spawn(|| {
                while !over.load(Ordering::Relaxed) && stop.requested().is_none() {
                    std::thread::park_timeout(MAX_WAIT);
                }
                if stop.requested().is_some() {
                    log.stop();
                }
            });
            let mut stored = Ok(());
            while let Some((messages, ended)) = receive(&receiver) {
                for message in messages {
                    if let Some(event) = workers::event(&message, jobs, self.run.label) {
                        reporter.event(&event);
                    }
                    if let (Message::Failed(error), Ok(())) = (message, &stored) {
                        stored = Err(error);
                    }
                }
                if stored.is_ok() {
                    stored = self.store(jobs, ended, reporter);
                }
                // After an error the workers stop. Jobs that end meanwhile run again next time.
                abort.store(stored.is_err(), Ordering::Relaxed);
            }
            over.store(true, Ordering::Relaxed);
            watch.thread().unpark();
            stored
        })
    }
}

/// Messages since the last call, ended jobs apart; `None` when no worker remains.
fn receive(receiver: &Receiver<Message>) -> Option<(Vec<Message>, Vec<Ended>)> {
    let mut messages = Vec::new();
    let mut ended = Vec::new();
    let mut next = match receiver.recv_timeout(MAX_WAIT) {
        Ok(message) => Some(message),
        Err(RecvTimeoutError::Timeout) => None,
        Err(RecvTimeoutError::Disconnected) => return None,
    };
    while let Some(message) = next {
        match message {
            Message::Ended(job) => ended.push(*job),
            other => messages.push(other),
        }
        next = if ended.len() < MAX_JOBS_PER_SYNC { receiver.try_recv().ok() } else { None };
    }
    Some((messages, ended))
}
