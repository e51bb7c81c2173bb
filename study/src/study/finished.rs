//! What planning knows of the jobs that have ended.

use billow_solver::output::measures::Verdict;

use crate::accuracy::{AssumedRanges, RowErrors};
use crate::job::result_limit::{Judged, ResultLimit};
use crate::job::row::{Cells, ColumnId};
use crate::job::{Job, JobId, Status};

/// What the results of a study are judged by.
#[derive(Debug, Clone, Copy)]
pub struct Judging<'a> {
    /// What they must meet to be safe.
    pub limits: &'a [ResultLimit],
    /// The ranges of what is assumed.
    pub assumed: &'a AssumedRanges,
    /// The measures that a search makes small.
    pub minimised: &'a [ColumnId],
}

/// What planning knows of a finished job.
#[derive(Debug, Clone, PartialEq)]
pub struct FinishedRow {
    /// The job.
    pub id: JobId,
    /// Its status, as in the table.
    pub status: Status,
    /// Its verdict.
    pub verdict: Option<Verdict>,
    /// What each limit of the study says of it.
    pub limits: Vec<Option<Judged>>,
    /// The measures that a search makes small; `None` unless the job is done.
    pub minimised: Vec<Option<f64>>,
}

impl FinishedRow {
    /// The row of a job that ended with these cells.
    pub fn of(job: &Job, cells: &Cells, by: Judging<'_>) -> Self {
        let status = cells.status();
        let errors = match by.limits {
            [] => RowErrors::NONE,
            _ => RowErrors::of(&job.scene, cells, by.assumed),
        };
        let known = |limit: &ResultLimit| {
            let uncertainty = errors.uncertainty(limit.measure, cells);
            limit.judge(status, cells.get(limit.measure), uncertainty)
        };
        let limits = by.limits.iter().map(known).collect();
        let value = |measure: &ColumnId| {
            let value = cells.get(*measure).any_number().filter(|value| value.is_finite());
            value.filter(|_| status == Status::Done)
        };
        let minimised = by.minimised.iter().map(value).collect();
        Self { id: job.id.clone(), status, verdict: cells.verdict(), limits, minimised }
    }
}
