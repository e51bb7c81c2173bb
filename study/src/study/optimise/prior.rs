//! What a cheap model says of the points of a search, before film does.
//!
//! The model is `storeys`: about a tenth of a second a run. Its runs are part of the plan, as the fold patterns are, and no
//! rows of the table: their measures are in no answer. How they are used says `expected.rs`.

use std::collections::BTreeMap;
use std::sync::{Arc, Mutex, PoisonError};

use billow_solver::models;
use billow_solver::models::run::Progress;
use billow_solver::platform::simd::InstructionSet;
use billow_solver::scene::{ModelKind, Scene};
use rayon::iter::{IntoParallelRefIterator, ParallelIterator};

use crate::job::control::{Control, Order, Task};
use crate::job::executor::{Solver, execute_guarded};
use crate::job::limits::JobLimits;
use crate::job::point::Point;
use crate::job::references::References;
use crate::job::row::Cells;
use crate::job::{Job, JobId};
use crate::study::finished::{FinishedRow, Judging};

/// Points of the cheap model, beside those of the search: spread evenly.
pub const POINTS: usize = 64;
/// Samples of a point that it runs with, at most. Chosen: four, spread over them, show their middle.
const MAX_SAMPLES: usize = 4;

/// What ran before: a plan asks for the same runs in each generation.
static KNOWN: Mutex<BTreeMap<JobId, Cells>> = Mutex::new(BTreeMap::new());

/// Whether these points are of film, and the cheap model can compute them all.
pub fn is_of(points: &[Point]) -> bool {
    let mut points = points.iter().filter(|point| point.infeasible.is_none()).peekable();
    points.peek().is_some()
        && points.all(|point| {
            point.job.scene.solver.model == ModelKind::Film && models::check(&scene(point)).is_ok()
        })
}

/// The scene of a point with the cheap model.
fn scene(point: &Point) -> Scene {
    let mut scene = (*point.job.scene).clone();
    scene.solver.model = ModelKind::Storeys;
    scene
}

/// The jobs of the cheap model for the runs of one point, each once: some of its samples, with the first of the other
/// replicates. `replicates` are the columns of these.
pub(super) fn jobs(runs: &[Point], replicates: &[usize]) -> Vec<Job> {
    let is_of_first = |run: &&Point| {
        let value = |run: &Point, column: usize| run.job.parameters[column].1.clone();
        replicates.iter().all(|column| value(run, *column) == value(&runs[0], *column))
    };
    let samples: Vec<&Point> = runs.iter().filter(is_of_first).collect();
    let chosen = samples.len().min(MAX_SAMPLES);
    let spread = (0..chosen).map(|k| samples[(2 * k + 1) * samples.len() / (2 * chosen)]);
    let mut jobs: Vec<Job> = Vec::new();
    for run in spread.filter(|run| run.infeasible.is_none()) {
        let scene = scene(run);
        let id = JobId::of(&scene);
        if jobs.iter().all(|job| job.id != id) {
            let parameters = run.job.parameters.clone();
            jobs.push(Job { id, parameters, scene: Arc::new(scene) });
        }
    }
    jobs
}

/// What is known of these jobs once they have run.
pub(super) fn rows(jobs: &[Job], judging: Judging<'_>) -> Vec<FinishedRow> {
    let known = || KNOWN.lock().unwrap_or_else(PoisonError::into_inner);
    let mut new = jobs.to_vec();
    new.retain(|job| !known().contains_key(&job.id));
    let (instruction_set, references) = (InstructionSet::detect(), References::default());
    let solver = Solver { instruction_set, references };
    let run = |job: &Job| {
        let limits = JobLimits::default();
        let task = Task { job, limits, checkpoint: None, control: &ToItsEnd };
        let cells = Cells::of(job, &execute_guarded(&solver, &task), None)?;
        Some((job.id.clone(), cells))
    };
    let ran: Vec<(JobId, Cells)> = new.par_iter().filter_map(run).collect();
    known().extend(ran);
    let known = known();
    let row = |job: &Job| Some(FinishedRow::of(job, known.get(&job.id)?, judging));
    jobs.iter().filter_map(row).collect()
}

/// A run without an observer.
struct ToItsEnd;

impl Control for ToItsEnd {
    fn order(&self) -> Order {
        Order::Continue
    }

    fn progress(&self, _: Progress) {}

    fn store(&self, _: &str, _: f64) {}

    fn note(&self, _: String) {}
}
