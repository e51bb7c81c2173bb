//! Which jobs a study has, and why some of its points have none.
//!
//! Planning is a pure function of the study and the rows already finished. A plain grid has one
//! generation; a search has several, and a resume replays them.

use std::collections::hash_map::Entry;
use std::collections::{BTreeSet, HashMap};

use billow_solver::fold::{FoldPattern, Nearest};

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
    /// What the fold solves; `None` where no pattern meets the design.
    pub solved: Option<Solved>,
    /// Parameters of later points that resolve to the same job.
    pub merged: Vec<Parameters>,
}

/// What the fold of a point solves.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Solved {
    /// ϕ, rad.
    pub phi: f64,
    /// Half top angle, rad.
    pub half_angle: f64,
    /// r1, m.
    pub top_radius: f64,
    /// H, m.
    pub height: f64,
}

impl Solved {
    /// Of a pattern.
    pub fn of(pattern: &FoldPattern) -> Self {
        Self {
            phi: pattern.angles.phi,
            half_angle: pattern.half_angle,
            top_radius: pattern.top_radius,
            height: pattern.height,
        }
    }
}

/// Why a point has no pattern.
#[derive(Debug, Clone, PartialEq)]
pub struct Infeasible {
    /// Reason.
    pub reason: String,
    /// Nearest feasible values, each for a change of that key alone.
    pub nearest: Vec<Nearest>,
}

impl Infeasible {
    /// The nearest feasible values in words, as a table cell has them; empty where there are none.
    pub fn nearest_text(&self) -> String {
        let nearest = self.nearest.iter();
        let texts: Vec<String> =
            nearest.map(|near| format!("{} = {}", near.key, near.value)).collect();
        texts.join(" or ")
    }
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
