//! What planning knows of the jobs that have ended.

use billow_solver::output::measures::Verdict;

use crate::accuracy::{AssumedRanges, RowErrors};
use crate::job::result_limit::{Judged, ResultLimit};
use crate::job::row::Cells;
use crate::job::{Job, JobId, Status};

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
}

impl FinishedRow {
    /// The row of a job that ended with these cells.
    pub fn of(job: &Job, cells: &Cells, limits: &[ResultLimit], assumed: &AssumedRanges) -> Self {
        let status = cells.status();
        let errors = match limits {
            [] => RowErrors::NONE,
            _ => RowErrors::of(&job.scene, cells, assumed),
        };
        let known = |limit: &ResultLimit| {
            let uncertainty = errors.uncertainty(limit.measure, cells);
            limit.judge(status, cells.get(limit.measure), uncertainty)
        };
        let limits = limits.iter().map(known).collect();
        Self { id: job.id.clone(), status, verdict: cells.verdict(), limits }
    }
}
