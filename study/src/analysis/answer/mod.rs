//! The answer of a study, from its table: how many jobs deploy, which points are safe, which job is fastest,
//! which has the largest impact, how far the results can be trusted, which value of each parameter is better with all
//! others equal, and where the borders of a search are.

use std::collections::BTreeSet;

use billow_solver::output::measures::Verdict;
use serde::{Serialize, Serializer};

use crate::analysis::compare;
use crate::analysis::ranking::{Ranking, RankingInput, default_measures};
use crate::analysis::replicates::{Condensed, fixed, point_key, source};
use crate::input::units::DisplayUnit;
use crate::input::value::{Value, json_value};
use crate::job::Status;
use crate::job::point::Point;
use crate::job::result_limit::{Condition, ResultLimit};
use crate::job::row::{ColumnId, Counts, HEADLINE};
use crate::store::stored::Stored;
use crate::store::table::{Column, Table};
use crate::study::assumptions::assumptions;
use crate::study::{Study, Zipped};

mod inflow;
mod optimum;
mod points;
mod safety;
mod searches;
mod tolerances;
mod trust;

pub use optimum::{Best, Optimum, Small, Tried};
pub use points::{MixedPoint, PointCounts, VerdictSensitivity};
pub use safety::{Nearest, SafeCounts, Safety};
pub use searches::{Found, Searches};
pub use tolerances::{Importance, MESH, MIN_SEEN, Part, Quantile, Tolerance, samples_needed};
pub use trust::Trust;

/// Most values of a parameter that the answer compares. Chosen: more are a chart, or `billow compare --rank`.
const MAX_COMPARED_VALUES: usize = 64;

/// Change of the volume from its mean over the last tenth of a run to its last value, relative, above which the capsule
/// still moved. Chosen: half of what `billow job` allows over that tenth.
const MIN_CHANGE_AT_END: f64 = 0.01;

/// The answer of a study.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct Answer {
    /// The question, as the study file has it.
    pub question: String,
    /// Whether its film is that of a mesh.
    pub is_from_mesh: bool,
    /// What decides the numbers and is no result.
    pub assumptions: Vec<String>,
    /// Numbers of rows by how they ended.
    pub counts: Counts,
    /// For each limit of a number the job with the worst value: a trusted one, or a done one where none can be trusted.
    pub worst: Vec<Extreme>,
    /// The trusted, deployed job with the smallest `t_90_z_rim_since_release`.
    pub fastest: Option<Extreme>,
    /// The job with the largest `peak_vz`: a trusted one, or a done one where none can be trusted.
    pub hardest: Option<Extreme>,
    /// The job with the largest `peak_kinetic_energy`, chosen so too.
    pub most_energy: Option<Extreme>,
    /// The audit of the done jobs.
    pub trust: Option<Trust>,
    /// Largest film stress of a done job over Young's modulus: the strain for which the linear material
    /// model is used.
    pub largest_strain: f64,
    /// The values of each parameter that varies, ranked with all other parameters equal, or why they cannot be.
    pub comparisons: Vec<(String, Result<Ranking, String>)>,
    /// Parameters, each with a measure that it cannot change: the peak comes before the inflow that it changes.
    pub no_effect: Vec<(String, ColumnId)>,
    /// Numbers of points, in a study with replicates.
    pub points: Option<PointCounts>,
    /// Number of runs that did not deploy and still moved at their end.
    pub still_moving: usize,
    /// The points whose runs do not all end alike.
    pub mixed: Vec<MixedPoint>,
    /// Points whose verdict depends on a numerical choice.
    pub sensitivity: Option<VerdictSensitivity>,
    /// Safe points, in a study with limits.
    pub safety: Option<Safety>,
    /// What samples say of each point.
    pub tolerances: Vec<Tolerance>,
    /// Of a grid, which parameter makes the spread of each measure.
    pub importance: Vec<(String, Importance)>,
    /// What the searches of borders found.
    pub searches: Option<Searches>,
    /// What the search of an optimum found.
    pub optimum: Option<Optimum>,
}

/// The job with the smallest or largest value of a measure.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Extreme {
    /// Id of the job.
    pub job: String,
    /// Its parameters, and the units in which they are shown.
    #[serde(serialize_with = "parameters")]
    pub parameters: Vec<(String, Value, DisplayUnit)>,
    /// The measure; of a margin the measure that it is of.
    pub measure: String,
    /// Value of the measure, or the margin, SI.
    pub value: f64,
    /// Unit in which the value is shown.
    #[serde(skip)]
    pub shown: DisplayUnit,
    /// Number of other jobs with the same value, up to rounding.
    pub others: usize,
    /// Number of other points, not counting replicates, with a job whose value is within the larger of both mesh errors.
    pub within_mesh_error: usize,
    /// Whether the value is extrapolated from several meshes.
    pub extrapolated: bool,
    /// Whether the job can be trusted.
    pub trusted: bool,
}

impl Answer {
    /// The answer of a results folder. `table` is its table.
    pub fn of(stored: &Stored<'_>, table: &Table) -> Self {
        let mut answer = Self::of_jobs(table, &stored.study.replicates());
        answer.question.clone_from(&stored.study.question);
        answer.is_from_mesh = stored.study.has_mesh();
        answer.assumptions = assumptions(&stored.points, stored.study.assumed());
        answer.largest_strain = largest_strain(stored);
        let rows: Vec<usize> = (0..table.rows()).collect();
        let (study, replicates) = (&stored.study, stored.study.replicates());
        let jobs = Condensed::of(table, &table.one_row_per_job(&rows), &replicates);
        answer.points = (!replicates.is_empty()).then(|| PointCounts::of(&jobs, &replicates));
        answer.sensitivity = VerdictSensitivity::of(table, &jobs);
        answer.mixed = MixedPoint::all(&jobs);
        // A large study needs the memory.
        drop(jobs);
        let limits = study.result_limits();
        let of_jobs = standing(table, &table.one_row_per_job(&rows), &replicates);
        let worst = bounds(limits).filter_map(|(measure, above)| {
            let worse: fn(f64, f64) -> bool = if above { |a, b| a < b } else { |a, b| a > b };
            most(table, &of_jobs, &replicates, measure, worse)
        });
        answer.worst = worst.collect();
        answer.safety = Safety::of(table, limits, &rows, &replicates);
        let sampled = study.sampled();
        answer.optimum = Optimum::of(stored, table);
        if answer.optimum.is_some() {
            // Its points are not spread evenly: what is known of them is what the search found.
        } else if study.is_product() {
            answer.importance = tolerances::of_grid(table, limits, &replicates);
        } else if !sampled.is_empty() {
            let inputs = (sampled.as_slice(), study.samples_are_independent());
            answer.tolerances = Tolerance::all(table, limits, &replicates, inputs);
        }
        if answer.optimum.is_none() {
            answer.comparisons = comparisons(table, &rows, study);
        }
        let scenes = stored.points.iter().map(|point| (point.job.id.as_str(), &*point.job.scene));
        let scenes = scenes.collect();
        let compared = answer.comparisons.iter().filter(|(_, ranking)| ranking.is_ok());
        let no_effect = compared.flat_map(|(by, _)| {
            inflow::peaks_before(table, by, &scenes)
                .into_iter()
                .map(|measure| (by.clone(), measure))
        });
        answer.no_effect = no_effect.collect();
        answer.searches = Searches::of(stored, table);
        answer
    }

    /// The parts of the answer that need only the table.
    fn of_jobs(table: &Table, replicates: &[String]) -> Self {
        let mut answer = Self::default();
        let all: Vec<usize> = (0..table.rows()).collect();
        let rows = table.one_row_per_job(&all);
        answer.still_moving = rows.iter().filter(|row| still_moves(table, **row)).count();
        for row in &rows {
            let near = table.value(ColumnId::NearThreshold, *row) == Some(&Value::Bool(true));
            if let Some(status) = table.status(*row) {
                answer.counts.add(status, table.verdict(*row), near);
            }
        }
        let judged = rows.iter().any(|row| table.verdict(*row).is_some());
        let can_be_best = |row: &usize| {
            let deployed = table.verdict(*row) == Some(Verdict::Deployed);
            table.is_trusted(*row) && (deployed || !judged)
        };
        let standing = standing(table, &rows, replicates);
        let best: Vec<usize> = standing.iter().copied().filter(can_be_best).collect();
        let least = |measure| extreme(table, &best, replicates, measure, |a, b| a < b);
        let most = |measure| most(table, &standing, replicates, measure, |a, b| a > b);
        answer.fastest = least(table.of_any_film(HEADLINE[0]));
        answer.hardest = most(table.of_any_film(ColumnId::PeakVz));
        answer.most_energy = most(ColumnId::PeakKineticEnergy);
        answer.trust = trust::trust(table, &rows);
        answer
    }
}

/// Of these rows those that stand for their points: where values are extrapolated, not the runs on other meshes.
fn standing(table: &Table, rows: &[usize], replicates: &[String]) -> Vec<usize> {
    if !table.has_extrapolated() {
        return rows.to_vec();
    }
    let points = Condensed::of(table, rows, replicates);
    let mut standing: Vec<usize> =
        points.runs.iter().flat_map(|runs| runs.finest.iter().copied()).collect();
    standing.sort_unstable();
    standing
}

/// The measures with a limit that is a number, and whether they must be above it.
fn bounds(limits: &[ResultLimit]) -> impl Iterator<Item = (ColumnId, bool)> {
    limits.iter().filter_map(|limit| match limit.condition {
        Condition::Bound { above, .. } => Some((limit.measure, above)),
        Condition::Is(_) => None,
    })
}

/// The values of each parameter that varies and repeats no point.
fn comparisons(
    table: &Table,
    rows: &[usize],
    study: &Study,
) -> Vec<(String, Result<Ranking, String>)> {
    let (repeated, replicates) = (study.replicates(), study.replicates_of_samples());
    let varied = table.parameters().filter(|column| !repeated.contains(&column.name));
    let compared = varied.filter_map(|column| {
        let values = compare::values(column, rows).len();
        let name = column.name.clone();
        let limits = (study.result_limits(), replicates.as_slice());
        let ranking = match values {
            0 | 1 => return None,
            2..=MAX_COMPARED_VALUES => {
                comparison(table, rows, &name, limits, &|name| study.zipped_with(name))
            }
            _ => Err(format!("{values} values: billow compare --rank --by {name}")),
        };
        Some((name, ranking))
    });
    compared.collect()
}

/// The values of one parameter; why they cannot be ranked.
fn comparison(
    table: &Table,
    rows: &[usize],
    by: &str,
    (limits, replicates): (&[ResultLimit], &[String]),
    zipped: &dyn Fn(&str) -> Vec<Zipped>,
) -> Result<Ranking, String> {
    let by = by.to_owned();
    let ranking = Ranking::of(&RankingInput {
        table,
        rows,
        by: std::slice::from_ref(&by),
        replicates,
        limits,
        measures: &default_measures(table, limits),
        zipped,
    })?;
    if ranking.is_one_job {
        return Err(format!("points that differ in {by} alone are one job"));
    }
    Ok(ranking)
}

/// Whether a run did not deploy and its volume still changed at its end, by the last volume and the mean of the last
/// tenth. A longer run may end otherwise.
pub fn still_moves(table: &Table, row: usize) -> bool {
    let number = |column| match table.value(column, row) {
        Some(Value::Number(number)) => *number,
        _ => f64::NAN,
    };
    let mean = number(ColumnId::VolumeRatio) * number(ColumnId::ReferenceVolume);
    let change = (number(ColumnId::FinalVolume) / mean - 1.0).abs();
    table.verdict(row).is_some_and(|verdict| verdict != Verdict::Deployed)
        && change > MIN_CHANGE_AT_END
}

/// The parameters of a row, and the units in which they are shown.
fn parameters_of(table: &Table, row: usize) -> Vec<(String, Value, DisplayUnit)> {
    let of =
        |column: &Column| (column.name.clone(), column.cells[row].clone(), column.shown.clone());
    table.parameters().map(of).collect()
}

/// Writes parameters as an object, SI.
fn parameters<S: Serializer>(
    parameters: &[(String, Value, DisplayUnit)],
    to: S,
) -> Result<S::Ok, S::Error> {
    to.collect_map(parameters.iter().map(|(name, value, _)| (name, json_value(value))))
}

/// Writes names with their numbers as an object.
fn named<S: Serializer>(numbers: &[(String, usize)], to: S) -> Result<S::Ok, S::Error> {
    to.collect_map(numbers.iter().map(|(name, number)| (name, number)))
}

/// The first trusted job with the largest value of a measure, or where `larger` says so the smallest; a done one where
/// none can be trusted.
fn most(
    table: &Table,
    rows: &[usize],
    replicates: &[String],
    measure: ColumnId,
    larger: fn(f64, f64) -> bool,
) -> Option<Extreme> {
    let trusted: Vec<usize> = rows.iter().copied().filter(|row| table.is_trusted(*row)).collect();
    let most = |rows: &[usize]| extreme(table, rows, replicates, measure, larger);
    most(&trusted).or_else(|| most(rows))
}

/// The first done job with the best value of a measure.
fn extreme(
    table: &Table,
    rows: &[usize],
    replicates: &[String],
    measure: ColumnId,
    better: fn(f64, f64) -> bool,
) -> Option<Extreme> {
    let raw = table.column(measure.name())?;
    let column = source(table, raw);
    let mut best: Option<(usize, f64)> = None;
    for row in rows.iter().copied() {
        let Some(value) = compare::measured(table, column, row) else { continue };
        if best.is_none_or(|(_, best)| better(value, best)) {
            best = Some((row, value));
        }
    }
    let (row, value) = best?;
    let same = |other: f64| (other - value).abs() <= compare::ROUNDING * value.abs();
    let measured = rows.iter().filter_map(|row| compare::measured(table, column, *row));
    let others = measured.filter(|other| same(*other)).count().saturating_sub(1);
    let errors = compare::columns_of_error(table, measure.name());
    let errors = errors.map(|sides| sides.map(|side| source(table, side)));
    let error = |row: usize| compare::error_at(table, errors?, row);
    let within = |other: &usize| {
        let known = compare::measured(table, column, *other).zip(error(*other)).zip(error(row));
        known.is_some_and(|((other, a), b)| compare::within_errors([other, value], [a, b]))
    };
    let fixed = fixed(table, replicates);
    let equal = rows.iter().filter(|row| within(row)).map(|row| point_key(&fixed, *row));
    let mut equal: BTreeSet<Vec<String>> = equal.collect();
    equal.remove(&point_key(&fixed, row));
    Some(Extreme {
        job: table.column("job")?.cells[row].to_string(),
        parameters: parameters_of(table, row),
        measure: measure.name().to_owned(),
        value,
        shown: column.shown.clone(),
        others,
        within_mesh_error: equal.len(),
        extrapolated: column.cells[row] != raw.cells[row],
        trusted: table.is_trusted(row),
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

#[cfg(test)]
mod point_tests;
#[cfg(test)]
mod tests;
