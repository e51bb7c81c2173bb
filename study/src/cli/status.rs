//! `billow status`: how far a study is.

use std::io::Write;
use std::path::PathBuf;

use serde_json::json;

use super::print::{count, duration, print_rows};
use super::run::{listed, threads};
use super::target::folder;
use super::{Format, Global, output_error};
use crate::job::Status as JobStatus;
use crate::job::row::{ColumnId, Counts};
use crate::platform::error::Result;
use crate::platform::files::Disk;
use crate::scene::summary;
use crate::store::doctor::{self, Depth, Health};
use crate::store::results::Results;
use crate::store::stored::Stored;

/// Arguments of `billow status`.
#[derive(Debug, clap::Args)]
pub struct Args {
    /// Study file, or folder of its results [default: the only one under results].
    pub study: Option<PathBuf>,
}

/// How far a study is.
struct Status {
    counts: Counts,
    /// Wall time of the jobs that have one, s, and how many have.
    seconds: f64,
    timed: usize,
    threads: usize,
}

/// Runs `billow status`: reads, and holds no lock.
///
/// # Errors
/// Where there are no results, or they cannot be read.
pub fn run(args: &Args, global: &Global, out: &mut dyn Write) -> Result<()> {
    let root = folder(args.study.as_deref(), global)?;
    let results = Results::new(&Disk, &root);
    // What is broken is one of the things it says.
    let (stored, _) = Stored::read_valid(results.clone())?;
    let health = doctor::examine(&results, Depth::Names);
    let mut status = Status::of(&stored);
    status.threads = match threads(global)? {
        Some(threads) => threads.get(),
        None => std::thread::available_parallelism().map_or(1, std::num::NonZero::get),
    };
    let json = status.json(&stored, &health);
    match global.format() {
        Format::Table => status.print(&stored, &health, out),
        Format::Json => writeln!(out, "{json}").map_err(output_error),
        Format::Csv => print_rows(&["quantity", "value"], &summary::rows(&json), Format::Csv, out),
    }
}

impl Status {
    fn of(stored: &Stored<'_>) -> Self {
        let mut status = Self { counts: Counts::default(), seconds: 0.0, timed: 0, threads: 1 };
        for point in &stored.points {
            let cells = stored.cells(point);
            status.counts.add_cells(&cells);
            if let Some(seconds) = cells.number(ColumnId::WallSeconds) {
                status.seconds += seconds;
                status.timed += 1;
            }
        }
        status
    }

    /// Mean wall time of a job, s.
    fn mean(&self) -> Option<f64> {
        (self.timed > 0).then(|| self.seconds / self.timed as f64)
    }

    /// Wall time until all has run, s, on `threads` at once; none while nothing has run.
    fn left(&self) -> Option<f64> {
        let pending = self.counts.of(JobStatus::Pending);
        let at_once = self.threads.min(pending).max(1);
        self.mean().map(|mean| mean * pending as f64 / at_once as f64)
    }

    fn json(&self, stored: &Stored<'_>, health: &Health) -> serde_json::Value {
        let infeasible = self.counts.of(JobStatus::Infeasible);
        json!({
            "study": stored.study.name,
            "question": stored.study.question,
            "results": stored.results.root().display().to_string(),
            "running": health.running,
            "points": self.counts.rows(),
            "jobs": self.counts.jobs(),
            "done": self.counts.of(JobStatus::Done),
            "failed": self.counts.failed(),
            "pending": self.counts.of(JobStatus::Pending),
            "infeasible": infeasible,
            "invalidated": stored.journal.invalidated.len(),
            "status": self.counts.status,
            "verdict": self.counts.verdict,
            "near_threshold": self.counts.near_threshold,
            "wall_seconds": self.seconds,
            "mean_wall_seconds": self.mean(),
            "seconds_left": self.left(),
            "threads": self.threads,
            "broken": health.faults(),
            "findings": health.findings.iter()
                .map(|finding| format!("{}: {}", finding.path.display(), finding.problem))
                .collect::<Vec<_>>(),
        })
    }

    fn print(&self, stored: &Stored<'_>, health: &Health, out: &mut dyn Write) -> Result<()> {
        let infeasible = self.counts.of(JobStatus::Infeasible);
        let pending = self.counts.of(JobStatus::Pending);
        let failed = self.counts.failures();
        let state = match (health.running, pending) {
            (true, _) => "running: another process holds its lock",
            (false, 0) => "finished",
            (false, _) => "not running",
        };
        let mut lines = vec![(String::new(), format!("{}: {state}", stored.study.name))];
        let mut line = |name: &str, text: String| lines.push((name.to_owned(), text));
        if !stored.study.question.is_empty() {
            line("question", stored.study.question.clone());
        }
        let jobs = count(self.counts.jobs(), "job");
        line("points", format!("{}: {jobs}, {infeasible} infeasible", self.counts.rows()));
        let invalidated = stored.journal.invalidated.len();
        let again =
            if invalidated > 0 { format!(" ({invalidated} invalidated)") } else { String::new() };
        let number = self.counts.failed();
        line(
            "jobs",
            format!(
                "{} done, {number} failed, {pending} pending{again}",
                self.counts.of(JobStatus::Done)
            ),
        );
        if !failed.is_empty() {
            line("failed", format!("{}; billow why JOB says why", listed(&failed)));
        }
        if !self.counts.verdict.is_empty() {
            let close = match self.counts.near_threshold {
                0 => String::new(),
                close => format!(" ({close} close to a threshold)"),
            };
            line("verdict", format!("{}{close}", listed(&self.counts.verdict)));
        }
        if let Some(mean) = self.mean() {
            let spent = duration(self.seconds);
            line("spent", format!("{spent} of one core, {} a job on the mean", duration(mean)));
        }
        match self.left().filter(|_| pending > 0) {
            Some(left) => {
                let threads = count(self.threads, "thread");
                line("left", format!("about {} on {threads}, from that mean", duration(left)));
            }
            None if pending > 0 => line("left", "nothing has run yet to tell from".to_owned()),
            None => {}
        }
        let root = stored.results.root().display();
        let broken = match (health.faults(), health.findings.first()) {
            (0, None) => "nothing".to_owned(),
            (0, Some(_)) => {
                format!(
                    "nothing; {} to know: billow doctor {root}",
                    count(health.findings.len(), "thing")
                )
            }
            (number, Some(first)) => {
                let more =
                    if number > 1 { format!(", and {} more", number - 1) } else { String::new() };
                format!(
                    "{}: {}{more}; next: billow doctor {root}",
                    first.path.display(),
                    first.problem
                )
            }
            (_, None) => unreachable!("a fault is a finding"),
        };
        line("broken", broken);
        line("results", root.to_string());
        for (name, text) in &lines {
            let written = if name.is_empty() {
                writeln!(out, "{text}")
            } else {
                writeln!(out, "  {name:<8} {text}")
            };
            written.map_err(output_error)?;
        }
        Ok(())
    }
}
