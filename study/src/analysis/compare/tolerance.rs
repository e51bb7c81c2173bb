//! Up to which difference two values of a measure are equal.
//!
//! ```text
//! tie:  |other − base| ≤ tolerance · max(|base|, |other|)     signed measure: |other − base| ≤ tolerance
//! points of several runs:  also if their ranges [least, largest] overlap
//! ```
//!
//! Without a given tolerance it is the mesh error of the measure, of a pair the larger one and over several rows
//! the median, or, where none is known, the spread of the method as the documents give it; for single runs the
//! largest spread over the seeds and replicates of any point, if that is larger. Points of several runs have
//! their ranges instead, so one chaotic point makes no others equal. A measure with no known spread has values
//! that are lower or higher, not better. A margin is the distance of a measure from its
//! limit over the limit: near the limit its spread is the relative spread of the measure.

use super::Sets;
use crate::analysis::replicates::Condensed;
use crate::analysis::statistics::Spread;
use crate::input::value::{Value, brief_number};
use crate::job::row::{CellType, ColumnId, DerivedColumn};
use crate::store::table::{Column, Table};
use crate::study::Zipped;

/// Largest relative difference of values that are equal up to rounding. Chosen: above rounding errors, far
/// below any effect of interest.
pub const ROUNDING: f64 = 1e-9;
/// The parameter whose values are repetitions of one job with another imperfection.
const SEED: &str = "seed";

/// Up to which difference two values of a measure are equal.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Tolerance {
    /// The limit: relative, for a signed measure absolute.
    pub limit: f64,
    /// Where it comes from.
    pub source: ToleranceSource,
    /// Whether the limit is an absolute difference.
    pub absolute: bool,
}

/// Where a tolerance comes from.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum ToleranceSource {
    /// The user gave it.
    Given,
    /// The largest spread over the runs of a point: the seeds, or the replicates, of the study.
    Seeds,
    /// No spread of the method is known; the ranges over the runs of both points decide.
    Ranges,
    /// The spread of the method, README, "Models and their limits".
    Method,
    /// The mesh error: of a pair the larger one, over several rows the median.
    MeshError,
    /// No spread is known: rounding alone.
    Unknown,
}

impl Tolerance {
    /// A relative tolerance that the user gives.
    pub fn given(limit: f64) -> Self {
        Self { limit, source: ToleranceSource::Given, absolute: false }
    }

    /// The tolerance of a measure in some rows of a table. `zipped` are the parameters on the axis of the
    /// seeds.
    pub fn of(table: &Table, rows: &[usize], measure: &Column, zipped: &[Zipped]) -> Self {
        Self::over(table, rows, measure, &[], zipped)
    }

    /// The same in a study with replicates. The rows are those of single runs.
    pub fn over(
        table: &Table,
        rows: &[usize],
        measure: &Column,
        replicates: &[String],
        zipped: &[Zipped],
    ) -> Self {
        let absolute = super::is_signed(&measure.name);
        let mut tolerance = Self { limit: ROUNDING, source: ToleranceSource::Unknown, absolute };
        let of_mesh = mesh_error(table, rows, measure);
        let method = match of_mesh {
            Some(error) => Some((error, ToleranceSource::MeshError)),
            None => spread_of_method(table, rows, &measure.name)
                .map(|limit| (limit, ToleranceSource::Method)),
        };
        let seeds = spread_of_runs(table, rows, measure, absolute, replicates, zipped)
            .map(|limit| (limit, ToleranceSource::Seeds));
        for (limit, source) in [method, seeds].into_iter().flatten() {
            if tolerance.source == ToleranceSource::Unknown || limit > tolerance.limit {
                tolerance = Self { limit: limit.max(ROUNDING), source, absolute };
            }
        }
        tolerance
    }

    /// The tolerance of the medians of points, beside their ranges.
    pub fn of_points(
        points: &Condensed,
        rows: &[usize],
        measure: &Column,
        zipped: &[Zipped],
    ) -> Self {
        let tolerance = Self::of(&points.table, rows, measure, zipped);
        let repeated = rows.iter().any(|row| points.runs[*row].measured.len() > 1);
        match tolerance.source {
            ToleranceSource::Unknown if repeated => {
                Self { source: ToleranceSource::Ranges, ..tolerance }
            }
            _ => tolerance,
        }
    }

    /// Whether two values are equal.
    pub fn is_tie(&self, a: f64, b: f64) -> bool {
        let scale = if self.absolute { 1.0 } else { a.abs().max(b.abs()) };
        // The difference of equal infinities is NaN.
        a.total_cmp(&b).is_eq() || (a - b).abs() <= self.limit * scale
    }

    /// Within what values are equal: "5 %", or an absolute difference. Mesh errors differ from pair to pair.
    pub fn text(&self) -> String {
        let limit = match self.source {
            ToleranceSource::Unknown | ToleranceSource::Ranges => "rounding".to_owned(),
            _ if self.absolute => brief_number(self.limit),
            _ => format!("{} %", brief_number(100.0 * self.limit)),
        };
        match self.source {
            ToleranceSource::MeshError => format!("their mesh errors (median {limit})"),
            _ => limit,
        }
    }

    /// Whether a difference above it is better or worse, and not only lower or higher.
    pub fn judges(&self) -> bool {
        self.source != ToleranceSource::Unknown
    }
}

/// The median of the mesh errors of a measure over some rows, relative to its values; `None` where no row has one.
fn mesh_error(table: &Table, rows: &[usize], measure: &Column) -> Option<f64> {
    let errors = super::columns_of_error(table, &measure.name)?;
    let relative = |row: &usize| {
        let value = super::measured(table, measure, *row)?;
        let [below, above] = super::error_at(table, errors, *row)?;
        Some(below.max(above) / value.abs())
    };
    let errors = rows.iter().filter_map(relative).filter(|error| error.is_finite());
    Spread::of(errors).map(|errors| errors.median)
}

/// The spread of the method for a measure, or for a margin. That of the smallest margin is the largest of the
/// measures that have it in these rows.
fn spread_of_method(table: &Table, rows: &[usize], name: &str) -> Option<f64> {
    if name != DerivedColumn::SmallestMargin.name() {
        return match name.strip_prefix("margin_") {
            Some(measure) => margin_spread(measure),
            None => ColumnId::from_name(name).and_then(method_spread),
        };
    }
    let of = table.column(DerivedColumn::SmallestMarginOf.name())?;
    let names = rows.iter().filter_map(|row| match &of.cells[*row] {
        Value::Text(measure) => Some(margin_spread(measure)),
        _ => None,
    });
    names.reduce(|a, b| Some(a?.max(b?))).flatten()
}

/// The spread of the method for the margin of a measure. A word has none.
fn margin_spread(measure: &str) -> Option<f64> {
    let id = ColumnId::from_name(measure)?;
    match id.column().cell_type {
        CellType::Bool | CellType::Text => Some(0.0),
        CellType::Integer | CellType::Number => method_spread(id),
    }
}

/// Spread of a measure by mesh, seed and numerical choices, relative. `None`: not known.
fn method_spread(measure: ColumnId) -> Option<f64> {
    // README, "Models and their limits": at n 8 against n 24, the paper's capsule; peak_vz by seed.
    match measure {
        ColumnId::T50ZRim | ColumnId::T50ZRimSinceRelease | ColumnId::PeakVz => Some(0.05),
        ColumnId::T90ZRim
        | ColumnId::T90Volume
        | ColumnId::TDeployed
        | ColumnId::T90ZRimSinceRelease
        | ColumnId::T90VolumeSinceRelease
        | ColumnId::TDeployedSinceRelease => Some(0.03),
        ColumnId::PeakKineticEnergy => Some(0.02),
        ColumnId::VolumeRatio | ColumnId::HeightRatio => Some(0.01),
        ColumnId::FilmStress99 => Some(0.25),
        ColumnId::FilmStress => Some(0.4),
        _ => None,
    }
}

/// The largest spread of a measure over the seeds and the replicates, all other parameters being equal; `None`
/// unless a set has two runs.
fn spread_of_runs(
    table: &Table,
    rows: &[usize],
    measure: &Column,
    absolute: bool,
    replicates: &[String],
    zipped: &[Zipped],
) -> Option<f64> {
    let varies = |name: &str| table.parameters().any(|column| column.name == name);
    let first = if varies(SEED) {
        SEED
    } else {
        replicates.iter().map(String::as_str).find(|name| varies(name))?
    };
    let measured = |row: &usize| super::measured(table, measure, *row);
    let rows: Vec<usize> = rows.iter().copied().filter(|row| measured(row).is_some()).collect();
    let sets = Sets::with_free(table, &rows, first, replicates, zipped).sets;
    let spreads = sets.iter().filter(|set| set.len() > 1).filter_map(|set| {
        let spread = Spread::of(set.iter().filter_map(measured))?;
        let width = spread.largest - spread.least;
        let scale = spread.largest.abs().max(spread.least.abs());
        Some(if absolute || scale == 0.0 { width } else { width / scale })
    });
    spreads.reduce(f64::max)
}
