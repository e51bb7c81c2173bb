//! Checks a results folder: every file that a run must have written exists, is complete and is
//! unchanged, and there are no other files. It changes nothing.
//!
//! A *fault* is damage: a result is lost, or cannot be read. A *note* is not: a torn last line, a
//! temporary file of a killed process, an unknown file. Each finding has a next step. [`repair`] does it.

use std::collections::BTreeSet;
use std::path::{Path, PathBuf};

use crate::job::JobId;
use crate::job::point::Point;
use crate::platform::error::Error;
use crate::platform::files::disk_error;
use crate::platform::quote;
use crate::store::journal::{Journal, Record};
use crate::store::results::Results;
use crate::store::stored::{self, Stored};
use crate::study::Study;

mod histories;
mod kinds;
pub mod repair;
mod unknown_files;

/// What to do about a damaged job.
const RUN_AGAIN: &str =
    "run `billow doctor --repair`, then `billow run` of its study: it runs the job again";

/// What to do about a damaged file that is written again from others.
const REPAIR: &str = "run `billow run` of its study, or `billow doctor --repair`";

/// What to do about what only a repair changes.
const REPAIR_ONLY: &str = "run `billow doctor --repair`";

/// What is wrong with a table that was changed, or is older than its journal.
const OTHER_TABLE: &str = "not the table of plan and journal";

/// Something found.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Finding {
    /// Whether it is damage.
    pub fault: bool,
    /// File or folder.
    pub path: PathBuf,
    /// What is wrong.
    pub problem: String,
    /// The next step.
    pub next: String,
}

/// Result of a check.
#[derive(Debug, Clone, PartialEq, Eq, Default)]
pub struct Health {
    /// Faults first, then notes, both in the order of the check.
    pub findings: Vec<Finding>,
    /// Number of jobs that the journals record as ended.
    pub records: usize,
    /// Number of history files checked.
    pub histories: usize,
    /// Number of checkpoints of jobs that have not ended.
    pub checkpoints: usize,
    /// Whether another process is running the study.
    pub running: bool,
}

impl Health {
    /// Number of faults.
    pub fn faults(&self) -> usize {
        self.findings.iter().filter(|finding| finding.fault).count()
    }

    fn fault(&mut self, path: &Path, problem: impl Into<String>, next: &str) {
        self.add(true, path, problem.into(), next);
    }

    fn note(&mut self, path: &Path, problem: impl Into<String>, next: &str) {
        self.add(false, path, problem.into(), next);
    }

    fn add(&mut self, fault: bool, path: &Path, problem: String, next: &str) {
        let path = path.to_owned();
        self.findings.push(Finding { fault, path, problem, next: next.to_owned() });
    }

    /// Adds an error as a fault: its text without the next step, and the next step.
    fn error(&mut self, path: &Path, error: &Error) {
        let (path, text) = match error {
            Error::Disk { path, problem } => (path.clone(), problem.clone()),
            other => (path.to_owned(), other.to_string()),
        };
        let (problem, next) = text.split_once("\n  next: ").unwrap_or((&text, ""));
        let problem = problem.split_whitespace().collect::<Vec<_>>().join(" ");
        self.fault(&path, problem, next);
    }
}

/// Checks a results folder.
pub fn examine(results: &Results<'_>) -> Health {
    let mut health = Health::default();
    if let Some(paths) = begin(results, &mut health) {
        let study = check_study(results, &mut health);
        let journal = check_journal(results, &mut health);
        let points = study.as_ref().map(|study| stored::planned(study, &journal));
        if let Some(points) = &points {
            note_unplanned(results, points, &journal, &mut health);
        }
        check_files(results, &journal, &paths, &mut health);
        if let (Some(study), Some(points)) = (study, points) {
            let units = study.display_units().clone();
            let stored = Stored { results: results.clone(), study, units, journal, points };
            check_table(&stored, &mut health);
        }
        health.findings.sort_by_key(|finding| !finding.fault);
    }
    let root = quote::path(results.root());
    for finding in &mut health.findings {
        let repair = format!("`billow doctor --repair {root}`");
        finding.next = finding.next.replace("`billow doctor --repair`", &repair);
    }
    health
}

/// The entries of a results folder; `None` where nothing more can be checked.
fn begin(results: &Results<'_>, health: &mut Health) -> Option<Vec<PathBuf>> {
    let paths = match results.files().list(results.root()) {
        Ok(paths) => paths,
        Err(error) => {
            health.error(results.root(), &disk_error(results.root(), &error));
            return None;
        }
    };
    if paths.is_empty() {
        let next = "run `billow run STUDY` first, or name the folder of its results";
        health.fault(results.root(), "no results here", next);
        return None;
    }
    match results.is_running() {
        Ok(running) => health.running = running,
        Err(error) => health.error(results.root(), &error),
    }
    let misplaced = kinds::misplaced(results);
    if !misplaced.is_empty() {
        for (path, problem) in misplaced {
            // A repair needs these two itself.
            let needed = [results.lock_path(), results.damaged_path()];
            let next = if needed.contains(&path) { "move it away" } else { REPAIR_ONLY };
            health.fault(&path, format!("{problem}; other files are not checked"), next);
        }
        return None;
    }
    Some(paths)
}

/// Notes the finished jobs that the study does not plan.
fn note_unplanned(results: &Results<'_>, points: &[Point], journal: &Journal, health: &mut Health) {
    let planned: BTreeSet<&JobId> = points.iter().map(|point| &point.job.id).collect();
    let unplanned = journal.records.keys().filter(|id| !planned.contains(id)).count();
    if unplanned > 0 {
        let problem = format!("{unplanned} finished jobs are not in the study as it is now");
        let next = "nothing; they are used again when the grid has their points, except those of \
                    another physics version";
        health.note(&results.journal_path(), problem, next);
    }
}

/// Checks the files beside study.json, journals and table.
fn check_files(results: &Results<'_>, journal: &Journal, paths: &[PathBuf], health: &mut Health) {
    histories::check(results, journal, health);
    let is_known = |id: &JobId| {
        let record = journal.records.get(id);
        record.is_some_and(|record| record.file_hash.is_some())
            || journal.invalidated.contains_key(id)
    };
    unknown_files::check(results, &is_known, paths, health);
    check_checkpoints(results, health);
    let is_open = |id: &JobId| journal.records.get(id).is_none_or(Record::reached_limit);
    health.checkpoints =
        results.checkpoints().unwrap_or_default().iter().filter(|id| is_open(id)).count();
    health.records = journal.records.len();
}

fn check_checkpoints(results: &Results<'_>, health: &mut Health) {
    match results.damaged_checkpoints() {
        Ok(damaged) => {
            for (path, problem) in damaged {
                health.fault(&path, format!("damaged checkpoint: {problem}"), REPAIR);
            }
        }
        Err(error) => health.error(&results.checkpoints_path(), &error),
    }
}

/// The study of the run before, which only the report reads.
fn check_previous(results: &Results<'_>, health: &mut Health) {
    let path = results.previous_path();
    if path.is_file() && Study::load(&path, &[]).is_err() {
        let next = "remove it: a report then compares with no run before";
        health.note(&path, "not a study that this program reads".to_owned(), next);
    }
}

fn check_study(results: &Results<'_>, health: &mut Health) -> Option<Study> {
    let path = results.study_path();
    let root = quote::path(results.root());
    let next = format!(
        "run `billow doctor --repair {root}`, or `billow run STUDY --results {root}` with the study file: it \
         writes the file again"
    );
    match results.owner() {
        Err(error) => health.error(&path, &error),
        Ok(None) => health.fault(&path, "missing: nothing says which study this is", &next),
        Ok(Some(_)) => match Study::load(&path, &[]) {
            Ok(study) => {
                check_previous(results, health);
                return Some(study);
            }
            Err(error) => {
                health.error(&path, &error);
                if let Some(last) = health.findings.last_mut() {
                    last.next = next;
                }
            }
        },
    }
    None
}

fn check_journal(results: &Results<'_>, health: &mut Health) -> Journal {
    let folder = results.journal_path();
    let journal = match results.journal() {
        Ok(journal) => journal,
        Err(error) => {
            health.error(&folder, &error);
            return Journal::default();
        }
    };
    note_journal(results, &journal, health);
    journal
}

/// Says what is wrong with the journals, and what remains to be done.
fn note_journal(results: &Results<'_>, journal: &Journal, health: &mut Health) {
    let folder = results.journal_path();
    for fault in &journal.faults {
        let problem = format!("line {}: {}; its job counts as not run", fault.line, fault.problem);
        if !fault.torn {
            health.fault(&fault.path, problem, REPAIR);
        } else if health.running {
            health.note(&fault.path, problem, "nothing; a running command is writing it");
        } else {
            health.note(&fault.path, problem, REPAIR);
        }
    }
    if !journal.invalidated.is_empty() {
        let number = journal.invalidated.len();
        let problem = format!("{number} jobs are invalidated and have not run again yet");
        health.note(&folder, problem, "run `billow run` of its study: it runs them");
    }
}

/// Compares the summary table with plan and journal.
fn check_table(stored: &Stored<'_>, health: &mut Health) {
    let path = stored.results.table_path();
    match stored.results.holds_table(stored.table()) {
        Err(error) => health.error(&path, &error),
        Ok(None) if health.running => {}
        Ok(None) => {
            let next = "nothing: `billow table` reads the journal; `billow run` of its study writes the table";
            health.note(&path, "no table yet", next);
        }
        Ok(Some(true)) => {}
        Ok(Some(false)) if is_of_other_physics(stored) => {
            let next = "nothing; `billow run` of its study computes its jobs again";
            health.note(&path, "rows of another physics version, which are not checked", next);
        }
        Ok(Some(false)) if health.running => {
            let next = "nothing; the running command writes it from time to time";
            health.note(&path, OTHER_TABLE, next);
        }
        Ok(Some(false)) if stored.results.attempts_path().exists() => {
            let problem = "older than the journal: the last run died before it wrote the table";
            health.note(&path, problem, "nothing; the next `billow run` of its study writes it");
        }
        Ok(Some(false)) => health.fault(&path, OTHER_TABLE, REPAIR),
    }
}

/// Whether every record is one of another physics version, so that no row of the plan has a result.
fn is_of_other_physics(stored: &Stored<'_>) -> bool {
    let records = &stored.journal.records;
    let others = stored::other_physics(&stored.points, records);
    !records.is_empty() && others.values().sum::<usize>() == records.len()
}
