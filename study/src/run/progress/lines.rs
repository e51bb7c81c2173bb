//! Plain lines for logs and pipes: from time to time, the progress of the study and its running jobs.

use std::collections::BTreeMap;
use std::fmt::Write as _;
use std::io::Write;
use std::time::{Duration, Instant};

use billow_solver::models::run::Progress;

use super::{JobCounts, finished_line};
use crate::input::value::short_number;
use crate::run::event::{Event, Reporter};

/// Time between two progress reports, at least.
const MIN_REPORT_INTERVAL: Duration = Duration::from_secs(5);
/// Time between two progress reports of a long run, at most.
const MAX_REPORT_INTERVAL: Duration = Duration::from_mins(1);
/// In between, the interval is this part of the elapsed time: a log of a long run stays short.
const REPORTS_PER_ELAPSED_TIME: u32 = 20;
/// Running jobs in a progress report, at most.
const MAX_JOBS_SHOWN: usize = 8;
/// Number of finished jobs from which the remaining time is estimated; running jobs count as parts.
const MIN_FINISHED_FOR_ESTIMATE: f64 = 0.01;

/// Writes plain lines.
pub(super) struct Lines<W> {
    pub(super) out: W,
    verbose: bool,
    counts: JobCounts,
    /// When the first job started, and the number of finished jobs then.
    pub(super) start: Option<(Instant, usize)>,
    /// When the last report was written.
    pub(super) last: Option<Instant>,
    /// Running jobs by thread: name and last progress.
    pub(super) running: BTreeMap<usize, (String, Option<Progress>)>,
}

impl<W: Write> Lines<W> {
    pub(super) fn new(out: W, verbose: bool) -> Self {
        let running = BTreeMap::new();
        Self { out, verbose, counts: JobCounts::default(), start: None, last: None, running }
    }

    fn line(&mut self, text: &str) {
        // A closed stderr must not stop a study.
        let _ = writeln!(self.out, "{text}");
    }

    /// Whether it is time for a report.
    fn due(&self) -> bool {
        let Some((start, _)) = self.start else { return false };
        let interval = (start.elapsed() / REPORTS_PER_ELAPSED_TIME)
            .clamp(MIN_REPORT_INTERVAL, MAX_REPORT_INTERVAL);
        self.last.is_some_and(|last| last.elapsed() >= interval)
    }

    /// Writes finished and failed jobs, the remaining time, and the running jobs.
    fn report(&mut self) {
        let JobCounts { jobs, finished, failed } = self.counts;
        let mut text = format!("{finished} of {jobs} jobs finished, {failed} failed");
        if let Some(remaining) = self.remaining_time() {
            let _ = write!(text, ", about {} remaining", duration_text(remaining));
        }
        self.line(&text);
        let running: Vec<String> =
            self.running.values().take(MAX_JOBS_SHOWN).filter_map(running_line).collect();
        for text in running {
            self.line(&text);
        }
        if self.running.len() > MAX_JOBS_SHOWN {
            self.line(&format!("  and {} more jobs running", self.running.len() - MAX_JOBS_SHOWN));
        }
        self.last = Some(Instant::now());
    }

    /// Remaining time, from the jobs finished since the start. A running job counts with its part of
    /// simulated time. `None` before there is enough to estimate from.
    fn remaining_time(&self) -> Option<Duration> {
        let (start, finished_before) = self.start?;
        let progress = self.running.values().filter_map(|(_, progress)| *progress);
        let running: f64 = progress.map(|job| (job.time / job.end_time).clamp(0.0, 1.0)).sum();
        let done = (self.counts.finished - finished_before) as f64 + running;
        let open = (self.counts.jobs - self.counts.finished) as f64 - running;
        let known = done > MIN_FINISHED_FOR_ESTIMATE && open > 0.0;
        let seconds = start.elapsed().as_secs_f64() * open / done;
        known.then(|| Duration::try_from_secs_f64(seconds).ok()).flatten()
    }
}

/// The line of a running job; `None` before its first progress.
fn running_line((name, progress): &(String, Option<Progress>)) -> Option<String> {
    let progress = (*progress)?;
    // Before its first step, a job with a fine mesh computes its static reference for some time.
    if progress.time <= 0.0 {
        return Some(format!("  {name}  prepares its mesh and its static reference"));
    }
    Some(format!(
        "  {name}  t {:.4} of {} s  z_centre {:.3} m  p {:.4} Pa",
        progress.time,
        short_number(progress.end_time),
        progress.z_centre,
        progress.pressure
    ))
}

/// A duration in seconds, minutes or hours.
pub(super) fn duration_text(duration: Duration) -> String {
    match duration.as_secs() {
        seconds @ 0..120 => format!("{} s", seconds.max(1)),
        seconds @ 120..7200 => format!("{} min", (seconds + 30) / 60),
        seconds => format!("{:.1} h", seconds as f64 / 3600.0),
    }
}

impl<W: Write> Reporter for Lines<W> {
    fn event(&mut self, event: &Event) {
        self.counts.add(event);
        let JobCounts { jobs, finished, .. } = self.counts;
        match event {
            Event::GenerationStarted { .. } if finished < jobs => {
                self.line(&format!("{jobs} jobs, {finished} finished, {} to run", jobs - finished));
                let now = Instant::now();
                self.start.get_or_insert((now, finished));
                self.last = Some(now);
            }
            Event::JobStarted { id, label, thread } => {
                self.running.insert(*thread, (format!("{} {label}", id.short()), None));
            }
            Event::JobSample { thread, progress } => {
                if let Some((_, last)) = self.running.get_mut(thread) {
                    *last = Some(*progress);
                }
                if self.due() {
                    self.report();
                }
            }
            Event::JobFinished { thread, .. } => {
                self.running.remove(thread);
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
            Event::GenerationStarted { .. } | Event::Ended => {}
        }
    }
}
