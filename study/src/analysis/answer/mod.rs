//! The answer of a study, from its table: how many jobs deploy, which job is fastest, which has the
//! largest impact, how far the results can be trusted, and the effect of each parameter with all others
//! equal.

use crate::analysis::compare::{self, Sets};
use crate::analysis::statistics::Spread;
use crate::input::value::Value;
use crate::job::Status;
use crate::job::point::Point;
use crate::job::row::{ColumnId, Counts};
use crate::store::stored::Stored;
use crate::store::table::{Column, Table};

/// Measures whose medians are given: speed of the deployment, impact.
pub const MEDIANS: [ColumnId; 2] = [ColumnId::T90ZRim, ColumnId::PeakVz];
/// Values of a parameter whose effect is listed, at most. Chosen: more values need a chart.
const MAX_VALUES: usize = 6;

/// The answer of a study.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct Answer {
    /// The question, as the study file has it.
    pub question: String,
    /// Numbers of rows by how they ended.
    pub counts: Counts,
    /// The done job with the smallest `t_90_z_rim`.
    pub fastest: Option<Extreme>,
    /// The done job with the largest `peak_vz`.
    pub hardest: Option<Extreme>,
    /// The done job with the largest `peak_kinetic_energy`.
    pub most_energy: Option<Extreme>,
    /// The audit of the done jobs.
    pub trust: Option<Trust>,
    /// Largest film stress of a done job over Young's modulus: the strain for which the linear material
    /// model is used.
    pub largest_strain: f64,
    /// Effects of the parameters with two to six values.
    pub effects: Vec<Effect>,
}

/// The job with the smallest or largest value of a measure.
#[derive(Debug, Clone, PartialEq)]
pub struct Extreme {
    /// Id of the job.
    pub job: String,
    /// Its parameters.
    pub parameters: Vec<(String, Value)>,
    /// Value of the measure, SI.
    pub value: f64,
    /// Number of other jobs with the same value, up to rounding.
    pub others: usize,
}

/// The audit over all done jobs.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Trust {
    /// Number of done jobs.
    pub jobs: usize,
    /// Largest energy ledger residual.
    pub ledger_residual: f64,
    /// Largest gas balance residual.
    pub gas_residual: f64,
    /// Passages of all jobs; `None` when no model counted them.
    pub passages: Option<i64>,
    /// Largest number of intersections at a sample of each job, summed; `None` when no model counted
    /// them.
    pub intersections: Option<i64>,
    /// Number of jobs that counted passages.
    pub counted: usize,
    /// Number of jobs marked `numerically_damped`.
    pub numerically_damped: usize,
}

/// Medians by the values of one parameter. Every value has one job in each set; the jobs of a set are
/// equal in all other parameters.
#[derive(Debug, Clone, PartialEq)]
pub struct Effect {
    /// The parameter.
    pub parameter: String,
    /// Its SI unit; "1" for a dimensionless number, empty for text.
    pub unit: String,
    /// Parameters that change with it.
    pub carried: Vec<String>,
    /// Number of sets in which every value has a done job.
    pub sets: usize,
    /// Values, and the median of each of [`MEDIANS`].
    pub values: Vec<(Value, [Option<f64>; MEDIANS.len()])>,
}

impl Answer {
    /// The answer of a results folder.
    pub fn of(stored: &Stored<'_>) -> Self {
        let table = stored.table();
        let mut answer = Self::of_jobs(&table);
        answer.question.clone_from(&stored.study.question);
        answer.largest_strain = largest_strain(stored);
        answer.effects = effects(&table, &|parameter| stored.study.zipped_with(parameter));
        answer
    }

    /// The parts of the answer that need only the table.
    fn of_jobs(table: &Table) -> Self {
        let mut answer = Self::default();
        let all: Vec<usize> = (0..table.rows()).collect();
        let rows = table.one_row_per_job(&all);
        for row in &rows {
            let verdict = match table.value(ColumnId::Verdict, *row) {
                Some(Value::Text(verdict)) => verdict.as_str(),
                _ => "",
            };
            let near = table.value(ColumnId::NearThreshold, *row) == Some(&Value::Bool(true));
            if let Some(status) = table.status(*row) {
                answer.counts.add(status, verdict, near);
            }
        }
        answer.fastest = extreme(table, &rows, ColumnId::T90ZRim, |value, best| value < best);
        answer.hardest = extreme(table, &rows, ColumnId::PeakVz, |value, best| value > best);
        answer.most_energy =
            extreme(table, &rows, ColumnId::PeakKineticEnergy, |value, best| value > best);
        answer.trust = trust(table, &rows);
        answer
    }
}

/// The first done job with the best value of a measure.
fn extreme(
    table: &Table,
    rows: &[usize],
    measure: ColumnId,
    better: fn(f64, f64) -> bool,
) -> Option<Extreme> {
    let column = table.column(measure.name())?;
    let mut best: Option<(usize, f64)> = None;
    for row in rows.iter().copied() {
        let Some(value) = compare::measured(table, column, row) else { continue };
        if best.is_none_or(|(_, best)| better(value, best)) {
            best = Some((row, value));
        }
    }
    let (row, value) = best?;
    let same = |other: f64| (other - value).abs() <= compare::DEFAULT_TIE * value.abs();
    let measured = rows.iter().filter_map(|row| compare::measured(table, column, *row));
    let others = measured.filter(|other| same(*other)).count().saturating_sub(1);
    let parameters = table.parameters();
    Some(Extreme {
        job: table.column("job")?.cells[row].to_string(),
        parameters: parameters
            .map(|column| (column.name.clone(), column.cells[row].clone()))
            .collect(),
        value,
        others,
    })
}

/// Largest film stress over Young's modulus of the done jobs.
fn largest_strain(stored: &Stored<'_>) -> f64 {
    let strain = |point: &Point| {
        let cells = stored.cells(point);
        let modulus = point.job.scene.film.youngs_modulus;
        match cells.number(ColumnId::FilmStress) {
            Some(stress) if cells.status() == Status::Done => stress / modulus,
            _ => 0.0,
        }
    };
    stored.points.iter().map(strain).fold(0.0, f64::max)
}

fn trust(table: &Table, rows: &[usize]) -> Option<Trust> {
    let is_done = |row: &usize| table.status(*row) == Some(Status::Done);
    let done: Vec<usize> = rows.iter().copied().filter(is_done).collect();
    let largest = |id: ColumnId| {
        let column = table.column(id.name());
        let values = column.into_iter().flat_map(|column| {
            done.iter().filter_map(|row| compare::measured(table, column, *row))
        });
        Spread::of(values).map_or(0.0, |spread| spread.largest)
    };
    let counts = |id: ColumnId| -> Vec<i64> {
        let count = |row: &usize| match table.value(id, *row) {
            Some(Value::Integer(count)) => Some(*count),
            _ => None,
        };
        done.iter().filter_map(count).collect()
    };
    let total = |counts: &[i64]| (!counts.is_empty()).then(|| counts.iter().sum());
    let passages = counts(ColumnId::Passages);
    (!done.is_empty()).then(|| Trust {
        jobs: done.len(),
        ledger_residual: largest(ColumnId::LedgerResidual),
        gas_residual: largest(ColumnId::GasResidual),
        passages: total(&passages),
        intersections: total(&counts(ColumnId::Intersections)),
        counted: passages.len(),
        numerically_damped: done
            .iter()
            .filter(|row| {
                table.value(ColumnId::NumericallyDamped, **row) == Some(&Value::Bool(true))
            })
            .count(),
    })
}

/// Effects of the parameters with two to six values.
fn effects(table: &Table, zipped: &dyn Fn(&str) -> Vec<String>) -> Vec<Effect> {
    let rows: Vec<usize> = (0..table.rows()).collect();
    let parameters = table.parameters().filter_map(|column| {
        let values = compare::values(column, &rows);
        let few = (2..=MAX_VALUES).contains(&values.len());
        few.then(|| effect(table, column, &values, &zipped(&column.name)))
    });
    parameters.filter(|effect| effect.sets > 0).collect()
}

fn effect(table: &Table, parameter: &Column, values: &[Value], zipped: &[String]) -> Effect {
    let done: Vec<usize> =
        (0..table.rows()).filter(|row| table.status(*row) == Some(Status::Done)).collect();
    let mut sets = Sets::new(table, &done, &parameter.name, zipped);
    sets.sets.retain(|set| set.len() == values.len());
    let median = |value: &Value, measure: ColumnId| {
        let measure = table.column(measure.name())?;
        let rows =
            sets.sets.iter().flatten().filter(|row| {
                compare::canonical(&parameter.cells[**row]) == compare::canonical(value)
            });
        let numbers = rows.filter_map(|row| compare::measured(table, measure, *row));
        Spread::of(numbers).map(|spread| spread.median)
    };
    Effect {
        values: values
            .iter()
            .map(|value| (value.clone(), MEDIANS.map(|measure| median(value, measure))))
            .collect(),
        parameter: parameter.name.clone(),
        unit: parameter.unit.clone(),
        sets: sets.sets.len(),
        carried: sets.carried,
    }
}

#[cfg(test)]
mod tests;
