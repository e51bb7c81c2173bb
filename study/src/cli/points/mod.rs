//! The points of a study with replicates: which runs a command reads, and one row per point.

use super::legend::PLUS_MINUS;
use super::range;
use crate::accuracy::error_column;
use crate::analysis::compare::measured;
use crate::analysis::replicates::{self, Condensed, Runs};
use crate::analysis::statistics::Spread;
use crate::input::value::Value;
use crate::input::{expression, keys};
use crate::job::proportion::Proportion;
use crate::job::row::{CellType, DerivedColumn};
use crate::platform::error::Result;
use crate::store::table::select::filtered;
use crate::store::table::{Column, Table};
use columns::{columns, keys_start};

mod columns;

/// Number of runs of a point.
pub const RUNS: &str = "runs";
/// Number of runs that deployed.
pub const DEPLOYED: &str = "deployed";
/// Ends of the names of the smallest and the largest value of a measure.
pub const RANGE: [&str; 2] = ["_least", "_largest"];
/// Significant digits of a margin.
const MARGIN_DIGITS: usize = 3;

/// One row per point.
pub struct Points<'a> {
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
    let parameter = |name: &str| {
        keys::find(name).map_or(name.to_owned(), |key| keys::short_name(key).to_owned())
    };
    if replicates.is_empty() || names.iter().any(|name| replicates.contains(&parameter(name))) {
        return filtered(table, condition);
    }
    let all: Vec<usize> = (0..table.rows()).collect();
    let points = Points::of(table, &all, replicates);
    if !names.iter().any(|name| points.is_result(name)) {
        return filtered(table, condition);
    }
    let kept = filtered(&points.as_variables(), condition)?;
    Ok(kept.iter().flat_map(|row| points.condensed.runs[*row].rows.clone()).collect())
}

impl<'a> Points<'a> {
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

    /// The table with `safe` as a truth value: whether every run is safe.
    fn as_variables(&self) -> Table {
        let mut table = self.table.clone();
        let safe = DerivedColumn::Safe.name();
        if let Some(column) = table.columns.iter_mut().find(|column| column.name == safe) {
            column.cell_type = CellType::Bool;
            let every = |runs: &Runs| match runs.safe {
                Proportion { of: 0, .. } => Value::Null,
                safe => Value::Bool(safe.met == safe.of),
            };
            column.cells = self.condensed.runs.iter().map(every).collect();
        }
        table
    }

    /// The cell of a column for a reader: a measure with its range, a number of runs as a proportion. Numbers
    /// that stay numbers are SI.
    pub fn cell(&self, column: &Column, row: usize) -> Value {
        let runs = &self.condensed.runs[row];
        let proportion = |proportion: Proportion| match proportion.of {
            0 => Value::Null,
            _ => Value::Text(proportion.to_string()),
        };
        match column.name.as_str() {
            RUNS => Value::Text(runs_text(runs)),
            DEPLOYED => proportion(runs.deployed),
            name if name == DerivedColumn::Safe.name() => proportion(runs.safe),
            name if name == DerivedColumn::SmallestMargin.name() => match column.cells[row] {
                Value::Number(margin) => Value::Number(range::rounded(margin, MARGIN_DIGITS)),
                _ => Value::Null,
            },
            _ => self.range(column, row).unwrap_or_else(|| column.cells[row].clone()),
        }
    }

    /// A measure with its range and its mesh error; `None` for a column that has none.
    pub fn range(&self, column: &Column, row: usize) -> Option<Value> {
        self.table.column(&format!("{}{}", column.name, RANGE[0]))?;
        let Some(spread) = self.spread(&column.name, row) else { return Some(Value::Null) };
        let text = range::text(&spread, &column.shown, self.condensed.runs[row].measured.len());
        // The mesh error is that of the median.
        let error = error_column(&column.name).and_then(|name| self.spread(name, row));
        Some(Value::Text(match error {
            Some(error) => {
                let alone = range::with_error(spread.median, error.median, &column.shown);
                match (alone.split_once(PLUS_MINUS), spread.least < spread.largest) {
                    (Some((_, error)), true) => format!("{text}{PLUS_MINUS}{error}"),
                    _ => alone,
                }
            }
            None => text,
        }))
    }

    /// Statistics of a measure over the runs of a point.
    pub fn spread(&self, measure: &str, row: usize) -> Option<Spread> {
        let column = replicates::source(self.runs_table, self.runs_table.column(measure)?);
        let runs = self.condensed.runs[row].measured.iter();
        Spread::of(runs.filter_map(|row| measured(self.runs_table, column, *row)))
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
