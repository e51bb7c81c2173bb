//! The search of an optimum, replayed from its finished jobs: generation after generation, as they were planned.

use std::collections::{HashMap, HashSet};

use super::acquisition::Search;
use super::proposed::{self, Known};
use super::trial::best;
use super::{Optimise, Optimum, Trial, prior, sobol};
use crate::input::value::Value;
use crate::job::point::{Point, Searched};
use crate::job::result_limit::{Judged, Safety};
use crate::job::{Job, JobId};
use crate::study::Study;
use crate::study::finished::FinishedRow;

/// Distance from an end of a range, as a part of it, within which a point is at that end.
const MAX_DISTANCE_FROM_END: f64 = 0.01;

/// A search with the points planned so far.
pub(crate) struct Replay<'a> {
    study: &'a Study,
    optimise: &'a Optimise,
    finished: HashMap<&'a JobId, &'a FinishedRow>,
    tried: Vec<Tried>,
    /// Jobs of all points, also of those without a fold pattern.
    known: HashSet<JobId>,
    /// Value of each column of the grid at its first point.
    first: Vec<Value>,
    /// Number of generations planned.
    generations: u32,
    /// Points of the cheap model and their jobs, those of each place once.
    prior: Vec<Tried>,
    prior_jobs: Vec<Job>,
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

impl<'a> Replay<'a> {
    /// The search at its start. `None` for a study without one.
    pub fn new(study: &'a Study, finished: &'a [FinishedRow]) -> Option<Self> {
        let optimise = study.grid.optimise.as_ref()?;
        let finished = finished.iter().map(|row| (&row.id, row)).collect();
        let first = study.points().first().map(values_of).unwrap_or_default();
        let mut replay = Self {
            study,
            optimise,
            finished,
            tried: Vec::new(),
            known: HashSet::new(),
            first,
            generations: 0,
            prior: Vec::new(),
            prior_jobs: Vec::new(),
        };
        replay.add(study.points());
        Some(replay)
    }

    /// Adds the points of a generation. One whose jobs are all those of others does not count.
    pub fn add(&mut self, points: &[Point]) {
        let optimise = self.optimise;
        let varied = |point: &Point| optimise.varied(&values_of(point));
        // Runs of one point stand together.
        for runs in points.chunk_by(|a, b| varied(a) == varied(b)) {
            let is_new = runs.iter().any(|run| !self.known.contains(&run.job.id));
            self.known.extend(runs.iter().map(|run| run.job.id.clone()));
            if !is_new {
                continue;
            }
            let place = optimise.place(&varied(&runs[0]));
            let mut jobs: Vec<JobId> = Vec::new();
            for run in runs.iter().filter(|run| run.infeasible.is_none()) {
                if !jobs.contains(&run.job.id) {
                    jobs.push(run.job.id.clone());
                }
            }
            let (values, generation) = (values_of(&runs[0]), self.generations);
            self.tried.push(Tried { values, place, generation, runs: jobs });
        }
        self.generations += 1;
    }

    /// The points of the next generation; none where the budget is used up, or no other point is to be tried.
    pub fn next_points(&mut self) -> Vec<Point> {
        let used = self.tried.len();
        let batch = self.optimise.batch.min(self.optimise.budget.saturating_sub(used));
        if batch == 0 {
            return Vec::new();
        }
        self.add_prior();
        let is_new = |chosen: &[Value]| {
            self.points_of(chosen).iter().any(|point| !self.known.contains(&point.job.id))
        };
        let (optimise, generation) = (self.optimise, (batch, self.generations));
        let (trials, judging) = (self.trials(), self.study.judging());
        let run = || {
            let rows = prior::rows(&self.prior_jobs, judging);
            self.trials_of(&self.prior, &rows.iter().map(|row| (&row.id, row)).collect())
        };
        let ids: Vec<&str> = self.prior_jobs.iter().map(|job| job.id.as_str()).collect();
        let known = Known { trials: &trials, beside: &format!("{judging:?} {ids:?}"), prior: &run };
        let proposed = proposed::next(optimise, &known, generation, &is_new);
        proposed.iter().flat_map(|chosen| self.points_of(chosen)).collect()
    }

    /// The runs of a point with these values of what is varied; none where the study refuses them.
    fn points_of(&self, chosen: &[Value]) -> Vec<Point> {
        self.study.points_at(&self.with(chosen), Searched::No)
    }

    /// Value of each column of the grid with these values of what is varied.
    fn with(&self, chosen: &[Value]) -> Vec<Value> {
        let mut values = self.first.clone();
        for (column, value) in self.optimise.columns.iter().zip(chosen) {
            values[*column] = value.clone();
        }
        values
    }

    /// Adds the points of the cheap model that are missing: those spread evenly, then those of the search.
    fn add_prior(&mut self) {
        let (optimise, grid) = (self.optimise, &self.study.grid);
        if !optimise.has_prior {
            return;
        }
        let replicates: Vec<usize> = (0..grid.columns.len())
            .filter(|column| grid.is_replicate(*column) && !grid.is_sampled(*column))
            .collect();
        let spread = sobol(optimise.columns.len(), optimise.seed).take(prior::POINTS);
        let spread = spread.filter(|_| self.prior.is_empty()).map(|point| optimise.values(&point));
        let tried = self.tried.iter().map(|tried| optimise.varied(&tried.values));
        for chosen in spread.chain(tried).collect::<Vec<_>>() {
            let values = self.with(&chosen);
            if self.prior.iter().any(|known| known.values == values) {
                continue;
            }
            let runs = self.points_of(&chosen);
            // What the study refuses is no point of the search either.
            if runs.is_empty() {
                continue;
            }
            let jobs = prior::jobs(&runs, &replicates);
            let runs = jobs.iter().map(|job| job.id.clone()).collect();
            let place = optimise.place(&chosen);
            self.prior.push(Tried { values, place, generation: 0, runs });
            self.prior_jobs.extend(jobs);
        }
    }

    /// What is known of each point.
    fn trials(&self) -> Vec<Trial> {
        self.trials_of(&self.tried, &self.finished)
    }

    fn trials_of(&self, tried: &[Tried], finished: &HashMap<&JobId, &FinishedRow>) -> Vec<Trial> {
        let trial = |tried: &Tried| {
            let rows: Vec<Option<&FinishedRow>> =
                tried.runs.iter().map(|id| finished.get(id).copied()).collect();
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
            let measures: Vec<Option<f64>> =
                (0..self.optimise.minimise.len()).map(measure).collect();
            let safe = |judged: &Judged| judged.as_far_as_known() == Safety::Safe;
            let keeps =
                |row: &&FinishedRow| row.limits.iter().all(|one| one.as_ref().is_some_and(safe));
            let keeps_limits = measures.iter().all(Option::is_some) && known.iter().all(keeps);
            Trial {
                values: self.optimise.varied(&tried.values),
                place: tried.place.clone(),
                generation: tried.generation,
                jobs: tried.runs.clone(),
                measures,
                margins: (0..limits).map(margin).collect(),
                keeps_limits,
                at_end: self.at_end(&tried.place),
                ended,
            }
        };
        tried.iter().map(trial).collect()
    }

    /// The names of what a place has at an end of its range.
    fn at_end(&self, place: &[f64]) -> Vec<(String, bool)> {
        let Optimise { columns, coordinates, .. } = self.optimise;
        let numbers =
            coordinates.iter().zip(place).zip(columns).filter(|((of, _), _)| !of.is_word());
        let ends = numbers.filter(|((_, place), _)| {
            **place < MAX_DISTANCE_FROM_END || **place > 1.0 - MAX_DISTANCE_FROM_END
        });
        let name = |column: usize| self.study.grid.columns[column].name.clone();
        ends.map(|((_, place), column)| (name(*column), *place > 0.5)).collect()
    }

    /// What the search has found; `ended` says whether it has no other point to try.
    pub fn optimum(&self, ended: bool) -> Optimum {
        let trials = self.trials();
        let best = best(&trials);
        let search = Search { optimise: self.optimise, trials: &trials, prior: &[], generation: 0 };
        let one = ended && self.optimise.minimise.len() == 1;
        let of_even_points = if one { search.of_even_points(trials.len()) } else { None };
        Optimum { trials, best, of_even_points, budget: self.optimise.budget, ended }
    }

    /// Whether every job planned so far has ended.
    pub fn has_ended_so_far(&self) -> bool {
        let mut runs = self.tried.iter().flat_map(|tried| &tried.runs);
        runs.all(|id| self.finished.contains_key(id))
    }

    /// The jobs of the points that run on finer meshes: the best first; of a front both ends and the middle.
    pub fn to_confirm(&self) -> Vec<Vec<JobId>> {
        let trials = self.trials();
        let mut best = best(&trials);
        if self.optimise.minimise.len() > 1 && best.len() > 2 {
            best = vec![best[0], best[best.len() - 1], best[best.len() / 2]];
        }
        best.into_iter().map(|trial| trials[trial].jobs.clone()).collect()
    }
}

/// The margin of a run without its known uncertainty.
fn certain(judged: &Judged) -> f64 {
    let uncertainty = judged.uncertainty.filter(|u| u.is_finite()).unwrap_or(0.0);
    (if judged.met { judged.margin - uncertainty } else { judged.margin }).clamp(-1.0, 1.0)
}

/// Value of each column of the grid at a point.
fn values_of(point: &Point) -> Vec<Value> {
    point.job.parameters.iter().map(|(_, value)| value.clone()).collect()
}

/// The middle value; of an even number the mean of the two.
fn median(mut values: Vec<f64>) -> f64 {
    values.sort_by(f64::total_cmp);
    let n = values.len();
    0.5 * (values[(n - 1) / 2] + values[n / 2])
}
