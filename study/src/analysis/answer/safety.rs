//! Which points are safe: all limits of the study met in all their runs.

use serde::Serialize;

use super::{Extreme, named, parameters_of};
use crate::analysis::replicates::Condensed;
use crate::input::units::DisplayUnit;
use crate::input::value::Value;
use crate::job::result_limit::ResultLimit;
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
    /// limits least. Its value is the margin.
    pub nearest: Option<Extreme>,
    /// For each missed limit its measure and the number of points that miss it, the most frequent first.
    #[serde(serialize_with = "named")]
    pub missed: Vec<(String, usize)>,
}

/// Numbers of points with a job.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, Serialize)]
pub struct SafeCounts {
    /// All.
    pub points: usize,
    /// All their runs are safe.
    pub safe: usize,
    /// Some of their runs are safe and some are not.
    pub mixed: usize,
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
            let is_missed = |row: &usize| {
                let value = table.value(limit.measure, *row).unwrap_or(&Value::Null);
                let judged = table.status(*row).and_then(|status| limit.judge(status, value));
                judged.is_some_and(|judged| !judged.met)
            };
            points.runs.iter().filter(|runs| runs.finest.iter().any(is_missed)).count()
        };
        let missed = limits.iter().map(|limit| (limit.measure.name().to_owned(), missed(limit)));
        let mut missed: Vec<(String, usize)> = missed.filter(|(_, points)| *points > 0).collect();
        missed.sort_by_key(|(_, points)| std::cmp::Reverse(*points));
        let all: Vec<usize> = points.feasible().collect();
        let safe = |point: &usize| points.is_safe(*point) == Some(true);
        let margins = all.iter().copied().filter(safe).filter_map(|p| margin(table, &points, p));
        let nearest = margins.reduce(|a, b| if b.value < a.value { b } else { a });
        Some(Self {
            limits: limits.iter().map(ToString::to_string).collect(),
            counts: SafeCounts::of(&points, &all),
            nearest: nearest.or_else(|| safest(table, &points, &all)),
            missed,
        })
    }
}

impl SafeCounts {
    /// Counts some points.
    fn of(points: &Condensed, some: &[usize]) -> Self {
        let mut counts = Self { points: some.len(), ..Self::default() };
        for point in some {
            match points.is_safe(*point) {
                Some(true) => counts.safe += 1,
                _ if points.runs[*point].safe.is_mixed() => counts.mixed += 1,
                Some(false) => {}
                None => counts.not_judged += 1,
            }
        }
        counts
    }
}

/// The point with the largest of the smallest margins; of points with a run that cannot be judged, none.
fn safest(table: &Table, points: &Condensed, some: &[usize]) -> Option<Extreme> {
    let judged = some.iter().copied().filter(|point| points.is_safe(*point).is_some());
    let margins = judged.filter_map(|point| margin(table, points, point));
    margins.reduce(|a, b| if b.value > a.value { b } else { a })
}

/// The smallest margin of a point.
fn margin(table: &Table, points: &Condensed, point: usize) -> Option<Extreme> {
    let (value, measure, row) = points.runs[point].worst_margin(table)?;
    Some(Extreme {
        job: table.column("job")?.cells[row].to_string(),
        parameters: parameters_of(&points.table, point),
        measure,
        value,
        shown: DisplayUnit::si("1"),
        others: 0,
        within_mesh_error: 0,
        extrapolated: false,
        trusted: table.is_trusted(row),
    })
}
