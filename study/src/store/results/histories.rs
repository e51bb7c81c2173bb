//! The history files of a results folder: written, checked against their records, read.

use std::io;
use std::path::Path;

use super::Results;
use crate::job::JobId;
use crate::platform::error::{Error, Result};
use crate::platform::files::{self, Stamp, disk_error};
use crate::platform::hash::bytes_hash;
use crate::store::history_file::{self, StoredHistory};
use crate::store::journal::Record;

/// What is wrong with a history file of other bytes.
const OTHER_FILE: &str = "not the file that was written; its job runs again";
/// What is wrong with a history file that does not exist.
const MISSING_FILE: &str = "missing; its job runs again";
/// A problem of a history file, with its next step.
fn next_run(root: &Path, problem: &str) -> String {
    format!(
        "{problem}\n  next: run `billow doctor --repair {}`, then `billow run` of its study: it runs the job \
         again; while a run is active, try again",
        root.display()
    )
}

impl Results<'_> {
    /// Why a recorded job must run again: its history file is missing, or is not the recorded one.
    /// `None` for an undamaged file. A file with the recorded size and time counts as undamaged; its bytes
    /// are checked by who reads it.
    ///
    /// # Errors
    /// [`Error::Disk`] when the file exists but cannot be read.
    pub fn damage(&self, record: &Record) -> Result<Option<String>> {
        let Some(hash) = &record.file_hash else { return Ok(None) };
        let path = self.job_path(&record.job);
        let again = |problem: &str| Some(format!("{}: {problem}", path.display()));
        let found = self.files.stamp(&path);
        match (&found, &record.file_stamp) {
            (Ok(found), Some(recorded)) if found == recorded => return Ok(None),
            (Ok(found), Some(recorded)) if found.size != recorded.size => {
                return Ok(again(OTHER_FILE));
            }
            _ => {}
        }
        match found.and_then(|_| self.files.read(&path)) {
            Ok(bytes) if bytes_hash(&bytes) == *hash => Ok(None),
            Ok(_) => Ok(again(OTHER_FILE)),
            Err(error) if error.kind() == io::ErrorKind::NotFound => Ok(again(MISSING_FILE)),
            Err(error) => Err(disk_error(&path, &error)),
        }
    }

    /// Checks that a history file holds the bytes that its record names, so that it is complete, unchanged,
    /// and that of its job.
    ///
    /// # Errors
    /// [`Error::Disk`] with the reason.
    pub fn check_history(&self, record: &Record) -> Result<()> {
        let path = self.job_path(&record.job);
        let bytes = self.files.read(&path).map_err(|error| match error.kind() {
            io::ErrorKind::NotFound => {
                Error::Disk { path: path.clone(), problem: next_run(self.root(), "missing") }
            }
            _ => disk_error(&path, &error),
        })?;
        if record.file_hash.as_ref().is_none_or(|hash| bytes_hash(&bytes) == *hash) {
            return Ok(());
        }
        let problem = next_run(self.root(), "not the history that was written for this job");
        Err(Error::Disk { path, problem })
    }

    /// Reads the history of a job, after [`Self::check_history`]. Without a record only its job is checked.
    ///
    /// # Errors
    /// [`Error::Disk`] with the reason.
    pub fn read_history(&self, id: &JobId, record: Option<&Record>) -> Result<StoredHistory> {
        let recorded = record.filter(|record| record.file_hash.is_some());
        recorded.map_or(Ok(()), |record| self.check_history(record))?;
        let path = self.job_path(id);
        let stored = history_file::read(&path)?;
        if recorded.is_some() || stored.job == *id {
            return Ok(stored);
        }
        let problem =
            next_run(self.root(), &format!("it is the history of the job {}", stored.job));
        Err(Error::Disk { path, problem })
    }

    /// Stores a history file. Returns its size and time.
    ///
    /// # Errors
    /// [`Error::Disk`].
    pub fn write_job(&self, id: &JobId, bytes: &[u8]) -> Result<Stamp> {
        let path = self.job_path(id);
        let jobs = self.jobs_path();
        let folder = path.parent().unwrap_or(&jobs);
        let write = || -> io::Result<Stamp> {
            if self.files.create_folder(folder)? {
                self.files.sync_folder(&jobs)?;
                self.files.sync_folder(&self.root)?;
            }
            files::write_atomic(self.files, &path, bytes)?;
            self.files.stamp(&path)
        };
        write().map_err(|error| disk_error(&path, &error))
    }
}
