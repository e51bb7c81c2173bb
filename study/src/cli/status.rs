//! `billow status`: shows the progress of a study.

use std::collections::{BTreeMap, BTreeSet};
use std::io::Write;
use std::num::NonZero;

use serde_json::json;

use super::options::{OutputOptions, ThreadsOption};
use super::results::{StudyArgs, folder};
use super::run::listed;
use super::{Format, changes, output_error};
use crate::cluster::slurm;
use crate::cluster::submission::{self, Queued};
use crate::input::value::brief_number;
use crate::job::row::{ColumnId, Counts};
use crate::job::{JobId, Status as JobStatus};
use crate::platform::error::Result;
use crate::platform::files::Disk;
use crate::platform::quote;
use crate::print::{TopicLine, count, duration, points_of_runs, print_rows};
use crate::scene::summary;
use crate::store::journal::{Fault, Record};
use crate::store::results::Results;
use crate::store::stored::{Stored, other_physics};

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
    stored: &'a Stored<'a>,
    /// Whether another process holds the lock.
    running: bool,
    /// Lines of the journal that are not valid, without the one that a running process is writing.
    faults: Vec<&'a Fault>,
    counts: Counts,
    /// Sum of the wall times of the jobs, s.
    seconds: f64,
    /// Number of jobs with a wall time.
    timed: usize,
    /// Number of threads for the estimate of the remaining time.
    threads: usize,
    /// Jobs with a checkpoint, and its simulated time, s.
    checkpoints: Vec<(JobId, Option<f64>)>,
    submission: Submission,
}

/// Runs `billow status`. It only reads, and takes no lock.
///
/// # Errors
/// When there are no results, or they cannot be read.
pub fn run(args: &Args, out: &mut dyn Write) -> Result<()> {
    let root = folder(&args.study)?;
    let cores = || std::thread::available_parallelism().ok();
    let threads = args.threads.count()?.or_else(cores).map_or(1, NonZero::get);
    // Damage is part of the answer, not an error.
    let stored = Stored::read(Results::new(&Disk, &root))?;
    let status = Status::new(&stored, threads)?;
    match args.output.format() {
        Format::Table => write!(out, "{}", status.text()).map_err(output_error),
        Format::Json => writeln!(out, "{}", status.json()).map_err(output_error),
        Format::Csv => {
            let rows = summary::rows(&status.json());
            print_rows(&["quantity", "value"], &rows, Format::Csv, out)
        }
    }
}

impl<'a> Status<'a> {
    fn new(stored: &'a Stored<'a>, threads: usize) -> Result<Self> {
        let (mut counts, mut seconds, mut timed) = (Counts::default(), 0.0, 0);
        for point in stored.points.iter() {
            let cells = stored.cells(point);
            counts.add_cells(&cells);
            if let Some(wall) = cells.number(ColumnId::WallSeconds) {
                seconds += wall;
                timed += 1;
            }
        }
        let running = stored.results.is_running()?;
        let faults = stored.journal.faults.iter();
        // A process that died may have left that of a job that has ended.
        let is_open = |id: &JobId| stored.journal.records.get(id).is_none_or(Record::reached_limit);
        let checkpoints = stored.results.checkpoints().unwrap_or_default().into_iter();
        let checkpoints = checkpoints.filter(is_open);
        let time_of = |id: JobId| (id.clone(), stored.results.checkpoint_time(&id));
        Ok(Self {
            stored,
            running,
            faults: faults.filter(|fault| !(fault.torn && running)).collect(),
            counts,
            seconds,
            timed,
            threads,
            checkpoints: checkpoints.map(time_of).collect(),
            submission: Submission::of(stored)?,
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
        let Self { stored, counts, .. } = self;
        let mut json = json!({
            "study": stored.study.name,
            "question": stored.study.question,
            "results": stored.results.root().display().to_string(),
            "running": self.running,
            "points": stored.planned_runs(),
            "jobs": counts.jobs(),
            "done": counts.of(JobStatus::Done),
            "failed": counts.failed(),
            "pending": counts.of(JobStatus::Pending),
            "infeasible": counts.of(JobStatus::Infeasible),
            "other_physics": self.other_physics(),
            "invalidated": stored.journal.invalidated.len(),
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
            "broken": self.faults.len(),
            "findings": self.faults.iter().map(ToString::to_string).collect::<Vec<_>>(),
        });
        json["workers"] = self.submission.json();
        json
    }

    /// Numbers of finished jobs of other versions of the physics, by version.
    fn other_physics(&self) -> BTreeMap<i64, usize> {
        other_physics(&self.stored.points, &self.stored.journal.records)
    }

    fn text(&self) -> String {
        let Self { stored, counts, .. } = self;
        let started = counts.ended() > 0 || !self.checkpoints.is_empty();
        let state = match (self.running, counts.of(JobStatus::Pending)) {
            (true, _) => "running, by another process",
            (false, 0) => "finished",
            (false, _) if started => "interrupted; `billow run` of the study resumes it",
            (false, _) => "not started",
        };
        let mut lines: Vec<TopicLine> = Vec::new();
        if !stored.study.question.is_empty() {
            lines.push(("question", quote::printable(&stored.study.question)));
        }
        lines.extend(self.job_lines());
        lines.extend(changes::other_physics(&self.other_physics()).map(|text| ("physics", text)));
        lines.extend(self.time_lines());
        lines.extend(self.submission.lines());
        lines.extend(self.checkpoint_line());
        lines.push(("broken", self.broken()));
        lines.push(("results", stored.results.root().display().to_string()));
        let lines = lines.iter().map(|(topic, text)| format!("  {topic:<9} {text}\n"));
        format!("{}: {state}\n{}", stored.study.name, lines.collect::<String>())
    }

    /// Numbers of points and jobs, failures and verdicts.
    fn job_lines(&self) -> Vec<TopicLine> {
        let Self { stored, counts, .. } = self;
        let with = |number: usize, text: &str| match number {
            0 => String::new(),
            number => text.replace("{}", &number.to_string()),
        };
        let of = |status| counts.of(status);
        let runs = stored.planned_runs();
        let duplicates = match runs.saturating_sub(counts.rows()) {
            0 => String::new(),
            number => format!(", {}", count(number, "duplicate")),
        };
        let points = format!(
            "{}: {}, {} infeasible{duplicates}",
            points_of_runs(&stored.study, runs, stored.pilot_runs()),
            count(counts.jobs(), "job"),
            of(JobStatus::Infeasible)
        );
        let jobs = format!(
            "{} done, {} failed, {} pending{}",
            of(JobStatus::Done),
            counts.failed(),
            of(JobStatus::Pending),
            with(stored.journal.invalidated.len(), " ({} invalidated)")
        );
        let mut lines = vec![("points", points), ("jobs", jobs)];
        let failures = counts.failures();
        if !failures.is_empty() {
            lines.push(("failed", format!("{}; billow job JOB explains one", listed(&failures))));
        }
        if !counts.verdict.is_empty() {
            let near = with(counts.near_threshold, " ({} near a threshold)");
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
            let unknown = || "unknown: no job has run yet".to_owned();
            let text = self.remaining_seconds().map_or_else(unknown, |remaining| {
                let (time, threads) = (duration(remaining), count(self.threads, "thread"));
                format!("about {time} on {threads} (--threads N for another number)")
            });
            lines.push(("remaining", text));
        }
        lines
    }

    /// Jobs that continue from a checkpoint.
    fn checkpoint_line(&self) -> Option<TopicLine> {
        const MAX_SHOWN: usize = 4;
        let shown = self.checkpoints.iter().take(MAX_SHOWN).map(|(id, time)| match time {
            Some(time) => format!("{} at {} s", id.short(), brief_number(*time)),
            None => id.short().to_owned(),
        });
        let mut shown: Vec<String> = shown.collect();
        if self.checkpoints.len() > MAX_SHOWN {
            shown.push(format!("and {} more", self.checkpoints.len() - MAX_SHOWN));
        }
        let jobs = count(self.checkpoints.len(), "job");
        let text = format!("{jobs} with a checkpoint: {}", shown.join(", "));
        (!shown.is_empty()).then_some(("stored", text))
    }

    /// The first fault of the journal, or that there is none.
    fn broken(&self) -> String {
        let Some(first) = self.faults.first() else { return "nothing".to_owned() };
        let more = match self.faults.len() - 1 {
            0 => String::new(),
            more => format!(", and {more} more"),
        };
        if self.faults.iter().all(|fault| fault.torn) {
            return format!("{first}{more}; nothing else is lost, `billow run` runs it again");
        }
        format!("{first}{more}; next: billow doctor {}", quote::path(self.stored.results.root()))
    }
}

/// The last submission of a study: its tasks in the queue of the cluster, and what they have stored.
struct Submission {
    queued: Option<Queued>,
    /// The tasks in the queue by state, or why the queue cannot be asked.
    queue: std::result::Result<BTreeMap<String, usize>, String>,
    /// Number of jobs that tasks have ended and that are not merged yet.
    unmerged: usize,
    /// The command that merges them.
    merge: String,
}

impl Submission {
    /// Reads the results of the tasks, and asks the queue. A study that was never submitted asks no queue.
    ///
    /// # Errors
    /// [`crate::platform::error::Error::Disk`].
    fn of(stored: &Stored<'_>) -> Result<Self> {
        let results = &stored.results;
        let queued = submission::last_queued(results)?;
        let queue = queued.as_ref().map_or_else(|| Ok([].into()), slurm::queue);
        let mut unmerged = BTreeSet::new();
        for part in results.parts()? {
            let ended = part.journal()?.records.into_keys();
            unmerged.extend(ended.filter(|id| stored.record(id).is_none()));
        }
        let merge = format!("billow merge {}", quote::path(results.root()));
        Ok(Self { queued, queue, unmerged: unmerged.len(), merge })
    }

    fn lines(&self) -> Vec<TopicLine> {
        let mut lines = Vec::new();
        if let Some(Queued { array, merge }) = &self.queued {
            let state = match &self.queue {
                Ok(states) if states.is_empty() => "has left the queue".to_owned(),
                Ok(states) => format!("in the queue: {}", listed(states).to_lowercase()),
                Err(problem) => format!("the queue cannot be asked: {problem}"),
            };
            lines.push(("slurm", format!("array {array}, merge {merge}: {state}")));
        }
        if self.unmerged > 0 {
            let jobs = count(self.unmerged, "job");
            lines.push(("parts", format!("{jobs} ended by tasks, not merged yet: {}", self.merge)));
        }
        lines
    }

    fn json(&self) -> serde_json::Value {
        let slurm = self.queued.as_ref().map(|Queued { array, merge }| {
            json!({
                "array": array,
                "merge": merge,
                "queue": self.queue.as_ref().ok(),
                "problem": self.queue.as_ref().err(),
            })
        });
        json!({ "slurm": slurm, "unmerged": self.unmerged })
    }
}
