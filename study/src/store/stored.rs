//! What a results folder holds, read as it lies there: its study, planned again, and its journal.
//! Nothing is changed and no lock is held, so it reads the same while a run goes on.

use std::collections::{BTreeMap, BTreeSet};
use std::path::PathBuf;

use crate::job::point::Point;
use crate::job::row::{self, Cells};
use crate::job::{self, JobId};
use crate::platform::error::{Error, InputError, Result};
use crate::store::journal::{self, Journal, Record};
use crate::store::results::Results;
use crate::store::table::Table;
use crate::study::Study;
use crate::study::plan::{self, FinishedRow};

/// Ids shown when one is not found, or not told apart.
const NEAREST: usize = 5;

/// A results folder, read.
pub struct Stored<'a> {
    /// Where it lies.
    pub results: Results<'a>,
    /// The study it was last run for.
    pub study: Study,
    /// What its journals say.
    pub journal: Journal,
    /// Every point planned so far, in plan order.
    pub points: Vec<Point>,
}

impl<'a> Stored<'a> {
    /// Reads a folder.
    ///
    /// # Errors
    /// [`Error::Disk`] where there is no study.json, or what lies there cannot be read.
    pub fn read(results: Results<'a>) -> Result<Self> {
        // What a line says that cannot be read is not to be guessed.
        let (stored, faults) = Self::salvage(results)?;
        faults.into_iter().next().map_or(Ok(stored), Err)
    }

    /// Reads what can be read: journal lines that are none of ours are passed over, and told.
    ///
    /// # Errors
    /// As [`Self::read`], but for such lines.
    pub fn salvage(results: Results<'a>) -> Result<(Self, Vec<Error>)> {
        if results.owner()?.is_none() {
            return Err(Error::Disk {
                path: results.root().to_owned(),
                problem: "no results here: no study.json\n  next: `billow run STUDY` first, or \
                          name the folder of its results"
                    .to_owned(),
            });
        }
        let study = Study::load(&results.study_path(), &[])?;
        let (journal, faults) = journal::examine(results.files(), &results.journal_path())?;
        let points = planned(&study, &journal.records);
        Ok((Self { results, study, journal, points }, faults))
    }

    /// How a point ended so far.
    pub fn cells(&self, point: &Point) -> Cells {
        journal::cells_of(point, &self.journal.records).unwrap_or_else(|| Cells::new(row::PENDING))
    }

    /// The table, from plan and journal.
    pub fn table(&self) -> Table {
        Table::build(&self.points, &self.journal.records, &|name| self.study.unit(name).to_owned())
    }

    /// The table with a row for every point of the grid: those that are one job have one row each.
    pub fn table_of_all_points(&self) -> Table {
        let mut points = Vec::with_capacity(self.points.len());
        let mut seen: BTreeSet<String> = BTreeSet::new();
        for point in &self.points {
            for parameters in [&point.job.parameters].into_iter().chain(&point.merged) {
                if seen.insert(format!("{parameters:?}")) {
                    let mut point = point.clone();
                    point.job.parameters.clone_from(parameters);
                    points.push(point);
                }
            }
        }
        Table::build(&points, &self.journal.records, &|name| self.study.unit(name).to_owned())
    }

    /// The planned point of a job.
    pub fn point(&self, id: &JobId) -> Option<&Point> {
        self.points.iter().find(|point| point.job.id == *id)
    }

    /// The record of a job, the last one before it was withdrawn included.
    pub fn record(&self, id: &JobId) -> Option<&Record> {
        self.journal.records.get(id).or_else(|| self.journal.withdrawn.get(id))
    }

    /// Where the history of a job lies.
    ///
    /// # Errors
    /// [`Error::Disk`] where the job has left none, and why.
    pub fn history_path(&self, id: &JobId) -> Result<PathBuf> {
        let path = self.results.job_path(id);
        if self.record(id).is_some_and(|record| record.file_hash.is_some()) {
            return Ok(path);
        }
        let why = match (self.point(id), self.record(id)) {
            (Some(point), None) if point.infeasible.is_some() => {
                "the point is infeasible: no job ran"
            }
            (_, None) => "the job has not run yet",
            (_, Some(_)) => "the job left no history",
        };
        let next = format!("billow why {} {}", id.short(), self.results.root().display());
        Err(Error::Disk { path, problem: format!("{why}\n  next: {next}") })
    }

    /// The job a prefix of its id means, among those planned and those only recorded.
    ///
    /// # Errors
    /// [`Error::Input`] when none or several begin like that; it lists the nearest.
    pub fn job(&self, prefix: &str) -> Result<JobId> {
        let wanted = prefix.trim().to_ascii_lowercase();
        let planned = self.points.iter().map(|point| &point.job.id);
        let recorded = self.journal.records.keys().chain(self.journal.withdrawn.keys());
        let known: BTreeSet<&JobId> = planned.chain(recorded).collect();
        let begins = |id: &&&JobId| !wanted.is_empty() && id.as_str().starts_with(&wanted);
        let found: Vec<&JobId> = known.iter().filter(begins).copied().collect();
        match found.as_slice() {
            [one] => Ok((*one).clone()),
            [] => {
                let mut near: Vec<&JobId> = known.into_iter().collect();
                // Stable: ids that agree equally far stay sorted.
                let agreed = |id: &&JobId| job::agreement(id.as_str(), &wanted);
                near.sort_by_key(|id| std::cmp::Reverse(agreed(id)));
                Err(self.no_job(prefix, "no job has this id", &near))
            }
            several => Err(self.no_job(
                prefix,
                &format!("{} jobs have ids that begin like this", several.len()),
                several,
            )),
        }
    }

    fn no_job(&self, prefix: &str, problem: &str, near: &[&JobId]) -> Error {
        let mut allowed: Vec<String> = near.iter().take(NEAREST).map(|id| self.label(id)).collect();
        if near.len() > NEAREST {
            allowed.push(format!("and {} more", near.len() - NEAREST));
        }
        InputError {
            file: "job".to_owned(),
            key: String::new(),
            value: prefix.to_owned(),
            problem: problem.to_owned(),
            allowed: if allowed.is_empty() {
                "there is none".to_owned()
            } else {
                format!("the first digits of one id, as {}", allowed.join("; "))
            },
            hint: format!("billow table {} --columns job", self.results.root().display()),
        }
        .into()
    }

    /// A job as a person tells it: short id and parameters.
    pub fn label(&self, id: &JobId) -> String {
        let parameters = self.point(id).map(|point| job::label(&point.job.parameters));
        match parameters {
            Some(text) if !text.is_empty() => format!("{} ({text})", id.short()),
            _ => id.short().to_owned(),
        }
    }
}

/// Every point the study plans on what is finished: generation after generation, as a run does.
pub fn planned(study: &Study, records: &BTreeMap<JobId, Record>) -> Vec<Point> {
    let mut points: Vec<Point> = Vec::new();
    let mut last = None;
    let mut finished = Vec::new();
    while let Some(generation) = plan::next_jobs(study, &finished)
        && last.is_none_or(|last| generation.number > last)
    {
        last = Some(generation.number);
        points.extend(generation.points);
        let row = |point: &Point| {
            let cells = journal::cells_of(point, records)?;
            Some(FinishedRow::of(&point.job.id, &cells))
        };
        finished = points.iter().filter_map(row).collect();
    }
    points
}
