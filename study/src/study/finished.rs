//! What planning knows of the jobs that have ended.

use billow_solver::output::measures::Verdict;

use crate::accuracy::RowErrors;
use crate::job::result_limit::{ResultLimit, Safety};
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
    /// For each limit of the study what is known of it, as far as its uncertainty is known.
    pub limits: Vec<Option<Safety>>,
}

impl FinishedRow {
    /// The row of a job that ended with these cells.
    pub fn of(job: &Job, cells: &Cells, limits: &[ResultLimit]) -> Self {
        let status = cells.status();
        let errors = match limits {
            [] => RowErrors::NONE,
            _ => RowErrors::of(&job.scene, cells),
        };
        let known = |limit: &ResultLimit| {
            let uncertainty = errors.uncertainty(limit.measure, cells);
            let judged = limit.judge(status, cells.get(limit.measure), uncertainty)?;
            Some(judged.as_far_as_known())
        };
        let limits = limits.iter().map(known).collect();
        Self { id: job.id.clone(), status, verdict: cells.verdict(), limits }
    }
}
