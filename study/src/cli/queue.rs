//! Who works on a study: the runs that share its folder, and the last submission in the queue of the cluster.

use serde_json::json;

use super::print::{TopicLine, count};
use super::run::listed;
use crate::cluster::slurm;
use crate::cluster::submission::{Queued, Submission};
use crate::platform::error::Result;
use crate::store::claims::LiveRun;
use crate::store::results::Results;

/// Runs that are named, at most.
const MAX_NAMED: usize = 4;

/// Who works on a study.
pub(super) struct Workers {
    runs: Vec<LiveRun>,
    submission: Option<(Submission, Queued)>,
    /// The tasks in the queue by state, or why the queue cannot be asked.
    queue: std::result::Result<std::collections::BTreeMap<String, usize>, String>,
}

impl Workers {
    /// Reads the claims of the folder first, and asks the queue second. A study that was never submitted asks no queue.
    ///
    /// # Errors
    /// [`crate::platform::error::Error::Disk`].
    pub fn of(results: &Results<'_>) -> Result<Self> {
        let runs = results.live_runs()?;
        let submission = Submission::last_queued(results)?;
        let queue = submission.as_ref().map(|(_, queued)| slurm::queue(queued));
        Ok(Self { runs, submission, queue: queue.unwrap_or_else(|| Ok([].into())) })
    }

    /// As lines of `billow status`.
    pub fn lines(&self) -> Vec<TopicLine> {
        let mut lines = Vec::new();
        if !self.runs.is_empty() {
            let jobs: usize = self.runs.iter().map(|run| run.jobs.len()).sum();
            let mut names: Vec<&str> =
                self.runs.iter().take(MAX_NAMED).map(|run| run.owner.as_str()).collect();
            if self.runs.len() > MAX_NAMED {
                names.push("…");
            }
            let runs = count(self.runs.len(), "run");
            lines.push((
                "shared",
                format!("{runs} at work on {}: {}", count(jobs, "job"), names.join(", ")),
            ));
        }
        if let Some((submission, queued)) = &self.submission {
            let Queued { array, merge } = queued;
            let state = match &self.queue {
                Ok(states) if states.is_empty() => "has left the queue".to_owned(),
                Ok(states) => format!("in the queue: {}", listed(states).to_lowercase()),
                Err(problem) => format!("the queue cannot be asked: {problem}"),
            };
            let name = &submission.name;
            lines.push((
                "slurm",
                format!("submission {name} (array {array}, merge {merge}) {state}"),
            ));
        }
        lines
    }

    /// As a value of `billow status --json`.
    pub fn json(&self) -> serde_json::Value {
        let runs = self.runs.iter().map(|run| {
            let jobs: Vec<&str> = run.jobs.iter().map(crate::job::JobId::as_str).collect();
            json!({ "owner": run.owner, "jobs": jobs })
        });
        let submission = self.submission.as_ref().map(|(submission, queued)| {
            json!({
                "submission": submission.name,
                "array": queued.array,
                "merge": queued.merge,
                "queue": self.queue.as_ref().ok(),
                "problem": self.queue.as_ref().err(),
            })
        });
        json!({ "runs": runs.collect::<Vec<_>>(), "slurm": submission })
    }
}
