//! The journal: which jobs of a study ended, and with which row.
//!
//! `journal/<number>.jsonl` holds a header line, then one line per ended job, appended and synced.
//! Every process that stores jobs writes its own file. Numbers increase and are never used again. So
//! no two processes write to one file, and a line that a crash cut short is the last of its file.
//! When a job has several lines, the last line of the last file counts.
//!
//! ```text
//! {"format":"billow-journal","version":3,…}
//! {"job":"<id>","file_hash":"<SHA-256 of its history file>","cells":{…}}   a job that ended
//! {"kind":"invalidated","job":"<id>"}                                      a job to run again
//! ```
//!
//! Older versions are read: version 2 says `withdrawn` for `invalidated` and has old names of columns
//! and statuses; version 1 has no `kind`.

use std::collections::BTreeMap;
use std::path::Path;

use crate::job::JobId;
use crate::job::point::Point;
use crate::job::row::Cells;
use crate::platform::error::{Error, Result};
use crate::platform::files::{Files, disk_error};

mod line;
mod writer;

pub use writer::Writer;

use line::Entry;

/// A job that ended.
#[derive(Debug, Clone, PartialEq)]
pub struct Record {
    /// Id of the job.
    pub job: JobId,
    /// Its row.
    pub cells: Cells,
    /// SHA-256 of the bytes of its history file; `None` for a job without one.
    pub file_hash: Option<String>,
}

/// The row of a point; `None` while its job has not ended.
pub fn cells_of(point: &Point, records: &BTreeMap<JobId, Record>) -> Option<Cells> {
    match &point.infeasible {
        Some(infeasible) => Some(Cells::infeasible(infeasible)),
        None => records.get(&point.job.id).map(|record| record.cells.clone()),
    }
}

/// What the journals of a study hold.
#[derive(Debug, Default)]
pub struct Journal {
    /// Last record of every job that ended.
    pub records: BTreeMap<JobId, Record>,
    /// Last record of every job that was invalidated and has not ended again.
    pub invalidated: BTreeMap<JobId, Record>,
    /// Torn lines, as notes for the user.
    pub notes: Vec<String>,
}

impl Journal {
    fn take(&mut self, entry: Entry) {
        match entry {
            Entry::Ended(record) => {
                self.invalidated.remove(&record.job);
                self.records.insert(record.job.clone(), record);
            }
            Entry::Invalidated(job) => self.invalidate(&job),
        }
    }

    /// Counts a job as not ended. Its record is kept in [`Self::invalidated`], for comparison.
    pub fn invalidate(&mut self, job: &JobId) {
        if let Some(record) = self.records.remove(job) {
            self.invalidated.insert(job.clone(), record);
        }
    }
}

/// Reads every journal in a folder. A missing folder is an empty journal.
///
/// # Errors
/// [`Error::Disk`] with file and line for a line that is not valid, or a journal of a newer version.
pub fn read(files: &dyn Files, folder: &Path) -> Result<Journal> {
    let (journal, faults) = examine(files, folder)?;
    faults.into_iter().next().map_or(Ok(journal), Err)
}

/// Reads all that can be read of every journal in a folder. Lines that are not valid are skipped and
/// returned as errors.
///
/// # Errors
/// [`Error::Disk`] when the folder cannot be listed.
pub fn examine(files: &dyn Files, folder: &Path) -> Result<(Journal, Vec<Error>)> {
    let mut journal = Journal::default();
    let mut faults = Vec::new();
    let paths = files.list(folder).map_err(|error| disk_error(folder, &error))?;
    for path in paths.iter().filter(|path| is_journal(path)) {
        match files.read(path) {
            Ok(bytes) => read_file(path, &bytes, &mut journal, &mut faults),
            Err(error) => faults.push(disk_error(path, &error)),
        }
    }
    Ok((journal, faults))
}

/// Whether a file has the name of a journal.
pub fn is_journal(path: &Path) -> bool {
    path.extension().is_some_and(|extension| extension == "jsonl")
}

fn read_file(path: &Path, bytes: &[u8], journal: &mut Journal, faults: &mut Vec<Error>) {
    let invalid = |number: usize, problem: &str| Error::Disk {
        path: path.to_owned(),
        problem: format!(
            "line {number}: {problem}\n  next: restore the file from a copy, or move it away; the \
             jobs that it records then run again"
        ),
    };
    let complete = bytes.iter().rposition(|byte| *byte == b'\n').map_or(0, |last| last + 1);
    if complete < bytes.len() {
        let number = bytes[..complete].split(|byte| *byte == b'\n').count();
        journal.notes.push(format!(
            "{}: line {number} is torn (the program was stopped while it wrote the line); the job of \
             this line runs again",
            path.display()
        ));
    }
    let mut lines = bytes[..complete].split_inclusive(|byte| *byte == b'\n');
    let Some(header) = lines.next() else { return };
    match line::parse_header(header) {
        Ok(()) => {}
        Err(line::HeaderError::Invalid(problem)) => return faults.push(invalid(1, &problem)),
        Err(line::HeaderError::Newer(problem)) => {
            return faults.push(Error::Disk { path: path.to_owned(), problem });
        }
    }
    for (number, text) in (2..).zip(lines) {
        match line::parse(text) {
            Ok(entry) => journal.take(entry),
            Err(problem) => faults.push(invalid(number, &problem)),
        }
    }
}

#[cfg(test)]
mod tests;
