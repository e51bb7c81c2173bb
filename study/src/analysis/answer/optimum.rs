//! What the search of an optimum found: the best point that keeps the limits, with its error, what limits it, and how the
//! search went on; of two measures the front between them.

use serde::{Serialize, Serializer};

use super::{parameters, parameters_of};
use crate::analysis::replicates::Condensed;
use crate::input::keys::numerical::MESH_PARAMETER;
use crate::input::units::DisplayUnit;
use crate::input::value::Value;
use crate::job::result_limit::{ResultLimit, Safety};
use crate::job::row::ColumnId;
use crate::store::stored::Stored;
use crate::store::table::Table;
use crate::study::{self, Trial};

/// What the search of an optimum found.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Optimum {
    /// What becomes small.
    pub minimise: Vec<String>,
    /// Number of points that have ended, and in all.
    pub points: [usize; 2],
    /// Whether it has no other point to try.
    pub ended: bool,
    /// The best point; of two measures those of the front, by the first measure. None where no point keeps the limits.
    pub best: Vec<Best>,
    /// Better points, which do not keep the limits on the finest mesh.
    pub refuted: Vec<Best>,
    /// The smallest value that a surrogate expects of as many points spread evenly, SI: what a grid of equal cost would
    /// find; `None` for two measures, and before the search has ended.
    pub of_even_points: Option<f64>,
    /// After each generation the number of points, and the smallest value of each measure so far among points that keep the
    /// limits, SI.
    pub course: Vec<(usize, Vec<Option<f64>>)>,
    /// Its points, in their order.
    pub tried: Vec<Tried>,
}

/// A point that the search tried.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Tried {
    /// Median of its runs of each measure that becomes small, SI; `None` where a run has none.
    pub measures: Vec<Option<f64>>,
    /// Whether every run keeps every limit.
    pub keeps_limits: bool,
    /// Whether it is the best point, or one of the front.
    pub is_best: bool,
}

/// A point of the search.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Best {
    /// What the search varies, in this point.
    #[serde(serialize_with = "parameters")]
    pub parameters: Vec<(String, Value, DisplayUnit)>,
    /// One of its jobs: the first.
    pub job: String,
    /// Number of its runs.
    pub runs: usize,
    /// Its place in the order of the search, from 1.
    pub number: usize,
    /// What the limits say of its runs on the finest mesh that it has; `None` without limits.
    #[serde(serialize_with = "safety")]
    pub safety: Option<Safety>,
    /// Whether its runs on the finest mesh that it has meet every limit.
    pub keeps_limits: bool,
    /// What becomes small.
    pub measures: Vec<Small>,
    /// The limit with the smallest margin, and that margin.
    pub limit: Option<(String, f64)>,
    /// Parameters at an end of their range, and whether it is the upper one.
    pub at_end: Vec<(String, bool)>,
    /// The finest mesh on which it ran, where that is finer than the mesh of the search.
    pub confirmed_on: Option<i64>,
}

/// A measure of a point.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Small {
    /// The measure.
    pub measure: String,
    /// Unit in which it is shown.
    #[serde(skip)]
    pub shown: DisplayUnit,
    /// Median of the runs on the mesh of the search, SI.
    pub value: f64,
    /// The value that the point stands for: that of the finest mesh, or extrapolated, SI, with the least and the largest of
    /// its runs.
    pub stands_for: Option<[f64; 3]>,
    /// Uncertainty of that below and above it, SI, where it is known.
    pub uncertainty: Option<[f64; 2]>,
}

impl Small {
    /// The value that the point stands for, SI.
    pub fn stands(&self) -> f64 {
        self.stands_for.map_or(self.value, |[median, ..]| median)
    }

    /// Whether its uncertainty, and that of chance, separates it from the same measure of another point; `None` where it is
    /// not known.
    pub fn is_separate_from(&self, other: &Self) -> Option<bool> {
        let interval = |one: &Self| {
            let [_, least, largest] = one.stands_for.unwrap_or([one.value; 3]);
            let [below, above] = one.uncertainty?;
            Some([least - below, largest + above])
        };
        let ([a, b], [c, d]) = (interval(self)?, interval(other)?);
        Some(b < c || d < a)
    }
}

impl Optimum {
    /// What the search of a study found; `None` for a study without one. `table` is its table.
    pub fn of(stored: &Stored<'_>, table: &Table) -> Option<Self> {
        let found = stored.optimum()?;
        let minimised = stored.study.minimised();
        let rows: Vec<usize> = (0..table.rows()).collect();
        let points = Condensed::of(table, &rows, &stored.study.replicates());
        let limits = stored.study.result_limits();
        let (mut best, mut refuted) = (Vec::new(), Vec::new());
        for trial in &found.best {
            let of = (&found.trials[*trial], *trial);
            let Some(point) = Best::of((table, &points), of, (minimised, limits)) else { continue };
            let one = minimised.len() == 1;
            if one && point.confirmed_on.is_some() && !point.keeps_limits {
                refuted.push(point);
                continue;
            }
            best.push(point);
            if one {
                break;
            }
        }
        let ended = found.trials.iter().filter(|trial| trial.ended).count();
        let tried = tried(&found, &best);
        Some(Self {
            minimise: minimised.iter().map(|measure| measure.name().to_owned()).collect(),
            points: [ended, found.budget],
            ended: found.ended,
            best,
            refuted,
            of_even_points: found.of_even_points,
            course: course(&found, minimised.len()),
            tried,
        })
    }
}

fn tried(found: &study::Optimum, best: &[Best]) -> Vec<Tried> {
    let tried = |(k, trial): (usize, &Trial)| Tried {
        measures: trial.measures.clone(),
        keeps_limits: trial.keeps_limits,
        is_best: best.iter().any(|point| point.number == k + 1),
    };
    found.trials.iter().enumerate().map(tried).collect()
}

/// The smallest values so far, after each generation.
fn course(found: &study::Optimum, measures: usize) -> Vec<(usize, Vec<Option<f64>>)> {
    let mut course: Vec<(usize, Vec<Option<f64>>)> = Vec::new();
    let mut smallest = vec![None; measures];
    for (index, trial) in found.trials.iter().enumerate().filter(|(_, trial)| trial.ended) {
        if trial.keeps_limits {
            for (least, value) in smallest.iter_mut().zip(&trial.measures) {
                *least = [*least, *value].into_iter().flatten().reduce(f64::min);
            }
        }
        let ends =
            found.trials.get(index + 1).is_none_or(|next| next.generation > trial.generation);
        if ends {
            course.push((index + 1, smallest.clone()));
        }
    }
    course
}

impl Best {
    fn of(
        (table, points): (&Table, &Condensed),
        (trial, number): (&Trial, usize),
        (minimised, limits): (&[ColumnId], &[ResultLimit]),
    ) -> Option<Self> {
        let jobs = table.column("job")?;
        let is_of = |row: &usize| {
            let id = jobs.cells[*row].to_string();
            trial.jobs.iter().any(|job| job.as_str() == id)
        };
        let point = points.runs.iter().position(|runs| runs.rows.iter().any(is_of))?;
        let runs = &points.runs[point];
        let meshes = table.column(MESH_PARAMETER);
        let mesh = |row: usize| match meshes.map(|column| &column.cells[row]) {
            Some(Value::Integer(n)) => Some(*n),
            _ => None,
        };
        let searched = runs.rows.iter().copied().find(|row| is_of(row))?;
        let finest = runs.finest.first().copied().unwrap_or(searched);
        let small = |(k, measure): (usize, &ColumnId)| {
            let column = table.column(measure.name())?;
            Some(Small {
                measure: column.name.clone(),
                shown: column.shown.clone(),
                value: trial.measures[k]?,
                stands_for: points
                    .spread(&column.name, point)
                    .map(|[least, median, largest]| [median, least, largest]),
                uncertainty: table.uncertainty(*measure, finest),
            })
        };
        let margin = runs.worst_margin(table);
        let keeps = |limit: &ResultLimit| {
            let met = |row: &usize| table.judge(limit, *row).is_some_and(|judged| judged.met);
            runs.finest.iter().all(met)
        };
        Some(Self {
            parameters: parameters_of(&points.table, point),
            job: jobs.cells[searched].to_string(),
            runs: trial.jobs.len(),
            number: number + 1,
            safety: points.safety(point),
            measures: minimised.iter().enumerate().filter_map(small).collect(),
            limit: margin.map(|(margin, measure, _)| (measure, margin)),
            keeps_limits: limits.iter().all(keeps),
            at_end: trial.at_end.clone(),
            confirmed_on: mesh(finest).filter(|n| Some(*n) > mesh(searched)),
        })
    }
}

/// Writes what the limits say as its word.
#[expect(
    clippy::ref_option,
    clippy::trivially_copy_pass_by_ref,
    reason = "the signature that serde asks for"
)]
fn safety<S: Serializer>(safety: &Option<Safety>, to: S) -> Result<S::Ok, S::Error> {
    safety.map(Safety::name).serialize(to)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn two_points_are_separate_where_their_intervals_do_not_meet() {
        let small = |[median, least, largest]: [f64; 3], uncertainty| Small {
            measure: "peak_vz".to_owned(),
            shown: DisplayUnit::si("m/s"),
            value: median,
            stands_for: Some([median, least, largest]),
            uncertainty,
        };
        let low = small([10.0, 9.0, 11.0], Some([1.0, 2.0]));
        for (other, separate) in [
            (small([20.0, 19.0, 21.0], Some([5.0, 1.0])), Some(true)),
            (small([20.0, 19.0, 21.0], Some([7.0, 1.0])), Some(false)),
            (small([20.0, 12.5, 21.0], Some([0.0, 0.0])), Some(false)),
            (small([20.0, 19.0, 21.0], None), None),
        ] {
            assert_eq!(low.is_separate_from(&other), separate, "{other:?}");
            assert_eq!(other.is_separate_from(&low), separate, "{other:?}");
        }
    }
}
