//! What planning knows of the jobs that have ended.

use billow_solver::output::measures::Verdict;

use crate::job::result_limit::ResultLimit;
use crate::job::row::Cells;
use crate::job::{JobId, Status};

/// What planning knows of a finished job.
#[derive(Debug, Clone, PartialEq)]
pub struct FinishedRow {
    /// The job.
    pub id: JobId,
    /// Its status, as in the table.
    pub status: Status,
    /// Its verdict.
    pub verdict: Option<Verdict>,
    /// For each limit of the study whether it is met, where that can be said.
    pub met: Vec<Option<bool>>,
}

impl FinishedRow {
    /// The row of a job that ended with these cells.
    pub fn of(id: &JobId, cells: &Cells, limits: &[ResultLimit]) -> Self {
        let status = cells.status();
        let met = limits
            .iter()
            .map(|limit| limit.judge(status, cells.get(limit.measure)).map(|judged| judged.met));
        Self { id: id.clone(), status, verdict: cells.verdict(), met: met.collect() }
    }
}
