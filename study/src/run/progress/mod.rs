//! The progress of a run on stderr: lines from time to time; on a terminal one line that is drawn again.

use std::io::{self, IsTerminal, Write};
use std::num::NonZero;
use std::time::{Duration, Instant};

use crate::run::event::{Event, Reporter, Silent};

mod work;

use work::{Running, Work};

/// Time between two progress reports, at least.
const MIN_REPORT_INTERVAL: Duration = Duration::from_secs(5);
/// Time between two progress reports of a long run, at most.
const MAX_REPORT_INTERVAL: Duration = Duration::from_mins(1);
/// In between, the interval is this part of the elapsed time: a log of a long run stays short.
const REPORTS_PER_ELAPSED_TIME: u32 = 20;
/// Time between two drawings of the line of a terminal.
const REDRAW_INTERVAL: Duration = Duration::from_millis(250);
/// Running jobs in a progress report, at most.
const MAX_JOBS_SHOWN: usize = 8;
/// Characters of the line of a terminal, at most: the usual width.
const MAX_DRAWN: usize = 79;
/// Returns to the start of the line and clears it.
const CLEAR: &str = "\r\x1b[K";

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
    let redraws = io::stderr().is_terminal();
    Box::new(Lines::new(io::stderr(), loudness == Loudness::Verbose, redraws, threads))
}

/// Writes the progress.
struct Lines<W> {
    out: W,
    verbose: bool,
    /// Whether a report replaces the last one.
    redraws: bool,
    /// Whether a report stands in the line of the cursor.
    is_drawn: bool,
    work: Work,
    /// When the last report was written.
    last: Option<Instant>,
}

impl<W: Write> Lines<W> {
    fn new(out: W, verbose: bool, redraws: bool, threads: Option<NonZero<usize>>) -> Self {
        Self { out, verbose, redraws, is_drawn: false, work: Work::new(threads), last: None }
    }

    fn line(&mut self, text: &str) {
        let clear = if std::mem::take(&mut self.is_drawn) { CLEAR } else { "" };
        // A closed stderr must not stop a study.
        let _ = writeln!(self.out, "{clear}{text}");
    }

    /// Whether it is time for a report.
    fn is_due(&self) -> bool {
        let Some((start, _)) = self.work.start else { return false };
        let of_log = (start.elapsed() / REPORTS_PER_ELAPSED_TIME)
            .clamp(MIN_REPORT_INTERVAL, MAX_REPORT_INTERVAL);
        let interval = if self.redraws { REDRAW_INTERVAL } else { of_log };
        self.last.is_some_and(|last| last.elapsed() >= interval)
    }

    /// Writes finished and failed jobs, the remaining time, and the running jobs.
    fn report(&mut self) {
        self.last = Some(Instant::now());
        let summary = self.work.summary();
        let running = self.work.running.values().filter(|job| job.has_progress());
        let running: Vec<String> = running.take(MAX_JOBS_SHOWN).map(Running::text).collect();
        if self.redraws {
            let of_job = running.first().filter(|_| self.work.running.len() == 1);
            let text = of_job.map_or(summary.clone(), |job| format!("{summary}; {job}"));
            let text: String = text.chars().take(MAX_DRAWN).collect();
            let _ = write!(self.out, "{CLEAR}{text}").and_then(|()| self.out.flush());
            self.is_drawn = true;
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
            Event::Ended if self.is_drawn => {
                let summary = self.work.summary();
                self.line(&summary);
            }
            Event::GenerationStarted { .. }
            | Event::JobStarted { .. }
            | Event::JobSample { .. }
            | Event::Ended => {}
        }
    }
}

#[cfg(test)]
mod tests;
