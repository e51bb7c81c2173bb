//! How far the results of a study can be trusted.

use serde::Serialize;

use crate::accuracy::{NO_ERROR_REASON, is_of_pilots, is_unknown};
use crate::analysis::compare;
use crate::analysis::statistics::Spread;
use crate::input::value::Value;
use crate::job::Status;
use crate::job::row::ColumnId;
use crate::store::table::Table;

/// The audit over all done jobs.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Trust {
    /// Number of done jobs.
    pub jobs: usize,
    /// Largest energy ledger residual.
    pub ledger_residual: f64,
    /// Largest gas balance residual.
    pub gas_residual: f64,
    /// Passages of all jobs; `None` when no model counted them.
    pub passages: Option<i64>,
    /// Largest number of intersections at a sample of each job, summed; `None` when no model counted
    /// them.
    pub intersections: Option<i64>,
    /// Number of jobs that counted passages.
    pub counted: usize,
    /// Number of jobs marked `numerically_damped`.
    pub numerically_damped: usize,
    /// Number of jobs that cannot be trusted: damped so, or with a passage or an intersection.
    pub not_trusted: usize,
    /// Number of jobs whose mesh errors are not known.
    pub without_error: usize,
    /// Why the first of these has none.
    pub no_error_reason: Option<String>,
    /// Where the mesh errors of jobs outside the table come from, if pilots gave them.
    pub pilots: Option<String>,
}

/// The audit of the done jobs in some rows; `None` without any.
pub(super) fn trust(table: &Table, rows: &[usize]) -> Option<Trust> {
    let is_done = |row: &usize| table.status(*row) == Some(Status::Done);
    let done: Vec<usize> = rows.iter().copied().filter(is_done).collect();
    let largest = |id: ColumnId| {
        let column = table.column(id.name());
        let values = column.into_iter().flat_map(|column| {
            done.iter().filter_map(|row| compare::measured(table, column, *row))
        });
        Spread::of(values).map_or(0.0, |spread| spread.largest)
    };
    let counts = |id: ColumnId| -> Vec<i64> {
        let count = |row: &usize| match table.value(id, *row) {
            Some(Value::Integer(count)) => Some(*count),
            _ => None,
        };
        done.iter().filter_map(count).collect()
    };
    let total = |counts: &[i64]| (!counts.is_empty()).then(|| counts.iter().sum());
    let passages = counts(ColumnId::Passages);
    let reason = |row: &usize| match &table.column(NO_ERROR_REASON)?.cells[*row] {
        Value::Text(reason) => Some(reason.clone()),
        _ => None,
    };
    let (reasons, known): (Vec<String>, Vec<String>) =
        done.iter().filter_map(reason).partition(|reason| is_unknown(reason));
    (!done.is_empty()).then(|| Trust {
        jobs: done.len(),
        ledger_residual: largest(ColumnId::LedgerResidual),
        gas_residual: largest(ColumnId::GasResidual),
        passages: total(&passages),
        intersections: total(&counts(ColumnId::Intersections)),
        counted: passages.len(),
        numerically_damped: done
            .iter()
            .filter(|row| {
                table.value(ColumnId::NumericallyDamped, **row) == Some(&Value::Bool(true))
            })
            .count(),
        without_error: reasons.len(),
        no_error_reason: reasons.into_iter().next(),
        pilots: known.into_iter().find(|reason| is_of_pilots(reason)),
        not_trusted: done.iter().filter(|row| !table.is_trusted(**row)).count(),
    })
}
