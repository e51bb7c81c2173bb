//! The search of an optimum, replayed from its finished jobs: generation after generation, as they were planned.

use std::collections::HashMap;

use super::{Optimise, acquisition, by_measure};
use crate::input::value::Value;
use crate::job::JobId;
use crate::job::point::{Point, Searched};
use crate::job::result_limit::Judged;
use crate::study::Study;
use crate::study::finished::FinishedRow;

/// Distance from an end of a range, as a part of it, within which a point is at that end.
const END: f64 = 0.01;

/// A search with the points planned so far.
pub(crate) struct Replay<'a> {
    study: &'a Study,
    optimise: &'a Optimise,
    finished: HashMap<&'a JobId, &'a FinishedRow>,
    tried: Vec<Tried>,
    /// Number of generations planned.
    generations: u32,
}

/// A point with its runs.
struct Tried {
    /// Value of each column of the grid; those of replicates are not used.
    values: Vec<Value>,
    /// Its place in the ranges.
    place: Vec<f64>,
    generation: u32,
    /// Its runs, different jobs; none where no fold pattern satisfies the design.
    runs: Vec<JobId>,
}

/// A point of the search, with what is known of it.
#[derive(Debug, Clone, PartialEq)]
pub struct Trial {
    /// The values of what the search varies.
    pub values: Vec<Value>,
    /// Its place in the ranges: from 0 to 1, or the position of a word.
    pub(super) place: Vec<f64>,
    /// Its generation; 0 for the first.
    pub generation: u32,
    /// Its jobs.
    pub jobs: Vec<JobId>,
    /// Median of the runs of each measure that becomes small; `None` where a run has none.
    pub measures: Vec<Option<f64>>,
    /// For each limit the margin of the run that is nearest to it or farthest beyond, its known uncertainty taken off;
    /// `None` where a run cannot be judged.
    pub margins: Vec<Option<f64>>,
    /// What it varies that is at an end of its range, and whether that is the upper one.
    pub at_end: Vec<(String, bool)>,
    /// Whether all of its runs have ended.
    pub ended: bool,
}

impl Trial {
    /// Whether every run keeps every limit, as far as is known.
    pub fn keeps_limits(&self) -> bool {
        self.is_measured() && self.margins.iter().all(|margin| margin.is_some_and(|m| m > 0.0))
    }

    /// Whether each run has a value of what becomes small.
    pub fn is_measured(&self) -> bool {
        self.measures.iter().all(Option::is_some)
    }
}

/// What a search has found.
#[derive(Debug, Clone, PartialEq)]
pub struct Optimum {
    /// Its points, in plan order.
    pub trials: Vec<Trial>,
    /// Of the points that keep the limits the positions of the best, the best first; of two measures those of the front,
    /// by the first measure.
    pub best: Vec<usize>,
    /// Number of points of the first generation.
    pub first: usize,
    /// Number of points in all.
    pub budget: usize,
}

impl<'a> Replay<'a> {
    /// The search at its start. `None` for a study without one.
    pub fn new(study: &'a Study, finished: &'a [FinishedRow]) -> Option<Self> {
        let optimise = study.grid.optimise.as_ref()?;
        let finished = finished.iter().map(|row| (&row.id, row)).collect();
        let mut replay = Self { study, optimise, finished, tried: Vec::new(), generations: 0 };
        replay.add(study.points());
        Some(replay)
    }

    /// Adds the points of a generation.
    pub fn add(&mut self, points: &[Point]) {
        let mut positions: HashMap<Vec<String>, usize> = HashMap::new();
        for point in points {
            let values: Vec<Value> =
                point.job.parameters.iter().map(|(_, value)| value.clone()).collect();
            let varied = self.optimise.columns.iter().map(|column| &values[*column]);
            let key = varied.clone().map(Value::to_string).collect();
            let place = self.optimise.coordinates.iter().zip(varied);
            let place: Vec<f64> = place.map(|(of, value)| of.place(value)).collect();
            let position = *positions.entry(key).or_insert(self.tried.len());
            if position == self.tried.len() {
                let generation = self.generations;
                self.tried.push(Tried { values, place, generation, runs: Vec::new() });
            }
            let runs = &mut self.tried[position].runs;
            if point.infeasible.is_none() && !runs.contains(&point.job.id) {
                runs.push(point.job.id.clone());
            }
        }
        self.generations += 1;
    }

    /// The points of the next generation; none where the budget is used up.
    pub fn next_points(&mut self) -> Vec<Point> {
        let used = self.tried.len();
        let batch = self.optimise.batch.min(self.optimise.budget.saturating_sub(used));
        if batch == 0 {
            return Vec::new();
        }
        let trials = self.trials();
        let proposed = acquisition::proposed(self.optimise, &trials, batch, self.generations);
        let mut points = Vec::new();
        for chosen in proposed {
            let mut values = self.tried[0].values.clone();
            for (column, value) in self.optimise.columns.iter().zip(chosen) {
                values[*column] = value;
            }
            points.extend(self.study.points_at(&values, Searched::No));
        }
        points
    }

    /// What is known of each point.
    fn trials(&self) -> Vec<Trial> {
        let trial = |tried: &Tried| {
            let rows: Vec<Option<&FinishedRow>> =
                tried.runs.iter().map(|id| self.finished.get(id).copied()).collect();
            let ended = rows.iter().all(Option::is_some);
            let known: Vec<&FinishedRow> = rows.into_iter().flatten().collect();
            let measure = |k: usize| {
                let values: Option<Vec<f64>> = known.iter().map(|row| row.minimised[k]).collect();
                values.filter(|values| ended && !values.is_empty()).map(median)
            };
            let margin = |k: usize| {
                let margins: Option<Vec<f64>> =
                    known.iter().map(|row| row.limits[k].map(|judged| certain(&judged))).collect();
                let margins = margins.filter(|margins| ended && !margins.is_empty())?;
                Some(margins.into_iter().fold(f64::INFINITY, f64::min))
            };
            let limits = self.study.result_limits().len();
            Trial {
                values: self.optimise.columns.iter().map(|c| tried.values[*c].clone()).collect(),
                place: tried.place.clone(),
                generation: tried.generation,
                jobs: tried.runs.clone(),
                measures: (0..self.optimise.minimise.len()).map(measure).collect(),
                margins: (0..limits).map(margin).collect(),
                at_end: self.at_end(&tried.place),
                ended,
            }
        };
        self.tried.iter().map(trial).collect()
    }

    /// The names of what a place has at an end of its range.
    fn at_end(&self, place: &[f64]) -> Vec<(String, bool)> {
        let Optimise { columns, coordinates, .. } = self.optimise;
        let numbers =
            coordinates.iter().zip(place).zip(columns).filter(|((of, _), _)| !of.is_word());
        let ends = numbers.filter(|((_, place), _)| **place < END || **place > 1.0 - END);
        let name = |column: usize| self.study.grid.columns[column].name.clone();
        ends.map(|((_, place), column)| (name(*column), *place > 0.5)).collect()
    }

    /// What the search has found.
    pub fn optimum(&self) -> Optimum {
        let trials = self.trials();
        let best = best(&trials);
        Optimum { trials, best, first: self.optimise.first(), budget: self.optimise.budget }
    }

    /// Whether every job planned so far has ended.
    pub fn has_ended_so_far(&self) -> bool {
        let runs = self.tried.iter().flat_map(|tried| &tried.runs);
        runs.into_iter().all(|id| self.finished.contains_key(id))
    }

    /// The jobs of the best points, the best first.
    pub fn to_confirm(&self) -> Vec<Vec<JobId>> {
        let trials = self.trials();
        let best = best(&trials);
        best.into_iter().map(|trial| trials[trial].jobs.clone()).collect()
    }
}

/// The margin of a run without its known uncertainty: above 0 where the limit is kept for certain.
fn certain(judged: &Judged) -> f64 {
    let margin = judged.margin.clamp(-1.0, 1.0);
    // A word is met or not.
    let uncertainty = judged.uncertainty.filter(|u| u.is_finite()).unwrap_or(0.0);
    if judged.met { margin - uncertainty } else { margin.min(-f64::EPSILON) }
}

/// The middle value; of an even number the mean of the two.
fn median(mut values: Vec<f64>) -> f64 {
    values.sort_by(f64::total_cmp);
    let n = values.len();
    0.5 * (values[(n - 1) / 2] + values[n / 2])
}

/// The best of the points that keep the limits: in order, or the front of two measures.
fn best(trials: &[Trial]) -> Vec<usize> {
    let mut kept: Vec<usize> = (0..trials.len()).filter(|k| trials[*k].keeps_limits()).collect();
    let measures = |k: &usize| &trials[*k].measures;
    if kept.first().is_none_or(|first| measures(first).len() == 1) {
        kept.sort_by(|a, b| by_measure(measures(a)[0], measures(b)[0]));
        return kept;
    }
    let dominates = |a: &usize, b: &usize| {
        let pairs = || measures(a).iter().zip(measures(b));
        pairs().all(|(a, b)| by_measure(*a, *b).is_le())
            // Of equal points the first stands for all.
            && (a < b || pairs().any(|(a, b)| by_measure(*a, *b).is_lt()))
    };
    let mut front: Vec<usize> =
        kept.iter().copied().filter(|k| !kept.iter().any(|other| other != k && dominates(other, k))).collect();
    front.sort_by(|a, b| by_measure(measures(a)[0], measures(b)[0]));
    front
}
