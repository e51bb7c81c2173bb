//! The candidates of a ranking: their points, runs, margins and medians.

use super::{Basis, Candidate, Field, Ranking, ranked_points};
use crate::analysis::answer::Set;
use crate::analysis::compare::Range;
use crate::analysis::replicates::Runs;
use crate::analysis::statistics::Spread;
use crate::input::value::Value;
use crate::job::proportion::Proportion;

impl Field<'_> {
    /// The candidates in their order.
    pub(super) fn ranked(&self, values: &[Vec<Value>]) -> Ranking {
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
                (with, self.sets.iter().filter(has).collect())
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
        let order: Vec<usize> = found.iter().map(|(index, _)| *index).collect();
        for (rank, (_, candidate)) in found.iter_mut().enumerate() {
            // One after it can dominate it: the order decides by differences within the spread, too.
            let first = order.iter().position(|other| self.dominates(*other, order[rank]));
            candidate.dominated_by = first.map(|position| position + 1);
        }
        Ranking {
            basis: self.basis,
            candidates: found.into_iter().map(|(_, candidate)| candidate).collect(),
            sets: self.sets.len(),
            matched: Vec::new(),
            carried: Vec::new(),
            left_out: Vec::new(),
            outside: 0,
            not_ended: 0,
            not_trusted: ranked_points(self).filter(|point| !self.trusted(*point)).count(),
            measure_sets: blocks.iter().map(|(_, sets)| sets.len()).collect(),
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
        let measures = blocks.iter().enumerate().map(|(measure, (with, sets))| {
            let of_points = sets.iter().filter_map(|set| self.value(measure, set, index));
            let spread = Spread::of(of_points).filter(|_| with.contains(&index))?;
            let name = &self.measures[measure].column.name;
            let range = |end: usize| {
                let points = sets.iter().filter_map(|set| set[index]);
                points.filter_map(move |p| Some(self.points.condensed.spread(name, p)?[end]))
            };
            Some(Spread {
                least: range(0).fold(spread.least, f64::min),
                largest: range(2).fold(spread.largest, f64::max),
                ..spread
            })
        });
        Candidate {
            points: points.len(),
            safe: count(&|point| self.points.is_safe(point) == Some(true)),
            deployed: count(&|point| self.points.deploys(point) == Some(true)),
            failed: count(&|point| self.points.condensed.runs[point].failed > 0),
            safe_runs: sum(&|runs| runs.safe),
            deployed_runs: sum(&|runs| runs.deployed),
            missed: self.missed(&points),
            margin: self.worst(&points),
            measures: measures.collect(),
            dominated_by: None,
            values,
        }
    }

    /// A proportion over the runs of some points.
    fn sum(&self, points: &[usize], of: &dyn Fn(&Runs) -> Proportion) -> Proportion {
        let proportions = points.iter().map(|point| of(&self.points.condensed.runs[*point]));
        proportions.fold(Proportion::default(), |sum, one| Proportion {
            met: sum.met + one.met,
            of: sum.of + one.of,
        })
    }

    /// Of all runs of some points, those that are not safe, or without limits those that do not deploy.
    pub(super) fn missed(&self, points: &[usize]) -> Proportion {
        self.sum(points, &|runs| {
            let met = match self.basis {
                Basis::Limits => runs.safe.met,
                Basis::Verdicts => runs.deployed.met,
                Basis::Measures => runs.finest.len(),
            };
            Proportion { met: runs.finest.len() - met, of: runs.finest.len() }
        })
    }

    /// The smallest margin over some points.
    pub(super) fn worst(&self, points: &[usize]) -> Option<(f64, String)> {
        let margins = points.iter().filter_map(|point| self.margins[*point].clone());
        margins.min_by(|a, b| a.0.total_cmp(&b.0))
    }

    fn trusted(&self, point: usize) -> bool {
        self.points.trusted[point]
    }

    /// A trusted value of a measure at the point of a candidate in a set.
    fn value(&self, measure: usize, set: &Set, candidate: usize) -> Option<f64> {
        self.range(measure, set, candidate).map(|range| range[1])
    }

    /// The same with its range over the runs of the point.
    pub(super) fn range(&self, measure: usize, set: &Set, candidate: usize) -> Option<Range> {
        let point = set[candidate].filter(|point| self.trusted(*point))?;
        self.measures[measure].range(self.table, point)
    }

    /// Whether a candidate has a value of a measure in any set.
    pub(super) fn has(&self, measure: usize, candidate: usize) -> bool {
        self.sets.iter().any(|set| self.value(measure, set, candidate).is_some())
    }
}
