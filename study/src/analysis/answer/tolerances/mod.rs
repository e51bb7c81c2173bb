//! What samples of inputs say of each point: how probable it is that it is safe, how its measures spread, and what makes
//! the spread.
//!
//! ```text
//! P(safe)       from the lower end of the Wilson interval of the runs that are safe to the upper end of that of the runs
//!               that are not unsafe: a run within its uncertainty, or without a result, may be either. Its n is the number
//!               of samples, also where replicates repeat them
//! spread²       = s² of the samples + s² within a sample + (mesh error/1.96)² + (assumed/1.96)²
//!                 s² of the samples: that of the means of their r runs, less s² within/r
//! ```
//!
//! Quantiles are in `quantile.rs`, what each input makes in `importance.rs`.

use std::collections::BTreeMap;

use serde::Serialize;

use super::{bounds, parameters, parameters_of};
use crate::analysis::compare;
use crate::analysis::replicates::{Condensed, finest, point_key, rows_of_points, source};
use crate::analysis::values::measured;
use crate::input::units::DisplayUnit;
use crate::input::value::Value;
use crate::job::Status;
use crate::job::proportion::{Proportion, Z};
use crate::job::result_limit::{ResultLimit, Safety};
use crate::job::row::{ColumnId, HEADLINE};
use crate::store::table::{Column, Table};

mod importance;
mod parts;
mod quantile;

pub use importance::{Importance, MIN_SEEN, samples_needed};
pub use parts::Part;
pub use quantile::Quantile;

/// Quantiles in the answer.
const QUANTILES: [f64; 3] = [0.05, 0.5, 0.95];
/// What makes a standard deviation beside one another: the samples, replicates, the mesh, what is assumed.
const SAMPLES: &str = "samples";
const REPLICATES: &str = "replicates";
/// The part of the mesh, for what is to be done about it.
pub const MESH: &str = "mesh error";
const ASSUMED: &str = "assumed values";

/// What samples say of a point.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Tolerance {
    /// Its parameters, and the units in which they are shown.
    #[serde(serialize_with = "parameters")]
    pub parameters: Vec<(String, Value, DisplayUnit)>,
    /// Number of runs that have ended.
    pub runs: usize,
    /// Number of different samples among them.
    pub samples: usize,
    /// Number of these runs without a result that the limits can judge: they failed, or no fold pattern fits.
    pub without_result: usize,
    /// Of all these runs, those that are safe; none without limits.
    pub safe: Proportion,
    /// The probability that a run is safe: an interval, 95 %.
    pub safe_between: [f64; 2],
    /// Number of runs that are unsafe; the others are within their uncertainty, or have no result.
    pub not_safe: usize,
    /// Number of runs whose values keep every limit, whatever their uncertainty.
    pub kept: usize,
    /// The run with the smallest margin: its job, the margin, the measure.
    pub nearest: Option<(String, f64, String)>,
    /// The measures that have a limit, or the main ones.
    pub measures: Vec<Spread>,
}

/// How a measure spreads over the samples of a point.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Spread {
    /// The measure.
    pub measure: String,
    /// Unit in which it is shown.
    #[serde(skip)]
    pub shown: DisplayUnit,
    /// Its quantiles, SI.
    pub quantiles: Vec<Quantile>,
    /// Standard deviation of all that is known together, SI.
    pub deviation: f64,
    /// What makes it, the largest first, as parts of its square: the samples, replicates, mesh error, assumed values.
    pub budget: Vec<Part>,
    /// Which input makes the spread of the samples.
    pub inputs: Importance,
    /// What is not known, and why.
    pub without: Vec<String>,
}

impl Tolerance {
    /// What samples say of every point; none without samples. `sampled` are the inputs, and whether they are independent.
    pub fn all(
        table: &Table,
        limits: &[ResultLimit],
        replicates: &[String],
        (sampled, independent): (&[String], bool),
    ) -> Vec<Self> {
        if sampled.is_empty() {
            return Vec::new();
        }
        let rows: Vec<usize> = (0..table.rows()).collect();
        // A sample is a row, also where it shares its job.
        let all = rows_of_points(table, &rows, replicates);
        let points = Condensed::of(table, &rows, replicates);
        let measures = measures(table, limits);
        let inputs: Vec<&Column> =
            table.parameters().filter(|column| sampled.contains(&column.name)).collect();
        let of = |point: usize| {
            let (nearest, parameters) =
                (points.runs[point].worst_margin(table), parameters_of(&points.table, point));
            let inputs = (inputs.as_slice(), independent);
            Self::of(table, (&all[point], nearest), parameters, (limits, &measures), inputs)
        };
        points.feasible().map(of).collect()
    }

    /// What the samples of one point say, in these rows; the smallest margin with its measure and row.
    fn of(
        table: &Table,
        (rows, nearest): (&[usize], Option<(f64, String, usize)>),
        parameters: Vec<(String, Value, DisplayUnit)>,
        (limits, measures): (&[ResultLimit], &[ColumnId]),
        inputs: (&[&Column], bool),
    ) -> Self {
        let mut ended = finest(table, rows);
        ended.retain(|row| table.status(*row) != Some(Status::Pending));
        let count = |wanted| ended.iter().filter(|row| table.safety(**row) == Some(wanted)).count();
        let [safe, uncertain, not_safe] = Safety::ALL.map(count);
        let of = if limits.is_empty() { 0 } else { ended.len() };
        let kept = |row: &&usize| {
            let met = |limit| table.judge(limit, **row).is_some_and(|judged| judged.met);
            limits.iter().all(met)
        };
        let samples = of_samples(inputs.0, &ended).len();
        let met = |met: usize| Proportion { met, of };
        let done = |row: &usize| table.status(*row) == Some(Status::Done);
        let done: Vec<usize> = ended.iter().copied().filter(done).collect();
        let measured = believed(table, &done);
        let spread = |measure: &ColumnId| {
            Spread::of(
                table,
                table.column(measure.name())?,
                measured.as_deref().unwrap_or(&done),
                inputs,
            )
        };
        let with_result = if limits.is_empty() { done.len() } else { safe + uncertain + not_safe };
        let possible = met(of.saturating_sub(not_safe)).wilson_of(samples);
        let job = |row: usize| table.column("job").map(|jobs| jobs.cells[row].to_string());
        Self {
            parameters,
            runs: ended.len(),
            samples,
            without_result: ended.len() - with_result,
            safe: met(safe),
            safe_between: [met(safe).wilson_of(samples)[0], possible[1]],
            not_safe,
            kept: ended.iter().filter(kept).count(),
            nearest: nearest.and_then(|(margin, name, row)| Some((job(row)?, margin, name))),
            measures: measures.iter().filter_map(spread).collect(),
        }
    }
}

/// Which parameter makes the spread of each measure over all points of a grid; none of a study with samples, and where too
/// few points or parameters vary.
pub fn of_grid(
    table: &Table,
    limits: &[ResultLimit],
    replicates: &[String],
) -> Vec<(String, Importance)> {
    let rows: Vec<usize> = (0..table.rows()).collect();
    let varied = table.parameters().filter(|column| !replicates.contains(&column.name));
    let inputs: Vec<&Column> =
        varied.filter(|column| compare::values(column, &rows).len() > 1).collect();
    if inputs.len() < 2 {
        return Vec::new();
    }
    let points = rows_of_points(table, &rows, replicates);
    let done: Vec<usize> = points
        .iter()
        .flat_map(|rows| finest(table, rows))
        .filter(|row| table.status(*row) == Some(Status::Done))
        .collect();
    let rows = believed(table, &done).unwrap_or(done);
    let of = |measure: ColumnId| {
        let spread = Spread::of(table, table.column(measure.name())?, &rows, (&inputs, true))?;
        (!spread.inputs.parts.is_empty()).then_some((spread.measure, spread.inputs))
    };
    measures(table, limits).into_iter().filter_map(of).collect()
}

/// Of these rows those that can be trusted; `None` where none can.
fn believed(table: &Table, rows: &[usize]) -> Option<Vec<usize>> {
    let trusted: Vec<usize> = rows.iter().copied().filter(|row| table.is_trusted(*row)).collect();
    (!trusted.is_empty()).then_some(trusted)
}

/// The runs of each sample among these rows.
fn of_samples(inputs: &[&Column], rows: &[usize]) -> BTreeMap<Vec<String>, Vec<usize>> {
    let mut samples: BTreeMap<Vec<String>, Vec<usize>> = BTreeMap::new();
    for row in rows {
        samples.entry(point_key(inputs, *row)).or_default().push(*row);
    }
    samples
}

/// The measures that have a limit; without one, how soon and how hard.
fn measures(table: &Table, limits: &[ResultLimit]) -> Vec<ColumnId> {
    let mut limited: Vec<ColumnId> = Vec::new();
    for (measure, _) in bounds(limits) {
        if !limited.contains(&measure) {
            limited.push(measure);
        }
    }
    if limited.is_empty() {
        let [soon, hard] =
            [HEADLINE[0], ColumnId::PeakVz].map(|measure| table.of_any_film(measure));
        limited = vec![soon, hard, ColumnId::PeakKineticEnergy];
    }
    limited
}

impl Spread {
    /// The spread of a measure over these rows; `None` without two values.
    fn of(
        table: &Table,
        column: &Column,
        rows: &[usize],
        (inputs, independent): (&[&Column], bool),
    ) -> Option<Self> {
        let values_of = source(table, column);
        let value = |row: &usize| measured(table, values_of, *row);
        let with_value: Vec<usize> =
            rows.iter().copied().filter(|row| value(row).is_some()).collect();
        let samples = of_samples(inputs, &with_value);
        let (mut values, mut means) = (Vec::new(), Vec::new());
        let (mut within, mut of_means) = (0.0, 0.0);
        for rows in samples.values() {
            let of_sample: Vec<f64> = rows.iter().filter_map(value).collect();
            let (mean, variance) = moments(&of_sample);
            means.push(mean);
            within += variance / samples.len() as f64;
            of_means += variance / (rows.len() * samples.len()) as f64;
            values.extend(of_sample);
        }
        if values.len() < 2 {
            return None;
        }
        values.sort_by(f64::total_cmp);
        let quantiles = QUANTILES.map(|p| Quantile::of(&values, p, samples.len()));
        let first: Vec<usize> = samples.values().map(|rows| rows[0]).collect();
        let between = (moments(&means).1 - of_means).max(0.0);
        let mut without = Vec::new();
        let mut variances = vec![(SAMPLES, between), (REPLICATES, within)];
        let id = ColumnId::from_name(&column.name);
        let half = |which: usize| -> Option<f64> {
            let sides = with_value.iter().map(|row| table.error_parts(id?, *row)[which]);
            let halves: Option<Vec<f64>> =
                sides.map(|sides| sides.map(|[a, b]| 0.5 * (a + b) / Z)).collect();
            halves.map(|halves| moments(&halves).0)
        };
        for (which, name) in [MESH, ASSUMED].into_iter().enumerate() {
            match half(which) {
                Some(deviation) => variances.push((name, deviation * deviation)),
                None => without.push(format!("{name}: not known")),
            }
        }
        let all: f64 = variances.iter().map(|(_, variance)| variance).sum();
        let part = |(name, variance): (&str, f64)| Part::new(name, variance / all);
        let budget = variances.into_iter().filter(|(_, variance)| *variance > 0.0).map(part);
        let inputs = Importance::of(inputs, &first, &means, independent);
        let inputs = inputs.unwrap_or_else(|problem| {
            without.push(problem);
            Importance::default()
        });
        Some(Self {
            measure: column.name.clone(),
            shown: column.shown.clone(),
            quantiles: quantiles.to_vec(),
            deviation: libm::sqrt(all),
            budget: parts::largest_first(budget.collect()),
            inputs,
            without,
        })
    }
}

/// Mean, and variance of a sample (0 for one value).
fn moments(values: &[f64]) -> (f64, f64) {
    let n = values.len() as f64;
    let mean = values.iter().sum::<f64>() / n;
    let squares: f64 = values.iter().map(|value| (value - mean) * (value - mean)).sum();
    (mean, if values.len() > 1 { squares / (n - 1.0) } else { 0.0 })
}

#[cfg(test)]
mod tests;
