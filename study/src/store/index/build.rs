//! Makes the index of results that were read whole.

use std::collections::HashMap;

use super::{Entry, FORMAT, Index, Key, VERSION};
use crate::job::JobId;
use crate::job::row::{ColumnId, Counts};
use crate::store::journal::Journal;
use crate::store::stored::Stored;
use crate::store::table::{Table, parquet};

impl Index {
    /// The index of results. `key` is that of the folder before they were read, `table` their table. `None` for
    /// results that have none, and where the stored table is another one.
    pub fn of(stored: &Stored<'_>, key: Key, table: &Table) -> Option<Self> {
        let Stored { results, study, journal, points, .. } = stored;
        if !study.is_plain_grid() || !is_plain(journal, &key) {
            return None;
        }
        let written = results.files().read(&results.table_path()).ok()?;
        if parquet::stored_checksum(&written)? != parquet::checksum(table) {
            return None;
        }
        let mut index = Self {
            format: FORMAT.to_owned(),
            version: VERSION,
            key,
            counts: Counts::default(),
            seconds: 0.0,
            timed: 0,
            runs: stored.planned_runs(),
            points: study.point_count(),
            finished: serde_json::Value::Null,
            failed: Vec::new(),
            entries: Vec::with_capacity(points.len()),
        };
        let mut numbers = numbers(stored);
        for (position, point) in points.iter().enumerate() {
            let cells = stored.cells(point);
            index.counts.add_cells(&cells);
            if let Some(wall) = cells.number(ColumnId::WallSeconds) {
                index.seconds += wall;
                index.timed += 1;
            }
            if cells.status().is_failure() {
                index.failed.push(position);
            }
            let id = &point.job.id;
            let record = journal.records.get(id);
            let place = record.and_then(|_| journal.places.get(id).copied());
            let file = record.filter(|record| record.file_hash.is_some());
            // Without a stamp every reader of the file must hash it.
            let stamp = file.map(|record| record.file_stamp.clone());
            if stamp == Some(None) || place.is_some() != record.is_some() {
                return None;
            }
            index.entries.push(Entry(id.clone(), numbers.remove(id)?, place, stamp.flatten()));
        }
        (index.records() == journal.records.len()).then_some(index)
    }
}

/// Whether the journals hold the records of planned jobs and nothing else.
fn is_plain(journal: &Journal, key: &Key) -> bool {
    let is_study = journal.study.as_deref().is_some_and(|text| key.is_study(text));
    let Journal { invalidated, deaths, remedies, unsealed, faults, .. } = journal;
    is_study
        && invalidated.is_empty()
        && deaths.is_empty()
        && remedies.is_empty()
        && *unsealed == 0
        && faults.is_empty()
}

/// The numbers of the study's points of each job.
fn numbers(stored: &Stored<'_>) -> HashMap<JobId, Vec<usize>> {
    let all = stored.study.point_numbers();
    if all.len() == stored.points.len() {
        let ids = stored.points.iter().map(|point| point.job.id.clone());
        return ids.zip(all).map(|(id, number)| (id, vec![number])).collect();
    }
    let mut numbers: HashMap<JobId, Vec<usize>> = HashMap::new();
    for (point, number) in stored.study.points().iter().zip(all) {
        numbers.entry(JobId::of(&point.scene)).or_default().push(number);
    }
    numbers
}
