//! What is stored of a job: its row of the table, one line per quantity, its events, its scene, its history.

use super::Inspected;
use crate::input::keys::{self, KEYS};
use crate::input::value::Value;
use crate::job::row::RowColumn;
use crate::platform::error::Result;
use crate::store::history_file::{self, StoredHistory};
use crate::store::table::Column;

impl Inspected {
    pub(super) fn history(&self) -> Result<StoredHistory> {
        history_file::read(&self.stored.history_path(&self.id)?)
    }
}

/// The columns of the row of the table that have a value, then the events; the values in the units of a reader if asked
/// for, in SI otherwise.
pub(super) fn rows(job: &Inspected, in_units: bool) -> Vec<Vec<Value>> {
    let Inspected { stored, id, cells } = job;
    // A job that is no longer in the study has no row of the table.
    let columns = stored.table_of(id).map_or_else(
        || {
            let of = |(column, value): (&RowColumn, &Value)| Column {
                unit: column.unit.to_owned(),
                shown: stored.units.of(column.name, column.unit),
                meaning: column.meaning.to_owned(),
                ..Column::plain(column.name, column.cell_type, vec![value.clone()])
            };
            cells.iter().map(of).collect()
        },
        |table| table.columns,
    );
    let row = |name: &str, value: Value, unit: &str, meaning: &str| {
        let text = |text: &str| Value::Text(text.to_owned());
        vec![text(name), value, text(unit), text(meaning)]
    };
    let columns = columns.iter().filter(|column| column.cells[0] != Value::Null);
    let columns = columns.map(|column| {
        let (value, name) = (&column.cells[0], &column.name);
        let key = keys::find(name).map_or("", |index| KEYS[index].doc);
        let meaning = if column.meaning.is_empty() { key } else { &column.meaning };
        if in_units {
            row(name, column.shown.value(value), column.shown.symbol(), meaning)
        } else {
            row(name, value.clone(), &column.unit, meaning)
        }
    });
    let mut rows: Vec<Vec<Value>> = columns.collect();
    if stored.record(id).is_none_or(|record| record.file_hash.is_none()) {
        return rows;
    }
    // The row is shown even if its file cannot be read: the error is then one of the lines.
    match job.history() {
        Ok(history) => rows.extend(history.events.iter().map(|event| {
            row(event.kind.name(), Value::Number(event.time), "s", event.kind.meaning())
        })),
        Err(error) => rows.push(row("history", Value::Text(error.to_string()), "", "")),
    }
    rows
}
