//! Lines of the answer on points: how many deploy in all their runs, which verdicts depend on a numerical
//! choice, and which points are safe.

use std::fmt::Write as _;

use super::job_text;
use crate::analysis::answer::{Depends, PointCounts, PointMargin, SafeBy, SafeCounts, Safety};
use crate::cli::best::MAX_VALUES;
use crate::cli::print::count;
use crate::input::value::brief_number;
use crate::job::Status;
use crate::job::row::Counts;

/// Most limits that a line names as missed.
const MAX_MISSED: usize = 3;

/// How many points deploy in all their runs, and how the runs ended that have no verdict.
pub(super) fn deployed(points: &PointCounts, runs: &Counts) -> String {
    let mut text =
        format!("all runs of {} of {} deploy", points.deployed, count(points.points, "point"));
    if points.mixed > 0 {
        let _ =
            write!(text, "; {} mixed (depends on {})", points.mixed, points.replicates.join(", "));
    }
    if points.never > 0 {
        let _ = write!(text, "; no run of {} deploys", count(points.never, "point"));
    }
    if points.undecided > 0 {
        let _ = write!(text, "; {} not decided", points.undecided);
    }
    let mut others = Vec::new();
    for (number, noun) in [(runs.failed(), "failed"), (runs.of(Status::Pending), "pending")] {
        if number > 0 {
            others.push(format!("{} {noun}", count(number, "run")));
        }
    }
    if runs.near_threshold > 0 {
        others.push(format!("{} near a threshold", count(runs.near_threshold, "run")));
    }
    let infeasible = runs.of(Status::Infeasible);
    if infeasible > 0 {
        others.push(format!("{} infeasible", count(infeasible, "point")));
    }
    if !others.is_empty() {
        let _ = write!(text, "; {}", others.join(", "));
    }
    text
}

/// The points whose verdict depends on a numerical choice.
pub(super) fn depends(depends: &Depends) -> String {
    let choices = depends.choices.iter().map(|(name, points)| format!("{name} ({points})"));
    format!(
        "the verdict of {} of {} depends on a numerical choice: {}",
        depends.points,
        count(depends.of, "point"),
        choices.collect::<Vec<_>>().join(", ")
    )
}

/// The safe points: one line for all, one per value of the choice.
pub(super) fn safe(safety: &Safety) -> Vec<String> {
    let mut all = format!("{} ({})", counts(&safety.counts, "point"), safety.limits.join(", "));
    if !safety.missed.is_empty() {
        let missed = safety.missed.iter().take(MAX_MISSED);
        let missed: Vec<String> = missed
            .map(|(measure, points)| format!("{measure} ({})", count(*points, "point")))
            .collect();
        let _ = write!(all, "; missed most often: {}", missed.join(", "));
    }
    if let Some(nearest) = &safety.nearest {
        let what =
            if safety.counts.safe > 0 { "nearest to a limit" } else { "least beyond a limit" };
        let _ = write!(all, "; {what}: {}", margin(nearest, None));
    }
    let mut lines = vec![all];
    lines.extend(safety.by.iter().flat_map(by_value));
    lines
}

/// One line per value of the choice.
fn by_value(by: &SafeBy) -> Vec<String> {
    let values = by.values.iter().take(MAX_VALUES);
    let mut lines: Vec<String> = values
        .map(|value| {
            let shown = by.shown.quantity(&value.value);
            let mut line = format!("{shown}: {}", counts(&value.counts, "point"));
            if let Some(safest) = &value.safest {
                let what = if value.counts.safe > 0 { "safest" } else { "least beyond a limit" };
                let _ = write!(line, "; {what}: {}", margin(safest, Some(&by.parameter)));
            }
            line
        })
        .collect();
    let more = by.values.len() - lines.len();
    if more > 0 {
        lines.push(format!("and {more} more values: billow rank --by {}", by.parameter));
    }
    lines
}

/// "12 of 16 points safe, 1 mixed".
fn counts(counts: &SafeCounts, noun: &str) -> String {
    let mut text = format!("{} of {} safe", counts.safe, count(counts.points, noun));
    for (number, noun) in [(counts.mixed, "mixed"), (counts.not_judged, "not judged")] {
        if number > 0 {
            let _ = write!(text, ", {number} {noun}");
        }
    }
    text
}

/// The smallest margin of a point, its measure, its job; without the parameter that the line names already.
fn margin(margin: &PointMargin, named: Option<&str>) -> String {
    let mut point = margin.point.clone();
    point.parameters.retain(|(name, _, _)| named != Some(name));
    format!(
        "smallest_margin {} ({}) at {}",
        brief_number(point.value),
        margin.measure,
        job_text(&point)
    )
}
