//! The searches of a study, replayed from its finished jobs: generation after generation, as they were
//! planned.

use std::collections::{BTreeSet, HashMap};

use billow_solver::output::measures::Verdict;

use super::Criterion;
use super::levels::{Border, Level, next, outcome};
use crate::input::value::Value;
use crate::job::JobId;
use crate::job::point::{Point, Searched};
use crate::job::proportion::Proportion;
use crate::job::result_limit::Safety;
use crate::study::Study;
use crate::study::finished::FinishedRow;

/// The searches of a study with the points planned so far.
pub(crate) struct Replay<'a> {
    study: &'a Study,
    finished: HashMap<&'a JobId, &'a FinishedRow>,
    searches: Vec<Running>,
    /// Positions of the searches, by the texts of the other parameters.
    positions: HashMap<Vec<String>, usize>,
}

/// One search: the values of the other parameters, and its levels.
struct Running {
    /// Value of each column of the grid; those of the search and of replicates are not used.
    values: Vec<Value>,
    /// Whether it is one of the product.
    searched: Searched,
    /// Whether the filter of the study removed a value that it needed.
    filtered: bool,
    /// Values, each with its different jobs.
    levels: Vec<(f64, Vec<Run>)>,
}

/// One run at a level.
struct Run {
    id: JobId,
    /// Whether the point has a job at all.
    feasible: bool,
}

impl<'a> Replay<'a> {
    /// The searches at their start. `None` for a study without one.
    pub fn new(study: &'a Study, finished: &'a [FinishedRow]) -> Option<Self> {
        study.grid.search.as_ref()?;
        let finished = finished.iter().map(|row| (&row.id, row)).collect();
        let mut replay = Self { study, finished, searches: Vec::new(), positions: HashMap::new() };
        replay.add(study.points());
        Some(replay)
    }

    /// Adds points of the searches: runs at their levels.
    pub fn add(&mut self, points: &[Point]) {
        let grid = &self.study.grid;
        let Some(search) = &grid.search else { return };
        let other = |column: usize| column != search.column && !grid.is_replicate(column);
        let is_searched = |point: &&Point| point.searched != Searched::No;
        for point in points.iter().filter(is_searched) {
            let values: Vec<Value> =
                point.job.parameters.iter().map(|(_, value)| value.clone()).collect();
            let level = values.get(search.column).and_then(Value::any_number);
            let Some(level) = level else { continue };
            let others = values.iter().enumerate().filter(|(column, _)| other(*column));
            let key: Vec<String> = others.map(|(_, value)| value.to_string()).collect();
            let position = *self.positions.entry(key).or_insert(self.searches.len());
            if position == self.searches.len() {
                let (searched, levels) = (point.searched, Vec::new());
                self.searches.push(Running { values, searched, filtered: false, levels });
            }
            let levels = &mut self.searches[position].levels;
            let index = match levels.binary_search_by(|(known, _)| known.total_cmp(&level)) {
                Ok(index) => index,
                Err(index) => {
                    levels.insert(index, (level, Vec::new()));
                    index
                }
            };
            // Points that are one job count once.
            let id = point.job.id.clone();
            if !levels[index].1.iter().any(|run| run.id == id) {
                levels[index].1.push(Run { id, feasible: point.infeasible.is_none() });
            }
        }
    }

    /// The points of the next generation, in the order of the searches.
    pub fn next_points(&mut self) -> Vec<Point> {
        let Some(search) = &self.study.grid.search else { return Vec::new() };
        let replicates = self.study.grid.replicate_count();
        let mut points = Vec::new();
        let mut filtered = BTreeSet::new();
        for (index, running) in self.searches.iter().enumerate() {
            for value in next(search, &self.levels(running), replicates) {
                let mut values = running.values.clone();
                values[search.column] = search.value(value);
                let new = self.study.points_at(&values, running.searched);
                if new.is_empty() {
                    filtered.insert(index);
                }
                points.extend(new);
            }
        }
        for index in filtered {
            self.searches[index].filtered = true;
        }
        points
    }

    /// Judges by these rows from now on.
    pub fn judge_by(&mut self, finished: &'a [FinishedRow]) {
        self.finished = finished.iter().map(|row| (&row.id, row)).collect();
    }

    /// What the searches have found.
    pub fn borders(&self) -> Vec<Border> {
        let grid = &self.study.grid;
        let replicates = grid.replicate_count();
        let border = |running: &Running| {
            let levels = self.levels(running);
            let others = running.values.iter().enumerate().filter(|(column, _)| {
                grid.search.as_ref().is_some_and(|search| search.column != *column)
                    && !grid.is_replicate(*column)
            });
            let parameters = others
                .map(|(column, value)| (grid.columns[column].name.clone(), value.clone()))
                .collect();
            let outcome = outcome(&levels, replicates);
            Border { parameters, levels, outcome, filtered: running.filtered }
        };
        self.searches.iter().map(border).collect()
    }

    fn levels(&self, running: &Running) -> Vec<Level> {
        let levels = running.levels.iter();
        levels.map(|(value, runs)| self.level(*value, runs)).collect()
    }

    fn level(&self, value: f64, runs: &[Run]) -> Level {
        let mut level =
            Level { value, met: Proportion::default(), uncertain: 0, not_judged: 0, open: 0 };
        let Some(search) = &self.study.grid.search else { return level };
        for run in runs {
            match self.finished.get(&run.id) {
                _ if !run.feasible => level.not_judged += 1,
                None => level.open += 1,
                Some(row) => match known(search.criterion, row) {
                    None => level.not_judged += 1,
                    Some(safety) => {
                        level.met.of += 1;
                        level.met.met += usize::from(safety == Safety::Safe);
                        level.uncertain += usize::from(safety == Safety::Uncertain);
                    }
                },
            }
        }
        level
    }
}

/// What is known of a row's criterion; `None` where nothing can be said.
fn known(criterion: Criterion, row: &FinishedRow) -> Option<Safety> {
    let limits = || row.limits.iter().map(|judged| judged.map(|judged| judged.as_far_as_known()));
    match criterion {
        Criterion::Deployed => row.verdict.map(|verdict| match verdict {
            Verdict::Deployed => Safety::Safe,
            _ => Safety::Unsafe,
        }),
        Criterion::Limit(index) => limits().nth(index).flatten(),
        Criterion::Safe if limits().flatten().any(|safety| safety == Safety::Unsafe) => {
            Some(Safety::Unsafe)
        }
        Criterion::Safe => limits().try_fold(Safety::Safe, |all, one| Some(all.max(one?))),
    }
}
