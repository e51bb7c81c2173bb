//! The progress of a run on stderr: a bar on a terminal, elsewhere lines from time to time.

use std::io::{self, IsTerminal, Write};
use std::num::NonZero;
use std::time::{Duration, Instant};

use indicatif::{ProgressBar, ProgressDrawTarget, ProgressStyle};

use crate::run::event::{Event, Reporter, Silent};

mod work;

use work::{Running, Work};

/// Time between two progress reports, at least.
const MIN_REPORT_INTERVAL: Duration = Duration::from_secs(5);
/// Time between two progress reports of a long run, at most.
const MAX_REPORT_INTERVAL: Duration = Duration::from_mins(1);
/// In between, the interval is this part of the elapsed time: a log of a long run stays short.
const REPORTS_PER_ELAPSED_TIME: u32 = 20;
/// Running jobs in a progress report, at most.
const MAX_JOBS_SHOWN: usize = 8;
/// The bar, then its message, cut to the width of the terminal.
const BAR: &str = "{bar:20} {wide_msg}";

/// How much a command prints on stderr.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Loudness {
    /// Errors only.
    Quiet,
    /// The progress of the study.
    Normal,
    /// Also every job as it ends.
    Verbose,
}

/// The reporter for this stderr, of a run with this number of threads; `None` for one per core.
pub fn reporter(loudness: Loudness, threads: Option<NonZero<usize>>) -> Box<dyn Reporter> {
    if loudness == Loudness::Quiet {
        return Box::new(Silent);
    }
    let bar = io::stderr().is_terminal().then(hidden_bar);
    Box::new(Lines::new(io::stderr(), loudness == Loudness::Verbose, bar, threads))
}

/// A bar that is drawn from the first job to run.
fn hidden_bar() -> ProgressBar {
    let style = ProgressStyle::with_template(BAR).unwrap_or_else(|_| ProgressStyle::default_bar());
    ProgressBar::hidden().with_style(style.progress_chars("=> "))
}

/// Writes the progress.
struct Lines<W> {
    out: W,
    verbose: bool,
    /// Takes the place of reports on a terminal.
    bar: Option<ProgressBar>,
    work: Work,
    /// When the last report was written.
    last: Option<Instant>,
}

impl<W: Write> Lines<W> {
    fn new(
        out: W,
        verbose: bool,
        bar: Option<ProgressBar>,
        threads: Option<NonZero<usize>>,
    ) -> Self {
        Self { out, verbose, bar, work: Work::new(threads), last: None }
    }

    fn line(&mut self, text: &str) {
        let out = &mut self.out;
        // A closed stderr must not stop a study.
        let mut write = || drop(writeln!(out, "{text}"));
        match &self.bar {
            Some(bar) => bar.suspend(write),
            None => write(),
        }
    }

    /// Whether it is time for a report. A bar limits its own drawings.
    fn is_due(&self) -> bool {
        let Some((start, _)) = self.work.start else { return false };
        let interval = (start.elapsed() / REPORTS_PER_ELAPSED_TIME)
            .clamp(MIN_REPORT_INTERVAL, MAX_REPORT_INTERVAL);
        self.bar.is_some() || self.last.is_some_and(|last| last.elapsed() >= interval)
    }

    /// Shows finished and failed jobs, the remaining time, and the running jobs.
    fn report(&mut self) {
        self.last = Some(Instant::now());
        let summary = self.work.summary();
        let running = self.work.running.values().filter(|job| job.has_progress());
        let running: Vec<String> = running.take(MAX_JOBS_SHOWN).map(Running::text).collect();
        if let Some(bar) = &self.bar {
            let of_job = running.first().filter(|_| self.work.running.len() == 1);
            bar.set_length(self.work.jobs as u64);
            bar.set_message(of_job.map_or(summary.clone(), |job| format!("{summary}; {job}")));
            bar.set_position(self.work.finished as u64);
            return;
        }
        self.line(&summary);
        for text in running {
            self.line(&format!("  {}", text.trim_end()));
        }
        let running = self.work.running.len();
        if running > MAX_JOBS_SHOWN {
            self.line(&format!("  and {} more jobs running", running - MAX_JOBS_SHOWN));
        }
    }
}

impl<W: Write> Reporter for Lines<W> {
    fn event(&mut self, event: &Event) {
        self.work.add(event);
        let (jobs, finished) = (self.work.jobs, self.work.finished);
        match event {
            Event::GenerationStarted { .. } if finished < jobs => {
                let word = if jobs == 1 { "job" } else { "jobs" };
                let open = jobs - finished;
                self.line(&format!("{jobs} {word}, {finished} finished, {open} to run"));
                self.last = Some(Instant::now());
                if let Some(bar) = &self.bar {
                    bar.set_draw_target(ProgressDrawTarget::stderr());
                    self.report();
                }
            }
            Event::JobSample { .. } if self.is_due() => self.report(),
            Event::JobFinished { id, status, verdict, .. } => {
                if self.verbose {
                    let verdict = verdict.as_ref().map(|verdict| format!(", {verdict}"));
                    let verdict = verdict.unwrap_or_default();
                    self.line(&format!("{} {status}{verdict}", id.short()));
                }
                if finished == jobs || self.is_due() {
                    self.report();
                }
            }
            Event::Note(text) => self.line(&format!("note: {text}")),
            Event::Ended => {
                // A log has this line since the last job ended.
                if let Some(bar) = self.bar.take_if(|bar| !bar.is_hidden()) {
                    bar.finish_and_clear();
                    let summary = self.work.summary();
                    self.line(&summary);
                }
            }
            Event::GenerationStarted { .. }
            | Event::JobStarted { .. }
            | Event::JobSample { .. } => {}
        }
    }
}

#[cfg(test)]
mod tests;
