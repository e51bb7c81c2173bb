//! The values of a table's rows: as they are matched, and as measures.

use crate::input::value::Value;
use crate::job::Status;
use crate::store::table::{Column, Table};

/// The text by which values are matched: numbers in shortest digits (8 = 8.0, −0 = 0), texts in
/// quotes.
pub fn canonical(value: &Value) -> String {
    match value {
        Value::Number(number) => format!("{}", number + 0.0),
        Value::Text(text) => format!("{text:?}"),
        other => other.to_string(),
    }
}

/// A measure of a row; `None` unless its job is done and has the measure.
pub fn measured(table: &Table, measure: &Column, row: usize) -> Option<f64> {
    if table.status(row) != Some(Status::Done) {
        return None;
    }
    match measure.cells[row] {
        Value::Number(number) if !number.is_nan() => Some(number),
        Value::Integer(number) => Some(number as f64),
        _ => None,
    }
}
