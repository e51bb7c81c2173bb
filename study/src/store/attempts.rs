//! Attempts: which jobs a running process has started.
//!
//! ```text
//! results/<study>/attempts.jsonl
//! {"checksum":"…","process":"<process id and time>"}
//! {"checksum":"…","job":"<id>"}                         written before the job starts
//! {"checksum":"…","job":"<id>","progressed":true}       it stored a checkpoint
//! ```
//!
//! The file exists while a run goes on. A run that ends in order, also after a signal or an error, removes
//! it. If it is there when the next run takes the lock, its process died: the started jobs without a record
//! were running then ([`take_deaths`]). A job that stored a checkpoint in that process is not to blame: it
//! gets further with every attempt. Lines are written without a sync: they survive the death of the
//! process, and after a power cut no job is to blame.

use std::collections::BTreeSet;
use std::io;
use std::path::PathBuf;
use std::time::SystemTime;

use billow_solver::platform::seal;
use serde::Deserialize;
use serde_json::json;

use crate::job::JobId;
use crate::platform::error::Result;
use crate::platform::files::{Append, Files, disk_error};
use crate::store::journal::{Death, Journal, Writer};
use crate::store::results::Results;

/// The attempts of this process. The file is created by the first attempt and removed on drop.
pub struct Attempts<'a> {
    files: &'a dyn Files,
    path: PathBuf,
    open: Option<Box<dyn Append>>,
    /// Whether no attempt counts any more.
    ended: bool,
}

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
struct Line {
    #[serde(default)]
    process: String,
    #[serde(default)]
    job: String,
    #[serde(default)]
    progressed: bool,
}

impl<'a> Attempts<'a> {
    /// The attempts of a process that holds the lock of the results, after [`take_deaths`].
    pub fn new(results: &Results<'a>) -> Self {
        Self { files: results.files(), path: results.attempts_path(), open: None, ended: false }
    }

    /// Records that these jobs are about to start. When this returns, a death of the process cannot undo
    /// it.
    ///
    /// # Errors
    /// [`crate::platform::error::Error::Disk`]; the jobs must not start then.
    pub fn start(&mut self, jobs: &[&JobId]) -> Result<()> {
        if self.ended {
            return Ok(());
        }
        let mut text = String::new();
        let at = |error: io::Error| disk_error(&self.path, &error);
        if self.open.is_none() {
            let time = SystemTime::now().duration_since(SystemTime::UNIX_EPOCH);
            let time = time.map_or(0, |time| time.as_nanos());
            let process = format!("{}-{time}", std::process::id());
            text += &line(&json!({ "process": process }));
            self.open = Some(self.files.create_append(&self.path).map_err(at)?);
        }
        for job in jobs {
            text += &line(&json!({ "job": job.as_str() }));
        }
        let Some(file) = &mut self.open else { return Ok(()) };
        file.append_unsynced(text.as_bytes()).map_err(at)
    }
}

impl Attempts<'_> {
    /// Records that a running job stored a checkpoint.
    ///
    /// # Errors
    /// [`crate::platform::error::Error::Disk`].
    pub fn progress(&mut self, job: &JobId) -> Result<()> {
        let Some(file) = &mut self.open else { return Ok(()) };
        let line = line(&json!({ "job": job.as_str(), "progressed": true }));
        file.append_unsynced(line.as_bytes()).map_err(|error| disk_error(&self.path, &error))
    }

    /// Removes the file: the process ends in order, and later attempts of it do not count either.
    pub fn end(&mut self) {
        self.ended = true;
        if self.open.take().is_some() {
            // If it cannot be removed, the next run counts deaths that were none.
            let _ = self.files.remove(&self.path);
        }
    }
}

/// A line of the file.
fn line(value: &serde_json::Value) -> String {
    seal::seal(&value.to_string()) + "\n"
}

impl Drop for Attempts<'_> {
    fn drop(&mut self) {
        self.end();
    }
}

/// Records in the journal which jobs a dead process was running, and removes its file. Only for the process
/// that holds the lock. A job that has a record since is no such job.
///
/// # Errors
/// [`crate::platform::error::Error::Disk`].
pub fn take_deaths(
    results: &Results<'_>,
    journal: &mut Journal,
    writer: &mut Writer<'_>,
) -> Result<()> {
    let path = results.attempts_path();
    let bytes = match results.files().read(&path) {
        Ok(bytes) => bytes,
        Err(error) if error.kind() == io::ErrorKind::NotFound => return Ok(()),
        Err(error) => return Err(disk_error(&path, &error)),
    };
    let deaths = deaths(&bytes, journal);
    if !deaths.is_empty() {
        writer.deaths(&deaths)?;
    }
    for death in deaths {
        journal.add_death(death);
    }
    results.files().remove(&path).map_err(|error| disk_error(&path, &error))
}

/// The jobs that a process with this file was running when it died. Lines that are not valid are ignored:
/// their jobs were not started, or are not known.
fn deaths(bytes: &[u8], journal: &Journal) -> Vec<Death> {
    let mut process = String::new();
    let mut jobs = BTreeSet::new();
    let mut progressed = BTreeSet::new();
    for line in bytes.split(|byte| *byte == b'\n') {
        let object = std::str::from_utf8(line).ok().and_then(|text| seal::open(text).ok());
        let Some(line) = object.and_then(|text| serde_json::from_str::<Line>(&text).ok()) else {
            continue;
        };
        match JobId::from_digits(&line.job) {
            None => process = line.process,
            Some(job) if journal.records.contains_key(&job) => {}
            Some(job) if line.progressed => {
                progressed.insert(job);
            }
            Some(job) => {
                jobs.insert(job);
            }
        }
    }
    let alone = jobs.len() == 1;
    let blamed = jobs.into_iter().filter(|job| !progressed.contains(job));
    blamed.map(|job| Death { job, process: process.clone(), alone }).collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::job::Status;
    use crate::job::row::Cells;
    use crate::platform::files::Disk;
    use crate::store::journal::Record;

    fn id(number: u32) -> JobId {
        JobId::from_digits(&format!("{number:032x}")).unwrap()
    }

    #[test]
    fn only_started_jobs_without_a_record_died_with_their_process() {
        let folder = tempfile::tempdir().unwrap();
        let results = Results::new(&Disk, folder.path());
        let mut writer = Writer::new(&Disk, results.journal_path());
        for _ in 0..2 {
            let mut journal = results.journal().unwrap();
            take_deaths(&results, &mut journal, &mut writer).unwrap();
            let mut attempts = Attempts::new(&results);
            attempts.start(&[&id(1), &id(2)]).unwrap();
            attempts.start(&[&id(3)]).unwrap();
            let cells = Cells::new(Status::Done);
            let record = Record { job: id(1), cells, file_hash: None, file_stamp: None };
            writer.append(&[record]).unwrap();
            // The process dies: nothing is dropped.
            std::mem::forget(attempts);
        }
        let mut journal = results.journal().unwrap();
        take_deaths(&results, &mut journal, &mut writer).unwrap();
        assert!(!results.attempts_path().exists());
        assert_eq!(journal.deaths, results.journal().unwrap().deaths);
        let jobs: Vec<&JobId> = journal.deaths.keys().collect();
        assert_eq!(jobs, [&id(2), &id(3)]);
        assert_eq!(journal.deaths[&id(2)].len(), 2);
        assert!(journal.deaths[&id(2)].iter().all(|death| !death.alone));

        writer.progress(&[id(2)]).unwrap();
        writer.invalidate(&[id(3)]).unwrap();
        assert!(results.journal().unwrap().deaths.is_empty());
    }

    #[test]
    fn a_job_that_stored_a_checkpoint_is_not_to_blame_but_was_running() {
        let folder = tempfile::tempdir().unwrap();
        let results = Results::new(&Disk, folder.path());
        let mut attempts = Attempts::new(&results);
        attempts.progress(&id(1)).unwrap();
        attempts.start(&[&id(1), &id(2)]).unwrap();
        attempts.progress(&id(1)).unwrap();
        std::mem::forget(attempts);
        let mut journal = Journal::default();
        let mut writer = Writer::new(&Disk, results.journal_path());
        take_deaths(&results, &mut journal, &mut writer).unwrap();
        let jobs: Vec<&JobId> = journal.deaths.keys().collect();
        assert_eq!(jobs, [&id(2)]);
        assert!(!journal.deaths[&id(2)][0].alone);
    }

    #[test]
    fn a_run_that_ends_in_order_leaves_no_attempts() {
        let folder = tempfile::tempdir().unwrap();
        let results = Results::new(&Disk, folder.path());
        let mut attempts = Attempts::new(&results);
        attempts.start(&[&id(1)]).unwrap();
        assert!(results.attempts_path().exists());
        drop(attempts);
        assert!(!results.attempts_path().exists());
    }
}
