//! The candidates of a ranking: their points, runs, margins and medians.

use std::collections::BTreeSet;

use super::{Basis, Candidate, Field, RankedMeasure, Ranking, penalty, ranked_points};
use crate::analysis::compare::{Better, Pair, Range, Set, Tally, median_range};
use crate::analysis::replicates::Runs;
use crate::analysis::statistics::Spread;
use crate::input::keys::numerical;
use crate::input::value::Value;
use crate::job::proportion::Proportion;
use crate::job::result_limit::Safety;
use crate::job::row::{BetterSide, DerivedColumn};

impl Field<'_> {
    /// The candidates in their order.
    pub(super) fn ranked(&self, values: &[Vec<Value>]) -> Ranking {
        let sets = self.different_sets();
        let blocks: Vec<(Vec<usize>, Vec<&Set>)> = (0..self.measures.len())
            .map(|measure| {
                let has = |set: &&Set| {
                    self.chosen.iter().all(|candidate| {
                        self.value(measure, set, *candidate).is_some()
                            || !self.has(measure, *candidate)
                    })
                };
                let with: Vec<usize> =
                    self.chosen.iter().copied().filter(|c| self.has(measure, *c)).collect();
                (with, sets.iter().copied().filter(has).collect())
            })
            .collect();
        let mut found: Vec<(usize, Candidate)> = self
            .chosen
            .iter()
            .map(|index| (*index, self.candidate(values[*index].clone(), *index, &blocks)))
            .collect();
        // The sort is stable: equal candidates stay in plan order.
        found.sort_by_key(|(index, _)| *index);
        found.sort_by(|a, b| self.compare(&a.1, &b.1));
        let measures = blocks.iter().enumerate();
        let measures = measures.map(|(index, (_, sets))| self.ranked_measure(index, sets, &found));
        Ranking {
            basis: self.basis,
            measures: measures.collect(),
            candidates: found.into_iter().map(|(_, candidate)| candidate).collect(),
            by: Vec::new(),
            is_one_job: self.sets.iter().all(|set| self.jobs(set).len() < 2),
            sets: self.sets.len(),
            matched: Vec::new(),
            carried: Vec::new(),
            left_out: Vec::new(),
            outside: 0,
            not_ended: 0,
            not_trusted: ranked_points(self).filter(|point| !self.trusted(*point)).count(),
        }
    }

    /// The different jobs of a set.
    fn jobs(&self, set: &Set) -> BTreeSet<String> {
        let job = self.table.column("job");
        let rows = self.chosen.iter().filter_map(|index| set[*index]);
        rows.filter_map(|row| Some(job?.cells[row].to_string())).collect()
    }

    /// The sets of different jobs, each once, whatever number of points are these jobs.
    fn different_sets(&self) -> Vec<&Set> {
        let mut seen = BTreeSet::new();
        let job = self.table.column("job");
        let jobs = |set: &Set| -> Vec<Option<String>> {
            let job = |row: &Option<usize>| Some(job?.cells[(*row)?].to_string());
            set.iter().map(job).collect()
        };
        self.sets.iter().filter(|set| job.is_none() || seen.insert(jobs(set))).collect()
    }

    /// How the candidates, in their order, stand to the best one in a measure.
    fn ranked_measure(
        &self,
        index: usize,
        sets: &[&Set],
        found: &[(usize, Candidate)],
    ) -> RankedMeasure {
        let measure = &self.measures[index];
        // Of a mesh, or a model, no value is better: it computes another number for the same capsule.
        let of_method = self.by.iter().any(|name| numerical::is_of_method(name));
        let median = |position: usize| Some(found[position].1.measures[index]?.median);
        let always = |candidate: &Candidate| {
            self.basis == Basis::Measures || candidate.deployed == candidate.points
        };
        let mut best: Option<(usize, f64)> = None;
        for (position, (_, candidate)) in found.iter().enumerate() {
            let value = median(position).filter(|_| always(candidate));
            let value = value.map(|value| penalty(measure, value));
            if let Some(value) = value.filter(|value| best.is_none_or(|(_, best)| *value < best)) {
                best = Some((position, value));
            }
        }
        let best = best.filter(|_| !of_method && measure.side() != BetterSide::Neither);
        let best = best.map(|(position, _)| position);
        let tally = |position: usize| {
            let base = best.filter(|best| *best != position)?;
            median(position)?;
            let pairs = sets.iter().filter_map(|set| {
                let [base, other] = [base, position].map(|position| set[found[position].0]);
                let pair = Pair { base: base?, other: other? };
                [pair.base, pair.other].iter().all(|row| self.trusted(*row)).then_some(pair)
            });
            let value = found[position].1.values.first().cloned().unwrap_or(Value::Null);
            Some(Tally::of(self.table, &pairs.collect::<Vec<_>>(), value, measure))
        };
        let range = |position: usize| found[position].1.ranges[index];
        let against_best: Vec<Option<Tally>> = (0..found.len()).map(tally).collect();
        let equal = |position: usize| {
            if let Some(tally) = against_best[position].as_ref().filter(|_| measure.has_errors()) {
                // Pair by pair, as `compare` judges.
                return tally.pairs() > 0 && tally.count(Better::Tie) == tally.pairs();
            }
            let pair = best.and_then(range).zip(range(position));
            pair.is_some_and(|(best, range)| measure.are_equal(best, range))
        };
        RankedMeasure {
            column: measure.column.like(measure.column.name.clone(), Vec::new()),
            tolerance: measure.tolerance,
            sets: sets.len(),
            best,
            equal: (0..found.len()).map(equal).collect(),
            against_best,
        }
    }

    fn candidate(
        &self,
        values: Vec<Value>,
        index: usize,
        blocks: &[(Vec<usize>, Vec<&Set>)],
    ) -> Candidate {
        let points: Vec<usize> = self.sets.iter().filter_map(|set| set[index]).collect();
        let count = |holds: &dyn Fn(usize) -> bool| points.iter().filter(|p| holds(**p)).count();
        let sum = |of: &dyn Fn(&Runs) -> Proportion| self.sum(&points, of);
        let ranges = blocks.iter().enumerate().map(|(measure, (with, sets))| {
            let ranges = sets.iter().filter_map(|set| self.range(measure, set, index));
            median_range(&ranges.collect::<Vec<_>>()).filter(|_| with.contains(&index))
        });
        let measures = blocks.iter().enumerate().map(|(measure, (with, sets))| {
            let of_points = sets.iter().filter_map(|set| self.value(measure, set, index));
            let spread = Spread::of(of_points).filter(|_| with.contains(&index))?;
            let name = &self.measures[measure].column.name;
            let range = |end: usize| {
                let points = sets.iter().filter_map(|set| set[index]);
                points.filter_map(move |p| Some(self.points.spread(name, p)?[end]))
            };
            Some(Spread {
                least: range(0).fold(spread.least, f64::min),
                largest: range(2).fold(spread.largest, f64::max),
                ..spread
            })
        });
        Candidate {
            points: points.len(),
            safe: count(&|point| self.points.safety(point) == Some(Safety::Safe)),
            deployed: count(&|point| self.points.deploys(point) == Some(true)),
            failed: count(&|point| self.points.runs[point].failed > 0),
            safe_runs: sum(&|runs| runs.safe),
            deployed_runs: sum(&|runs| runs.deployed),
            missed: self.missed(&points),
            margin: self.worst(&points),
            measures: measures.collect(),
            ranges: ranges.collect(),
            values,
        }
    }

    /// A proportion over the runs of some points.
    fn sum(&self, points: &[usize], of: &dyn Fn(&Runs) -> Proportion) -> Proportion {
        let proportions = points.iter().map(|point| of(&self.points.runs[*point]));
        proportions.fold(Proportion::default(), |sum, one| Proportion {
            met: sum.met + one.met,
            of: sum.of + one.of,
        })
    }

    /// Of all runs of some points, those that are neither safe nor within their uncertainty, or without limits those that
    /// do not deploy.
    fn missed(&self, points: &[usize]) -> Proportion {
        self.sum(points, &|runs| {
            let met = match self.basis {
                Basis::Limits => runs.safe.of - runs.not_safe,
                Basis::Verdicts => runs.deployed.met,
                Basis::Measures => runs.finest.len(),
            };
            Proportion { met: runs.finest.len() - met, of: runs.finest.len() }
        })
    }

    /// The smallest margin over some points.
    fn worst(&self, points: &[usize]) -> Option<(f64, String)> {
        let margins = self.table.column(DerivedColumn::SmallestMargin.name())?;
        let names = self.table.column(DerivedColumn::SmallestMarginOf.name())?;
        let margins = points.iter().filter_map(|point| match margins.cells[*point] {
            Value::Number(margin) => Some((margin, names.cells[*point].to_string())),
            _ => None,
        });
        margins.min_by(|a, b| a.0.total_cmp(&b.0))
    }

    fn trusted(&self, point: usize) -> bool {
        self.points.runs[point].has_trusted
    }

    /// A trusted value of a measure at the point of a candidate in a set.
    fn value(&self, measure: usize, set: &Set, candidate: usize) -> Option<f64> {
        self.range(measure, set, candidate).map(|range| range[1])
    }

    /// The same with its range over the runs of the point.
    fn range(&self, measure: usize, set: &Set, candidate: usize) -> Option<Range> {
        let point = set[candidate].filter(|point| self.trusted(*point))?;
        self.measures[measure].range(self.table, point)
    }

    /// Whether a candidate has a value of a measure in any set.
    fn has(&self, measure: usize, candidate: usize) -> bool {
        self.sets.iter().any(|set| self.value(measure, set, candidate).is_some())
    }
}
