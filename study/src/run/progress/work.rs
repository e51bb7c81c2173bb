//! How far a run is: jobs finished and running, and the remaining time.

use std::collections::BTreeMap;
use std::num::NonZero;
use std::time::{Duration, Instant};

use billow_solver::models::run::Progress;

use crate::input::value::{brief_number, short_number};
use crate::run::event::Event;

/// Least part of a job that an estimate is made from. Chosen: the first steps of a job tell little.
const MIN_DONE: f64 = 0.05;
/// Least elapsed time that an estimate is made from. Chosen: a start takes up to a second.
const MIN_ELAPSED: Duration = Duration::from_secs(2);

/// The work of a run, event by event.
#[derive(Debug, Clone)]
pub(super) struct Work {
    /// Jobs of the study, jobs finished, jobs failed.
    pub jobs: usize,
    pub finished: usize,
    pub failed: usize,
    /// Number of threads of the run.
    threads: usize,
    /// When the first job could start, and the number of finished jobs then.
    pub start: Option<(Instant, usize)>,
    /// Running jobs by thread.
    pub running: BTreeMap<usize, Running>,
}

/// A running job.
#[derive(Debug, Clone)]
pub(super) struct Running {
    id: String,
    label: String,
    progress: Option<Progress>,
}

impl Work {
    /// No work yet; without a number of threads the run has one for each core.
    pub fn new(threads: Option<NonZero<usize>>) -> Self {
        let threads = threads.or_else(|| std::thread::available_parallelism().ok());
        Self {
            jobs: 0,
            finished: 0,
            failed: 0,
            threads: threads.map_or(1, NonZero::get),
            start: None,
            running: BTreeMap::new(),
        }
    }

    pub fn add(&mut self, event: &Event) {
        match event {
            Event::GenerationStarted { jobs, finished, .. } => {
                self.jobs += jobs;
                self.finished += finished;
                if self.finished < self.jobs {
                    self.start.get_or_insert((Instant::now(), self.finished));
                }
            }
            Event::JobStarted { id, label, thread } => {
                let (id, label) = (id.short().to_owned(), label.clone());
                self.running.insert(*thread, Running { id, label, progress: None });
            }
            Event::JobSample { thread, progress } => {
                if let Some(job) = self.running.get_mut(thread) {
                    job.progress = Some(*progress);
                }
            }
            Event::JobFinished { thread, status, .. } => {
                self.running.remove(thread);
                self.finished += 1;
                self.failed += usize::from(status.is_failure());
            }
            Event::Note(_) | Event::Ended => {}
        }
    }

    /// Numbers of jobs and the remaining time, in words.
    pub fn summary(&self) -> String {
        let Self { jobs, finished, failed, .. } = self;
        let remaining = match self.remaining_time() {
            Some(remaining) => {
                let threads = u32::try_from(self.threads.min(jobs - finished)).unwrap_or(u32::MAX);
                let core = duration_text(remaining.saturating_mul(threads));
                let core = match threads {
                    1 => String::new(),
                    threads => format!(" ({core} of core time on {threads} threads)"),
                };
                format!(", about {} remaining{core}", duration_text(remaining))
            }
            None => String::new(),
        };
        format!("{finished} of {jobs} jobs finished, {failed} failed{remaining}")
    }

    /// Remaining time on the threads of this run. A job costs what the jobs since the start have cost;
    /// a running one counts with its part of simulated time. `None` before there is enough to estimate
    /// from, and after the last job.
    pub fn remaining_time(&self) -> Option<Duration> {
        let (start, before) = self.start?;
        let running: f64 = self.running.values().map(Running::part).sum();
        let done = (self.finished - before) as f64 + running;
        let open = (self.jobs - self.finished) as f64 - running;
        let elapsed = start.elapsed();
        if done < MIN_DONE || elapsed < MIN_ELAPSED || open <= 0.0 {
            return None;
        }
        // Threads without a job cost nothing.
        let busy = |jobs: usize| self.threads.min(jobs).max(1) as f64;
        let cost = elapsed.as_secs_f64() * busy(self.jobs - before) / done;
        Duration::try_from_secs_f64(cost * open / busy(self.jobs - self.finished)).ok()
    }
}

impl Running {
    /// The part of its simulated time that has passed.
    pub fn part(&self) -> f64 {
        self.progress.map_or(0.0, |progress| (progress.time / progress.end_time).clamp(0.0, 1.0))
    }

    /// The job with its quantities, in words.
    pub fn text(&self) -> String {
        let Self { id, label, .. } = self;
        match self.progress {
            None => format!("{id}  starts  {label}"),
            // Before its first step, a job with a fine mesh computes its static reference.
            Some(progress) if progress.time <= 0.0 => {
                format!("{id}  prepares its mesh and its static reference  {label}")
            }
            Some(Progress { time, end_time, height, pressure }) => format!(
                "{id}  t {time:.3} of {} s  height {height:.3} m  pressure {} Pa  {label}",
                short_number(end_time),
                brief_number(pressure)
            ),
        }
    }

    /// Whether it has sent its progress.
    pub fn has_progress(&self) -> bool {
        self.progress.is_some()
    }
}

/// A duration in seconds, minutes or hours.
pub(super) fn duration_text(duration: Duration) -> String {
    match duration.as_secs() {
        seconds @ 0..120 => format!("{} s", seconds.max(1)),
        seconds @ 120..7200 => format!("{} min", (seconds + 30) / 60),
        seconds => format!("{:.1} h", seconds as f64 / 3600.0),
    }
}
