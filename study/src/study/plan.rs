//! The jobs of a study.
//!
//! Planning is a pure function of the study and its finished rows. A plain grid has one generation; a
//! search has several, and a resumed study replays them.

use std::collections::hash_map::Entry;
use std::collections::{BTreeSet, HashMap};

use billow_solver::output::measures::Verdict;

use crate::job::point::Point;
use crate::job::row::Cells;
use crate::job::{Job, JobId, Status};
use crate::study::Study;

/// Points that are planned together.
#[derive(Debug, Clone, PartialEq)]
pub struct Generation {
    /// 0 for the first.
    pub number: u32,
    /// Points in plan order.
    pub points: Vec<Point>,
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
}

impl FinishedRow {
    /// The row of a job that ended with these cells.
    pub fn of(id: &JobId, cells: &Cells) -> Self {
        Self { id: id.clone(), status: cells.status(), verdict: cells.verdict() }
    }
}

/// Numbers of points and jobs of a plan: points = jobs + duplicates + infeasible.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub struct PlanCounts {
    /// Points of the study, without the filtered ones.
    pub points: usize,
    /// Different scenes to run.
    pub jobs: usize,
    /// Points whose job another point has already.
    pub duplicates: usize,
    /// Points without a fold pattern.
    pub infeasible: usize,
    /// Points of the product that the filter removed.
    pub filtered: usize,
}

impl PlanCounts {
    /// Counts the points of a study and of its generation.
    pub fn of(study: &Study, generation: &Generation) -> Self {
        let (infeasible, feasible): (Vec<&Point>, Vec<&Point>) =
            generation.points.iter().partition(|point| point.infeasible.is_some());
        let number = |points: &[&Point]| -> usize {
            points.iter().map(|point| 1 + point.merged.len()).sum()
        };
        Self {
            points: study.points().len(),
            jobs: feasible.len(),
            duplicates: number(&feasible) - feasible.len(),
            infeasible: number(&infeasible),
            filtered: study.filtered(),
        }
    }
}

/// The next generation of a study; `None` when every job is finished. The same study and the same
/// finished rows, in any order, give the same generation.
///
/// A grid has one generation, planned whole while any of its jobs has no finished row; the runner
/// leaves out the finished ones. Infeasible points have no job to finish. Without any finished row the
/// generation is always given, so that a study of infeasible points gets its rows.
pub fn next_jobs(study: &Study, finished: &[FinishedRow]) -> Option<Generation> {
    let finished: BTreeSet<&JobId> = finished.iter().map(|row| &row.id).collect();
    let generation = first_generation(study);
    let open = generation
        .points
        .iter()
        .any(|point| point.infeasible.is_none() && !finished.contains(&point.job.id));
    (open || finished.is_empty()).then_some(generation)
}

/// Every point of the grid. Points with the same job are merged into the first of them.
fn first_generation(study: &Study) -> Generation {
    let mut points: Vec<Point> = Vec::with_capacity(study.points().len());
    let mut positions: HashMap<JobId, usize> = HashMap::new();
    for point in study.points() {
        let id = JobId::of(&point.scene);
        match positions.entry(id) {
            Entry::Occupied(entry) => points[*entry.get()].merged.push(point.parameters.clone()),
            Entry::Vacant(entry) => {
                let job = Job {
                    id: entry.key().clone(),
                    parameters: point.parameters.clone(),
                    scene: point.scene.clone(),
                };
                entry.insert(points.len());
                let infeasible = point.infeasible.clone();
                points.push(Point { job, infeasible, solved: point.solved, merged: Vec::new() });
            }
        }
    }
    Generation { number: 0, points }
}
