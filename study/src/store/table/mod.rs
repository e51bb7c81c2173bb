//! The summary table: one row a planned point, in plan order, rebuilt from plan and journal.
//!
//! Columns: `job`, the parameters of the study, then [`row::COLUMNS`]. A parameter that bears the
//! name of a later column keeps it; the later one is then called `<name>_resolved`.

use std::collections::BTreeMap;

use crate::input::value::Value;
use crate::job::JobId;
use crate::job::point::Point;
use crate::job::row::{self, COLUMNS, Cells, Kind};
use crate::store::journal::{self, Record};

pub mod parquet;

/// A table in memory: columns of equal length.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct Table {
    /// Columns, in stored order.
    pub columns: Vec<Column>,
}

/// A column of a table.
#[derive(Debug, Clone, PartialEq)]
pub struct Column {
    /// Name.
    pub name: String,
    /// Type of its cells; any may be null.
    pub kind: Kind,
    /// SI unit; "1" for a pure number, empty for what is none or unknown.
    pub unit: String,
    /// Meaning, one line.
    pub meaning: String,
    /// One a row.
    pub cells: Vec<Value>,
}

impl Table {
    /// Builds the table of a plan. `unit` gives the SI unit of a parameter.
    pub fn build(
        points: &[Point],
        records: &BTreeMap<JobId, Record>,
        unit: &dyn Fn(&str) -> String,
    ) -> Self {
        let mut columns = vec![Column {
            name: "job".to_owned(),
            kind: Kind::Text,
            unit: String::new(),
            meaning: "job id: hash of all that decides the result".to_owned(),
            cells: points.iter().map(|p| Value::Text(p.job.id.as_str().to_owned())).collect(),
        }];
        columns.extend(parameter_columns(points, unit));
        let parameters: Vec<String> = columns.iter().map(|column| column.name.clone()).collect();

        let row = |point: &Point| {
            journal::cells_of(point, records).unwrap_or_else(|| Cells::new(row::PENDING))
        };
        let rows: Vec<Cells> = points.iter().map(row).collect();
        for (at, column) in COLUMNS.iter().enumerate() {
            let taken = parameters.iter().any(|name| name == column.name);
            columns.push(Column {
                name: format!("{}{}", column.name, if taken { "_resolved" } else { "" }),
                kind: column.kind,
                unit: column.unit.to_owned(),
                meaning: column.meaning.to_owned(),
                cells: rows.iter().map(|row| row.at(at).clone()).collect(),
            });
        }
        Self { columns }
    }

    /// Number of rows.
    pub fn rows(&self) -> usize {
        self.columns.first().map_or(0, |column| column.cells.len())
    }

    /// The column of that name.
    pub fn column(&self, name: &str) -> Option<&Column> {
        self.columns.iter().find(|column| column.name == name)
    }

    /// Columns between `job` and `status`: what the study varies.
    pub fn parameters(&self) -> impl Iterator<Item = &Column> {
        self.columns.iter().skip(1).take_while(|column| column.name != "status")
    }
}

/// Every parameter any point has, in the order of first appearance.
fn parameter_columns(points: &[Point], unit: &dyn Fn(&str) -> String) -> Vec<Column> {
    let mut names: Vec<&str> = Vec::new();
    for (name, _) in points.iter().flat_map(|point| &point.job.parameters) {
        if !names.contains(&name.as_str()) {
            names.push(name);
        }
    }
    let column = |name: &&str| {
        let cells: Vec<Value> = points
            .iter()
            .map(|point| {
                let found = point.job.parameters.iter().find(|(other, _)| other == name);
                found.map_or(Value::Null, |(_, value)| value.clone())
            })
            .collect();
        let kind = common_kind(&cells);
        Column {
            name: (*name).to_owned(),
            kind,
            unit: unit(name),
            meaning: "parameter of the study".to_owned(),
            cells: cells.into_iter().map(|cell| widen(kind, cell)).collect(),
        }
    };
    names.iter().map(column).collect()
}

/// The narrowest type that holds every cell.
fn common_kind(cells: &[Value]) -> Kind {
    let kinds = cells.iter().filter_map(|cell| match cell {
        Value::Null => None,
        Value::Bool(_) => Some(Kind::Bool),
        Value::Integer(_) => Some(Kind::Integer),
        Value::Number(_) => Some(Kind::Number),
        Value::Text(_) => Some(Kind::Text),
    });
    kinds
        .reduce(|one, other| match (one, other) {
            (one, other) if one == other => one,
            (Kind::Integer | Kind::Number, Kind::Integer | Kind::Number) => Kind::Number,
            _ => Kind::Text,
        })
        .unwrap_or(Kind::Text)
}

fn widen(kind: Kind, cell: Value) -> Value {
    match (kind, cell) {
        (_, Value::Null) => Value::Null,
        (Kind::Number, Value::Integer(value)) => Value::Number(value as f64),
        (Kind::Text, value @ (Value::Bool(_) | Value::Integer(_) | Value::Number(_))) => {
            Value::Text(value.to_string())
        }
        (_, value) => value,
    }
}

#[cfg(test)]
mod tests;
