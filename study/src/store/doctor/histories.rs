//! Checks the history file of every record.

use std::collections::{BTreeMap, BTreeSet};
use std::path::{Path, PathBuf};

use super::{Depth, Health, RUN_AGAIN};
use crate::job::row::ColumnId;
use crate::platform::error::Error;
use crate::platform::files::disk_error;
use crate::store::history_file;
use crate::store::journal::{Journal, Record};
use crate::store::results::Results;

/// Checks that the history file of every record exists and, at [`Depth::Contents`], is the recorded
/// one.
pub(super) fn check(results: &Results<'_>, journal: &Journal, depth: Depth, health: &mut Health) {
    let mut listed: BTreeMap<PathBuf, BTreeSet<PathBuf>> = BTreeMap::new();
    for record in journal.records.values() {
        let Some(hash) = &record.file_hash else { continue };
        let path = results.job_path(&record.job);
        let folder = path.parent().unwrap_or(&path).to_owned();
        let existing = listed.entry(folder).or_insert_with_key(|folder| {
            results.files().list(folder).unwrap_or_default().into_iter().collect()
        });
        if !existing.contains(&path) {
            health.fault(&path, "missing", RUN_AGAIN);
            continue;
        }
        health.histories += 1;
        if depth == Depth::Contents {
            match results.files().read(&path) {
                Ok(bytes) => check_contents(&path, record, hash, &bytes, health),
                Err(error) => health.error(&path, &disk_error(&path, &error)),
            }
        }
    }
}

fn check_contents(path: &Path, record: &Record, hash: &str, bytes: &[u8], health: &mut Health) {
    let read = history_file::read(path);
    if history_file::bytes_hash(bytes) != hash {
        let reason = match &read {
            Err(Error::Disk { problem, .. }) => problem.split('\n').next().unwrap_or("").to_owned(),
            Err(other) => other.to_string(),
            Ok(_) => "a valid history, but another one".to_owned(),
        };
        let problem = format!("not the file that was written ({reason})");
        return health.fault(path, problem, RUN_AGAIN);
    }
    let stored = match read {
        Ok(stored) => stored,
        Err(error) => return health.error(path, &error),
    };
    let cells = &record.cells;
    for (what, in_file, in_journal) in [
        ("job", stored.job.as_str(), record.job.as_str()),
        ("status", stored.status.name(), cells.status().name()),
        ("content_hash", stored.content_hash.as_str(), cells.text(ColumnId::ContentHash)),
    ] {
        if in_file != in_journal {
            let problem = format!("its {what} is {in_file:?}, the journal has {in_journal:?}");
            health.fault(path, problem, RUN_AGAIN);
        }
    }
}
