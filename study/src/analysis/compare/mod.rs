//! Comparison: the effect of one parameter with all others equal.
//!
//! Rows that are equal in all other parameters form a set. In a set, the row with the base value and
//! each row with another value form a pair. Parameters are matched by their canonical text (the
//! shortest digits that read back as the number), never by nearly equal floats. A parameter on the
//! same axis as the compared one that is a function of it changes with it, so it is not matched
//! (example: a strategy with its residual gas).
//!
//! ```text
//! difference = other − base        ratio = other / base, unless the measure is signed
//! ```
//!
//! Only done jobs have measures, and only when the measured event happened. A pair of which only one
//! side has the measure is an outcome (`only_base`, `only_other`) and is never ignored. A pair with a
//! pending job is `pending` and does not count, nor does a pair of two points that are one job.

use std::collections::BTreeSet;

use super::replicates::Condensed;
use super::statistics::Spread;
use crate::input::value::Value;
use crate::job::Status;
use crate::job::row::{BetterSide, COLUMNS, CellType, ColumnId, DerivedColumn};
use crate::store::table::{Column, Table};
use crate::study::Zipped;

mod comparison;
mod sets;
mod tally;
mod tolerance;

pub use super::values::{canonical, columns_of_assumed, columns_of_error, error_at, measured};
pub use comparison::Comparison;
pub use sets::{Pair, Set, Sets, block, pairs};
pub use tally::{Tally, pairs_of_jobs, tallies};
pub use tolerance::{ROUNDING, Tolerance, ToleranceSource};

/// Names of the measures of which that side is better, in the order of the table.
pub fn measures_with(side: BetterSide) -> Vec<&'static str> {
    COLUMNS.iter().filter(|column| column.better == side).map(|column| column.name).collect()
}

/// Whether a column holds margins of limits.
pub fn is_margin(name: &str) -> bool {
    name == DerivedColumn::SmallestMargin.name() || name.starts_with("margin_")
}

/// Whether a measure can be negative or zero, so that a ratio of two values means nothing.
pub fn is_signed(measure: &str) -> bool {
    is_margin(measure) || ColumnId::from_name(measure).is_some_and(ColumnId::is_signed)
}

/// Which side of a measure is better. A larger margin is.
fn better_side(measure: &str) -> BetterSide {
    if is_margin(measure) {
        return BetterSide::Larger;
    }
    ColumnId::from_name(measure).map_or(BetterSide::Neither, |id| id.column().better)
}

/// Different values of a column in some rows, in the order of first appearance.
pub fn values(column: &Column, rows: &[usize]) -> Vec<Value> {
    let mut known = BTreeSet::new();
    let cells = rows.iter().map(|row| &column.cells[*row]);
    cells.filter(|value| known.insert(canonical(value))).cloned().collect()
}

/// Which job of a pair is better in a measure.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Better {
    /// The job with the base value.
    Base,
    /// The job with the other value.
    Other,
    /// Equal up to the tie.
    Tie,
    /// Only the job with the base value has the measure.
    OnlyBase,
    /// Only the job with the other value has the measure.
    OnlyOther,
    /// Neither job has the measure.
    Neither,
    /// A job has not ended yet.
    Pending,
    /// Both points are one job.
    SameJob,
    /// The other value is lower, and it is not known or not defined whether that is better.
    Lower,
    /// The other value is higher, and it is not known or not defined whether that is better.
    Higher,
}

impl Better {
    /// Name, as in the column `better`.
    pub fn name(self) -> &'static str {
        match self {
            Self::Base => "base",
            Self::Other => "other",
            Self::Tie => "tie",
            Self::OnlyBase => "only_base",
            Self::OnlyOther => "only_other",
            Self::Neither => "neither",
            Self::Pending => "pending",
            Self::SameJob => "same_job",
            Self::Lower => "lower",
            Self::Higher => "higher",
        }
    }

    /// The result with base and other exchanged.
    #[must_use]
    fn exchanged(self) -> Self {
        match self {
            Self::Base => Self::Other,
            Self::Other => Self::Base,
            Self::OnlyBase => Self::OnlyOther,
            Self::OnlyOther => Self::OnlyBase,
            Self::Lower => Self::Higher,
            Self::Higher => Self::Lower,
            same => same,
        }
    }
}

/// A measure to compare, and up to which difference its values are equal.
#[derive(Debug, Clone, Copy)]
pub struct Measure<'a> {
    /// Its column.
    pub column: &'a Column,
    /// Its tolerance.
    pub tolerance: Tolerance,
    /// The smallest and the largest values over the runs of each point; `None` for single runs.
    pub ranges: Option<[&'a Column; 2]>,
    /// Its mesh errors, below and above its values, where they decide what is equal.
    pub errors: Option<[&'a Column; 2]>,
}

/// Least, median and largest value over the runs of a point; of a single run its value.
pub type Range = [f64; 3];

/// The median of each end, and of the medians, of some ranges.
pub fn median_range(ranges: &[Range]) -> Option<Range> {
    let median = |end: usize| Spread::of(ranges.iter().map(|range| range[end]));
    Some([median(0)?.median, median(1)?.median, median(2)?.median])
}

impl<'a> Measure<'a> {
    /// A measure of single runs.
    pub fn of_runs(column: &'a Column, tolerance: Tolerance) -> Self {
        Self { column, tolerance, ranges: None, errors: None }
    }

    /// The same with the mesh errors of a table, if the tolerance is that of the mesh error.
    #[must_use]
    pub fn with_errors(self, table: &'a Table) -> Self {
        let errors = columns_of_error(table, &self.column.name);
        let decide = self.tolerance.source == ToleranceSource::MeshError;
        Self { errors: errors.filter(|_| decide), ..self }
    }

    /// A measure of points: a column of their medians. `zipped` are the parameters on the axis of the seeds.
    pub fn of_points(
        points: &'a Condensed,
        rows: &[usize],
        column: &'a Column,
        zipped: &[Zipped],
    ) -> Self {
        let tolerance = Tolerance::of_points(points, rows, column, zipped);
        let end = |table: &'a Table| table.column(&column.name);
        let ranges = end(&points.least).zip(end(&points.largest));
        let ranges = ranges.map(|(least, largest)| [least, largest]);
        Self { column, tolerance, ranges, errors: None }.with_errors(&points.table)
    }

    /// The value at a row, with its range.
    pub fn range(&self, table: &Table, row: usize) -> Option<Range> {
        let value = measured(table, self.column, row)?;
        let end = |column: &Column| measured(table, column, row).unwrap_or(value);
        Some(self.ranges.map_or([value; 3], |[least, largest]| [end(least), value, end(largest)]))
    }

    /// Whether the mesh errors of both values of a pair decide whether they are equal.
    pub fn has_errors(&self) -> bool {
        self.errors.is_some()
    }

    /// Whether two values are equal: within the tolerance, or because their ranges overlap.
    pub fn are_equal(&self, a: Range, b: Range) -> bool {
        self.tolerance.is_tie(a[1], b[1]) || (a[0] <= b[2] && b[0] <= a[2])
    }

    /// Whether the values of two rows are within their mesh errors, or their ranges overlap; `None` where an error is not
    /// known.
    fn equal_by_errors(&self, table: &Table, pair: Pair, a: Range, b: Range) -> Option<bool> {
        let error = |row: usize| error_at(table, self.errors?, row);
        let overlap = a[0] <= b[2] && b[0] <= a[2];
        Some(within_errors([a[1], b[1]], [error(pair.base)?, error(pair.other)?]) || overlap)
    }

    /// Which of two values is better; neither while no spread is known.
    pub fn side(&self) -> BetterSide {
        if self.tolerance.judges() { better_side(&self.column.name) } else { BetterSide::Neither }
    }

    /// Whether the measure can be negative or zero, so that a ratio of two values means nothing.
    pub fn is_signed(&self) -> bool {
        is_signed(&self.column.name)
    }
}

/// Whether two values differ by no more than the larger of their mesh errors towards each other: each has one below and
/// one above it.
pub fn within_errors([a, b]: [f64; 2], [of_a, of_b]: [[f64; 2]; 2]) -> bool {
    let [lower, upper] = if a < b { [of_a, of_b] } else { [of_b, of_a] };
    (a - b).abs() <= lower[1].max(upper[0])
}

/// One measure of a pair.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Compared {
    /// Value of the job with the base value.
    pub base: Option<f64>,
    /// Value of the job with the other value.
    pub other: Option<f64>,
    /// Which job is better.
    pub better: Better,
    /// Whether the measure is signed.
    signed: bool,
}

impl Compared {
    /// Other minus base.
    pub fn difference(&self) -> Option<f64> {
        Some(self.other? - self.base?)
    }

    /// Other over base; `None` for a base of zero and for a signed measure.
    pub fn ratio(&self) -> Option<f64> {
        let base = self.base.filter(|base| *base != 0.0 && !self.signed)?;
        Some(self.other? / base)
    }
}

/// Compares one measure of a pair.
pub fn compared(table: &Table, pair: Pair, measure: &Measure<'_>) -> Compared {
    let [base, other] = [pair.base, pair.other].map(|row| measure.range(table, row));
    let has = |row: usize, status| table.status(row) == Some(status);
    let pending = [pair.base, pair.other].iter().any(|row| has(*row, Status::Pending));
    let better = match (base, other) {
        _ if same_job(table, pair) => Better::SameJob,
        _ if pending => Better::Pending,
        (None, None) => Better::Neither,
        (Some(_), None) => Better::OnlyBase,
        (None, Some(_)) => Better::OnlyOther,
        (Some(base), Some(other)) => match measure.equal_by_errors(table, pair, base, other) {
            Some(true) => Better::Tie,
            Some(false) => better_of(measure, base, other),
            None => judge(measure, base, other),
        },
    };
    let [base, other] = [base, other].map(|side| side.map(|range| range[1]));
    Compared { base, other, better, signed: measure.is_signed() }
}

/// Whether both points of a pair are one job. Infeasible points have none.
fn same_job(table: &Table, pair: Pair) -> bool {
    let infeasible = table.status(pair.base) == Some(Status::Infeasible);
    table
        .column("job")
        .is_some_and(|job| job.cells[pair.base] == job.cells[pair.other] && !infeasible)
}

fn judge(measure: &Measure<'_>, base: Range, other: Range) -> Better {
    if measure.are_equal(base, other) { Better::Tie } else { better_of(measure, base, other) }
}

/// Which of two different values is better.
fn better_of(measure: &Measure<'_>, base: Range, other: Range) -> Better {
    let base_is_smaller = base[1] < other[1];
    let smaller = if base_is_smaller { Better::Base } else { Better::Other };
    match measure.side() {
        BetterSide::Smaller => smaller,
        BetterSide::Larger => smaller.exchanged(),
        BetterSide::Neither if base_is_smaller => Better::Higher,
        BetterSide::Neither => Better::Lower,
    }
}

/// Whether a column can be compared as a measure.
pub fn is_measure(column: &Column) -> bool {
    matches!(column.cell_type, CellType::Number | CellType::Integer)
}

#[cfg(test)]
mod tests;
#[cfg(test)]
mod tolerance_tests;
