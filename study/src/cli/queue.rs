//! The last submission of a study: its tasks in the queue of the cluster, and what they have stored.

use std::collections::{BTreeMap, BTreeSet};

use serde_json::json;

use super::print::{TopicLine, count};
use super::run::listed;
use crate::cluster::slurm;
use crate::cluster::submission::{self, Queued};
use crate::job::JobId;
use crate::platform::error::Result;
use crate::store::results::Results;

/// The tasks of the last submission.
pub(super) struct Workers {
    queued: Option<Queued>,
    /// The tasks in the queue by state, or why the queue cannot be asked.
    queue: std::result::Result<BTreeMap<String, usize>, String>,
    /// Number of jobs that tasks have ended and that are not merged yet.
    unmerged: usize,
    /// The command that merges them.
    merge: String,
}

impl Workers {
    /// Reads the results of the tasks, and asks the queue. A study that was never submitted asks no queue.
    ///
    /// # Errors
    /// [`crate::platform::error::Error::Disk`].
    pub fn of(results: &Results<'_>, merged: &dyn Fn(&JobId) -> bool) -> Result<Self> {
        let queued = submission::last_queued(results)?;
        let queue = queued.as_ref().map(slurm::queue);
        let mut unmerged = BTreeSet::new();
        for part in results.parts()? {
            unmerged.extend(part.journal()?.records.into_keys().filter(|id| !merged(id)));
        }
        let merge = format!("billow merge {}", results.root().display());
        let queue = queue.unwrap_or_else(|| Ok([].into()));
        Ok(Self { queued, queue, unmerged: unmerged.len(), merge })
    }

    /// As lines of `billow status`.
    pub fn lines(&self) -> Vec<TopicLine> {
        let mut lines = Vec::new();
        if let Some(Queued { array, merge }) = &self.queued {
            let state = match &self.queue {
                Ok(states) if states.is_empty() => "has left the queue".to_owned(),
                Ok(states) => format!("in the queue: {}", listed(states).to_lowercase()),
                Err(problem) => format!("the queue cannot be asked: {problem}"),
            };
            lines.push(("slurm", format!("array {array}, merge {merge}: {state}")));
        }
        if self.unmerged > 0 {
            let jobs = count(self.unmerged, "job");
            lines.push(("parts", format!("{jobs} ended by tasks, not merged yet: {}", self.merge)));
        }
        lines
    }

    /// As a value of `billow status --json`.
    pub fn json(&self) -> serde_json::Value {
        let slurm = self.queued.as_ref().map(|Queued { array, merge }| {
            json!({
                "array": array,
                "merge": merge,
                "queue": self.queue.as_ref().ok(),
                "problem": self.queue.as_ref().err(),
            })
        });
        json!({ "slurm": slurm, "unmerged": self.unmerged })
    }
}
