//! What the columns of a row are taken from: the job, how it ended, its fold pattern.

use billow_solver::geometry::fold::{FoldError, FoldPattern};
use billow_solver::models::film::CONTACT_COLUMNS;
use billow_solver::output::audit::Audit;
use billow_solver::output::measures::{Measures, Verdict};
use billow_solver::output::outcome::{Deployment, Failure, Stop};
use billow_solver::scene::Thresholds;
use billow_solver::scene::error::SceneError;

use crate::job::executor::Outcome;
use crate::job::{Job, Status};

/// The reason of a job in quarantine.
const CRASHED: &str = "the process died in two attempts at this job, in the last one with no other job \
                       beside it (memory, a signal, an error in the program); next: billow run STUDY --again \
                       crashed";

/// A job that ended, as the table of columns sees it. The methods return `None` for what this job
/// does not have; its cell is then null.
pub struct JobEnd<'a> {
    job: &'a Job,
    outcome: &'a Outcome,
    /// How the job ended.
    pub status: Status,
    pattern: Option<FoldPattern>,
    /// Hash of history and frames of a job that ran.
    pub content_hash: Option<&'a str>,
}

impl<'a> JobEnd<'a> {
    /// `None` for a cancelled job: nothing of it is stored.
    pub fn new(job: &'a Job, outcome: &'a Outcome, content_hash: Option<&'a str>) -> Option<Self> {
        let status = match outcome {
            Outcome::Cancelled => return None,
            Outcome::Ran { deployment, .. } => match &deployment.stop {
                Stop::Cancelled => return None,
                Stop::Done => Status::Done,
                Stop::Failed(failure) => Status::Failed(failure.kind),
            },
            Outcome::Refused(SceneError::Fold(FoldError::Infeasible { .. })) => Status::Infeasible,
            Outcome::Refused(_) => Status::Invalid,
            Outcome::Panicked(_) => Status::Panicked,
            Outcome::Limited(limit) => limit.status(),
            Outcome::Crashed => Status::Crashed,
        };
        // A job that panicked or crashed may have done so in the solution of its pattern.
        let pattern = match outcome {
            Outcome::Panicked(_) | Outcome::Crashed => None,
            _ => job.scene.design.pattern().ok(),
        };
        Some(Self { job, outcome, status, pattern, content_hash })
    }

    /// The result of a job that ran.
    pub fn deployment(&self) -> Option<&'a Deployment> {
        match self.outcome {
            Outcome::Ran { deployment, .. } => Some(deployment),
            _ => None,
        }
    }

    /// A measure of a job that ran.
    pub fn measure(&self, measure: fn(&Measures) -> Option<f64>) -> Option<f64> {
        measure(&self.deployment()?.measures)
    }

    /// A time of a job that ran, counted from the release of the lid, s.
    pub fn since_release(&self, time: fn(&Measures) -> Option<f64>) -> Option<f64> {
        Some(self.measure(time)? - self.job.scene.release_time)
    }

    /// The verdict of a job that ran.
    pub fn verdict(&self) -> Option<Verdict> {
        self.deployment()?.measures.verdict
    }

    /// A quantity of the audit of a job that ran.
    pub fn audit<T>(&self, quantity: fn(&Audit) -> T) -> Option<T> {
        Some(quantity(&self.deployment()?.audit))
    }

    /// The largest or smallest value of a contact column of the history: `pick` returns one of two
    /// values.
    ///
    /// # Panics
    /// When contact has no column with that name. This is a mistake in the table of columns.
    pub fn extreme(&self, track: &str, pick: fn(f64, f64) -> f64) -> Option<f64> {
        let known = CONTACT_COLUMNS.iter().any(|(name, ..)| *name == track);
        assert!(known, "contact has no column {track:?}");
        self.deployment()?.followed(track).iter().copied().reduce(pick)
    }

    /// Largest value of a track over the samples, SI, and its first time, s; `None` for a model without it.
    pub fn largest(&self, track: &str) -> Option<[f64; 2]> {
        let run = self.deployment()?;
        let values = run.followed(track);
        let times = run.history.column("time");
        let samples = values.iter().zip(times).map(|(value, time)| [*value, *time]);
        samples.reduce(|largest, sample| if sample[0] > largest[0] { sample } else { largest })
    }

    /// A threshold of the verdict. A job that panicked or crashed shows none.
    pub fn threshold(&self, threshold: fn(&Thresholds) -> f64) -> Option<f64> {
        let unknown = matches!(self.outcome, Outcome::Panicked(_) | Outcome::Crashed);
        (!unknown).then(|| threshold(&self.job.scene.outputs.thresholds))
    }

    /// A dimension of the solved fold pattern.
    pub fn pattern(&self, dimension: fn(&FoldPattern) -> f64) -> Option<f64> {
        self.pattern.as_ref().map(dimension)
    }

    /// Why, when and where a failed run stopped.
    pub fn failure(&self) -> Option<&'a Failure> {
        match &self.deployment()?.stop {
            Stop::Failed(failure) => Some(failure),
            Stop::Done | Stop::Cancelled => None,
        }
    }

    /// Why there is no run, or no verdict.
    pub fn reason(&self) -> Option<String> {
        match self.outcome {
            Outcome::Ran { deployment, .. } => {
                let missing = deployment.measures.no_verdict.as_ref();
                missing.map(|missing| format!("no verdict: {missing}"))
            }
            Outcome::Refused(error) => Some(error.to_string()),
            Outcome::Panicked(message) => Some(message.clone()),
            Outcome::Limited(limit) => Some(limit.reason()),
            Outcome::Crashed => Some(CRASHED.to_owned()),
            Outcome::Cancelled => None,
        }
    }

    /// Wall time of a job that ran, s.
    pub fn seconds(&self) -> Option<f64> {
        match self.outcome {
            Outcome::Ran { seconds, .. } => Some(*seconds),
            _ => None,
        }
    }

    /// Wall time over elements and accepted steps, ns. Both count from the last start or resume.
    pub fn time_per_zone_cycle(&self) -> Option<f64> {
        let Outcome::Ran { deployment, seconds, steps } = self.outcome else { return None };
        let element_steps = *steps as f64 * deployment.elements as f64;
        (element_steps > 0.0).then(|| seconds * 1e9 / element_steps)
    }
}

/// A count as a cell holds it.
pub fn integer(value: u64) -> i64 {
    i64::try_from(value).unwrap_or(i64::MAX)
}
