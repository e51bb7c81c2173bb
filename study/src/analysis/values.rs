//! The values of a table's rows: as they are matched, and as measures.

use crate::accuracy::error_columns;
use crate::accuracy::promised::promise;
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
    measure.cells[row].any_number().filter(|number| !number.is_nan())
}

/// The columns with the mesh error of a measure, below and above its value.
pub fn columns_of_error<'a>(table: &'a Table, measure: &str) -> Option<[&'a Column; 2]> {
    let [below, above] = error_columns(measure)?.map(|name| table.column(name));
    Some([below?, above?])
}

/// The columns with the change of a measure over the ranges of what is assumed, below and above its value.
pub fn columns_of_assumed<'a>(table: &'a Table, measure: &str) -> Option<[&'a Column; 2]> {
    let measure = measure.strip_suffix("_extrapolated").unwrap_or(measure);
    let [below, above] = promise(measure)?.assumed_columns.map(|name| table.column(name));
    Some([below?, above?])
}

/// The mesh error in these columns at a row, below and above the value; `None` as for a measure.
pub fn error_at(table: &Table, [below, above]: [&Column; 2], row: usize) -> Option<[f64; 2]> {
    Some([measured(table, below, row)?, measured(table, above, row)?])
}
