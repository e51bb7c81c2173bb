//! Checks the history file of every record.

use std::io;

use super::{Health, RUN_AGAIN};
use crate::job::JobId;
use crate::job::row::ColumnId;
use crate::platform::error::{Error, Result};
use crate::platform::files::disk_error;
use crate::platform::hash::bytes_hash;
use crate::store::history_file;
use crate::store::journal::{Journal, Record};
use crate::store::results::Results;

/// Checks that the history file of every record exists and is the recorded one.
pub(super) fn check(results: &Results<'_>, journal: &Journal, health: &mut Health) {
    for record in journal.records.values().filter(|record| record.file_hash.is_some()) {
        let path = results.job_path(&record.job);
        match problem(results, record) {
            Ok(None) => health.histories += 1,
            Ok(Some(problem)) => health.fault(&path, problem, RUN_AGAIN),
            Err(error) => health.error(&path, &error),
        }
    }
}

/// Jobs whose history file is missing or not the recorded one, and what is wrong with it.
///
/// # Errors
/// [`Error::Disk`] when a file exists but cannot be read.
pub(super) fn damaged(results: &Results<'_>, journal: &Journal) -> Result<Vec<(JobId, String)>> {
    let mut damaged = Vec::new();
    for record in journal.records.values().filter(|record| record.file_hash.is_some()) {
        let found = problem(results, record)?;
        damaged.extend(found.map(|problem| (record.job.clone(), problem)));
    }
    Ok(damaged)
}

/// What is wrong with the history file of a record; `None` for the file that was written.
fn problem(results: &Results<'_>, record: &Record) -> Result<Option<String>> {
    let path = results.job_path(&record.job);
    if path.is_dir() {
        return Ok(Some("a folder where a file must be".to_owned()));
    }
    let bytes = match results.files().read(&path) {
        Ok(bytes) => bytes,
        Err(error) if error.kind() == io::ErrorKind::NotFound => {
            return Ok(Some("missing".to_owned()));
        }
        Err(error) => return Err(disk_error(&path, &error)),
    };
    let read = history_file::read(&path);
    if record.file_hash.as_ref().is_some_and(|hash| bytes_hash(&bytes) != *hash) {
        let reason = match &read {
            Err(Error::Disk { problem, .. }) => problem.split('\n').next().unwrap_or("").to_owned(),
            Err(other) => other.to_string(),
            Ok(_) => "a valid history, but another one".to_owned(),
        };
        return Ok(Some(format!("not the file that was written ({reason})")));
    }
    let stored = match read {
        Ok(stored) => stored,
        Err(Error::Disk { problem, .. }) => return Ok(Some(problem)),
        Err(other) => return Err(other),
    };
    let cells = &record.cells;
    for (what, in_file, in_journal) in [
        ("job", stored.job.as_str(), record.job.as_str()),
        ("status", stored.status.name(), cells.status().name()),
        ("content_hash", stored.content_hash.as_str(), cells.text(ColumnId::ContentHash)),
    ] {
        if in_file != in_journal {
            return Ok(Some(format!("its {what} is {in_file:?}, the journal has {in_journal:?}")));
        }
    }
    Ok(None)
}
