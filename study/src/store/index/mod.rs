//! The index of a results folder: what commands need of a large study without planning it again and without reading
//! its journals. It is derived from study.json, the journals and the table, and can be deleted at any time.
//!
//! ```text
//! index.json   {"checksum":"…","format":"billow-index","version":2,
//!               "key":{study, program, physics, journals and table with size and time},
//!               "counts":…,"entries":[[job, numbers of its points, [journal, offset, length], [size, time]], …]}
//! ```
//!
//! `billow run` writes it at its end. A reader uses it only if its [`Key`] is that of the folder as it is now; else, also
//! where it is damaged or missing, the reader plans the study and reads the journals as without it, with the same
//! result. An index is written for a plain grid ([`Study::is_plain_grid`]) whose journals have no faults, no remedies,
//! and no jobs that are invalidated or that the study does not plan (`build`).

use std::path::PathBuf;

use billow_solver::platform::seal;
use serde::{Deserialize, Serialize};

use crate::job::JobId;
use crate::job::row::Counts;
use crate::platform::files::{Stamp, write_atomic};
use crate::store::journal::{self, Journal, Place, Record};
use crate::store::results::Results;
use crate::store::stored::Stored;
use crate::study::Study;

mod build;
mod key;

pub use key::Key;

/// Name of the format.
const FORMAT: &str = "billow-index";
/// Version of the format; an index of another one is ignored.
const VERSION: u64 = 2;

/// What is known of a study without reading it whole.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Index {
    format: String,
    version: u64,
    key: Key,
    /// Numbers of rows by how they ended.
    pub counts: Counts,
    /// Sum of the wall times of the jobs, s.
    pub seconds: f64,
    /// Number of jobs with a wall time.
    pub timed: usize,
    /// Number of runs planned, also of those that share a job.
    pub runs: usize,
    /// Number of points that differ in more than replicates.
    pub points: usize,
    /// What `billow run` prints when nothing is to do, as the command line stores it; `null` where it has nothing.
    pub finished: serde_json::Value,
    /// Positions of the entries of failed jobs.
    pub failed: Vec<usize>,
    /// One entry per point, in plan order.
    entries: Vec<Entry>,
}

/// One point: its job, the numbers of the study's points that are this job, where its record is, and size and time of
/// its history file.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
struct Entry(JobId, Vec<usize>, Option<Place>, Option<Stamp>);

impl Index {
    /// Reads the index of a folder; `None` without one that is up to date.
    pub fn read(results: &Results<'_>) -> Option<Self> {
        let bytes = results.files().read(&results.index_path()).ok()?;
        let text = String::from_utf8(bytes).ok()?;
        let index: Self = serde_json::from_str(&seal::open(&text).ok()?).ok()?;
        let known = index.format == FORMAT && index.version == VERSION;
        (known && index.is_current(results)).then_some(index)
    }

    /// The same where study.json is also that of a given study.
    pub fn of_study(results: &Results<'_>, study: &Study) -> Option<Self> {
        if results.is_written_for(study) { Self::read(results) } else { None }
    }

    /// Whether the folder has the files that it was made from.
    pub fn is_current(&self, results: &Results<'_>) -> bool {
        Key::of(results).is_some_and(|key| key == self.key)
    }

    /// Writes the index, if the folder still has the files that it was made from. Returns whether it did.
    ///
    /// # Errors
    /// What the disk says. There is no index then, or the old one, which is not used.
    pub fn write(&self, results: &Results<'_>) -> Result<bool, String> {
        if !self.is_current(results) {
            return Ok(false);
        }
        let object = serde_json::to_string(self).map_err(|error| error.to_string())?;
        let bytes = seal::seal(&object).into_bytes();
        let path = results.index_path();
        write_atomic(results.files(), &path, &bytes).map_err(|error| error.to_string())?;
        Ok(true)
    }

    /// Position of the only entry whose job id begins with `prefix`; `None` where there is none, or several.
    pub fn position(&self, prefix: &str) -> Option<usize> {
        let begins_so = |entry: &Entry| entry.0.as_str().starts_with(prefix);
        let mut found = self.entries.iter().enumerate().filter(|(_, entry)| begins_so(entry));
        let (position, _) = found.next().filter(|_| !prefix.is_empty())?;
        found.next().is_none().then_some(position)
    }

    /// The job of an entry.
    pub fn job(&self, position: usize) -> Option<&JobId> {
        Some(&self.entries.get(position)?.0)
    }

    /// Number of jobs that have ended.
    pub fn records(&self) -> usize {
        self.entries.iter().filter(|entry| entry.2.is_some()).count()
    }

    /// The jobs with a history file, and its size and time.
    pub fn files(&self) -> impl Iterator<Item = (&JobId, &Stamp)> {
        self.entries.iter().filter_map(|entry| Some((&entry.0, entry.3.as_ref()?)))
    }

    /// The results at these entries alone, as those of the whole folder show them; `None` where a record or a point
    /// is not the one that the index names.
    pub fn stored<'a>(&self, results: &Results<'a>, positions: &[usize]) -> Option<Stored<'a>> {
        let study = Study::sketch(&results.study_path(), &[]).ok()??;
        let study = study.counted(self.runs, self.points);
        let entries = positions.iter().map(|position| self.entries.get(*position));
        let entries: Vec<&Entry> = entries.collect::<Option<_>>()?;
        let numbers: Vec<usize> = entries.iter().flat_map(|entry| entry.1.clone()).collect();
        let points = study.generation_of(&numbers)?.points;
        let planned = points.iter().map(|point| &point.job.id);
        if !planned.eq(entries.iter().map(|entry| &entry.0)) {
            return None;
        }
        let mut journal = Journal::default();
        for entry in entries.iter().filter(|entry| entry.2.is_some()) {
            journal.records.insert(entry.0.clone(), self.record(results, entry)?);
        }
        let units = study.display_units().clone();
        Some(Stored { results: results.clone(), study, units, journal, points })
    }

    /// The record of an entry.
    fn record(&self, results: &Results<'_>, entry: &Entry) -> Option<Record> {
        let place = entry.2?;
        let path: PathBuf = results.journal_path().join(self.key.journal(place.journal)?);
        let line = results.files().read_part(&path, place.offset, place.length).ok()?;
        journal::record_in(&line).filter(|record| record.job == entry.0)
    }
}

#[cfg(test)]
mod tests;
