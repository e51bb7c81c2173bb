//! Up to which difference two values of a measure are equal.
//!
//! ```text
//! tie:  |other − base| ≤ tolerance · max(|base|, |other|)     signed measure: |other − base| ≤ tolerance
//! ```
//!
//! Without a given tolerance it is the larger of two spreads: that over the seeds of the study, and that
//! of the method as the documents give it. A measure with neither has no known spread: its values are
//! lower or higher, not better.

use super::Sets;
use crate::analysis::statistics::Spread;
use crate::job::row::ColumnId;
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
    /// The largest spread over the seeds of the study.
    Seeds,
    /// The spread of the method, README, "Models and their limits".
    Method,
    /// No spread is known: rounding alone.
    Unknown,
}

impl Tolerance {
    /// A relative tolerance that the user gives.
    pub fn given(limit: f64) -> Self {
        Self { limit, source: ToleranceSource::Given, absolute: false }
    }

    /// The tolerance of a measure in some rows of a table.
    pub fn of(table: &Table, rows: &[usize], measure: &Column, zipped: &[Zipped]) -> Self {
        let id = ColumnId::from_name(&measure.name);
        let absolute = id.is_some_and(ColumnId::is_signed);
        let mut tolerance = Self { limit: ROUNDING, source: ToleranceSource::Unknown, absolute };
        let method = id.and_then(method_spread).map(|limit| (limit, ToleranceSource::Method));
        let seeds = seed_spread(table, rows, measure, absolute, zipped)
            .map(|limit| (limit, ToleranceSource::Seeds));
        for (limit, source) in [method, seeds].into_iter().flatten() {
            if tolerance.source == ToleranceSource::Unknown || limit > tolerance.limit {
                tolerance = Self { limit: limit.max(ROUNDING), source, absolute };
            }
        }
        tolerance
    }

    /// Whether two values are equal.
    pub fn is_tie(&self, a: f64, b: f64) -> bool {
        let scale = if self.absolute { 1.0 } else { a.abs().max(b.abs()) };
        // The difference of equal infinities is NaN.
        a.total_cmp(&b).is_eq() || (a - b).abs() <= self.limit * scale
    }

    /// Whether a difference above it is better or worse, and not only lower or higher.
    pub fn judges(&self) -> bool {
        self.source != ToleranceSource::Unknown
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

/// The largest spread of a measure over the seeds, all other parameters being equal; `None` unless a set
/// has two seeds.
fn seed_spread(
    table: &Table,
    rows: &[usize],
    measure: &Column,
    absolute: bool,
    zipped: &[Zipped],
) -> Option<f64> {
    table.parameters().find(|column| column.name == SEED)?;
    let measured = |row: &usize| super::measured(table, measure, *row);
    let rows: Vec<usize> = rows.iter().copied().filter(|row| measured(row).is_some()).collect();
    let sets = Sets::new(table, &rows, SEED, zipped).sets;
    let spreads = sets.iter().filter(|set| set.len() > 1).filter_map(|set| {
        let spread = Spread::of(set.iter().filter_map(measured))?;
        let width = spread.largest - spread.least;
        let scale = spread.largest.abs().max(spread.least.abs());
        Some(if absolute || scale == 0.0 { width } else { width / scale })
    });
    spreads.reduce(f64::max)
}
