//! Events of a run: the only link between running and reporting.

use billow_solver::models::run::Progress;

use crate::job::{JobId, Status};

/// An event of a run.
#[derive(Debug, Clone, PartialEq)]
pub enum Event {
    /// A generation of jobs starts.
    GenerationStarted {
        /// Number of the generation, from 0.
        number: u32,
        /// Number of jobs to run, finished ones included.
        jobs: usize,
        /// Number of these jobs that are already finished.
        finished: usize,
    },
    /// A job starts.
    JobStarted {
        /// Id of the job.
        id: JobId,
        /// Its varied parameters: "N=5 M=2".
        label: String,
        /// Number of its thread, from 0.
        thread: usize,
    },
    /// Progress of a running job. Not every sample gives an event.
    JobSample {
        /// Number of its thread.
        thread: usize,
        /// Simulated time, height and pressure.
        progress: Progress,
    },
    /// A job ended, and its results are on disk.
    JobFinished {
        /// Id of the job.
        id: JobId,
        /// Number of its thread.
        thread: usize,
        /// How it ended.
        status: Status,
        /// Its verdict; `None` unless it is done.
        verdict: Option<String>,
    },
    /// A message for the user that is not an error: a torn journal line, a damaged file.
    Note(String),
    /// The run ended. No event follows.
    Ended,
}

/// Receives events.
pub trait Reporter {
    /// Receives one event.
    fn event(&mut self, event: &Event);
}

/// Ignores every event.
#[derive(Debug, Clone, Copy, Default)]
pub struct Silent;

impl Reporter for Silent {
    fn event(&mut self, _: &Event) {}
}
