//! The summary table: one row per planned point, in plan order, built from plan and journal. Points
//! that are one job stand one after the other and have the same job id.
//!
//! Columns: `job`, the parameters of the study, [`crate::job::row::COLUMNS`], the mesh errors of
//! [`crate::accuracy::PROMISED`], then [`crate::job::row::SAME_JOB_AS`]. A parameter keeps its name when a later column has the same one; the
//! later column is then called `<name>_resolved`.

use std::collections::BTreeMap;
use std::sync::Arc;

use billow_solver::output::measures::Verdict;

use crate::accuracy::AssumedRanges;
use crate::input::units::{DisplayUnit, DisplayUnits};
use crate::input::value::Value;
use crate::job::point::Point;
use crate::job::row::{COLUMNS, CellType, Cells, ColumnId};
use crate::job::{JobId, Status};
use crate::store::journal::{self, Record};

pub mod extrapolated;
mod judged;
mod mesh_errors;
pub mod parquet;
mod pilots;
pub mod reference;
pub mod same_job;
pub mod select;

use same_job::PointRow;

/// Suffix of a column whose name a parameter of the study has.
const RESOLVED: &str = "_resolved";

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
    /// Type of its cells; any cell may be null.
    pub cell_type: CellType,
    /// SI unit; "1" for a dimensionless number, empty for text or an unknown unit.
    pub unit: String,
    /// Unit in which its cells are shown; they are SI.
    pub shown: DisplayUnit,
    /// Meaning, one line.
    pub meaning: String,
    /// One value per row.
    pub cells: ColumnCells,
}

/// The cells of a column; a copy shares them. Where all of them are the same, as in a column that no job fills, one is
/// kept; those of a measure are the ones of the records.
#[derive(Debug, Clone)]
pub enum ColumnCells {
    /// This cell, and the number of rows.
    Same(Value, usize),
    /// The cell of each row.
    Each(Arc<Vec<Value>>),
    /// The cells of all rows, and the column of these.
    Of(Arc<Vec<Cells>>, ColumnId),
}

impl ColumnCells {
    /// Number of rows.
    #[expect(clippy::len_without_is_empty, reason = "no caller asks")]
    pub fn len(&self) -> usize {
        match self {
            Self::Same(_, rows) => *rows,
            Self::Each(cells) => cells.len(),
            Self::Of(rows, _) => rows.len(),
        }
    }

    /// The cells in the order of the rows.
    pub fn iter(&self) -> impl ExactSizeIterator<Item = &Value> {
        (0..self.len()).map(|row| &self[row])
    }

    /// The cells of one column in these rows.
    fn of(rows: &Arc<Vec<Cells>>, column: ColumnId) -> Self {
        Self::Of(Arc::clone(rows), column).shortened()
    }

    /// One cell, where all are the same.
    fn shortened(self) -> Self {
        // Zero and negative zero are two values.
        let same = |a: &Value, b: &Value| match (a, b) {
            (Value::Number(a), Value::Number(b)) => a.to_bits() == b.to_bits(),
            _ => a == b,
        };
        let first = self.iter().next().cloned();
        match first.filter(|first| self.iter().all(|cell| same(first, cell))) {
            Some(first) => Self::Same(first, self.len()),
            None => self,
        }
    }
}

impl From<Vec<Value>> for ColumnCells {
    fn from(cells: Vec<Value>) -> Self {
        Self::Each(Arc::new(cells)).shortened()
    }
}

impl std::ops::Index<usize> for ColumnCells {
    type Output = Value;

    fn index(&self, row: usize) -> &Value {
        match self {
            Self::Same(cell, rows) if row < *rows => cell,
            Self::Same(_, rows) => panic!("row {row} of {rows}"),
            Self::Each(cells) => &cells[row],
            Self::Of(rows, column) => rows[row].get(*column),
        }
    }
}

impl std::ops::IndexMut<usize> for ColumnCells {
    fn index_mut(&mut self, row: usize) -> &mut Value {
        if !matches!(self, Self::Each(_)) {
            *self = Self::Each(Arc::new(self.iter().cloned().collect()));
        }
        match self {
            Self::Each(cells) => &mut Arc::make_mut(cells)[row],
            Self::Same(..) | Self::Of(..) => unreachable!("every row has its cell now"),
        }
    }
}

impl FromIterator<Value> for ColumnCells {
    fn from_iter<I: IntoIterator<Item = Value>>(cells: I) -> Self {
        cells.into_iter().collect::<Vec<_>>().into()
    }
}

#[cfg(test)]
impl<T: AsRef<[Value]>> PartialEq<T> for ColumnCells {
    fn eq(&self, other: &T) -> bool {
        self.iter().eq(other.as_ref())
    }
}

impl PartialEq for ColumnCells {
    fn eq(&self, other: &Self) -> bool {
        self.iter().eq(other.iter())
    }
}

impl Column {
    /// A column, shown in SI.
    pub fn new(
        name: impl Into<String>,
        (cell_type, unit): (CellType, &str),
        meaning: impl Into<String>,
        cells: Vec<Value>,
    ) -> Self {
        let (name, meaning) = (name.into(), meaning.into());
        let (unit, shown) = (unit.to_owned(), DisplayUnit::si(unit));
        Self { name, cell_type, unit, shown, meaning, cells: cells.into() }
    }

    /// A column without unit and meaning.
    pub fn plain(name: &str, cell_type: CellType, cells: Vec<Value>) -> Self {
        Self::new(name, (cell_type, ""), "", cells)
    }

    /// A column of other cells with the type, unit and meaning of this one.
    #[must_use]
    pub fn like(&self, name: impl Into<String>, cells: Vec<Value>) -> Self {
        Self {
            name: name.into(),
            cell_type: self.cell_type,
            unit: self.unit.clone(),
            shown: self.shown.clone(),
            meaning: self.meaning.clone(),
            cells: cells.into(),
        }
    }

    /// Whether every cell is empty or zero.
    pub fn is_empty(&self) -> bool {
        self.cells.iter().all(|cell| matches!(cell, Value::Null | Value::Integer(0)))
    }
}

impl Table {
    /// A measure, or the one in its place where no row has it and film without rings has the other.
    pub fn of_any_film(&self, measure: ColumnId) -> ColumnId {
        let has = |measure: ColumnId| {
            let column = self.column(measure.name());
            column.is_some_and(|column| column.cells.iter().any(|cell| *cell != Value::Null))
        };
        let other = measure.without_rings();
        if !has(measure) && has(other) { other } else { measure }
    }

    /// Builds the table of a plan. `unit` gives the SI unit of a parameter, `assumed` the ranges of what is assumed.
    pub fn build(
        points: &[Point],
        records: &BTreeMap<JobId, Record>,
        unit: &dyn Fn(&str) -> String,
        assumed: &AssumedRanges,
    ) -> Self {
        let points = &same_job::point_rows(points);
        let ids = points.iter().map(|row| Value::Text(row.point.job.id.as_str().to_owned()));
        let meaning = "job id: hash of all that decides the result";
        let mut columns = vec![Column::new("job", (CellType::Text, ""), meaning, ids.collect())];
        columns.extend(parameter_columns(points, unit));
        let parameters: Vec<String> = columns.iter().map(|column| column.name.clone()).collect();

        let row = |row: &PointRow<'_>| journal::row_of(row.point, records);
        let rows: Arc<Vec<Cells>> = Arc::new(points.iter().map(row).collect());
        for column in COLUMNS {
            let shadowed = parameters.iter().any(|name| name == column.name);
            let name = format!("{}{}", column.name, if shadowed { RESOLVED } else { "" });
            let kind = (column.cell_type, column.unit);
            let cells = ColumnCells::of(&rows, column.id);
            columns.push(Column { cells, ..Column::new(name, kind, column.meaning, Vec::new()) });
        }
        columns.extend(mesh_errors::columns(points, &rows, assumed));
        columns.push(same_job::column(points));
        Self { columns }
    }

    /// The same table, shown in these units. Its cells stay SI.
    #[must_use]
    pub fn shown_in(mut self, units: &DisplayUnits) -> Self {
        for column in &mut self.columns {
            column.shown = units.of(&column.name, &column.unit);
        }
        self
    }

    /// Number of rows.
    pub fn rows(&self) -> usize {
        self.columns.first().map_or(0, |column| column.cells.len())
    }

    /// The column with that name.
    pub fn column(&self, name: &str) -> Option<&Column> {
        self.columns.iter().find(|column| column.name == name)
    }

    /// The value of a row in a column that every study has; `None` for a table without the column.
    pub fn value(&self, column: ColumnId, row: usize) -> Option<&Value> {
        self.columns
            .iter()
            .skip_while(|column| column.name != ColumnId::Status.name())
            .find(|stored| row_column_name(&stored.name) == column.name())
            .map(|stored| &stored.cells[row])
    }

    /// Status of a row; `None` for a text that is not a status.
    pub fn status(&self, row: usize) -> Option<Status> {
        match self.value(ColumnId::Status, row) {
            Some(Value::Text(name)) => Status::from_name(name),
            _ => None,
        }
    }

    /// Verdict of a row; `None` without one.
    pub fn verdict(&self, row: usize) -> Option<Verdict> {
        match self.value(ColumnId::Verdict, row) {
            Some(Value::Text(name)) => Verdict::from_name(name),
            _ => None,
        }
    }

    /// Whether a job is done and its audit found nothing: no passage, no intersection, no motion damped by the
    /// numerics.
    pub fn is_trusted(&self, row: usize) -> bool {
        self.status(row) == Some(Status::Done) && self.audit_mark(row).is_none()
    }

    /// The first column of the audit that speaks against a row; `None` without any.
    pub fn audit_mark(&self, row: usize) -> Option<ColumnId> {
        let speaks = |column: &ColumnId| {
            matches!(self.value(*column, row), Some(Value::Integer(1..) | Value::Bool(true)))
        };
        [ColumnId::Passages, ColumnId::Intersections, ColumnId::NumericallyDamped]
            .into_iter()
            .find(speaks)
    }

    /// The parameters of the study: the columns between `job` and `status`.
    pub fn parameters(&self) -> impl Iterator<Item = &Column> {
        let is_parameter = |column: &&Column| column.name != ColumnId::Status.name();
        self.columns.iter().skip(1).take_while(is_parameter)
    }
}

/// The name of a column without the suffix that it has when a parameter shadows it.
pub fn row_column_name(name: &str) -> &str {
    name.strip_suffix(RESOLVED).unwrap_or(name)
}

/// Every parameter of any point, in the order of first appearance.
fn parameter_columns(points: &[PointRow<'_>], unit: &dyn Fn(&str) -> String) -> Vec<Column> {
    let mut names: Vec<&str> = Vec::new();
    for (name, _) in points.iter().flat_map(|point| point.parameters.iter()) {
        if !names.contains(&name.as_str()) {
            names.push(name);
        }
    }
    let column = |name: &&str| {
        let cells: Vec<Value> = points
            .iter()
            .map(|point| {
                let found = point.parameters.iter().find(|(other, _)| other == name);
                found.map_or(Value::Null, |(_, value)| value.clone())
            })
            .collect();
        let cell_type = common_type(&cells);
        let cells = cells.into_iter().map(|cell| convert(cell_type, cell)).collect();
        Column::new(*name, (cell_type, &unit(name)), "parameter of the study", cells)
    };
    names.iter().map(column).collect()
}

/// The narrowest type that holds every cell.
fn common_type(cells: &[Value]) -> CellType {
    let types = cells.iter().filter_map(|cell| match cell {
        Value::Null => None,
        Value::Bool(_) => Some(CellType::Bool),
        Value::Integer(_) => Some(CellType::Integer),
        Value::Number(_) => Some(CellType::Number),
        Value::Text(_) => Some(CellType::Text),
    });
    types
        .reduce(|a, b| match (a, b) {
            (a, b) if a == b => a,
            (CellType::Integer | CellType::Number, CellType::Integer | CellType::Number) => {
                CellType::Number
            }
            _ => CellType::Text,
        })
        .unwrap_or(CellType::Text)
}

fn convert(cell_type: CellType, cell: Value) -> Value {
    match (cell_type, cell) {
        (_, Value::Null) => Value::Null,
        (CellType::Number, Value::Integer(value)) => Value::Number(value as f64),
        (CellType::Text, value @ (Value::Bool(_) | Value::Integer(_) | Value::Number(_))) => {
            Value::Text(value.to_string())
        }
        (_, value) => value,
    }
}

#[cfg(test)]
mod tests;
