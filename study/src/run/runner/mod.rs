//! Running a study: plan, skip what is finished, run the rest, store every job as it ends.
//!
//! Workers (one rayon pool, over jobs only) take batches of jobs in plan order and compute. This
//! thread alone touches the disk: it stores what comes in, history file first, journal record
//! second, so that a record always has its file; whatever happens in between is run again and gives
//! the same bits. A job that is run again ([`Run::again`]) is withdrawn first, and its new history is
//! held against the hash of the one before.

use std::collections::{BTreeMap, BTreeSet};
use std::num::NonZero;
use std::sync::atomic::{AtomicBool, Ordering};
use std::sync::mpsc::{self, Receiver, RecvTimeoutError};
use std::time::{Duration, Instant};

use crate::input::study_file::Json;
use crate::job::executor::Executor;
use crate::job::point::Point;
use crate::job::row::{self, Cells, Counts};
use crate::job::{Job, JobId};
use crate::platform::error::{Error, Result};
use crate::platform::stop::Stop;
use crate::run::event::{Event, Reporter};
use crate::store::history_file;
use crate::store::journal::{self, Record, Writer};
use crate::store::results::Results;
use crate::store::table::Table;
use crate::study::plan::{FinishedRow, Generation};

mod workers;

use workers::{Ended, Message};

/// Least time between two writings of the table while jobs run.
const TABLE_INTERVAL: Duration = Duration::from_secs(10);
/// Longest time without a look at the stop flag.
const TICK: Duration = Duration::from_millis(100);
/// Most jobs stored under one sync of the journal.
const GROUP: usize = 64;

/// What to run, and with what.
pub struct Run<'a> {
    /// Name of the study.
    pub name: &'a str,
    /// The study, for study.json.
    pub study: &'a Json,
    /// [`crate::study::plan::next_jobs`] of that study.
    pub planner: &'a dyn Fn(&[FinishedRow]) -> Option<Generation>,
    /// SI unit of a parameter.
    pub unit: &'a dyn Fn(&str) -> String,
    /// Computes the jobs.
    pub executor: &'a dyn Executor,
    /// Where results go.
    pub results: Results<'a>,
    /// Threads; `None` is one a core.
    pub threads: Option<NonZero<usize>>,
    /// Asks to end early.
    pub stop: Stop,
    /// Jobs to run whether they are finished or not, and nothing else; `None` runs what is missing.
    pub again: Option<&'a BTreeSet<JobId>>,
}

/// What a run left.
#[derive(Debug, Clone, PartialEq, Eq, Default)]
pub struct Summary {
    /// How the rows ended.
    pub counts: Counts,
    /// Jobs this run has computed and stored.
    pub ran: usize,
    /// The signal that ended it early.
    pub signal: Option<i32>,
    /// Of the jobs it ran, those that had ended before and left the same history again.
    pub same: usize,
    /// Those that left another one than before, or ended otherwise.
    pub different: Vec<JobId>,
}

/// Runs what is missing of a study.
///
/// # Errors
/// [`Error::Disk`] when results cannot be read or stored; what was stored until then is kept.
pub fn run(run: &Run<'_>, reporter: &mut dyn Reporter) -> Result<Summary> {
    let _lock = run.results.lock()?;
    run.results.sweep()?;
    run.results.write_study(run.name, run.study)?;
    let journal = run.results.journal()?;
    for note in journal.notes {
        reporter.event(&Event::Note(note));
    }
    let mut state = State {
        run,
        writer: Writer::new(run.results.files(), run.results.journal_path()),
        before: journal.withdrawn,
        recorded: journal.records,
        records: BTreeMap::new(),
        points: Vec::new(),
        ran: 0,
        same: 0,
        different: Vec::new(),
        table_due: Instant::now() + TABLE_INTERVAL,
        table_stale: true,
    };
    state.withdraw()?;
    let mut finished = Vec::new();
    let mut last = None;
    while run.stop.requested().is_none()
        && let Some(generation) = (run.planner)(&finished)
        && last.is_none_or(|last| generation.number > last)
    {
        last = Some(generation.number);
        let missing = state.begin(generation, reporter)?;
        state.run_jobs(&missing, reporter)?;
        finished = state.finished();
    }
    state.write_table()?;
    reporter.event(&Event::Ended);
    Ok(state.summary())
}

struct State<'a> {
    run: &'a Run<'a>,
    writer: Writer<'a>,
    /// Records of jobs that were finished once and are no longer.
    before: BTreeMap<JobId, Record>,
    /// What the journals held at the start, not yet checked.
    recorded: BTreeMap<JobId, Record>,
    /// Sound records of planned jobs.
    records: BTreeMap<JobId, Record>,
    /// Every point planned so far.
    points: Vec<Point>,
    ran: usize,
    same: usize,
    different: Vec<JobId>,
    table_due: Instant,
    table_stale: bool,
}

impl State<'_> {
    /// Withdraws the finished ones of the jobs to run again.
    fn withdraw(&mut self) -> Result<()> {
        let Some(again) = self.run.again else { return Ok(()) };
        let finished = again.iter().filter(|job| self.recorded.contains_key(*job));
        let finished: Vec<JobId> = finished.cloned().collect();
        if !finished.is_empty() {
            self.writer.withdraw(&finished)?;
        }
        for job in finished {
            self.before.extend(self.recorded.remove_entry(&job));
        }
        Ok(())
    }

    /// Takes in a generation; gives the jobs that are missing, in plan order.
    fn begin(&mut self, generation: Generation, reporter: &mut dyn Reporter) -> Result<Vec<Job>> {
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
                        self.before.insert(id.clone(), record);
                        missing.push(point.job.clone());
                    }
                },
            }
        }
        let open = missing.len();
        if let Some(again) = self.run.again {
            missing.retain(|job| again.contains(&job.id));
        }
        reporter.event(&Event::GenerationStarted {
            number: generation.number,
            jobs: seen.len() - open + missing.len(),
            finished: seen.len() - open,
        });
        self.points.extend(generation.points);
        self.table_stale = true;
        Ok(missing)
    }

    fn run_jobs(&mut self, jobs: &[Job], reporter: &mut dyn Reporter) -> Result<()> {
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
        // Bounded, so that results wait with the workers and not in memory when the disk is slow.
        let (sender, receiver) = mpsc::sync_channel(4 * pool.current_num_threads());
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
                    // The workers stop; what they still send is dropped, and run again next time.
                    abort.store(stored.is_err(), Ordering::Relaxed);
                }
            }
            stored
        })
    }

    /// Stores jobs that ended: history files, then their records under one sync.
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
            let mut file_hash = None;
            if let Some(deployment) = deployment {
                let path = self.run.results.job_path(&job.id);
                let bytes = history_file::encode(job, &deployment, cells.text("content_hash"))
                    .map_err(|problem| Error::Disk { path, problem })?;
                self.run.results.write_job(&job.id, &bytes)?;
                file_hash = Some(history_file::bytes_hash(&bytes));
            }
            events.push(Event::JobFinished {
                id: job.id.clone(),
                thread,
                status: cells.status().to_owned(),
                verdict: Some(cells.text("verdict").to_owned()).filter(|text| !text.is_empty()),
            });
            records.push(Record { job: job.id.clone(), cells, file_hash });
        }
        for (id, reference) in self.run.executor.references() {
            self.run.results.write_reference(&id, &reference)?;
        }
        if !records.is_empty() {
            self.writer.append(&records)?;
            self.ran += records.len();
            self.table_stale = true;
            for record in &records {
                self.hold_against(record);
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

    /// Counts whether a job that had ended before ended the same.
    fn hold_against(&mut self, record: &Record) {
        let Some(before) = self.before.remove(&record.job) else { return };
        let end = |record: &Record| {
            let text = |name: &str| record.cells.text(name).to_owned();
            [text("status"), text("content_hash")]
        };
        if end(&before) == end(record) {
            self.same += 1;
        } else {
            self.different.push(record.job.clone());
        }
    }

    fn write_table(&mut self) -> Result<()> {
        if self.table_stale {
            let table = Table::build(&self.points, &self.records, self.run.unit);
            self.run.results.write_table(&table)?;
            self.table_stale = false;
        }
        self.table_due = Instant::now() + TABLE_INTERVAL;
        Ok(())
    }

    fn cells(&self, point: &Point) -> Option<Cells> {
        journal::cells_of(point, &self.records)
    }

    /// What planning may know, in plan order.
    fn finished(&self) -> Vec<FinishedRow> {
        let row = |point: &Point| Some(FinishedRow::of(&point.job.id, &self.cells(point)?));
        self.points.iter().filter_map(row).collect()
    }

    fn summary(&self) -> Summary {
        let mut summary = Summary {
            ran: self.ran,
            signal: self.run.stop.requested(),
            same: self.same,
            different: self.different.clone(),
            ..Summary::default()
        };
        for point in &self.points {
            let cells = self.cells(point).unwrap_or_else(|| Cells::new(row::PENDING));
            summary.counts.add_cells(&cells);
        }
        summary
    }
}

/// What came in since the last look, ended jobs apart; `None` when no worker is left.
fn receive(receiver: &Receiver<Message>) -> Option<(Vec<Message>, Vec<Ended>)> {
    let mut messages = Vec::new();
    let mut ended = Vec::new();
    let mut next = match receiver.recv_timeout(TICK) {
        Ok(message) => Some(message),
        Err(RecvTimeoutError::Timeout) => None,
        Err(RecvTimeoutError::Disconnected) => return None,
    };
    while let Some(message) = next {
        match message {
            Message::Ended(job) => ended.push(*job),
            other => messages.push(other),
        }
        next = if ended.len() < GROUP { receiver.try_recv().ok() } else { None };
    }
    Some((messages, ended))
}

#[cfg(test)]
mod rerun_tests;
#[cfg(test)]
mod tests;
