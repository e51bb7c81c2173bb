//! How many rows ended how.

use std::collections::BTreeMap;

use super::{Cells, INFEASIBLE, is_failure};
use crate::input::value::Value;

/// Rows by how they ended.
#[derive(Debug, Clone, PartialEq, Eq, Default)]
pub struct Counts {
    /// Rows by status.
    pub status: BTreeMap<String, usize>,
    /// Done rows by verdict.
    pub verdict: BTreeMap<String, usize>,
    /// Done rows whose verdict a change of less than the margin would change.
    pub close: usize,
}

impl Counts {
    /// Takes in a row; its verdict is empty where it has none.
    pub fn add(&mut self, status: &str, verdict: &str, close: bool) {
        *self.status.entry(status.to_owned()).or_default() += 1;
        if !verdict.is_empty() {
            *self.verdict.entry(verdict.to_owned()).or_default() += 1;
        }
        self.close += usize::from(close);
    }

    /// Takes in the cells of a row.
    pub fn add_cells(&mut self, cells: &Cells) {
        let close = *cells.get("close") == Value::Bool(true);
        self.add(cells.status(), cells.text("verdict"), close);
    }

    /// Rows of that status.
    pub fn of(&self, status: &str) -> usize {
        self.status.get(status).copied().unwrap_or(0)
    }

    /// All rows.
    pub fn rows(&self) -> usize {
        self.status.values().sum()
    }

    /// Rows that have a job.
    pub fn jobs(&self) -> usize {
        self.rows() - self.of(INFEASIBLE)
    }

    /// Failed jobs by status.
    pub fn failures(&self) -> BTreeMap<String, usize> {
        let failed = self.status.iter().filter(|(status, _)| is_failure(status));
        failed.map(|(status, number)| (status.clone(), *number)).collect()
    }

    /// Rows of failed jobs.
    pub fn failed(&self) -> usize {
        self.failures().values().sum()
    }
}
