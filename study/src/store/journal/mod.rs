//! The journal: which jobs of a study ended, and with which row.
//!
//! `journal/<number>.jsonl` holds a header line, then one line per ended job, appended and synced.
//! Every process that stores jobs writes its own file. Numbers increase and are never used again. So
//! no two processes write to one file, and a line that a crash cut short is the last of its file.
//! When a job has several lines, the last line of the last file counts.
//!
//! ```text
//! {"checksum":"…","format":"billow-journal","version":7,…}
//! {"checksum":"…","job":"<id>","cells":{…},                       a job that ended
//!     "file_hash":"<SHA-256 of its history file>","file_size":…,"file_time":"…"}
//! {"checksum":"…","kind":"invalidated","job":"<id>"}              a job to run again
//! {"checksum":"…","kind":"died","job":"<id>",…}                   its process died while it ran
//! {"checksum":"…","kind":"progressed","job":"<id>"}               it stored a checkpoint
//! {"checksum":"…","kind":"study","text":"…"}                      study.json, to restore it
//! ```
//!
//! `checksum` is that of [`billow_solver::platform::seal`]. A line that is not valid costs its own record
//! only.

use std::collections::BTreeMap;
use std::io::Read;
use std::path::{Path, PathBuf};

use rayon::iter::{IndexedParallelIterator, IntoParallelRefIterator, ParallelIterator};

use crate::job::point::Point;
use crate::job::row::Cells;
use crate::job::{JobId, Status};
use crate::platform::error::{Error, Result};
use crate::platform::files::{Files, Stamp, disk_error};

mod line;
mod mend;
mod writer;

pub use mend::mend;
pub use writer::Writer;

use line::Entry;

/// Bytes of a journal that are read at once. Chosen: far more than a line, far less than a large journal; in unit tests
/// less than a line, so that lines span blocks.
const BLOCK: u64 = if cfg!(test) { 100 } else { 1 << 23 };

/// A job that ended.
#[derive(Debug, Clone, PartialEq)]
pub struct Record {
    /// Id of the job.
    pub job: JobId,
    /// Its row.
    pub cells: Cells,
    /// SHA-256 of the bytes of its history file; `None` for a job without one.
    pub file_hash: Option<String>,
    /// Size and time of that file when it was written; `None` for a job without one.
    pub file_stamp: Option<Stamp>,
}

impl Record {
    /// Whether the job was ended by a limit, or crashed. Its checkpoint is kept, so that it can resume.
    pub fn reached_limit(&self) -> bool {
        // A run that used up solver.step_limit has a history.
        self.file_hash.is_none() && self.cells.status().is_limit()
    }
}

/// The death of a process while a job ran.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Death {
    /// Id of the job.
    pub job: JobId,
    /// Name of the process, unique in the folder.
    pub process: String,
    /// Whether no other job ran.
    pub alone: bool,
}

/// A line that is not valid.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Fault {
    /// File.
    pub path: PathBuf,
    /// Number of the line, from 1.
    pub line: usize,
    /// What is wrong with it.
    pub problem: String,
    /// Whether the line is the last one, and incomplete: the program was stopped while it wrote it. Its
    /// record did not count as written.
    pub torn: bool,
}

impl std::fmt::Display for Fault {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        let Self { path, line, problem, .. } = self;
        write!(f, "{}: line {line}: {problem}; its job counts as not run", path.display())
    }
}

/// The row of a point; `None` while its job has not ended.
pub fn cells_of(point: &Point, records: &BTreeMap<JobId, Record>) -> Option<Cells> {
    if let Some(infeasible) = &point.infeasible {
        return Some(Cells::infeasible(infeasible));
    }
    Some(records.get(&point.job.id)?.cells.clone())
}

/// The row of a point, pending while its job has not ended.
pub fn row_of(point: &Point, records: &BTreeMap<JobId, Record>) -> Cells {
    cells_of(point, records).unwrap_or_else(|| Cells::new(Status::Pending))
}

/// What the journals of a study hold.
#[derive(Debug, Default)]
pub struct Journal {
    /// Last record of every job that ended.
    pub records: BTreeMap<JobId, Record>,
    /// Last record of every job that was invalidated and has not ended again.
    pub invalidated: BTreeMap<JobId, Record>,
    /// Deaths of processes while a job ran that has not ended, progressed or been invalidated since.
    pub deaths: BTreeMap<JobId, Vec<Death>>,
    /// The text of study.json at the start of the last run.
    pub study: Option<String>,
    /// Lines that are not valid, in the order of the files.
    pub faults: Vec<Fault>,
}

impl Journal {
    fn take(&mut self, entry: Entry) {
        match entry {
            Entry::Ended(record) => {
                self.invalidated.remove(&record.job);
                self.deaths.remove(&record.job);
                self.records.insert(record.job.clone(), *record);
            }
            Entry::Invalidated(job) => self.invalidate(&job),
            Entry::Died(death) => self.add_death(death),
            Entry::Progressed(job) => {
                self.deaths.remove(&job);
            }
            Entry::Study(text) => self.study = Some(text),
        }
    }

    /// Whether there is no line at all.
    pub fn is_empty(&self) -> bool {
        let Self { records, invalidated, deaths, study, faults } = self;
        records.is_empty()
            && invalidated.is_empty()
            && deaths.is_empty()
            && study.is_none()
            && faults.is_empty()
    }

    /// The last record of a job, also of an invalidated one.
    pub fn record(&self, id: &JobId) -> Option<&Record> {
        self.records.get(id).or_else(|| self.invalidated.get(id))
    }

    /// Counts a job as not ended. Its record is kept in [`Self::invalidated`], for comparison.
    pub fn invalidate(&mut self, job: &JobId) {
        self.deaths.remove(job);
        if let Some(record) = self.records.remove(job) {
            self.invalidated.insert(job.clone(), record);
        }
    }

    /// Adds a death. The same process counts once.
    pub(super) fn add_death(&mut self, death: Death) {
        let deaths = self.deaths.entry(death.job.clone()).or_default();
        if deaths.iter().all(|known| known.process != death.process) {
            deaths.push(death);
        }
    }
}

/// Reads every journal in a folder. A missing folder is an empty journal. Lines that are not valid are
/// skipped; they are in [`Journal::faults`].
///
/// # Errors
/// [`Error::Disk`] when the folder or a journal cannot be read, and for a journal of another version.
pub fn read(files: &dyn Files, folder: &Path) -> Result<Journal> {
    let mut journal = Journal::default();
    for path in &paths(files, folder)? {
        let at = |error| disk_error(path, &error);
        let mut file = files.open(path).map_err(at)?;
        let (mut bytes, mut lines, mut is_end) = (Vec::new(), 0, false);
        while !is_end {
            is_end = (&mut file).take(BLOCK).read_to_end(&mut bytes).map_err(at)? == 0;
            let scanned = if is_end { bytes.len() } else { complete(&bytes) };
            for line in scan(path, lines, &bytes[..scanned])? {
                lines += 1;
                match line.entry {
                    Ok(Some(entry)) => journal.take(entry),
                    Ok(None) => {}
                    Err(fault) => journal.faults.push(fault),
                }
            }
            bytes.drain(..scanned);
        }
    }
    Ok(journal)
}

/// The journals of a folder, in the order of their names.
///
/// # Errors
/// [`Error::Disk`] when the folder cannot be listed.
pub fn paths(files: &dyn Files, folder: &Path) -> Result<Vec<PathBuf>> {
    let mut paths = files.list(folder).map_err(|error| disk_error(folder, &error))?;
    paths.retain(|path| is_journal(path));
    Ok(paths)
}

/// Whether a file has the name of a journal.
pub fn is_journal(path: &Path) -> bool {
    path.extension().is_some_and(|extension| extension == "jsonl")
}

/// One line of a journal.
struct ScannedLine<'a> {
    /// Its bytes, with the end of the line.
    bytes: &'a [u8],
    /// What it says; `None` for the header.
    entry: std::result::Result<Option<Entry>, Fault>,
}

/// Length of the complete lines.
fn complete(bytes: &[u8]) -> usize {
    bytes.iter().rposition(|byte| *byte == b'\n').map_or(0, |last| last + 1)
}

/// The lines of a journal that follow the first `before` lines.
fn scan<'a>(path: &Path, before: usize, bytes: &'a [u8]) -> Result<Vec<ScannedLine<'a>>> {
    let fault = |line: usize, problem: String, torn: bool| Fault {
        path: path.to_owned(),
        line,
        problem,
        torn,
    };
    let complete = complete(bytes);
    let all: Vec<&[u8]> = bytes[..complete].split_inclusive(|byte| *byte == b'\n').collect();
    let entry = |number: usize, bytes: &[u8]| {
        let read = if number == 1 {
            match line::check_header(bytes) {
                Ok(()) => Ok(None),
                Err(line::HeaderError::Version(problem)) => {
                    return Err(Error::Disk { path: path.to_owned(), problem });
                }
                Err(line::HeaderError::Invalid(problem)) => Err(problem),
            }
        } else {
            line::parse(bytes).map(Some)
        };
        Ok(read.map_err(|problem| fault(number, problem, false)))
    };
    // A large study has 2 kB for each of its jobs.
    let lines = all.par_iter().enumerate();
    let mut lines: Vec<ScannedLine<'_>> = lines
        .map(|(index, bytes)| Ok(ScannedLine { bytes, entry: entry(before + index + 1, bytes)? }))
        .collect::<Result<_>>()?;
    if complete < bytes.len() {
        let problem = "torn (the program was stopped while it wrote the line)".to_owned();
        let entry = Err(fault(before + lines.len() + 1, problem, true));
        lines.push(ScannedLine { bytes: &bytes[complete..], entry });
    }
    Ok(lines)
}

#[cfg(test)]
mod tests;
