//! Which run the row of a point shows, where its planned job failed and remedies were tried.
//!
//! ```text
//! row of a point = first run with a remedy that is done (or whose record is lost: it runs again), else the planned job
//! ```
//! The journal has a link from the planned job to each such run. The scene of the run follows from the planned scene and the
//! changes of the link, and must have the id of the run. So a link of another study, or of another program, changes nothing.

use std::collections::BTreeMap;

use billow_solver::scene::Solver;

use crate::job::point::{Point, Remedied, RemedyRun};
use crate::job::remedy::{self, Failure};
use crate::job::{Job, JobId, Status};
use crate::store::journal::{Record, RemedyLink};

/// The last record of a job, also of one that must run again.
pub type RecordOf<'a> = dyn Fn(&JobId) -> Option<&'a Record> + 'a;

/// The links of a journal, by planned job.
pub type Links = BTreeMap<JobId, Vec<RemedyLink>>;

/// Gives points whose planned job has remedies the run that their row shows. A point that shows one already keeps it.
pub fn apply(points: &mut [Point], links: &Links, record_of: &RecordOf<'_>) {
    if links.is_empty() {
        return;
    }
    for point in points.iter_mut().filter(|point| !point.shows_remedy()) {
        let Some(links) = links.get(&point.job.id) else { continue };
        let runs: Vec<(Job, RemedyRun)> =
            links.iter().filter_map(|link| run(&point.job, link, record_of)).collect();
        let has_result = |run: &RemedyRun| run.status.is_none_or(|status| status == Status::Done);
        let shown = runs.iter().position(|(_, run)| has_result(run));
        let planned = point.job.id.clone();
        if let Some(shown) = shown {
            point.job = runs[shown].0.clone();
        }
        let runs = runs.into_iter().map(|(_, run)| run).collect();
        point.remedied = Some(Remedied { planned, runs, shown });
    }
}

/// Gives points the runs that the same points of another list show.
pub fn copy(points: &mut [Point], from: &[Point]) {
    let remedied = from.iter().filter(|point| point.remedied.is_some());
    let remedied: BTreeMap<&JobId, &Point> =
        remedied.map(|point| (point.planned_id(), point)).collect();
    for point in points.iter_mut() {
        if let Some(other) = remedied.get(point.planned_id()) {
            let (id, scene) = (other.job.id.clone(), other.job.scene.clone());
            point.job = Job { id, scene, ..point.job.clone() };
            point.remedied.clone_from(&other.remedied);
        }
    }
}

/// The run of a link; `None` if it is not one of this job.
fn run(planned: &Job, link: &RemedyLink, record_of: &RecordOf<'_>) -> Option<(Job, RemedyRun)> {
    let settings = planned.scene.solver;
    let changed = link.changes.iter().fold(settings, |solver, change| change.applied(&solver));
    let job = with_settings(planned, changed);
    let status = record_of(&job.id).map(|record| record.cells.status());
    let text = remedy::text(&link.changes, &settings);
    let run = RemedyRun { job: link.by.clone(), settings: changed, text, status };
    (job.id == link.by).then_some((job, run))
}

/// A job with other settings.
fn with_settings(job: &Job, solver: Solver) -> Job {
    let mut scene = job.scene.clone();
    scene.solver = solver;
    Job { id: JobId::of(&scene), parameters: job.parameters.clone(), scene }
}

/// The next run of a point that failed.
#[derive(Debug, Clone, PartialEq)]
pub struct Attempt {
    /// Its job.
    pub job: Job,
    /// The link from the planned job.
    pub link: RemedyLink,
    /// What is changed: "solver.cfl 0.45 -> 0.225".
    pub text: String,
    /// Why, one sentence.
    pub reason: &'static str,
}

/// Why an attempt that reached a limit runs again.
const AGAIN: &str =
    "the run with this remedy reached a limit; it resumes from its checkpoint, if it has one";

/// The next run of a point; `None` for a point that has not failed, and where no remedy remains.
pub fn next(point: &Point, record_of: &RecordOf<'_>) -> Option<Attempt> {
    let has_failed = |status: Status| status.is_failure();
    let planned = &point.job;
    if point.infeasible.is_some() || point.shows_remedy() {
        return None;
    }
    let record = record_of(&planned.id).filter(|record| has_failed(record.cells.status()))?;
    let settings = planned.scene.solver;
    let mut runs = vec![(settings, Failure::of(&record.cells))];
    let mut last = record;
    for run in point.remedied.iter().flat_map(|remedied| &remedied.runs) {
        last = record_of(&run.job)?;
        runs.push((run.settings, Failure::of(&last.cells)));
    }
    let (solver, reason) = match runs.last() {
        Some((solver, _)) if runs.len() > 1 && last.reached_limit() => (*solver, AGAIN),
        _ => remedy::next(&runs)?,
    };
    let job = with_settings(planned, solver);
    let changes = remedy::changes(&settings, &solver);
    let text = remedy::text(&changes, &settings);
    let link = RemedyLink { planned: planned.id.clone(), by: job.id.clone(), changes };
    Some(Attempt { job, link, text, reason })
}
