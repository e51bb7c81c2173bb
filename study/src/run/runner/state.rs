//! The thread of a run that stores results: what is finished, what is missing, what came back.

use std::collections::{BTreeMap, BTreeSet};
use std::sync::Arc;
use std::time::{Duration, Instant};

use super::attempt_log::AttemptLog;
use super::quarantine::{self, Deaths};
use super::workers::Ended;
use super::{Run, RunResult, Summary};
use crate::job::point::Point;
use crate::job::row::ColumnId;
use crate::job::{Job, JobId};
use crate::platform::error::{Error, Result};
use crate::platform::hash::bytes_hash;
use crate::run::event::{Event, Reporter};
use crate::store::finished;
use crate::store::history_file;
use crate::store::journal::{self, Journal, Record};
use crate::study::finished::FinishedRow;
use crate::study::plan::{self, Generation};

/// Time between two writes of the table while jobs run, at least. Chosen: a reader sees new rows
/// soon, and writing takes little of a run.
const MIN_TABLE_INTERVAL: Duration = Duration::from_secs(10);
/// The same over the time that a write takes, at least. Chosen: a twentieth of a run at most.
const MIN_TABLE_RATIO: u32 = 20;

mod dispatch;

/// State of a run.
pub(super) struct State<'a, 'w> {
    run: &'a Run<'a>,
    log: &'a AttemptLog<'w>,
    /// Old records of jobs that must run again, for comparison.
    old_records: BTreeMap<JobId, Record>,
    /// Records of the journals that are not yet checked against their files.
    recorded: BTreeMap<JobId, Record>,
    /// Records of planned jobs, with undamaged files, and those of [`Run::known`].
    records: BTreeMap<JobId, Record>,
    /// Deaths of earlier processes.
    deaths: Deaths,
    /// Every point planned so far.
    points: Arc<Vec<Point>>,
    summary: Summary,
    table_due: Instant,
    table_outdated: bool,
}

impl<'a, 'w> State<'a, 'w> {
    /// The state at the start, with the journals of earlier runs.
    pub(super) fn new(run: &'a Run<'a>, log: &'a AttemptLog<'w>, journal: Journal) -> Self {
        Self {
            run,
            log,
            old_records: journal.invalidated,
            recorded: journal.records,
            records: run.known.clone(),
            deaths: Deaths::new(journal.deaths),
            points: Arc::default(),
            summary: Summary::default(),
            table_due: Instant::now() + MIN_TABLE_INTERVAL,
            table_outdated: true,
        }
    }

    /// Removes the checkpoints of jobs that have ended: those of a process that died in between.
    pub(super) fn remove_checkpoints(&self) -> Result<()> {
        for id in self.log.stored() {
            if self.recorded.get(&id).is_some_and(|record| !record.reached_limit()) {
                self.log.remove(&id)?;
            }
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
            let number = seen.len();
            if !seen.insert(id.clone()) || self.records.contains_key(id) {
                continue;
            }
            let again = self.run.rerun.is_some_and(|jobs| jobs.contains(id));
            if !self.must_run(id, again, reporter)? {
                continue;
            }
            if self.run.selection.takes(number) {
                missing.push(point.job.clone());
            } else {
                self.summary.not_selected += 1;
            }
        }
        match self.run.rerun {
            Some(jobs) => {
                missing.retain(|job| jobs.contains(&job.id));
                for job in &missing {
                    self.deaths.forget(&job.id);
                }
            }
            None => self.quarantine(&mut missing, reporter)?,
        }
        let suspects = missing.iter().filter(|job| self.deaths.is_suspect(&job.id));
        if let Some(note) = quarantine::suspects_note(suspects, self.run.label) {
            reporter.event(&Event::Note(note));
        }
        let to_run: BTreeSet<&JobId> = missing.iter().map(|job| &job.id).collect();
        let is_finished = |id: &&JobId| self.records.contains_key(*id) && !to_run.contains(id);
        let finished = seen.iter().filter(is_finished).count();
        let jobs = finished + missing.len();
        reporter.event(&Event::GenerationStarted { number: generation.number, jobs, finished });
        plan::add_generation(&mut self.points, generation);
        self.table_outdated = true;
        Ok(missing)
    }

    /// Whether a job has no record with an undamaged file, or must run `again`.
    fn must_run(&mut self, id: &JobId, again: bool, reporter: &mut dyn Reporter) -> Result<bool> {
        let Some(record) = self.recorded.remove(id) else { return Ok(true) };
        match self.run.results.damage(&record)? {
            None => {
                // The record of a job to run again counts until its new one is there.
                if again {
                    self.old_records.insert(id.clone(), record.clone());
                }
                self.records.insert(id.clone(), record);
                Ok(again)
            }
            Some(note) => {
                reporter.event(&Event::Note(note));
                let path = self.run.results.job_path(id);
                if path.is_dir() {
                    self.run.results.set_aside(&path)?;
                }
                self.old_records.insert(id.clone(), record);
                Ok(true)
            }
        }
    }

    /// Stores jobs that ended: history files first, then their records with one sync.
    fn store(
        &mut self,
        jobs: &[Job],
        ended: Vec<Ended>,
        reporter: &mut dyn Reporter,
    ) -> Result<()> {
        if !ended.is_empty() {
            self.log.check_folder()?;
        }
        let ended = self.without_limited_reruns(jobs, ended, reporter);
        let replaced = ended.iter().map(|ended| &jobs[ended.index].id);
        let replaced: Vec<JobId> =
            replaced.filter(|id| self.records.contains_key(*id)).cloned().collect();
        if !replaced.is_empty() {
            self.log.writer().invalidate(&replaced)?;
        }
        let mut events = Vec::with_capacity(ended.len());
        let mut records = Vec::with_capacity(ended.len());
        for Ended { index, thread, cells, deployment, reservation } in ended {
            let job = &jobs[index];
            let (mut file_hash, mut file_stamp) = (None, None);
            if let Some(deployment) = deployment {
                let path = self.run.results.job_path(&job.id);
                let hash = cells.text(ColumnId::ContentHash);
                let bytes = history_file::encode(job, &deployment, hash)
                    .map_err(|problem| Error::Disk { path, problem })?;
                file_stamp = Some(self.run.results.write_job(&job.id, &bytes)?);
                file_hash = Some(bytes_hash(&bytes));
            }
            let verdict = cells.text(ColumnId::Verdict);
            events.push(Event::JobFinished {
                id: job.id.clone(),
                thread,
                status: cells.status(),
                verdict: Some(verdict.to_owned()).filter(|text| !text.is_empty()),
            });
            records.push(Record { job: job.id.clone(), cells, file_hash, file_stamp });
            drop(reservation);
        }
        if !records.is_empty() {
            self.log.writer().append(&records)?;
            self.summary.ran += records.len();
            self.table_outdated = true;
            for record in &records {
                self.compare_with_old(record);
            }
            for record in &records {
                if !record.reached_limit() {
                    self.log.remove(&record.job)?;
                }
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

    /// Leaves out jobs that ran again and reached a limit, where an earlier attempt reached none: that result
    /// is kept.
    fn without_limited_reruns(
        &self,
        jobs: &[Job],
        mut ended: Vec<Ended>,
        reporter: &mut dyn Reporter,
    ) -> Vec<Ended> {
        ended.retain(|ended| {
            let id = &jobs[ended.index].id;
            let old = self.records.get(id).filter(|old| !old.reached_limit());
            let kept =
                old.is_some() && ended.deployment.is_none() && ended.cells.status().is_limit();
            if kept {
                let reason = ended.cells.text(ColumnId::Reason);
                let id = id.short();
                reporter.event(&Event::Note(format!("job {id} keeps its result; again: {reason}")));
            }
            !kept
        });
        ended
    }

    /// Compares status and content hash of a job that ran again with its old record.
    fn compare_with_old(&mut self, record: &Record) {
        let Some(old) = self.old_records.remove(&record.job) else { return };
        if old.reached_limit() || record.reached_limit() {
            // There are no bits to compare.
            return;
        }
        let hash = |record: &Record| record.cells.text(ColumnId::ContentHash).to_owned();
        if old.cells.status() == record.cells.status() && hash(&old) == hash(record) {
            self.summary.same += 1;
        } else {
            self.summary.different.push(record.job.clone());
        }
    }

    /// Writes the table when it is outdated.
    pub(super) fn write_table(&mut self) -> Result<()> {
        let start = Instant::now();
        // A run that was stopped before its plan leaves the table as it is.
        if self.table_outdated && !self.points.is_empty() {
            self.log.check_folder()?;
            let table = (self.run.table)(&self.points, &self.records);
            self.run.results.write_table(table)?;
            self.table_outdated = false;
        }
        let now = Instant::now();
        self.table_due = now + MIN_TABLE_INTERVAL.max((now - start) * MIN_TABLE_RATIO);
        Ok(())
    }

    /// Finished rows for the planner, in plan order.
    pub(super) fn finished(&self) -> Vec<FinishedRow> {
        finished::rows(&self.points, &self.records, self.run.judging)
    }

    /// The result of the run so far.
    pub(super) fn into_result(self) -> RunResult {
        let Self { points, records, .. } = self;
        let mut summary = Summary { signal: self.run.stop.requested(), ..self.summary };
        for point in points.iter() {
            summary.counts.add_cells(&journal::row_of(point, &records));
        }
        RunResult { summary, points, records }
    }
}
