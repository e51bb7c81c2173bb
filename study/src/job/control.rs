//! What the runner asks of a running job, and what it gets from it.

use billow_solver::models::run::Progress;

use crate::job::Job;
use crate::job::limits::JobLimits;

/// A job to compute, with everything its executor needs.
pub struct Task<'a> {
    /// The job.
    pub job: &'a Job,
    /// Its limits. The memory limit is checked before.
    pub limits: JobLimits,
    /// The text of its checkpoint, if an earlier attempt stored one.
    pub checkpoint: Option<String>,
    /// Its runner.
    pub control: &'a dyn Control,
}

/// The runner of a job. A job asks it about every 50 ms and at every sample.
pub trait Control: Sync {
    /// What the job does now.
    fn order(&self) -> Order;

    /// Receives the progress at a sample.
    fn progress(&self, progress: Progress);

    /// Receives a checkpoint: its text, and the simulated time (s).
    fn store(&self, text: &str, time: f64);

    /// Receives a message for the user.
    fn note(&self, text: String);
}

/// What a job does.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Order {
    /// It goes on.
    Continue,
    /// It stores a checkpoint and goes on.
    Store,
    /// It stores a checkpoint and ends as cancelled.
    End,
}
