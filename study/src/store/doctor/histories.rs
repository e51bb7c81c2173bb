//! Checks the history file of every record.

use std::collections::{HashMap, HashSet};
use std::ffi::OsString;
use std::path::Path;

use super::{Depth, Health, RUN_AGAIN};
use crate::job::JobId;
use crate::job::row::ColumnId;
use crate::platform::error::{Error, Result};
use crate::platform::files::disk_error;
use crate::store::history_file;
use crate::store::journal::{Journal, Record};
use crate::store::results::Results;

/// Checks that the history file of every record exists and, at [`Depth::Contents`], is the recorded
/// one.
pub(super) fn check(results: &Results<'_>, journal: &Journal, depth: Depth, health: &mut Health) {
    let mut existing = Existing::default();
    for record in journal.records.values().filter(|record| record.file_hash.is_some()) {
        let path = results.job_path(&record.job);
        if !existing.contains(results, &path) {
            health.fault(&path, MISSING, RUN_AGAIN);
            continue;
        }
        health.histories += 1;
        if depth == Depth::Contents {
            match problem(results, record) {
                Ok(None) => {}
                Ok(Some(problem)) => health.fault(&path, problem, RUN_AGAIN),
                Err(error) => health.error(&path, &error),
            }
        }
    }
}

/// Jobs whose history file is missing or not the recorded one, and what is wrong with it.
///
/// # Errors
/// [`Error::Disk`] when a file exists but cannot be read.
pub(super) fn damaged(results: &Results<'_>, journal: &Journal) -> Result<Vec<(JobId, String)>> {
    let mut existing = Existing::default();
    let mut damaged = Vec::new();
    for record in journal.records.values().filter(|record| record.file_hash.is_some()) {
        let found = if existing.contains(results, &results.job_path(&record.job)) {
            problem(results, record)?
        } else {
            Some(MISSING.to_owned())
        };
        damaged.extend(found.map(|problem| (record.job.clone(), problem)));
    }
    Ok(damaged)
}

/// The problem of a file that does not exist.
const MISSING: &str = "missing";

/// The names of the files of the folders of histories, listed once per folder.
#[derive(Default)]
struct Existing(HashMap<OsString, HashSet<OsString>>);

impl Existing {
    fn contains(&mut self, results: &Results<'_>, path: &Path) -> bool {
        let (Some(folder), Some(name)) = (path.parent(), path.file_name()) else { return false };
        let key = folder.file_name().unwrap_or_default();
        if !self.0.contains_key(key) {
            let paths = results.files().list(folder).unwrap_or_default();
            let names = paths.iter().filter_map(|path| path.file_name().map(OsString::from));
            self.0.insert(key.to_owned(), names.collect());
        }
        self.0[key].contains(name)
    }
}

/// What is wrong with the history file of a record; `None` for the file that was written.
fn problem(results: &Results<'_>, record: &Record) -> Result<Option<String>> {
    let path = results.job_path(&record.job);
    if path.is_dir() {
        return Ok(Some("a folder where a file must be".to_owned()));
    }
    let bytes = results.files().read(&path).map_err(|error| disk_error(&path, &error))?;
    let read = history_file::read(&path);
    if record.file_hash.as_ref().is_some_and(|hash| history_file::bytes_hash(&bytes) != *hash) {
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
