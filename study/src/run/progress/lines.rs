//! Plain lines for logs and pipes: from time to time, the progress of the study and its running jobs.

use std::io::Write;
use std::num::NonZero;
use std::time::{Duration, Instant};

use super::finished_line;
use super::work::{Running, Work};
use crate::run::event::{Event, Reporter};

/// Time between two progress reports, at least.
const MIN_REPORT_INTERVAL: Duration = Duration::from_secs(5);
/// Time between two progress reports of a long run, at most.
const MAX_REPORT_INTERVAL: Duration = Duration::from_mins(1);
/// In between, the interval is this part of the elapsed time: a log of a long run stays short.
const REPORTS_PER_ELAPSED_TIME: u32 = 20;
/// Running jobs in a progress report, at most.
const MAX_JOBS_SHOWN: usize = 8;

/// Writes plain lines.
pub(super) struct Lines<W> {
    pub(super) out: W,
    verbose: bool,
    pub(super) work: Work,
    /// When the last report was written.
    pub(super) last: Option<Instant>,
}

impl<W: Write> Lines<W> {
    pub(super) fn new(out: W, verbose: bool, threads: Option<NonZero<usize>>) -> Self {
        Self { out, verbose, work: Work::new(threads), last: None }
    }

    fn line(&mut self, text: &str) {
        // A closed stderr must not stop a study.
        let _ = writeln!(self.out, "{text}");
    }

    /// Whether it is time for a report.
    fn due(&self) -> bool {
        let Some((start, _)) = self.work.start else { return false };
        let interval = (start.elapsed() / REPORTS_PER_ELAPSED_TIME)
            .clamp(MIN_REPORT_INTERVAL, MAX_REPORT_INTERVAL);
        self.last.is_some_and(|last| last.elapsed() >= interval)
    }

    /// Writes finished and failed jobs, the remaining time, and the running jobs.
    fn report(&mut self) {
        self.line(&self.work.summary());
        let running: Vec<String> = self
            .work
            .running
            .values()
            .filter(|job| job.has_progress())
            .take(MAX_JOBS_SHOWN)
            .map(Running::text)
            .collect();
        for text in running {
            self.line(&format!("  {}", text.trim_end()));
        }
        let running = self.work.running.len();
        if running > MAX_JOBS_SHOWN {
            self.line(&format!("  and {} more jobs running", running - MAX_JOBS_SHOWN));
        }
        self.last = Some(Instant::now());
    }
}

impl<W: Write> Reporter for Lines<W> {
    fn event(&mut self, event: &Event) {
        self.work.add(event);
        let (jobs, finished) = (self.work.jobs, self.work.finished);
        match event {
            Event::GenerationStarted { .. } if finished < jobs => {
                let word = if jobs == 1 { "job" } else { "jobs" };
                self.line(&format!(
                    "{jobs} {word}, {finished} finished, {} to run",
                    jobs - finished
                ));
                self.last = Some(Instant::now());
            }
            Event::JobSample { .. } if self.due() => self.report(),
            Event::JobFinished { .. } => {
                if self.verbose
                    && let Some(text) = finished_line(event)
                {
                    self.line(&text);
                }
                if finished == jobs || self.due() {
                    self.report();
                }
            }
            Event::Note(text) => self.line(&format!("note: {text}")),
            Event::GenerationStarted { .. }
            | Event::JobStarted { .. }
            | Event::JobSample { .. }
            | Event::Ended => {}
        }
    }
}
