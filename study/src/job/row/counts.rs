//! Numbers of rows by status and by verdict.

use std::collections::BTreeMap;

use billow_solver::output::measures::Verdict;
use serde::{Deserialize, Serialize};

use super::{Cells, ColumnId};
use crate::input::value::Value;
use crate::job::Status;

/// Numbers of rows by how they ended.
#[derive(Debug, Clone, PartialEq, Eq, Default, Serialize, Deserialize)]
pub struct Counts {
    /// Rows by name of their status.
    pub status: BTreeMap<String, usize>,
    /// Done rows by verdict.
    pub verdict: BTreeMap<String, usize>,
    /// Done rows whose verdict is near a threshold.
    pub near_threshold: usize,
}

impl Counts {
    /// Adds a row.
    pub fn add(&mut self, status: Status, verdict: Option<Verdict>, near_threshold: bool) {
        *self.status.entry(status.name().to_owned()).or_default() += 1;
        if let Some(verdict) = verdict {
            *self.verdict.entry(verdict.name().to_owned()).or_default() += 1;
        }
        self.near_threshold += usize::from(near_threshold);
    }

    /// Adds the row with these cells.
    pub fn add_cells(&mut self, cells: &Cells) {
        let near_threshold = *cells.get(ColumnId::NearThreshold) == Value::Bool(true);
        self.add(cells.status(), cells.verdict(), near_threshold);
    }

    /// Number of rows with that status.
    pub fn of(&self, status: Status) -> usize {
        self.status.get(status.name()).copied().unwrap_or(0)
    }

    /// Number of rows with that verdict.
    pub fn with(&self, verdict: Verdict) -> usize {
        self.verdict.get(verdict.name()).copied().unwrap_or(0)
    }

    /// Number of rows.
    pub fn rows(&self) -> usize {
        self.status.values().sum()
    }

    /// Number of rows that have a job.
    pub fn jobs(&self) -> usize {
        self.rows() - self.of(Status::Infeasible)
    }

    /// Number of jobs that have run.
    pub fn ended(&self) -> usize {
        self.jobs() - self.of(Status::Pending)
    }

    /// Failed jobs by name of their status.
    pub fn failures(&self) -> BTreeMap<String, usize> {
        let failed = |name: &str| Status::from_name(name).is_some_and(Status::is_failure);
        let failures = self.status.iter().filter(|(name, _)| failed(name));
        failures.map(|(name, number)| (name.clone(), *number)).collect()
    }

    /// Number of failed jobs.
    pub fn failed(&self) -> usize {
        self.failures().values().sum()
    }
}
