//! Runs a study: plans, skips finished jobs, runs the others, stores every job as it ends.
//!
//! The workers (one rayon pool, over jobs only) take jobs in plan order and compute. The
//! calling thread stores results (`state`): the history file of a job first and its journal record
//! second, so a record always has its file. A job that was interrupted in between runs again and gives
//! the same bits. A worker writes only the line of its attempt and the checkpoints of its job
//! (`attempt_log`).
//!
//! A job that is run again ([`Run::rerun`]) keeps its record until its new result is stored. Its new history is
//! compared with the hash of the old one.

use std::collections::{BTreeMap, BTreeSet};
use std::num::NonZero;
use std::sync::Arc;
use std::time::Duration;

use crate::input::json::Json;
use crate::job::executor::Executor;
use crate::job::limits::JobLimits;
use crate::job::point::Point;
use crate::job::row::Counts;
use crate::job::{JobId, Parameters};
use crate::platform::error::Result;
use crate::platform::stop::Stop;
use crate::run::event::{Event, Reporter};
use crate::run::exclusive;
use crate::run::selection::Selection;
use crate::store::journal::Record;
use crate::store::results::Results;
use crate::store::table::Table;
use crate::study::finished::{FinishedRow, Judging};
use crate::study::plan::Generation;

mod attempt_log;
mod quarantine;
mod state;
mod workers;

use attempt_log::AttemptLog;
use state::State;

/// Time between two checkpoints of a job, at least. Chosen: a crash loses little, and a short job has none.
pub const CHECKPOINT_INTERVAL: Duration = Duration::from_secs(30);

/// Builds the table of planned points from the records of their jobs.
pub type TableOf<'a> = dyn Fn(&[Point], &BTreeMap<JobId, Record>) -> Table + 'a;

/// What to run, and with what.
pub struct Run<'a> {
    /// Name of the study.
    pub name: &'a str,
    /// The file of the study, for study.json.
    pub study: &'a Json,
    /// [`crate::study::plan::next_jobs`] of that study.
    pub planner: &'a dyn Fn(&[FinishedRow]) -> Option<Generation>,
    /// What its results are judged by.
    pub judging: Judging<'a>,
    /// The table of the points planned so far, from the records of their jobs.
    pub table: &'a TableOf<'a>,
    /// The parameters of a job as text, for messages.
    pub label: &'a dyn Fn(&Parameters) -> String,
    /// Computes the jobs.
    pub executor: &'a dyn Executor,
    /// Folder of the results.
    pub results: Results<'a>,
    /// Number of threads; `None` for one per core.
    pub threads: Option<NonZero<usize>>,
    /// Limits of every job.
    pub limits: JobLimits,
    /// Time between two checkpoints of a job, at least: [`CHECKPOINT_INTERVAL`].
    pub checkpoint_interval: Duration,
    /// Requests an early stop.
    pub stop: Stop,
    /// Runs only these jobs, also finished ones; `None` runs every job that is not finished.
    pub rerun: Option<&'a BTreeSet<JobId>>,
    /// The jobs of the plan that this run takes.
    pub selection: Selection,
    /// Jobs that have ended in the results of which these are a part: they do not run again.
    pub known: BTreeMap<JobId, Record>,
}

/// Result of a run.
#[derive(Debug, Clone, PartialEq, Eq, Default)]
pub struct Summary {
    /// Numbers of rows by how they ended.
    pub counts: Counts,
    /// Number of jobs that this run computed and stored.
    pub ran: usize,
    /// The signal that stopped it early.
    pub signal: Option<i32>,
    /// Number of jobs that had ended before and gave the same status and history again.
    pub same: usize,
    /// Jobs that had ended before and gave another status or history.
    pub different: Vec<JobId>,
    /// Number of unfinished jobs that are not in this run's selection.
    pub not_selected: usize,
}

/// What a run leaves in memory; the results folder has it too.
pub struct RunResult {
    /// How it ended.
    pub summary: Summary,
    /// Every point planned.
    pub points: Arc<Vec<Point>>,
    /// The records of their jobs.
    pub records: BTreeMap<JobId, Record>,
}

/// Runs the jobs of a study that are not finished.
///
/// # Errors
/// [`crate::platform::error::Error::Disk`] when results cannot be read or stored. Jobs that were
/// stored before are kept.
pub fn run(run: &Run<'_>, reporter: &mut dyn Reporter) -> Result<RunResult> {
    let lock = run.results.lock()?;
    let opened = exclusive::open(&run.results, Some((run.name, run.study)))?;
    for fault in &opened.faults {
        reporter.event(&Event::Note(fault.to_string()));
    }
    let log = AttemptLog::new(&run.results, &lock, opened.writer)?;
    let mut state = State::new(run, &log, opened.journal);
    state.remove_checkpoints()?;
    run_generations(run, &mut state, reporter)?;
    state.write_table()?;
    reporter.event(&Event::Ended);
    Ok(state.into_result())
}

/// Runs one generation after another, until a job of one is not finished.
fn run_generations(
    run: &Run<'_>,
    state: &mut State<'_, '_>,
    reporter: &mut dyn Reporter,
) -> Result<()> {
    let mut finished = Vec::new();
    let mut last = None;
    while run.stop.requested().is_none()
        && let Some(generation) = (run.planner)(&finished)
        && last.is_none_or(|last| generation.number > last)
    {
        last = Some(generation.number);
        let missing = state.begin_generation(generation, reporter)?;
        state.run_jobs(missing, reporter)?;
        finished = state.finished();
    }
    Ok(())
}

#[cfg(test)]
mod attempt_tests;
#[cfg(test)]
mod rerun_tests;
#[cfg(test)]
mod tests;
