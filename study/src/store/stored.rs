//! The contents of a results folder: its study, planned again, and its journal. Reading changes
//! nothing and holds no lock, so it works while a run goes on.

use std::collections::{BTreeMap, BTreeSet};
use std::path::PathBuf;
use std::sync::Arc;

use crate::input::units::DisplayUnits;
use crate::input::value::Value;
use crate::job::id::common_prefix_length;
use crate::job::point::Point;
use crate::job::row::{Cells, ColumnId};
use crate::job::{JobId, Status};
use crate::platform::error::{Error, InputError, Result};
use crate::platform::provenance::PHYSICS_VERSION;
use crate::platform::quote;
use crate::store::finished;
use crate::store::history_file;
use crate::store::journal::{self, Journal, Record};
use crate::store::results::Results;
use crate::store::table::Table;
use crate::study::finished::FinishedRow;
use crate::study::plan;
use crate::study::{Border, Optimum, Study};

/// Ids in the message about an id that is not found or not unique, at most.
const MAX_IDS_SHOWN: usize = 5;

/// A results folder that was read.
pub struct Stored<'a> {
    /// The folder.
    pub results: Results<'a>,
    /// The study that the folder was last run for.
    pub study: Study,
    /// The units in which its quantities are shown: those of the study.
    pub units: DisplayUnits,
    /// Its journals.
    pub journal: Journal,
    /// Every point planned so far, in plan order.
    pub points: Arc<Vec<Point>>,
}

impl<'a> Stored<'a> {
    /// Reads a folder. Journal lines that are not valid are skipped; they are in
    /// [`Journal::faults`].
    ///
    /// # Errors
    /// [`Error::Disk`] when there is no study.json, or when a file cannot be read.
    pub fn read(results: Results<'a>) -> Result<Self> {
        if results.owner()?.is_none() {
            let root = quote::path(results.root());
            let problem = if results.journal_path().is_dir() {
                format!("study.json is missing\n  next: billow doctor --repair {root}")
            } else {
                "no results here: no study.json\n  next: run `billow run STUDY` first, or name the folder of its \
                 results"
                    .to_owned()
            };
            return Err(Error::Disk { path: results.root().to_owned(), problem });
        }
        let journal = results.journal()?;
        let study = Study::load(&results.study_path(), &[])?;
        Ok(Self::of(results, study, journal))
    }

    /// A folder whose study and journal were read.
    pub fn of(results: Results<'a>, study: Study, journal: Journal) -> Self {
        let points = planned(&study, &journal);
        let units = study.display_units().clone();
        Self { results, study, units, journal, points }
    }

    /// The same results, read as those of another study: one that differs in its limits.
    #[must_use]
    pub fn asked(self, study: Study) -> Self {
        Self::of(self.results, study, self.journal)
    }

    /// The row of a point.
    pub fn cells(&self, point: &Point) -> Cells {
        journal::row_of(point, &self.journal.records)
    }

    /// The row of a job: that of its point, or for a job without one its record.
    pub fn cells_of_job(&self, id: &JobId) -> Cells {
        if let Some(point) = self.point(id) {
            return self.cells(point);
        }
        let record = self.record(id).map(|record| record.cells.clone());
        record.unwrap_or_else(|| Cells::new(Status::Pending))
    }

    /// The table, built from plan and journal: one row per point, also for points that share a job.
    pub fn table(&self) -> Table {
        self.built(&self.points)
    }

    /// The table of all rows; where rows stand alone, of the first points alone that have this number of rows.
    pub fn first_rows(&self, rows: Option<usize>) -> Table {
        let rows = rows.filter(|_| self.study.rows_stand_alone()).unwrap_or(usize::MAX);
        self.built(&self.points[..rows.min(self.points.len())])
    }

    /// The table of one job: a row for each of its points. `None` for a job that no row shows.
    pub fn table_of(&self, id: &JobId) -> Option<Table> {
        let point = self.point(id)?;
        if !self.study.meshes().of_pilots {
            return Some(self.built(std::slice::from_ref(point)));
        }
        // Only the whole table knows the errors of the pilots.
        let mut table = self.table();
        let ids = table.column("job")?.cells.clone();
        let id = Value::Text(id.as_str().to_owned());
        let rows: Vec<usize> = (0..ids.len()).filter(|row| ids[*row] == id).collect();
        for column in &mut table.columns {
            column.cells = rows.iter().map(|row| column.cells[*row].clone()).collect();
        }
        Some(table)
    }

    /// The table of these points, shown in the study's units.
    fn built(&self, points: &[Point]) -> Table {
        Table::of_study(&self.study, points, &self.journal.records).shown_in(&self.units)
    }

    fn finished(&self) -> Vec<FinishedRow> {
        finished::rows(&self.points, &self.journal.records, self.study.judging())
    }

    /// Number of runs planned so far, one for each replicate of a point, also of those that share a job.
    pub fn planned_runs(&self) -> usize {
        self.points.iter().map(|point| 1 + point.merged.len()).sum()
    }

    /// Number of runs of pilots among them.
    pub fn pilot_runs(&self) -> usize {
        let pilots = self.points.iter().filter(|point| self.study.is_pilot(point));
        pilots.map(|point| 1 + point.merged.len()).sum()
    }

    /// What the searches of the study have found so far.
    pub fn borders(&self) -> Vec<Border> {
        let finished = self.finished();
        if !self.study.meshes().of_pilots {
            return plan::borders(&self.study, &finished, &finished);
        }
        // Only the whole table knows the errors of the pilots.
        let table = self.table();
        let jobs = table.one_row_per_job(&(0..table.rows()).collect::<Vec<_>>());
        // Both stand in the order of the plan.
        let ended = jobs.iter().filter(|row| table.status(**row) != Some(Status::Pending));
        let mut judged = finished.clone();
        for (row, position) in judged.iter_mut().zip(ended) {
            let limits = self.study.result_limits().iter();
            row.limits = limits.map(|limit| table.judge(limit, *position)).collect();
        }
        plan::borders(&self.study, &finished, &judged)
    }

    /// What the search of an optimum has found so far; `None` without one.
    pub fn optimum(&self) -> Option<Optimum> {
        plan::optimum(&self.study, &self.finished())
    }

    /// The point of a job.
    pub fn point(&self, id: &JobId) -> Option<&Point> {
        self.points.iter().find(|point| point.job.id == *id)
    }

    /// The last record of a job, also of an invalidated one.
    pub fn record(&self, id: &JobId) -> Option<&Record> {
        self.journal.record(id)
    }

    /// Path of the history file of a job, after a check that it is the file that its record names.
    ///
    /// # Errors
    /// [`Error::Disk`] with the reason when the job has no history, or another one.
    pub fn history_path(&self, id: &JobId) -> Result<PathBuf> {
        let path = self.results.job_path(id);
        let record = self.record(id);
        let root = quote::path(self.results.root());
        let (why, next) = match (self.point(id), record) {
            (_, Some(record)) if record.file_hash.is_some() => {
                return self.results.check_history(record).map(|()| path);
            }
            (Some(point), None) if point.infeasible.is_some() => (
                "the point is infeasible, so no job ran",
                format!("billow job {} {root}", id.short()),
            ),
            (_, None) => {
                ("the job has not run yet", format!("billow run, then billow status {root}"))
            }
            (_, Some(_)) => {
                ("the job wrote no history", format!("billow job {} {root}", id.short()))
            }
        };
        Err(Error::Disk { path, problem: format!("{why}\n  next: {next}") })
    }

    /// The planned or recorded job whose id begins with `prefix`.
    ///
    /// # Errors
    /// [`Error::Input`] when no id or several ids begin so. The message lists the nearest ids.
    pub fn job(&self, prefix: &str) -> Result<JobId> {
        let wanted = wanted(prefix);
        let planned = self.points.iter().map(|point| &point.job.id);
        let recorded = self.journal.records.keys().chain(self.journal.invalidated.keys());
        let known: BTreeSet<&JobId> = planned.chain(recorded).collect();
        let begins_so = |id: &&&JobId| !wanted.is_empty() && id.as_str().starts_with(&wanted);
        let found: Vec<&JobId> = known.iter().filter(begins_so).copied().collect();
        match found.as_slice() {
            [id] => Ok((*id).clone()),
            [] => {
                let mut near: Vec<&JobId> = known.into_iter().collect();
                // The sort is stable: ids with equal prefixes stay in order.
                let common = |id: &&JobId| common_prefix_length(id.as_str(), &wanted);
                near.sort_by_key(|id| std::cmp::Reverse(common(id)));
                Err(self.no_job(prefix, "no job has this id", &near))
            }
            several => {
                Err(self.no_job(prefix, &format!("{} job ids begin so", several.len()), several))
            }
        }
    }

    fn no_job(&self, prefix: &str, problem: &str, near: &[&JobId]) -> Error {
        let mut allowed: Vec<String> =
            near.iter().take(MAX_IDS_SHOWN).map(|id| self.label(id)).collect();
        if near.len() > MAX_IDS_SHOWN {
            allowed.push(format!("and {} more", near.len() - MAX_IDS_SHOWN));
        }
        InputError {
            file: "job".to_owned(),
            key: String::new(),
            value: if prefix.is_empty() { "\"\"" } else { prefix }.to_owned(),
            problem: problem.to_owned(),
            allowed: if allowed.is_empty() {
                "nothing: the study has no jobs".to_owned()
            } else {
                format!("the first digits of one id: {}", allowed.join("; "))
            },
            hint: format!("billow table {} --runs --columns job", quote::path(self.results.root())),
        }
        .into()
    }

    /// The scene of a job as JSON: the stored one if the job has run, else the one that will run.
    ///
    /// # Errors
    /// A history that cannot be read, or whose scene is not JSON.
    pub fn scene(&self, id: &JobId) -> Result<serde_json::Value> {
        let is_stored = self.record(id).is_some_and(|record| record.file_hash.is_some());
        let scene = match self.point(id) {
            Some(point) if !is_stored && point.job.id == *id => {
                serde_json::to_value(&*point.job.scene)
            }
            _ => serde_json::from_str(&history_file::read(&self.history_path(id)?)?.scene),
        };
        scene.map_err(|error| Error::Disk {
            path: self.results.job_path(id),
            problem: format!("its scene is not valid JSON: {error}"),
        })
    }

    /// Short id and parameters of a job, for messages.
    pub fn label(&self, id: &JobId) -> String {
        let label = |point: &Point| self.study.label(&point.job.parameters, &self.units);
        let parameters = self.point(id).map(label);
        match parameters {
            Some(text) if !text.is_empty() => format!("{} ({text})", id.short()),
            _ => id.short().to_owned(),
        }
    }
}

/// The digits that a prefix of a job id asks for.
pub fn wanted(prefix: &str) -> String {
    prefix.trim().to_ascii_lowercase()
}

/// Numbers of finished jobs of other versions of the physics, by version. A planned job does not count,
/// whatever version its record has.
pub fn other_physics(points: &[Point], records: &BTreeMap<JobId, Record>) -> BTreeMap<i64, usize> {
    let planned: BTreeSet<&JobId> = points.iter().map(|point| &point.job.id).collect();
    let mut versions = BTreeMap::new();
    for record in records.values().filter(|record| !planned.contains(&record.job)) {
        if let Value::Integer(version) = record.cells.get(ColumnId::PhysicsVersion)
            && *version != i64::from(PHYSICS_VERSION)
        {
            *versions.entry(*version).or_default() += 1;
        }
    }
    versions
}

/// Every point that the study plans with these finished jobs: generation after generation, as in a run.
pub fn planned(study: &Study, journal: &Journal) -> Arc<Vec<Point>> {
    let mut points = Arc::default();
    let mut last = None;
    let mut finished = Vec::new();
    while let Some(generation) = plan::next_jobs(study, &finished)
        && last.is_none_or(|last| generation.number > last)
    {
        last = Some(generation.number);
        plan::add_generation(&mut points, generation);
        if !study.has_generations() {
            break;
        }
        finished = finished::rows(&points, &journal.records, study.judging());
    }
    points
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::run::fixture;

    #[test]
    fn unplanned_jobs_of_another_physics_version_are_counted() {
        let all = fixture::points(5);
        let mut records = BTreeMap::new();
        for (number, point) in all.iter().enumerate() {
            let mut cells = Cells::new(Status::Done);
            let version = i64::from(PHYSICS_VERSION) - i64::from(number != 4);
            cells.set(ColumnId::PhysicsVersion, version);
            let record =
                Record { job: point.job.id.clone(), cells, file_hash: None, file_stamp: None };
            records.insert(record.job.clone(), record);
        }
        // Jobs 0 and 1 are planned, job 4 is of the version of today.
        let old = i64::from(PHYSICS_VERSION) - 1;
        assert_eq!(other_physics(&all[..2], &records), [(old, 2)].into());
        assert!(other_physics(&all, &records).is_empty());
    }
}
