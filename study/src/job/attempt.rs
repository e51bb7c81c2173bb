//! One attempt at a job: asks the runner what to do, and notices the limits of the job.

use std::time::Instant;

use billow_solver::models::run::{Answer, Observer, Pause, Progress};

use crate::job::control::{Order, Task};
use crate::job::limits::Limit;
use crate::job::pace::Pace;

/// Why an attempt ended before its job.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Ending {
    /// The runner asked for it.
    Stopped,
    /// The job reached a limit.
    Limited(Limit),
}

/// An attempt. Its clock starts with it.
pub struct Attempt<'a> {
    task: &'a Task<'a>,
    start: Instant,
    pace: Pace,
    /// Steps since time 0 at the first pause of this attempt, and at the last one.
    first: Option<u64>,
    now: u64,
    ending: Option<Ending>,
}

impl<'a> Attempt<'a> {
    /// An attempt that starts now.
    pub fn new(task: &'a Task<'a>) -> Self {
        let pace = Pace::new();
        Self { task, start: Instant::now(), pace, first: None, now: 0, ending: None }
    }

    /// Why it ended; `None` if it has not.
    pub fn ending(&self) -> Option<Ending> {
        self.ending
    }

    /// Wall time since its start, s, and the steps in this time of a run of `steps` steps.
    pub fn cost(&self, steps: u64) -> (f64, u64) {
        // The first pause comes after one step.
        let before = self.first.map_or(0, |first| first.saturating_sub(1));
        (self.start.elapsed().as_secs_f64(), steps.saturating_sub(before))
    }

    /// Whether the attempt goes on, where no checkpoint is possible.
    pub fn continues(&mut self) -> bool {
        self.ending = self.limit().map(Ending::Limited);
        if self.ending.is_none() && self.task.control.order() == Order::End {
            self.ending = Some(Ending::Stopped);
        }
        self.ending.is_none()
    }

    /// The limit that is reached now.
    fn limit(&self) -> Option<Limit> {
        let limits = &self.task.limits;
        let steps = limits.steps.filter(|limit| self.now >= *limit).map(Limit::Steps);
        let elapsed = self.start.elapsed().as_secs_f64();
        steps.or(limits.wall_time.filter(|limit| elapsed >= *limit).map(Limit::WallTime))
    }
}

impl Observer for Attempt<'_> {
    fn sample(&mut self, progress: Progress) -> bool {
        self.task.control.progress(progress);
        true
    }

    fn prepares(&mut self) -> bool {
        self.continues()
    }

    fn steps(&mut self) -> u64 {
        let remaining = self.task.limits.steps.map(|limit| limit.saturating_sub(self.now));
        remaining.map_or(self.pace.steps(), |remaining| remaining.min(self.pace.steps()))
    }

    fn pause(&mut self, steps: u64) -> Answer {
        self.pace.asked();
        self.first.get_or_insert(steps);
        self.now = steps;
        self.ending = self.limit().map(Ending::Limited);
        match (self.ending, self.task.control.order()) {
            (None, Order::Continue) => Answer::Continue,
            (None, Order::End) => {
                self.ending = Some(Ending::Stopped);
                Answer::Store
            }
            (Some(_), _) | (None, Order::Store) => Answer::Store,
        }
    }

    fn store(&mut self, pause: &Pause<'_>) -> bool {
        match (pause.text)(self.task.job.id.as_str()) {
            Some(Ok(text)) => self.task.control.store(&text, pause.time),
            Some(Err(error)) => {
                let id = self.task.job.id.short();
                self.task.control.note(format!("job {id} has no checkpoint: {error}"));
            }
            None => {}
        }
        self.ending.is_none()
    }
}
