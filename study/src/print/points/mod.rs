//! The points of a study with replicates: which runs a command reads, and one row per point.

use crate::analysis::compare::measured;
use crate::analysis::replicates::{self, Condensed, Runs};
use crate::input::value::Value;
use crate::input::{expression, keys};
use crate::platform::error::Result;
use crate::print::shown_cells;
use crate::store::table::select::filtered;
use crate::store::table::{Column, Table};
use columns::{columns, keys_start};

mod columns;

/// Number of runs of a point.
pub const RUNS: &str = "runs";
/// Number of runs that deployed.
pub const DEPLOYED: &str = "deployed";
/// Column with the number of runs that are safe.
pub const SAFE: &str = "safe";
/// Ends of the names of the smallest and the largest value of a measure.
const RANGE: [&str; 2] = ["_least", "_largest"];

/// One row per point.
pub struct PointTable<'a> {
    /// Every run.
    runs_table: &'a Table,
    /// The runs as medians.
    pub condensed: Condensed,
    /// One number per column: `runs`, the parameters, the outcome, each measure with its range.
    pub table: Table,
}

/// The rows of the runs that a condition (`--where`) chooses. In a study with replicates a condition on
/// results chooses points; one that names a replicate, or parameters alone, chooses runs.
///
/// # Errors
/// An invalid condition, or an unknown column in it.
pub fn chosen_runs(
    table: &Table,
    condition: Option<&str>,
    replicates: &[String],
) -> Result<Vec<usize>> {
    let names = condition.map(expression::names).unwrap_or_default();
    let is_replicate =
        |name: &String| replicates.iter().any(|known| known == keys::shortened(name));
    if replicates.is_empty() || names.iter().any(is_replicate) {
        return filtered(table, condition);
    }
    let all: Vec<usize> = (0..table.rows()).collect();
    let points = PointTable::of(table, &all, replicates);
    if !names.iter().any(|name| points.is_result(name)) {
        return filtered(table, condition);
    }
    let kept = filtered(&points.table, condition)?;
    Ok(kept.iter().flat_map(|row| points.condensed.runs[*row].rows.clone()).collect())
}

impl<'a> PointTable<'a> {
    /// The points of some rows of a table.
    pub fn of(table: &'a Table, rows: &[usize], replicates: &[String]) -> Self {
        let condensed = Condensed::of(table, rows, replicates);
        let columns = columns(table, &condensed);
        Self { runs_table: table, condensed, table: Table { columns } }
    }

    /// Whether a column holds results: it is neither a parameter nor a key.
    fn is_result(&self, name: &str) -> bool {
        let keys = &self.runs_table.columns[keys_start(self.runs_table)..];
        let given = self.table.parameters().chain(keys).any(|column| column.name == name);
        !given && self.table.column(name).is_some()
    }

    /// The table as a reader sees it: how the runs of each point ended, and the number of runs that have a measure, where
    /// not all have it.
    pub fn for_reader(&self) -> Table {
        let cells = |column: &Column| -> Vec<Value> {
            let has_range = self.table.column(&format!("{}{}", column.name, RANGE[0])).is_some();
            let cell = |(runs, (row, cell)): (&Runs, (usize, &Value))| {
                if column.name == RUNS {
                    return Value::Text(runs_text(runs));
                }
                let all = runs.measured.len();
                let with = if has_range { self.runs_with(&column.name, runs) } else { all };
                if with == 0 || with == all {
                    return cell.clone();
                }
                let text = shown_cells(&self.table, column, &[row])[0].short();
                Value::Text(format!("{text} ({with} of {all})"))
            };
            self.condensed.runs.iter().zip(column.cells.iter().enumerate()).map(cell).collect()
        };
        let columns = self.table.columns.iter();
        let columns = columns.map(|column| column.like(column.name.clone(), cells(column)));
        Table { columns: columns.collect() }
    }

    /// Number of the runs of a point that have a measure.
    fn runs_with(&self, measure: &str, runs: &Runs) -> usize {
        let Some(column) = self.runs_table.column(measure) else { return runs.measured.len() };
        let column = replicates::source(self.runs_table, column);
        let has = |row: &&usize| measured(self.runs_table, column, **row).is_some();
        runs.measured.iter().filter(has).count()
    }

    /// Number of all runs.
    pub fn run_count(&self) -> usize {
        self.condensed.runs.iter().map(|runs| runs.rows.len()).sum()
    }
}

/// How the runs of a point ended: "5", or "4 done, 1 failed".
fn runs_text(runs: &Runs) -> String {
    if runs.failed + runs.pending + runs.infeasible + runs.not_trusted == 0 {
        return runs.rows.len().to_string();
    }
    if runs.infeasible == runs.rows.len() {
        return "infeasible".to_owned();
    }
    let parts = [
        (runs.done - runs.not_trusted, "done"),
        (runs.not_trusted, "not trusted"),
        (runs.failed, "failed"),
        (runs.infeasible, "infeasible"),
        (runs.pending, "pending"),
    ];
    let parts = parts.iter().filter(|(number, _)| *number > 0);
    parts.map(|(number, word)| format!("{number} {word}")).collect::<Vec<_>>().join(", ")
}

#[cfg(test)]
mod tests;
