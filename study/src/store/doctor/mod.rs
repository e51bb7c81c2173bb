//! Whether a results folder is sound: every file that should be there is, whole and as it was
//! written, and nothing else lies there. It changes nothing.
//!
//! A *fault* is something broken: a result is lost, or cannot be read. A *note* is not: a torn last
//! line, a leftover of a killed process, a file nobody named. Each says what to do.

use std::collections::{BTreeMap, BTreeSet};
use std::io;
use std::path::{Path, PathBuf};

use crate::job::JobId;
use crate::platform::error::Error;
use crate::platform::files::{self, disk_error};
use crate::store::history_file;
use crate::store::journal::{self, Journal, Record};
use crate::store::results::{OURS, Results};
use crate::store::stored::{self, Stored};
use crate::store::table::Table;
use crate::study::Study;

/// What other commands leave in a results folder.
const ALSO_OURS: [&str; 1] = ["report.html"];
/// What runs a job again, or writes a table.
const RUN: &str = "`billow run` of its study runs the job again";

/// How deep to look.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Depth {
    /// Which files are there.
    Names,
    /// What is in them, too.
    Contents,
}

/// Something found.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Finding {
    /// Whether something is broken.
    pub fault: bool,
    /// Where.
    pub path: PathBuf,
    /// What.
    pub problem: String,
    /// What to do.
    pub next: String,
}

/// What an examination came to.
#[derive(Debug, Clone, PartialEq, Eq, Default)]
pub struct Health {
    /// Faults first, each kind in the order of the folder.
    pub findings: Vec<Finding>,
    /// Jobs the journals record as ended.
    pub records: usize,
    /// History files looked at.
    pub histories: usize,
    /// Whether another process is running the study.
    pub running: bool,
}

impl Health {
    /// How many things are broken.
    pub fn faults(&self) -> usize {
        self.findings.iter().filter(|finding| finding.fault).count()
    }

    fn fault(&mut self, path: &Path, problem: impl Into<String>, next: &str) {
        self.find(true, path, problem.into(), next);
    }

    fn note(&mut self, path: &Path, problem: impl Into<String>, next: &str) {
        self.find(false, path, problem.into(), next);
    }

    fn find(&mut self, fault: bool, path: &Path, problem: String, next: &str) {
        let path = path.to_owned();
        self.findings.push(Finding { fault, path, problem, next: next.to_owned() });
    }

    /// An error of any kind as a fault: its first line, and what it says to do.
    fn error(&mut self, path: &Path, error: &Error) {
        let text = match error {
            Error::Disk { path, problem } => (path.clone(), problem.clone()),
            other => (path.to_owned(), other.to_string()),
        };
        let (path, text) = text;
        let (problem, next) = text.split_once("\n  next: ").unwrap_or((&text, ""));
        let problem = problem.split_whitespace().collect::<Vec<_>>().join(" ");
        self.fault(&path, problem, next);
    }
}

/// Looks at a results folder.
pub fn examine(results: &Results<'_>, depth: Depth) -> Health {
    let mut health = Health::default();
    let names = match results.files().list(results.root()) {
        Ok(names) => names,
        Err(error) => {
            health.error(results.root(), &disk_error(results.root(), &error));
            return health;
        }
    };
    if names.is_empty() {
        let next = "`billow run STUDY` first, or name the folder of its results";
        health.fault(results.root(), "no results here", next);
        return health;
    }
    match results.is_locked() {
        Ok(running) => health.running = running,
        Err(error) => health.error(results.root(), &error),
    }
    let study = study(results, &mut health);
    let journal = journal(results, &mut health);
    let points = study.as_ref().map(|study| stored::planned(study, &journal.records));
    if let Some(points) = &points {
        let planned: BTreeSet<&JobId> = points.iter().map(|point| &point.job.id).collect();
        let left = journal.records.keys().filter(|id| !planned.contains(id)).count();
        if left > 0 {
            let problem = format!("{left} finished jobs are not in the study as it is now");
            health.note(
                &results.journal_path(),
                problem,
                "nothing; a grid that names them again finds them",
            );
        }
    }
    histories(results, &journal, depth, &mut health);
    strays(results, &journal, &names, &mut health);
    for path in results.unread_references() {
        let problem = "static states that cannot be read, or of another physics version";
        health.note(&path, problem.to_owned(), "nothing; a run that needs them finds them again");
    }
    health.records = journal.records.len();
    if let (Some(study), Some(points)) = (study, points) {
        let stored = Stored { results: results.clone(), study, journal, points };
        table(&stored, &mut health);
    }
    health.findings.sort_by_key(|finding| !finding.fault);
    health
}

fn study(results: &Results<'_>, health: &mut Health) -> Option<Study> {
    let path = results.study_path();
    let next = format!("billow run STUDY --results {} writes it again", results.root().display());
    match results.owner() {
        Err(error) => health.error(&path, &error),
        Ok(None) => health.fault(&path, "missing: nothing says which study this is", &next),
        Ok(Some(_)) => match Study::load(&path, &[]) {
            Ok(study) => return Some(study),
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

fn journal(results: &Results<'_>, health: &mut Health) -> Journal {
    let folder = results.journal_path();
    let (journal, faults) = match journal::examine(results.files(), &folder) {
        Ok(read) => read,
        Err(error) => {
            health.error(&folder, &error);
            return Journal::default();
        }
    };
    for fault in &faults {
        health.error(&folder, fault);
    }
    for note in &journal.notes {
        // A note names its file before the first colon and space.
        let (path, text) = note.split_once(": ").unwrap_or(("", note));
        let next = if health.running {
            "nothing; it is being written"
        } else {
            "`billow run` of its study"
        };
        health.note(Path::new(path), text, next);
    }
    if !journal.withdrawn.is_empty() {
        let problem =
            format!("{} jobs are withdrawn and have not run again yet", journal.withdrawn.len());
        health.note(&folder, problem, "`billow run` of its study runs them");
    }
    journal
}

/// The history file of every record.
fn histories(results: &Results<'_>, journal: &Journal, depth: Depth, health: &mut Health) {
    let mut listed: BTreeMap<PathBuf, BTreeSet<PathBuf>> = BTreeMap::new();
    for record in journal.records.values() {
        let Some(hash) = &record.file_hash else { continue };
        let path = results.job_path(&record.job);
        let folder = path.parent().unwrap_or(&path).to_owned();
        let there = listed.entry(folder).or_insert_with_key(|folder| {
            results.files().list(folder).unwrap_or_default().into_iter().collect()
        });
        if !there.contains(&path) {
            health.fault(&path, "missing", RUN);
            continue;
        }
        health.histories += 1;
        if depth == Depth::Contents {
            match results.files().read(&path) {
                Ok(bytes) => contents(&path, record, hash, &bytes, health),
                Err(error) => health.error(&path, &disk_error(&path, &error)),
            }
        }
    }
}

fn contents(path: &Path, record: &Record, hash: &str, bytes: &[u8], health: &mut Health) {
    let read = history_file::read(path);
    if history_file::bytes_hash(bytes) != hash {
        let why = match &read {
            Err(Error::Disk { problem, .. }) => problem.split('\n').next().unwrap_or("").to_owned(),
            Err(other) => other.to_string(),
            Ok(_) => "a whole history, but another one".to_owned(),
        };
        return health.fault(path, format!("not the file that was written ({why})"), RUN);
    }
    let stored = match read {
        Ok(stored) => stored,
        Err(error) => return health.error(path, &error),
    };
    let cells = &record.cells;
    for (what, file, row) in [
        ("job", stored.job.as_str(), record.job.as_str()),
        ("status", stored.status.as_str(), cells.status()),
        ("content_hash", stored.content_hash.as_str(), cells.text("content_hash")),
    ] {
        if file != row {
            health.fault(path, format!("its {what} is {file:?}, the journal says {row:?}"), RUN);
        }
    }
}

/// Files that no record names, leftovers of killed processes, and what is not ours.
fn strays(results: &Results<'_>, journal: &Journal, names: &[PathBuf], health: &mut Health) {
    let name = |path: &Path| path.file_name().unwrap_or_default().to_string_lossy().into_owned();
    let foreign = "nothing; billow does not look at it";
    let leftover = if health.running {
        "nothing; it is being written"
    } else {
        "the next `billow run` of its study removes it"
    };
    for path in names {
        let own = name(path);
        if files::is_temporary(path) {
            health.note(path, "a file left half written", leftover);
        } else if !OURS.contains(&own.as_str()) && !ALSO_OURS.contains(&own.as_str()) {
            health.note(path, "not a file of billow", foreign);
        }
    }
    let list = |folder: &Path| -> io::Result<Vec<PathBuf>> { results.files().list(folder) };
    let journals = list(&results.journal_path()).unwrap_or_default();
    for path in journals.iter().filter(|path| !journal::is_journal(path)) {
        health.note(path, "not a file of billow", foreign);
    }
    let folders = match list(&results.root().join("jobs")) {
        Ok(folders) => folders,
        Err(error) => return health.error(results.root(), &disk_error(results.root(), &error)),
    };
    let has_file = |record: &Record| record.file_hash.is_some();
    for folder in folders {
        let own = name(&folder);
        if own.len() != 2 || !own.bytes().all(|byte| byte.is_ascii_hexdigit()) {
            health.note(&folder, "not a file of billow", foreign);
            continue;
        }
        if !folder.is_dir() {
            health.fault(&folder, "a file where a folder of histories belongs", "move it away");
            continue;
        }
        let paths = match list(&folder) {
            Ok(paths) => paths,
            Err(error) => {
                health.error(&folder, &disk_error(&folder, &error));
                continue;
            }
        };
        for path in paths {
            let own = name(&path);
            let id = own.strip_suffix(".h5").and_then(JobId::from_digits);
            match id.filter(|id| results.job_path(id) == path) {
                _ if files::is_temporary(&path) => {
                    health.note(&path, "a file left half written", leftover);
                }
                None => health.note(&path, "not a file of billow", foreign),
                Some(id) if journal.records.get(&id).is_some_and(has_file) => {}
                Some(id) if journal.withdrawn.contains_key(&id) => {}
                Some(_) if health.running => {}
                Some(_) => health.note(
                    &path,
                    "a history no record names",
                    "nothing: a run of its job replaces it; delete it if the job is not wanted",
                ),
            }
        }
    }
}

/// Whether the table says what plan and journal say.
fn table(stored: &Stored<'_>, health: &mut Health) {
    let path = stored.results.table_path();
    let again = "`billow run` of its study writes it again";
    let there = match stored.results.read_table() {
        Ok(there) => there,
        Err(_) if !path.exists() => {
            if !health.running {
                let next =
                    "nothing, `billow table` reads the journal instead; `billow run` writes it";
                health.note(&path, "no table yet", next);
            }
            return;
        }
        Err(Error::Disk { path, problem }) => {
            let problem = problem.split('\n').next().unwrap_or_default();
            let newer = problem.contains("this program reads up to");
            let next = if newer { "use the newer billow that wrote it" } else { again };
            return health.fault(&path, problem, next);
        }
        Err(other) => return health.error(&path, &other),
    };
    let behind = rows_apart(&there, &stored.table());
    if behind > 0 {
        let problem = format!("out of step with the journal in {behind} rows");
        if health.running {
            health.note(&path, problem, "nothing; the run writes it now and then");
        } else {
            health.fault(&path, problem, again);
        }
    }
}

/// Rows in which two tables differ; all of them where their columns do.
pub fn rows_apart(one: &Table, other: &Table) -> usize {
    let names = |table: &Table| -> Vec<String> {
        table.columns.iter().map(|column| column.name.clone()).collect()
    };
    let rows = one.rows().max(other.rows());
    if one.rows() != other.rows() || names(one) != names(other) {
        return rows;
    }
    // As text, so that no number equals no number.
    let apart = |row: &usize| {
        one.columns.iter().zip(&other.columns).any(|(one, other)| {
            one.cells[*row] != other.cells[*row]
                && format!("{:?}", one.cells[*row]) != format!("{:?}", other.cells[*row])
        })
    };
    (0..rows).filter(apart).count()
}
