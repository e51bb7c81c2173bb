//! The run before, beside the rows of this one. A row of it belongs to the row with the same parameters.

use std::collections::BTreeMap;

use serde_json::{Value as Json, json};

use super::table;
use crate::analysis::compare::canonical;
use crate::input::value::Value;
use crate::job::result_limit::ResultLimit;
use crate::job::row::{ColumnId, DerivedColumn};
use crate::store::table::{Column, Table};

/// What the run before had.
pub struct Before {
    /// The keys in which its study differs, with both values.
    changes: Vec<String>,
    /// Its row for each row of this run.
    rows: Vec<Option<usize>>,
    /// Its values for each row of this run.
    table: Table,
}

impl Before {
    /// The run before: `table` of this run, `now` its parameters, `before` of the other one; `names` are the parameters of
    /// both, which both tables have.
    pub fn of(
        table: &Table,
        now: &Table,
        before: &Table,
        names: &[String],
        changes: Vec<String>,
    ) -> Self {
        let place = |of: &Table, row: usize| -> Option<Vec<_>> {
            let cell = |name: &String| Some(canonical(&of.column(name)?.cells[row]));
            names.iter().map(cell).collect()
        };
        // A place that several rows have is that of none.
        let mut known: BTreeMap<_, Option<usize>> = BTreeMap::new();
        for row in 0..before.rows() {
            known.entry(place(before, row)).and_modify(|at| *at = None).or_insert(Some(row));
        }
        let rows: Vec<Option<usize>> = (0..table.rows())
            .map(|row| place(now, row).and_then(|at| known.get(&Some(at)).copied().flatten()))
            .collect();
        let column = |column: &Column| {
            let other = before.column(&column.name)?;
            let cell =
                |row: &Option<usize>| row.map_or(Value::Null, |row| other.cells[row].clone());
            Some(Column { cells: rows.iter().map(cell).collect(), ..column.clone() })
        };
        let columns = table.columns.iter().filter_map(column).collect();
        Self { changes, table: Table { columns }, rows }
    }

    /// How this run compares, in words.
    pub(super) fn lines(&self, now: &Table) -> Vec<String> {
        let cell =
            |of: &Table, name: &str, row: usize| of.column(name).map(|c| c.cells[row].clone());
        let matched: Vec<usize> =
            (0..self.rows.len()).filter(|row| self.rows[*row].is_some()).collect();
        let differ = |name: &str| {
            let other = |row: &&usize| cell(now, name, **row) != cell(&self.table, name, **row);
            matched.iter().filter(other).count()
        };
        let outcomes = [ColumnId::Status, ColumnId::Verdict].map(|id| id.column().name);
        let outcomes = outcomes.into_iter().chain([DerivedColumn::Safety.name()]);
        let known = outcomes.filter(|name| self.table.column(name).is_some());
        let changed: Vec<String> =
            known.map(|name| format!("another {name} at {}", differ(name))).collect();
        vec![
            match self.changes.as_slice() {
                [] => "this run is written in another form".to_owned(),
                changes => format!("this run has {}", changes.join(", ")),
            },
            format!(
                "{} of {} rows were in it, {} of them with the same job; {}",
                matched.len(),
                self.rows.len(),
                matched.len() - differ("job"),
                changed.join(", ")
            ),
        ]
    }

    /// The columns of its values.
    pub(super) fn columns(&self, limits: &[ResultLimit]) -> Json {
        let mut columns = table::columns(&self.table, limits);
        columns.retain(|column| column["role"] != "parameter");
        json!(columns)
    }
}
