//! Tables and limits of tests.

use crate::accuracy::{NO_ERROR_REASON, error_columns};
use crate::input::value::Value;
use crate::job::result_limit::{Condition, ResultLimit};
use crate::job::row::{CellType, ColumnId};
use crate::store::table::{Column, Table};

/// A table as a test writes it: names, then one line per row; `-` is an empty cell. The cells give the type of a column;
/// jobs are words.
pub fn table(text: &str) -> Table {
    let mut lines = text.lines().map(str::trim).filter(|line| !line.is_empty());
    let names = lines.next().unwrap_or_default().split_whitespace();
    let rows: Vec<Vec<&str>> = lines.map(|line| line.split_whitespace().collect()).collect();
    let column = |(index, name): (usize, &str)| {
        let cells: Vec<&str> = rows.iter().map(|row| row[index]).collect();
        let all = |is: &dyn Fn(&str) -> bool| cells.iter().all(|cell| *cell == "-" || is(cell));
        let cell_type = if name == "job" {
            CellType::Text
        } else if all(&|cell| cell.parse::<bool>().is_ok()) {
            CellType::Bool
        } else if all(&|cell| cell.parse::<i64>().is_ok()) {
            CellType::Integer
        } else if all(&|cell| cell.parse::<f64>().is_ok()) {
            CellType::Number
        } else {
            CellType::Text
        };
        let cell = |cell: &&str| match cell_type {
            _ if *cell == "-" => Value::Null,
            CellType::Bool => Value::Bool(*cell == "true"),
            CellType::Integer => Value::Integer(cell.parse().unwrap()),
            CellType::Number => Value::Number(cell.parse().unwrap()),
            CellType::Text => Value::Text((*cell).to_owned()),
        };
        Column::plain(name, cell_type, cells.iter().map(cell).collect())
    };
    Table { columns: names.enumerate().map(column).collect() }
}

/// The same of lines that a test computes.
pub fn table_of(names: &str, rows: impl Iterator<Item = String>) -> Table {
    let rows: Vec<String> = rows.collect();
    table(&format!("{names}\n{}", rows.join("\n")))
}

/// The rows of a table.
pub fn all(table: &Table) -> Vec<usize> {
    (0..table.rows()).collect()
}

/// The limits `peak_vz` below a speed, and deployed.
pub fn limits(speed: f64) -> Vec<ResultLimit> {
    let bound = Condition::Bound { bound: speed, above: false, or_equal: false };
    let word = Condition::Is(Value::Text("deployed".to_owned()));
    let limit = |measure, condition, text| ResultLimit { measure, condition, text };
    let (below, deployed) = (format!("< {speed} m/s"), "deployed".to_owned());
    vec![limit(ColumnId::PeakVz, bound, below), limit(ColumnId::Verdict, word, deployed)]
}

/// The table with this mesh error of a measure in every row, and no reason why others have none.
pub fn with_error(mut table: Table, measure: &str, error: f64) -> Table {
    let names = error_columns(measure).unwrap();
    let rows = table.rows();
    let others = |name: &str| !names.contains(&name) && name != NO_ERROR_REASON;
    table.columns.retain(|column| others(&column.name));
    let column = |name| Column::plain(name, CellType::Number, vec![Value::Number(error); rows]);
    table.columns.extend(names.map(column));
    table
}
