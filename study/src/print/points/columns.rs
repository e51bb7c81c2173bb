//! The columns of a table of points, one number per column.

use super::{DEPLOYED, RANGE, RUNS, SAFE};
use crate::accuracy::is_error_column;
use crate::analysis::replicates::{Condensed, Runs, integer, proportion_columns};
use crate::input::value::Value;
use crate::job::proportion::Proportion;
use crate::job::row::{CellType, DerivedColumn, SAME_JOB_AS};
use crate::store::table::{Column, Table};

/// The position of the first column of a key, which stands after the stored columns.
pub fn keys_start(table: &Table) -> usize {
    let last = table.columns.iter().position(|column| column.name == SAME_JOB_AS);
    last.map_or(table.columns.len(), |last| last + 1)
}

/// The columns of the points.
pub fn columns(table: &Table, condensed: &Condensed) -> Vec<Column> {
    let counted = |name: &str, meaning: &str, count: fn(&Runs) -> usize| {
        let cells = condensed.runs.iter().map(|runs| integer(count(runs)));
        column(name, CellType::Integer, meaning, cells.collect())
    };
    let proportions = |name: &str, what: &str, of: fn(&Runs) -> Proportion| {
        let all: Vec<Proportion> = condensed.runs.iter().map(of).collect();
        proportion_columns(name, what, &all)
    };
    let mut new = vec![counted(RUNS, "number of runs: different jobs", |runs| runs.rows.len())];
    let parameters = condensed.table.parameters().count();
    let stored = keys_start(&condensed.table);
    let stored = (1..stored).filter(|index| condensed.table.columns[*index].name != SAME_JOB_AS);
    for index in stored {
        let median = &condensed.table.columns[index];
        let number = matches!(median.cell_type, CellType::Integer | CellType::Number);
        let with = |end: &str, source: &Table| Column {
            name: format!("{}{end}", median.name),
            ..source.columns[index].clone()
        };
        let [least, largest] = RANGE;
        match median.name.as_str() {
            name if is_error_column(name) => new.push(median.clone()),
            name if name == DerivedColumn::Safety.name() => {
                let word = |point| condensed.safety(point).map_or(Value::Null, Value::from);
                let cells = (0..condensed.runs.len()).map(word).collect();
                new.push(Column { cells, ..median.clone() });
                new.extend(proportions(SAFE, "are safe", |runs| runs.safe));
            }
            _ if index <= parameters || !number => new.push(median.clone()),
            name if name == DerivedColumn::SmallestMargin.name() => {
                new.extend([median.clone(), with(largest, &condensed.largest)]);
            }
            _ => new.extend([
                median.clone(),
                with(least, &condensed.least),
                with(largest, &condensed.largest),
            ]),
        }
        if index == parameters + 1 {
            new.push(counted("runs_done", "number of done runs", |runs| runs.done));
            let not_trusted = "number of done runs that cannot be trusted";
            new.push(counted("runs_not_trusted", not_trusted, |runs| runs.not_trusted));
            new.push(counted("runs_failed", "number of failed runs", |runs| runs.failed));
            new.push(counted("runs_pending", "number of runs to come", |runs| runs.pending));
            new.extend(proportions(DEPLOYED, "deployed", |runs| runs.deployed));
        }
    }
    // Keys that a condition or an option names: the runs of a point have one value, or none is given.
    new.extend(table.columns.iter().skip(keys_start(table)).map(|key| Column {
        cells: condensed.runs.iter().map(|runs| common(key, &runs.rows)).collect(),
        ..key.clone()
    }));
    new
}

/// The value that all these rows have.
fn common(column: &Column, rows: &[usize]) -> Value {
    let first = &column.cells[rows[0]];
    let same = rows.iter().all(|row| column.cells[*row] == *first);
    if same { first.clone() } else { Value::Null }
}

fn column(name: &str, cell_type: CellType, meaning: &str, cells: Vec<Value>) -> Column {
    Column::new(name, (cell_type, "1"), meaning, cells)
}
