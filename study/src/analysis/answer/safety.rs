//! Which points are safe: all limits of the study met in all their runs.

use serde::Serialize;

use super::{Extreme, named, parameters_of};
use crate::analysis::at_limit::AtLimit;
use crate::analysis::replicates::Condensed;
use crate::input::units::DisplayUnit;
use crate::job::result_limit::Safety::{Safe, Uncertain, Unsafe};
use crate::job::result_limit::{Condition, ResultLimit};
use crate::store::table::Table;

/// The points by the limits of the study.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Safety {
    /// The limits, as in `peak_vz < 25 m/s`.
    pub limits: Vec<String>,
    /// The numbers of points.
    #[serde(flatten)]
    pub counts: SafeCounts,
    /// The run with the smallest margin of the safe point nearest to a limit; without one of the point that misses its
    /// limits least.
    pub nearest: Option<Nearest>,
    /// The same of the safe point farthest from its limits; `None` where no safe point is farther than the nearest.
    pub farthest: Option<Nearest>,
    /// For each missed limit its measure and the number of points that miss it, the most frequent first.
    #[serde(serialize_with = "named")]
    pub missed: Vec<(String, usize)>,
    /// What makes most of the uncertainty of the points that are within it, and their number, the most frequent first.
    #[serde(serialize_with = "named")]
    pub uncertain_by: Vec<(String, usize)>,
}

/// The smallest margin of a point. The value of `run` is the margin.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Nearest {
    /// The run.
    #[serde(flatten)]
    pub run: Extreme,
    /// The limit with the smallest margin.
    pub limit: AtLimit,
    /// Least and largest value of its measure over the runs of the point, SI.
    pub seeds: Option<[f64; 2]>,
}

/// Numbers of points with a job.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, Serialize)]
pub struct SafeCounts {
    /// All.
    pub points: usize,
    /// All their runs are safe.
    pub safe: usize,
    /// Within their uncertainty: that of a value reaches across a limit or is not known, or the runs differ.
    pub uncertain: usize,
    /// No limit says more: a run failed, has not ended, or lacks a measure.
    pub not_judged: usize,
}

impl Safety {
    /// The safety of points; `None` without limits.
    pub fn of(
        table: &Table,
        limits: &[ResultLimit],
        rows: &[usize],
        replicates: &[String],
    ) -> Option<Self> {
        if limits.is_empty() {
            return None;
        }
        let points = Condensed::of(table, &table.one_row_per_job(rows), replicates);
        let missed = |limit: &ResultLimit| {
            let is_missed =
                |row: &usize| table.judge(limit, *row).is_some_and(|judged| !judged.met);
            points.runs.iter().filter(|runs| runs.finest.iter().any(is_missed)).count()
        };
        let missed = limits.iter().map(|limit| (limit.measure.name().to_owned(), missed(limit)));
        let mut missed: Vec<(String, usize)> = missed.filter(|(_, points)| *points > 0).collect();
        missed.sort_by_key(|(_, points)| std::cmp::Reverse(*points));
        let all: Vec<usize> = points.feasible().collect();
        let uncertain = all.iter().filter(|point| points.safety(**point) == Some(Uncertain));
        let mut uncertain_by: Vec<(String, usize)> = Vec::new();
        for point in uncertain {
            let Some(cause) = cause(table, limits, &points, *point) else { continue };
            match uncertain_by.iter_mut().find(|(known, _)| *known == cause) {
                Some((_, count)) => *count += 1,
                None => uncertain_by.push((cause.to_owned(), 1)),
            }
        }
        uncertain_by.sort_by_key(|(_, count)| std::cmp::Reverse(*count));
        let safe = |point: &usize| points.safety(*point) == Some(Safe);
        let safe: Vec<usize> = all.iter().copied().filter(safe).collect();
        let margins = safe.iter().filter_map(|point| margin(table, limits, &points, *point));
        let nearest = margins.reduce(|a, b| if b.run.value < a.run.value { b } else { a });
        let is_farther =
            |far: &Nearest| nearest.as_ref().is_some_and(|near| far.run.value > near.run.value);
        let farthest = safest(table, limits, &points, &safe).filter(is_farther);
        Some(Self {
            limits: limits.iter().map(ToString::to_string).collect(),
            counts: SafeCounts::of(&points, &all),
            nearest: nearest.or_else(|| safest(table, limits, &points, &all)),
            farthest,
            missed,
            uncertain_by,
        })
    }
}

/// What makes most of the uncertainty of a point: of the value nearest to a limit that is within it the larger part towards
/// that limit; or that runs differ.
fn cause(
    table: &Table,
    limits: &[ResultLimit],
    points: &Condensed,
    point: usize,
) -> Option<&'static str> {
    let runs = &points.runs[point].finest;
    let at = |row: &usize| {
        limits.iter().map(|limit| AtLimit::of(table, limit, *row)).collect::<Vec<_>>()
    };
    let uncertain = |one: &AtLimit| one.judged.is_some_and(|judged| judged.safety() == Uncertain);
    let margin = |one: &AtLimit| one.judged.map_or(f64::INFINITY, |judged| judged.margin.abs());
    let nearest = runs.iter().flat_map(at).filter(uncertain);
    let Some(nearest) = nearest.min_by(|a, b| margin(a).total_cmp(&margin(b))) else {
        return Some("runs that differ");
    };
    let judged = nearest.judged?;
    let differs = |row: &usize| {
        table.judge(&nearest.limit, *row).is_some_and(|other| other.met != judged.met)
    };
    if runs.iter().any(differs) {
        return Some("runs that differ");
    }
    let Condition::Bound { above, .. } = nearest.limit.condition else { return None };
    let Some(mesh) = nearest.mesh_error else { return Some("mesh error not known") };
    let towards = usize::from(above != judged.met);
    let assumed = nearest.assumed.map_or(0.0, |sides| sides[towards]);
    Some(if assumed > mesh[towards] { "what is assumed" } else { "mesh" })
}

impl SafeCounts {
    /// Counts some points.
    fn of(points: &Condensed, some: &[usize]) -> Self {
        let mut counts = Self { points: some.len(), ..Self::default() };
        for point in some {
            match points.safety(*point) {
                Some(Safe) => counts.safe += 1,
                Some(Uncertain) => counts.uncertain += 1,
                Some(Unsafe) => {}
                None => counts.not_judged += 1,
            }
        }
        counts
    }
}

/// The point with the largest of the smallest margins; of points with a run that cannot be judged, none.
fn safest(
    table: &Table,
    limits: &[ResultLimit],
    points: &Condensed,
    some: &[usize],
) -> Option<Nearest> {
    let judged = some.iter().copied().filter(|point| points.safety(*point).is_some());
    let margins = judged.filter_map(|point| margin(table, limits, points, point));
    margins.reduce(|a, b| if b.run.value > a.run.value { b } else { a })
}

/// The smallest margin of a point.
fn margin(
    table: &Table,
    limits: &[ResultLimit],
    points: &Condensed,
    point: usize,
) -> Option<Nearest> {
    let (value, measure, row) = points.runs[point].worst_margin(table)?;
    let limit = limits.iter().find(|limit| limit.measure.name() == measure)?;
    let seeds = points.spread(&measure, point).map(|[least, _, largest]| [least, largest]);
    let run = Extreme {
        job: table.column("job")?.cells[row].to_string(),
        parameters: parameters_of(&points.table, point),
        measure,
        value,
        shown: DisplayUnit::si("1"),
        others: 0,
        within_mesh_error: 0,
        extrapolated: false,
        trusted: table.is_trusted(row),
    };
    Some(Nearest { run, limit: AtLimit::of(table, limit, row), seeds })
}
