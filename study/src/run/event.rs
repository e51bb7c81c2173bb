//! What running says to whoever watches; running and reporting meet only here.

use billow_solver::models::run::Progress;

use crate::job::JobId;

/// Something happened while a study ran.
#[derive(Debug, Clone, PartialEq)]
pub enum Event {
    /// A generation of jobs begins.
    GenerationStarted {
        /// 0 for the first.
        number: u32,
        /// Points that have a job.
        jobs: usize,
        /// Jobs of it that are finished already.
        finished: usize,
    },
    /// A job begins.
    JobStarted {
        /// Its name.
        id: JobId,
        /// Its varied parameters, as "N=5 M=2".
        label: String,
        /// The thread it runs on, from 0.
        thread: usize,
    },
    /// A running job stands here. Not every sample is told.
    JobSample {
        /// The thread it runs on.
        thread: usize,
        /// Where it stands.
        progress: Progress,
    },
    /// A job ended and its results are on disk.
    JobFinished {
        /// Its name.
        id: JobId,
        /// The thread it ran on.
        thread: usize,
        /// How it ended.
        status: String,
        /// Its verdict, if it has one.
        verdict: Option<String>,
    },
    /// Something the user should know that is no error: a torn journal line, a damaged file.
    Note(String),
    /// Nothing more happens.
    Ended,
}

/// Hears events.
pub trait Reporter {
    /// One event.
    fn event(&mut self, event: &Event);
}

/// Hears nothing.
#[derive(Debug, Clone, Copy, Default)]
pub struct Silent;

impl Reporter for Silent {
    fn event(&mut self, _: &Event) {}
}
