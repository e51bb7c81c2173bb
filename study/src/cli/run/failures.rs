//! The error of a run whose jobs failed or gave other bits, with the commands that come next.

use std::collections::BTreeMap;
use std::fmt::Write as _;
use std::path::Path;

use billow_solver::output::outcome::FailureKind;

use super::listed;
use crate::job::limits::JobLimits;
use crate::job::{JobId, Status};
use crate::platform::error::{Error, Result};
use crate::platform::quote;
use crate::print::count;
use crate::run::runner::Summary;
use crate::study::Study;

/// The error of a run, if it has one.
pub(super) fn result(
    study: &Study,
    summary: &Summary,
    limits: &JobLimits,
    root: &Path,
) -> Result<()> {
    if !summary.different.is_empty() {
        return Err(Error::JobsFailed(format!(
            "{} gave different bits than before: {}\n  next: billow job JOB; compare \
             program_version, commit and physics_version",
            count(summary.different.len(), "job"),
            summary.different.iter().map(JobId::short).collect::<Vec<_>>().join(", ")
        )));
    }
    match summary.counts.failed() {
        0 => Ok(()),
        failed => Err(Error::JobsFailed(format!(
            "{} failed{}\n  next: billow table {}{} --columns job,status,stop_time,stop_audit,stop_location\n        billow job JOB {}{}",
            count(failed, "job"),
            limited(&summary.counts.failures()),
            quote::path(root),
            // A point of several runs has no job.
            if study.replicate_count() > 1 { " --runs" } else { "" },
            quote::path(root),
            next_of_limited(summary, limits, root),
        ))),
    }
}

/// Statuses of jobs that can go on or run again, with the option that changes what stopped them.
const RERUN: [(Status, &str); 4] = [
    (Status::Timeout, " --set job_limits.wall_time=…"),
    (Status::Failed(FailureKind::StepLimit), " --set job_limits.steps=…"),
    (Status::OutOfMemory, " --set job_limits.memory=…"),
    (Status::Crashed, ""),
];

/// The failures by status, where a limit or a crash is one of them.
fn limited(failures: &BTreeMap<String, usize>) -> String {
    let step_limit = Status::Failed(FailureKind::StepLimit);
    let names = RERUN.iter().filter(|(status, _)| *status != step_limit);
    let any = names.map(|(status, _)| status.name()).any(|name| failures.contains_key(name));
    if any { format!(" ({})", listed(failures)) } else { String::new() }
}

/// The commands that run such jobs again.
fn next_of_limited(summary: &Summary, limits: &JobLimits, root: &Path) -> String {
    let mut text = String::new();
    for (status, option) in RERUN {
        // Without job_limits.steps it is solver.step_limit that was reached.
        let by_limit = status != Status::Failed(FailureKind::StepLimit) || limits.steps.is_some();
        if by_limit && summary.counts.of(status) > 0 {
            let root = quote::path(root);
            // Without job_limits.memory it is the machine's memory, or a limit of the process.
            let by_machine = status == Status::OutOfMemory && limits.memory.is_none();
            let option = if by_machine { ", with more memory or a coarser mesh" } else { option };
            let _ = write!(text, "\n        billow run {root} --again {status}{option}");
        }
    }
    text
}
