//! `billow status`: shows the progress of a study.

use std::collections::BTreeMap;
use std::io::Write;
use std::num::NonZero;

use serde_json::json;

use super::options::{OutputOptions, ThreadsOption};
use super::print::{TopicLine, count, duration, points_of_runs, print_rows};
use super::queue::Workers;
use super::results::{StudyArgs, folder};
use super::run::listed;
use super::{Format, changes, output_error};
use crate::input::value::brief_number;
use crate::job::row::{ColumnId, Counts};
use crate::job::{JobId, Status as JobStatus};
use crate::platform::error::Result;
use crate::platform::files::Disk;
use crate::platform::quote;
use crate::scene::summary;
use crate::store::doctor::{self, Health};
use crate::store::results::Results;
use crate::store::stored::{Stored, other_physics};
use crate::study::Study;

/// Arguments of `billow status`.
#[derive(Debug, clap::Args)]
pub struct Args {
    #[command(flatten)]
    study: StudyArgs,
    #[command(flatten)]
    threads: ThreadsOption,
    #[command(flatten)]
    output: OutputOptions,
}

/// The progress of a study.
struct Status<'a> {
    results: &'a Results<'a>,
    study: &'a Study,
    health: &'a Health,
    /// Number of runs planned.
    runs: usize,
    counts: Counts,
    /// Number of jobs that must run again.
    invalidated: usize,
    /// Numbers of finished jobs of other versions of the physics, by version.
    other_physics: BTreeMap<i64, usize>,
    /// Sum of the wall times of the jobs, s.
    seconds: f64,
    /// Number of jobs with a wall time.
    timed: usize,
    /// Number of threads for the estimate of the remaining time.
    threads: usize,
    /// Jobs with a checkpoint, and its simulated time, s.
    checkpoints: Vec<(JobId, Option<f64>)>,
    workers: Workers,
}

/// The jobs with a checkpoint, and its simulated time, s.
fn checkpoints(results: &Results<'_>) -> Vec<(JobId, Option<f64>)> {
    let ids = results.checkpoints().unwrap_or_default().into_iter();
    ids.map(|id| (id.clone(), results.checkpoint_time(&id))).collect()
}

/// Runs `billow status`. It only reads, and takes no lock.
///
/// # Errors
/// When there are no results, or they cannot be read.
pub fn run(args: &Args, out: &mut dyn Write) -> Result<()> {
    let root = folder(&args.study)?;
    let results = Results::new(&Disk, &root);
    let cores = || std::thread::available_parallelism().ok();
    let threads = args.threads.count()?.or_else(cores).map_or(1, NonZero::get);
    // Damage is part of the answer, not an error.
    let stored = Stored::read(results)?;
    let health = doctor::examine_stored(&stored);
    print(&Status::new(&stored, &health, threads)?, args, out)
}

/// Prints the progress in the format asked for.
fn print(status: &Status<'_>, args: &Args, out: &mut dyn Write) -> Result<()> {
    match args.output.format() {
        Format::Table => status.print(out),
        Format::Json => writeln!(out, "{}", status.json()).map_err(output_error),
        Format::Csv => {
            let rows = summary::rows(&status.json());
            print_rows(&["quantity", "value"], &rows, Format::Csv, out)
        }
    }
}

impl<'a> Status<'a> {
    fn new(stored: &'a Stored<'a>, health: &'a Health, threads: usize) -> Result<Self> {
        let mut counts = Counts::default();
        let (mut seconds, mut timed) = (0.0, 0);
        for point in &stored.points {
            let cells = stored.cells(point);
            counts.add_cells(&cells);
            if let Some(wall) = cells.number(ColumnId::WallSeconds) {
                seconds += wall;
                timed += 1;
            }
        }
        Ok(Self {
            results: &stored.results,
            study: &stored.study,
            health,
            runs: stored.planned_runs(),
            counts,
            invalidated: stored.journal.invalidated.len(),
            other_physics: other_physics(&stored.points, &stored.journal.records),
            seconds,
            timed,
            threads,
            checkpoints: checkpoints(&stored.results),
            workers: Workers::of(&stored.results, &|id| stored.record(id).is_some())?,
        })
    }

    /// Mean wall time of a job, s.
    fn mean_seconds(&self) -> Option<f64> {
        (self.timed > 0).then(|| self.seconds / self.timed as f64)
    }

    /// Estimated wall time until all jobs have run, s; `None` while no job has run.
    fn remaining_seconds(&self) -> Option<f64> {
        let pending = self.counts.of(JobStatus::Pending);
        let at_once = self.threads.min(pending).max(1);
        self.mean_seconds().map(|mean| mean * pending as f64 / at_once as f64)
    }

    fn json(&self) -> serde_json::Value {
        let counts = &self.counts;
        json!({
            "study": self.study.name,
            "question": self.study.question,
            "results": self.results.root().display().to_string(),
            "running": self.health.running,
            "points": self.runs,
            "jobs": counts.jobs(),
            "done": counts.of(JobStatus::Done),
            "failed": counts.failed(),
            "pending": counts.of(JobStatus::Pending),
            "infeasible": counts.of(JobStatus::Infeasible),
            "other_physics": self.other_physics,
            "invalidated": self.invalidated,
            "status": counts.status,
            "verdict": counts.verdict,
            "near_threshold": counts.near_threshold,
            "job_seconds": self.seconds,
            "mean_job_seconds": self.mean_seconds(),
            "remaining_seconds": self.remaining_seconds(),
            "threads": self.threads,
            "checkpoints": self.checkpoints.iter()
                .map(|(id, time)| json!({"job": id.as_str(), "time": time}))
                .collect::<Vec<_>>(),
            "workers": self.workers.json(),
            "broken": self.health.faults(),
            "findings": self.health.findings.iter()
                .map(|finding| format!("{}: {}", finding.path.display(), finding.problem))
                .collect::<Vec<_>>(),
        })
    }

    fn print(&self, out: &mut dyn Write) -> Result<()> {
        let state = match (self.health.running, self.counts.of(JobStatus::Pending)) {
            (true, _) => "running: another process holds its lock",
            (false, 0) => "finished",
            (false, _) => "not running",
        };
        writeln!(out, "{}: {state}", self.study.name).map_err(output_error)?;
        let mut lines: Vec<TopicLine> = Vec::new();
        if !self.study.question.is_empty() {
            lines.push(("question", quote::printable(&self.study.question)));
        }
        lines.extend(self.job_lines());
        lines.extend(changes::other_physics(&self.other_physics).map(|text| ("physics", text)));
        lines.extend(self.time_lines());
        lines.extend(self.workers.lines());
        lines.extend(self.checkpoint_line());
        lines.push(("broken", self.broken()));
        lines.push(("results", self.results.root().display().to_string()));
        for (topic, text) in &lines {
            writeln!(out, "  {topic:<9} {text}").map_err(output_error)?;
        }
        Ok(())
    }

    /// Numbers of points and jobs, failures and verdicts.
    fn job_lines(&self) -> Vec<TopicLine> {
        let counts = &self.counts;
        let (infeasible, pending) =
            (counts.of(JobStatus::Infeasible), counts.of(JobStatus::Pending));
        let jobs = count(counts.jobs(), "job");
        let points = points_of_runs(self.study, self.runs);
        let duplicates = match self.runs.saturating_sub(counts.rows()) {
            0 => String::new(),
            number => format!(", {}", count(number, "duplicate")),
        };
        let mut lines =
            vec![("points", format!("{points}: {jobs}, {infeasible} infeasible{duplicates}"))];
        let invalidated = match self.invalidated {
            0 => String::new(),
            number => format!(" ({number} invalidated)"),
        };
        let (done, failed) = (counts.of(JobStatus::Done), counts.failed());
        lines.push((
            "jobs",
            format!("{done} done, {failed} failed, {pending} pending{invalidated}"),
        ));
        let failures = counts.failures();
        if !failures.is_empty() {
            lines.push(("failed", format!("{}; billow job JOB explains one", listed(&failures))));
        }
        if !counts.verdict.is_empty() {
            let near = match counts.near_threshold {
                0 => String::new(),
                near => format!(" ({near} near a threshold)"),
            };
            lines.push(("verdict", format!("{}{near}", listed(&counts.verdict))));
        }
        lines
    }

    /// Time of the finished jobs, and remaining time.
    fn time_lines(&self) -> Vec<TopicLine> {
        let mut lines = Vec::new();
        if let Some(mean) = self.mean_seconds() {
            // Jobs run side by side, in several runs: their sum is no time on a clock.
            let text = format!(
                "{} in all, the sum over {} of one thread each; mean {}",
                duration(self.seconds),
                count(self.timed, "job"),
                duration(mean)
            );
            lines.push(("job time", text));
        }
        if self.counts.of(JobStatus::Pending) > 0 {
            let text = match self.remaining_seconds() {
                Some(remaining) => {
                    let threads = count(self.threads, "thread");
                    format!(
                        "about {} on {threads} (--threads N for another number)",
                        duration(remaining)
                    )
                }
                None => "unknown: no job has run yet".to_owned(),
            };
            lines.push(("remaining", text));
        }
        lines
    }

    /// Jobs that continue from a checkpoint.
    fn checkpoint_line(&self) -> Option<TopicLine> {
        const MAX_SHOWN: usize = 4;
        let shown = self.checkpoints.iter().take(MAX_SHOWN).map(|(id, time)| {
            let at = time.map_or_else(String::new, |time| format!(" at {} s", brief_number(time)));
            format!("{}{at}", id.short())
        });
        let mut shown: Vec<String> = shown.collect();
        if self.checkpoints.len() > MAX_SHOWN {
            shown.push(format!("and {} more", self.checkpoints.len() - MAX_SHOWN));
        }
        let jobs = count(self.checkpoints.len(), "job");
        (!shown.is_empty())
            .then(|| ("stored", format!("{jobs} with a checkpoint: {}", shown.join(", "))))
    }

    /// The first fault, or that there is none.
    fn broken(&self) -> String {
        let root = self.results.root().display();
        let findings = &self.health.findings;
        match (self.health.faults(), findings.first()) {
            (0, None) => "nothing".to_owned(),
            (0, Some(_)) => {
                format!("nothing; {}: billow doctor {root}", count(findings.len(), "note"))
            }
            (faults, Some(first)) => {
                let more =
                    if faults > 1 { format!(", and {} more", faults - 1) } else { String::new() };
                let path = first.path.display();
                format!("{path}: {}{more}; next: billow doctor {root}", first.problem)
            }
            (_, None) => unreachable!("every fault is a finding"),
        }
    }
}
