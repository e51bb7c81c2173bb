//! Which jobs a study has, and why some of its points have none.
//!
//! Planning is a pure function of the study and the rows already finished. A plain grid has one
//! generation; a search has several, and a resume replays them.

use std::collections::hash_map::Entry;
use std::collections::{BTreeSet, HashMap};

use crate::job::point::Point;
use crate::job::row::{Cells, ColumnId};
use crate::job::{Job, JobId, Status};
use crate::study::Study;

/// The jobs that can be planned together.
#[derive(Debug, Clone, PartialEq)]
pub struct Generation {
    /// 0 for the first.
    pub number: u32,
    /// Points in plan order.
    pub points: Vec<Point>,
}

/// What planning may know of a finished job.
#[derive(Debug, Clone, PartialEq)]
pub struct FinishedRow {
    /// The job.
    pub id: JobId,
    /// Its status, as in the table.
    pub status: Status,
    /// Its verdict, as in the table.
    pub verdict: Option<String>,
}

impl FinishedRow {
    /// Of a job that ended with these cells.
    pub fn of(id: &JobId, cells: &Cells) -> Self {
        let verdict = Some(cells.text(ColumnId::Verdict)).filter(|text| !text.is_empty());
        Self { id: id.clone(), status: cells.status(), verdict: verdict.map(str::to_owned) }
    }
}

/// The next generation of a study, or `None` when nothing is left to plan. Pure: the same study and
/// the same finished rows, in any order, give the same generation.
///
/// A grid has one generation. It is planned while any of its jobs has no finished row, and it is
/// whole each time: which of its points are finished is for the runner to see. Infeasible points
/// need no run, so they hold nothing up; but with no finished row at all the generation is always
/// given, so that a study of infeasible points alone gets its rows.
pub fn next_jobs(study: &Study, finished: &[FinishedRow]) -> Option<Generation> {
    let finished: BTreeSet<&JobId> = finished.iter().map(|row| &row.id).collect();
    let generation = first_generation(study);
    let open = generation
        .points
        .iter()
        .any(|point| point.infeasible.is_none() && !finished.contains(&point.job.id));
    (open || finished.is_empty()).then_some(generation)
}

/// Every point of the grid; points that resolve to the same job are one, at the place of the first.
fn first_generation(study: &Study) -> Generation {
    let mut points: Vec<Point> = Vec::with_capacity(study.points().len());
    let mut places: HashMap<JobId, usize> = HashMap::new();
    for point in study.points() {
        let id = JobId::of(&point.scene);
        match places.entry(id) {
            Entry::Occupied(place) => points[*place.get()].merged.push(point.parameters.clone()),
            Entry::Vacant(place) => {
                let job = Job {
                    id: place.key().clone(),
                    parameters: point.parameters.clone(),
                    scene: point.scene.clone(),
                };
                place.insert(points.len());
                let infeasible = point.infeasible.clone();
                points.push(Point { job, infeasible, solved: point.solved, merged: Vec::new() });
            }
        }
    }
    Generation { number: 0, points }
}
