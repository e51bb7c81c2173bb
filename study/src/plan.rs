//! Which jobs a study has, and why some of its points have none.
//!
//! Planning is a pure function of the study and the rows already finished. A plain grid has one
//! generation; a search has several, and a resume replays them.

use billow_solver::fold::Nearest;

use crate::job::{Job, JobId, Parameters};
use crate::study::Study;

/// The jobs that can be planned together.
#[derive(Debug, Clone, PartialEq)]
pub struct Generation {
    /// 0 for the first.
    pub number: u32,
    /// Points in plan order.
    pub points: Vec<Point>,
}

/// One point of the grid.
#[derive(Debug, Clone, PartialEq)]
pub struct Point {
    /// The job; for an infeasible point it carries the id and the parameters of its row.
    pub job: Job,
    /// Set when no fold pattern meets the design: the point is a row, not a run.
    pub infeasible: Option<Infeasible>,
    /// Parameters of later points that resolve to the same job.
    pub merged: Vec<Parameters>,
}

/// Why a point has no pattern.
#[derive(Debug, Clone, PartialEq)]
pub struct Infeasible {
    /// Reason.
    pub reason: String,
    /// Nearest feasible values, each for a change of that key alone.
    pub nearest: Vec<Nearest>,
}

/// What planning may know of a finished job.
#[derive(Debug, Clone, PartialEq)]
pub struct FinishedRow {
    /// The job.
    pub id: JobId,
    /// Its status, as in the table.
    pub status: String,
    /// Its verdict, as in the table.
    pub verdict: Option<String>,
}

/// The next generation of a study, or `None` when nothing is left to plan. Pure: the same study and
/// the same finished rows, in any order, give the same generation.
pub fn next_jobs(study: &Study, finished: &[FinishedRow]) -> Option<Generation> {
    let _ = (study, finished);
    todo!()
}
