//! Lines of the answer on points: how many deploy in all their runs, which verdicts depend on a numerical
//! choice, and which points are safe.

use std::fmt::Write as _;

use super::{job_text, parameters_text};
use crate::analysis::answer::{MixedPoint, PointCounts, SafeCounts, Safety, VerdictSensitivity};
use crate::job::Status;
use crate::job::row::Counts;
use crate::print::at_limit::at_limit;
use crate::print::{MAX_VALUES, count};

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

/// The points whose runs do not all end alike, by name: "N=6: 3 of 5 deploy, 2 of 5 safe, 1 unsafe".
pub(super) fn mixed(points: &[MixedPoint]) -> Vec<String> {
    let text = |point: &MixedPoint| {
        let (deployed, safe) = (point.deployed, point.safe);
        let mut counts = Vec::new();
        if deployed.is_mixed() {
            counts.push(format!("{} of {} deploy", deployed.met, deployed.of));
        }
        if safe.of > 0 {
            counts.push(format!("{} of {} safe", safe.met, safe.of));
        }
        if point.not_safe > 0 {
            counts.push(format!("{} unsafe", point.not_safe));
        }
        format!("{}: {}", parameters_text(&point.parameters), counts.join(", "))
    };
    let mut texts: Vec<String> = points.iter().take(MAX_VALUES).map(text).collect();
    if points.len() > MAX_VALUES {
        texts.push(format!("and {} more", points.len() - MAX_VALUES));
    }
    texts
}

/// The points whose verdict depends on a numerical choice.
pub(super) fn sensitivity(found: &VerdictSensitivity) -> String {
    let choices = found.choices.iter().map(|(name, points)| format!("{name} ({points})"));
    format!(
        "the verdict of {} of {} depends on a numerical choice: {}",
        found.points,
        count(found.of, "point"),
        choices.collect::<Vec<_>>().join(", ")
    )
}

/// The safe points, and those nearest to and farthest from their limits.
pub(super) fn safe(safety: &Safety) -> String {
    let mut all = format!("{} ({})", counts(&safety.counts, "point"), safety.limits.join(", "));
    if !safety.missed.is_empty() {
        let missed = safety.missed.iter().take(MAX_MISSED);
        let missed: Vec<String> = missed
            .map(|(measure, points)| format!("{measure} ({})", count(*points, "point")))
            .collect();
        let _ = write!(all, "; most values beyond a limit: {}", missed.join(", "));
    }
    if !safety.uncertain_by.is_empty() {
        let causes =
            safety.uncertain_by.iter().map(|(cause, points)| format!("{cause} ({points})"));
        let causes: Vec<String> = causes.collect();
        let _ = write!(all, "; most of the uncertainty is: {}", causes.join(", "));
    }
    if let Some(nearest) = &safety.nearest {
        let what = match nearest.run.value {
            margin if margin < 0.0 => "least beyond a limit",
            _ if safety.counts.safe == 0 => "nearest to a limit",
            _ => "safe and nearest to a limit",
        };
        let (limit, job) = (at_limit(&nearest.limit, nearest.seeds), job_text(&nearest.run));
        let _ = write!(all, "; {what}: {limit}, at {job}");
    }
    if let Some(farthest) = &safety.farthest {
        let (limit, job) = (at_limit(&farthest.limit, farthest.seeds), job_text(&farthest.run));
        let _ = write!(all, "; the safe point farthest from its limits: {limit}, at {job}");
    }
    all
}

/// "12 of 16 points safe, 1 within the uncertainty".
fn counts(counts: &SafeCounts, noun: &str) -> String {
    let mut text = format!("{} of {} safe", counts.safe, count(counts.points, noun));
    for (number, noun) in
        [(counts.uncertain, "within the uncertainty"), (counts.not_judged, "not judged")]
    {
        if number > 0 {
            let _ = write!(text, ", {number} {noun}");
        }
    }
    text
}
