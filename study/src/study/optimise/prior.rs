//! What a cheap model says of the points of a search, before film does.
//!
//! The model is `storeys`: a tenth of a second a run. Its runs are part of the plan, as the fold patterns are, and no rows of
//! the table: their measures are in no answer. How they are used says `expected.rs`.

use std::collections::BTreeMap;
use std::sync::{Arc, Mutex, PoisonError};

use billow_solver::models::run::Progress;
use billow_solver::platform::simd::InstructionSet;
use billow_solver::scene::ModelKind;
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
/// Runs of a point at most. Chosen: replicates are one run to it; of samples four show their middle.
const MAX_RUNS: usize = 4;

/// What ran before: a plan asks for the same runs in each generation.
static KNOWN: Mutex<BTreeMap<JobId, Cells>> = Mutex::new(BTreeMap::new());

/// The jobs of the cheap model for the runs of one point, each once.
pub(super) fn jobs(runs: &[Point]) -> Vec<Job> {
    let mut jobs: Vec<Job> = Vec::new();
    for run in runs.iter().filter(|run| run.infeasible.is_none()) {
        let mut scene = (*run.job.scene).clone();
        scene.solver.model = ModelKind::Storeys;
        let id = JobId::of(&scene);
        if jobs.len() < MAX_RUNS && jobs.iter().all(|job| job.id != id) {
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
