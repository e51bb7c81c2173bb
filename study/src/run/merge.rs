//! Joins what several runs have stored: folders of parts of one study.

use std::path::PathBuf;

use crate::input::json::Json;
use crate::job::JobId;
use crate::job::row::ColumnId;
use crate::platform::error::{Error, Result};
use crate::platform::files::disk_error;
use crate::platform::hash::bytes_hash;
use crate::platform::stop::Stop;
use crate::run::exclusive::{self, Exclusive};
use crate::store::journal::{Journal, Record, Writer};
use crate::store::results::Results;
use crate::store::stored::Stored;
use crate::store::table::Table;

/// Records that are written with one sync. Chosen: few syncs, little memory.
const RECORDS_PER_SYNC: usize = 256;

fn write_table(results: &Results<'_>) -> Result<()> {
    let stored = Stored::read(results.clone())?;
    let Stored { study, points, journal, .. } = &stored;
    results.write_table(Table::of_study(study, points, &journal.records)).map(|_| ())
}

/// Makes a folder ready for parts of this study, whose runs read its study.json.
///
/// # Errors
/// [`Error::Disk`], also when another command holds the lock.
pub fn prepare(results: &Results<'_>, study: (&str, &Json)) -> Result<()> {
    let _lock = results.lock()?;
    exclusive::open(results, Some(study)).map(|_| ())
}

/// What a merge of folders did.
#[derive(Debug, Clone, PartialEq, Eq, Default)]
pub struct Merged {
    /// Number of jobs that were copied.
    pub copied: usize,
    /// Number of jobs that the folder had already, with the same bits.
    pub same: usize,
    /// Jobs that the folder had already with other bits, and kept.
    pub different: Vec<JobId>,
    /// Jobs whose history is damaged in its folder; they were left out.
    pub damaged: Vec<PathBuf>,
}

/// Copies the jobs of folders into another one, and writes its table. Every folder belongs to this study; the other one
/// may be new. A job that is there already stays: a later merge, or the same one again after an interruption, copies what is missing.
///
/// # Errors
/// [`Error::Disk`]; [`Error::Input`] for a folder of another study.
pub fn merge(
    sources: &[Results<'_>],
    target: &Results<'_>,
    (name, study): (&str, &Json),
    stop: &Stop,
) -> Result<Merged> {
    for source in sources {
        if source.owner()?.is_none_or(|owner| owner != name) || !source.holds(name, study)? {
            return Err(other_study(source, name));
        }
    }
    let lock = target.lock()?;
    let Exclusive { mut journal, mut writer, .. } = exclusive::open(target, Some((name, study)))?;
    let mut merged = Merged::default();
    for source in sources {
        copy(source, target, &mut journal, &mut writer, stop, &mut merged)?;
    }
    if stop.requested().is_none() {
        target.check_lock(&lock)?;
        write_table(target)?;
    }
    Ok(merged)
}

/// Copies the jobs of one folder.
fn copy(
    source: &Results<'_>,
    target: &Results<'_>,
    journal: &mut Journal,
    writer: &mut Writer<'_>,
    stop: &Stop,
    merged: &mut Merged,
) -> Result<()> {
    let found = source.journal()?;
    let mut records = Vec::new();
    for (id, record) in &found.records {
        if stop.requested().is_some() {
            break;
        }
        // A job that a limit ended may have a result in another folder.
        if let Some(known) = journal.records.get(id)
            && (!known.reached_limit() || record.reached_limit())
        {
            if record.reached_limit() || is_same(known, record) {
                merged.same += 1;
            } else {
                merged.different.push(id.clone());
            }
            continue;
        }
        match copied(source, target, record)? {
            Some(record) => records.push(record),
            None => merged.damaged.push(source.job_path(id)),
        }
        if records.len() == RECORDS_PER_SYNC {
            append(&mut records, journal, writer, merged)?;
        }
    }
    append(&mut records, journal, writer, merged)
}

/// Copies a history and returns its record; `None` where the history is damaged or missing.
fn copied(source: &Results<'_>, target: &Results<'_>, record: &Record) -> Result<Option<Record>> {
    let Some(hash) = &record.file_hash else { return Ok(Some(record.clone())) };
    let path = source.job_path(&record.job);
    let bytes = match source.files().read(&path) {
        Ok(bytes) if bytes_hash(&bytes) == *hash => bytes,
        Err(error) if error.kind() != std::io::ErrorKind::NotFound => {
            return Err(disk_error(&path, &error));
        }
        _ => return Ok(None),
    };
    let stamp = target.write_job(&record.job, &bytes)?;
    Ok(Some(Record { file_stamp: Some(stamp), ..record.clone() }))
}

/// Appends copied records to the journal.
fn append(
    records: &mut Vec<Record>,
    journal: &mut Journal,
    writer: &mut Writer<'_>,
    merged: &mut Merged,
) -> Result<()> {
    if records.is_empty() {
        return Ok(());
    }
    writer.append(records)?;
    merged.copied += records.len();
    journal.records.extend(records.drain(..).map(|record| (record.job.clone(), record)));
    Ok(())
}

/// Whether two records of one job have the same status and the same history.
fn is_same(one: &Record, other: &Record) -> bool {
    let hash = |record: &Record| record.cells.text(ColumnId::ContentHash).to_owned();
    one.cells.status() == other.cells.status() && hash(one) == hash(other)
}

fn other_study(source: &Results<'_>, name: &str) -> Error {
    Error::invalid_option(
        "billow merge",
        &source.root().display().to_string(),
        format!("not results of the study {name:?} with these keys and grid"),
        "folders of the same study file, run with the same --set (units and job limits may differ)",
        "run the same study in each: billow run STUDY --points K/N --results FOLDER",
    )
}

#[cfg(test)]
mod tests;
