//! The thread of a run that stores results: what is finished, what is missing, what came back.

use std::collections::{BTreeMap, BTreeSet};
use std::num::NonZero;
use std::sync::atomic::{AtomicBool, Ordering};
use std::sync::mpsc::{self, Receiver, RecvTimeoutError};
use std::time::{Duration, Instant};

use super::workers::{self, Ended, Message};
use super::{Run, Summary};
use crate::job::point::Point;
use crate::job::row::{Cells, ColumnId};
use crate::job::{Job, JobId, Status};
use crate::platform::error::{Error, Result};
use crate::run::event::{Event, Reporter};
use crate::store::history_file;
use crate::store::journal::{self, Journal, Record, Writer};
use crate::store::table::Table;
use crate::study::plan::{FinishedRow, Generation};

/// Time between two writes of the table while jobs run, at least. Chosen: a reader sees new rows
/// soon, and writing takes little of a run.
const MIN_TABLE_INTERVAL: Duration = Duration::from_secs(10);
/// Time without a check of the stop request, at most.
const MAX_WAIT: Duration = Duration::from_millis(100);
/// Jobs stored with one sync of the journal, at most. Chosen: a sync takes longer than a small job.
const MAX_JOBS_PER_SYNC: usize = 64;
/// Messages that wait for the storing thread, at most, per worker. When the disk is slow, results then
/// wait in the workers, and memory stays bounded.
const MAX_MESSAGES_PER_WORKER: usize = 4;

/// State of a run.
pub(super) struct State<'a> {
    run: &'a Run<'a>,
    writer: Writer<'a>,
    /// The text of study.json that the journal has.
    recorded_study: Option<String>,
    /// Old records of jobs that must run again, for comparison.
    old_records: BTreeMap<JobId, Record>,
    /// Records of the journals that are not yet checked against their files.
    recorded: BTreeMap<JobId, Record>,
    /// Records of planned jobs, with undamaged files.
    records: BTreeMap<JobId, Record>,
    /// Every point planned so far.
    points: Vec<Point>,
    summary: Summary,
    table_due: Instant,
    table_outdated: bool,
}

impl<'a> State<'a> {
    /// The state at the start, with the journals of earlier runs.
    pub(super) fn new(run: &'a Run<'a>, journal: Journal) -> Self {
        Self {
            run,
            writer: Writer::new(run.results.files(), run.results.journal_path()),
            recorded_study: journal.study,
            old_records: journal.invalidated,
            recorded: journal.records,
            records: BTreeMap::new(),
            points: Vec::new(),
            summary: Summary::default(),
            table_due: Instant::now() + MIN_TABLE_INTERVAL,
            table_outdated: true,
        }
    }

    /// Records the text of study.json, unless the journal has it.
    pub(super) fn record_study(&mut self, text: &str) -> Result<()> {
        if self.recorded_study.as_deref() == Some(text) {
            return Ok(());
        }
        self.writer.study(text)?;
        self.recorded_study = Some(text.to_owned());
        Ok(())
    }

    /// Invalidates the finished ones of the jobs to run again.
    pub(super) fn invalidate(&mut self) -> Result<()> {
        let Some(rerun) = self.run.rerun else { return Ok(()) };
        let finished = rerun.iter().filter(|job| self.recorded.contains_key(*job));
        let finished: Vec<JobId> = finished.cloned().collect();
        if !finished.is_empty() {
            self.writer.invalidate(&finished)?;
        }
        for job in finished {
            self.old_records.extend(self.recorded.remove_entry(&job));
        }
        Ok(())
    }

    /// Adds a generation and returns its missing jobs, in plan order.
    pub(super) fn begin_generation(
        &mut self,
        generation: Generation,
        reporter: &mut dyn Reporter,
    ) -> Result<Vec<Job>> {
        let mut missing = Vec::new();
        let mut seen = BTreeSet::new();
        for point in generation.points.iter().filter(|point| point.infeasible.is_none()) {
            let id = &point.job.id;
            if !seen.insert(id.clone()) || self.records.contains_key(id) {
                continue;
            }
            match self.recorded.remove(id) {
                None => missing.push(point.job.clone()),
                Some(record) => match self.run.results.damage(&record)? {
                    None => {
                        self.records.insert(id.clone(), record);
                    }
                    Some(note) => {
                        reporter.event(&Event::Note(note));
                        self.old_records.insert(id.clone(), record);
                        missing.push(point.job.clone());
                    }
                },
            }
        }
        let finished = seen.len() - missing.len();
        if let Some(rerun) = self.run.rerun {
            missing.retain(|job| rerun.contains(&job.id));
        }
        let jobs = finished + missing.len();
        reporter.event(&Event::GenerationStarted { number: generation.number, jobs, finished });
        self.points.extend(generation.points);
        self.table_outdated = true;
        Ok(missing)
    }

    /// Runs jobs and stores them as they end.
    pub(super) fn run_jobs(&mut self, jobs: &[Job], reporter: &mut dyn Reporter) -> Result<()> {
        if jobs.is_empty() {
            return Ok(());
        }
        let pool = rayon::ThreadPoolBuilder::new()
            .num_threads(self.run.threads.map_or(0, NonZero::get))
            .thread_name(|thread| format!("billow-{thread}"))
            .build()
            .map_err(|error| Error::Disk {
                path: "threads".into(),
                problem: format!("cannot start: {error}\n  next: ask for fewer with --threads N"),
            })?;
        let capacity = MAX_MESSAGES_PER_WORKER * pool.current_num_threads();
        let (sender, receiver) = mpsc::sync_channel(capacity);
        let abort = AtomicBool::new(false);
        let stop = &self.run.stop;
        let ending = || abort.load(Ordering::Relaxed) || stop.requested().is_some();
        let executor = self.run.executor;
        std::thread::scope(|scope| {
            scope.spawn(|| workers::work(&pool, executor, jobs, &ending, sender));
            let mut stored = Ok(());
            while let Some((messages, ended)) = receive(&receiver) {
                for message in &messages {
                    if let Some(event) = workers::event(message, jobs) {
                        reporter.event(&event);
                    }
                }
                if stored.is_ok() {
                    stored = self.store(jobs, ended, reporter);
                    // After an error the workers stop. Jobs that end meanwhile run again next time.
                    abort.store(stored.is_err(), Ordering::Relaxed);
                }
            }
            stored
        })
    }

    /// Stores jobs that ended: history files first, then their records with one sync.
    fn store(
        &mut self,
        jobs: &[Job],
        ended: Vec<Ended>,
        reporter: &mut dyn Reporter,
    ) -> Result<()> {
        let mut events = Vec::with_capacity(ended.len());
        let mut records = Vec::with_capacity(ended.len());
        for Ended { index, thread, cells, deployment } in ended {
            let job = &jobs[index];
            let (mut file_hash, mut file_stamp) = (None, None);
            if let Some(deployment) = deployment {
                let path = self.run.results.job_path(&job.id);
                let hash = cells.text(ColumnId::ContentHash);
                let bytes = history_file::encode(job, &deployment, hash)
                    .map_err(|problem| Error::Disk { path, problem })?;
                file_stamp = Some(self.run.results.write_job(&job.id, &bytes)?);
                file_hash = Some(history_file::bytes_hash(&bytes));
            }
            let verdict = cells.text(ColumnId::Verdict);
            events.push(Event::JobFinished {
                id: job.id.clone(),
                thread,
                status: cells.status(),
                verdict: Some(verdict.to_owned()).filter(|text| !text.is_empty()),
            });
            records.push(Record { job: job.id.clone(), cells, file_hash, file_stamp });
        }
        for (id, reference) in self.run.executor.references() {
            self.run.results.write_reference(&id, &reference)?;
        }
        if !records.is_empty() {
            self.writer.append(&records)?;
            self.summary.ran += records.len();
            self.table_outdated = true;
            for record in &records {
                self.compare_with_old(record);
            }
            self.records.extend(records.into_iter().map(|record| (record.job.clone(), record)));
        }
        for event in &events {
            reporter.event(event);
        }
        if Instant::now() >= self.table_due {
            self.write_table()?;
        }
        Ok(())
    }

    /// Compares status and content hash of a job that ran again with its old record.
    fn compare_with_old(&mut self, record: &Record) {
        let Some(old) = self.old_records.remove(&record.job) else { return };
        let hash = |record: &Record| record.cells.text(ColumnId::ContentHash).to_owned();
        if old.cells.status() == record.cells.status() && hash(&old) == hash(record) {
            self.summary.same += 1;
        } else {
            self.summary.different.push(record.job.clone());
        }
    }

    /// Writes the table when it is outdated.
    pub(super) fn write_table(&mut self) -> Result<()> {
        if self.table_outdated {
            let table = Table::build(&self.points, &self.records, self.run.unit);
            self.run.results.write_table(&table)?;
            self.table_outdated = false;
        }
        self.table_due = Instant::now() + MIN_TABLE_INTERVAL;
        Ok(())
    }

    fn cells(&self, point: &Point) -> Option<Cells> {
        journal::cells_of(point, &self.records)
    }

    /// Finished rows for the planner, in plan order.
    pub(super) fn finished(&self) -> Vec<FinishedRow> {
        let row = |point: &Point| Some(FinishedRow::of(&point.job.id, &self.cells(point)?));
        self.points.iter().filter_map(row).collect()
    }

    /// The result of the run so far.
    pub(super) fn summary(&self) -> Summary {
        let mut summary = Summary { signal: self.run.stop.requested(), ..self.summary.clone() };
        for point in &self.points {
            let cells = self.cells(point).unwrap_or_else(|| Cells::new(Status::Pending));
            summary.counts.add_cells(&cells);
        }
        summary
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
