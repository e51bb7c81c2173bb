//! The jobs of a study.
//!
//! Planning is a pure function of the study and its finished rows. A plain grid has one generation; a
//! search has several. A resumed study replays them.

use std::collections::hash_map::Entry;
use std::collections::{BTreeSet, HashMap, HashSet};
use std::sync::Arc;

use crate::job::JobId;
use crate::job::point::Point;
use crate::study::finished::FinishedRow;
use crate::study::search::replay::Replay;
use crate::study::{Border, Optimum, Study, optimise};

/// Points that are planned together.
#[derive(Debug, Clone, PartialEq)]
pub struct Generation {
    /// 0 for the first.
    pub number: u32,
    /// Points in plan order; those of the study itself where none share a job.
    pub points: Arc<Vec<Point>>,
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
/// A generation is planned whole while any of its jobs has no finished row; the runner leaves out the
/// finished ones. A grid has one generation, a search one more each time its jobs have ended. Infeasible
/// points have no job to finish. The pilots of a study are its last generations. Without any finished row the first
/// generation is always given, so that a study of infeasible points gets its rows.
pub fn next_jobs(study: &Study, finished: &[FinishedRow]) -> Option<Generation> {
    let ids: BTreeSet<&JobId> = finished.iter().map(|row| &row.id).collect();
    let is_open = |points: &[Point]| {
        let mut jobs = points.iter().filter(|point| point.infeasible.is_none());
        jobs.any(|point| !ids.contains(&point.job.id))
    };
    if is_open(study.points()) || finished.is_empty() {
        return Some(generation(0, study.points()));
    }
    let has_pilots = study.meshes().of_pilots;
    let mut planned =
        if has_pilots { generation(0, study.points()).points } else { Arc::default() };
    let mut number = 0;
    let mut searching = Searching::of(study, finished);
    // Points without a job have nothing to wait for: they come with the next ones that have.
    let mut without_job: Vec<Point> = Vec::new();
    while let Some(points) = searching.next_points() {
        searching.add(&points);
        without_job.extend(points);
        number += 1;
        if without_job.iter().all(|point| point.infeasible.is_some()) {
            continue;
        }
        let points = Arc::new(std::mem::take(&mut without_job));
        if is_open(&points) {
            return Some(generation(number, &points));
        }
        if has_pilots {
            add_generation(&mut planned, generation(number, &points));
        }
    }
    let best = match &searching {
        Searching::Optimum(replay) => Some(replay.to_confirm()),
        _ => None,
    };
    let mut pilots = study.pilots(&planned, finished, best.as_deref());
    match pilots.first_mut() {
        Some(first) => {
            first.splice(0..0, without_job);
        }
        None if without_job.is_empty() => {}
        // The runner takes a generation of this number once.
        None => return Some(generation(number, &Arc::new(without_job))),
    }
    for pilots in pilots {
        number += 1;
        if is_open(&pilots) {
            return Some(generation(number, &Arc::new(pilots)));
        }
    }
    None
}

/// The search of a study, if it has one.
enum Searching<'a> {
    /// A grid.
    Nothing,
    /// Of borders.
    Border(Replay<'a>),
    /// Of an optimum.
    Optimum(optimise::Replay<'a>),
}

impl<'a> Searching<'a> {
    fn of(study: &'a Study, finished: &'a [FinishedRow]) -> Self {
        let border = Replay::new(study, finished).map(Self::Border);
        let optimum = || optimise::Replay::new(study, finished).map(Self::Optimum);
        border.or_else(optimum).unwrap_or(Self::Nothing)
    }

    /// The points of the next generation; `None` at the end.
    fn next_points(&mut self) -> Option<Vec<Point>> {
        let points = match self {
            Self::Nothing => Vec::new(),
            Self::Border(replay) => replay.next_points(),
            Self::Optimum(replay) => replay.next_points(),
        };
        (!points.is_empty()).then_some(points)
    }

    fn add(&mut self, points: &[Point]) {
        match self {
            Self::Nothing => {}
            Self::Border(replay) => replay.add(points),
            Self::Optimum(replay) => replay.add(points),
        }
    }
}

/// Adds a generation to the points planned before. A job that is planned already keeps its place and its
/// result, and gets the parameters of the new point.
pub fn add_generation(points: &mut Arc<Vec<Point>>, generation: Generation) {
    if points.is_empty() {
        *points = generation.points;
        return;
    }
    let known = points.iter().enumerate().map(|(index, point)| (point.job.id.clone(), index));
    let known: HashMap<JobId, usize> = known.collect();
    let points = Arc::make_mut(points);
    for point in Arc::unwrap_or_clone(generation.points) {
        match known.get(&point.job.id) {
            Some(index) => {
                points[*index].merged.push(point.job.parameters);
                points[*index].merged.extend(point.merged);
            }
            None => points.push(point),
        }
    }
}

/// What the searches of a study have found with these finished jobs; `judged` are the same with the errors of pilots.
pub fn borders(study: &Study, finished: &[FinishedRow], judged: &[FinishedRow]) -> Vec<Border> {
    let Some(mut replay) = Replay::new(study, finished) else { return Vec::new() };
    loop {
        let points = replay.next_points();
        if points.is_empty() {
            // What the pilots say plans no further jobs.
            replay.judge_by(judged);
            return replay.borders();
        }
        replay.add(&points);
    }
}

/// What the search of an optimum has found with these finished jobs; `None` for a study without one.
pub fn optimum(study: &Study, finished: &[FinishedRow]) -> Option<Optimum> {
    let mut replay = optimise::Replay::new(study, finished)?;
    while replay.has_ended_so_far() {
        let points = replay.next_points();
        if points.is_empty() {
            return Some(replay.optimum(true));
        }
        replay.add(&points);
    }
    Some(replay.optimum(false))
}

/// A generation of these points. Points with the same job are merged into the first of them.
pub(super) fn generation(number: u32, planned: &Arc<Vec<Point>>) -> Generation {
    let jobs: HashSet<&JobId> = planned.iter().map(|point| &point.job.id).collect();
    if jobs.len() == planned.len() {
        return Generation { number, points: Arc::clone(planned) };
    }
    let mut points: Vec<Point> = Vec::with_capacity(planned.len());
    let mut positions: HashMap<&JobId, usize> = HashMap::with_capacity(planned.len());
    for point in planned.iter() {
        match positions.entry(&point.job.id) {
            Entry::Occupied(entry) => {
                points[*entry.get()].merged.push(point.job.parameters.clone());
            }
            Entry::Vacant(entry) => {
                entry.insert(points.len());
                points.push(point.clone());
            }
        }
    }
    Generation { number, points: Arc::new(points) }
}
