//! One row of the summary table: what a job was, how it ended, what it measured, what it took.

use std::sync::Arc;

use billow_solver::output::measures::Verdict;

use crate::input::value::Value;
use crate::job::executor::Outcome;
use crate::job::point::Infeasible;
use crate::job::{Job, Status};

mod columns;
mod counts;
mod derived;
mod job_end;
mod noisy;
mod without_rings;

pub use columns::{BetterSide, COLUMNS, CellType, ColumnGroup, ColumnId, RowColumn};
pub use counts::Counts;
pub use derived::{DERIVED_COLUMNS, DerivedColumn, DerivedRow};
pub use job_end::JobEnd;
pub use noisy::{HEADLINE, NOISY};

/// Name of the last column of the table, which lists the other points of a job.
pub const SAME_JOB_AS: &str = "same_job_as";
/// Meaning of that column, one line.
pub const SAME_JOB_AS_MEANING: &str =
    "other points of the study that are the same job: the parameters in which they differ";

/// The cells of one row; a copy shares them. A study has many rows, and a third of their cells are null: those take no
/// memory.
#[derive(Debug, Clone, PartialEq)]
pub struct Cells {
    status: Status,
    /// Which cells are not null: bit k is that of column k of [`COLUMNS`].
    present: u128,
    /// The cells that are not null, in the order of their columns.
    values: Arc<Vec<Value>>,
}

const _: () = assert!(COLUMNS.len() <= u128::BITS as usize, "a bit for every column");

impl Cells {
    /// A row with this status; every other cell is null.
    pub fn new(status: Status) -> Self {
        Self::with(status, [(ColumnId::Status, status.name().into())])
    }

    /// The row of a job that ended; `None` for a cancelled job, of which nothing is stored.
    /// `content_hash` is the hash of history and frames of a job that ran.
    pub fn of(job: &Job, outcome: &Outcome, content_hash: Option<&str>) -> Option<Self> {
        let end = JobEnd::new(job, outcome, content_hash)?;
        Some(Self::with(end.status, COLUMNS.iter().map(|column| (column.id, (column.take)(&end)))))
    }

    /// A row of these cells, that of the status among them; every other cell is null.
    pub fn with(status: Status, cells: impl IntoIterator<Item = (ColumnId, Value)>) -> Self {
        let values = Arc::new(Vec::with_capacity(COLUMNS.len()));
        let mut row = Self { status, present: 0, values };
        for (column, value) in cells {
            row.put(column, value);
        }
        Arc::make_mut(&mut row.values).shrink_to_fit();
        row
    }

    /// The row of a point without a fold pattern.
    pub fn infeasible(infeasible: &Infeasible) -> Self {
        let mut cells = Self::new(Status::Infeasible);
        cells.set(ColumnId::Reason, infeasible.reason.as_str());
        if !infeasible.nearest.is_empty() {
            cells.set(ColumnId::Nearest, infeasible.nearest_text());
        }
        cells
    }

    /// The value of that column.
    pub fn get(&self, column: ColumnId) -> &Value {
        const NULL: &Value = &Value::Null;
        let is_present = self.present >> column.index() & 1 == 1;
        if is_present { &self.values[self.place(column)] } else { NULL }
    }

    /// Number of cells before that column which are not null.
    fn place(&self, column: ColumnId) -> usize {
        (self.present & ((1 << column.index()) - 1)).count_ones() as usize
    }

    fn put(&mut self, column: ColumnId, value: Value) {
        let (place, bit) = (self.place(column), 1 << column.index());
        let values = Arc::make_mut(&mut self.values);
        if self.present & bit != 0 {
            values.remove(place);
            self.present &= !bit;
        }
        if value != Value::Null {
            values.insert(place, value);
            self.present |= bit;
        }
    }

    /// The number of that column; `None` for a cell without one.
    pub fn number(&self, column: ColumnId) -> Option<f64> {
        if let Value::Number(number) = self.get(column) { Some(*number) } else { None }
    }

    /// The text of that column, empty for a cell without one.
    pub fn text(&self, column: ColumnId) -> &str {
        if let Value::Text(text) = self.get(column) { text } else { "" }
    }

    /// The verdict; `None` for a row without one.
    pub fn verdict(&self) -> Option<Verdict> {
        Verdict::from_name(self.text(ColumnId::Verdict))
    }

    /// Whether the job is done and its audit found nothing: no passage, no intersection, no motion damped by
    /// the numerics.
    pub fn is_trusted(&self) -> bool {
        let none = |column| !matches!(self.get(column), Value::Integer(1..));
        self.status == Status::Done
            && none(ColumnId::Passages)
            && none(ColumnId::Intersections)
            && *self.get(ColumnId::NumericallyDamped) != Value::Bool(true)
    }

    /// Sets a cell. The status is set by [`Self::new`] alone.
    pub fn set(&mut self, column: ColumnId, value: impl Into<Value>) {
        debug_assert_ne!(column, ColumnId::Status, "Cells::new sets the status");
        self.put(column, value.into());
    }

    /// How the job ended.
    pub fn status(&self) -> Status {
        self.status
    }

    /// Columns and their values.
    pub fn iter(&self) -> impl Iterator<Item = (&'static RowColumn, &Value)> {
        COLUMNS.iter().map(|column| (column, self.get(column.id)))
    }
}

#[cfg(test)]
mod tests;
