//! One measure over all pairs of the base with one other value.

use std::collections::{BTreeMap, BTreeSet};

use super::{Better, Compared, Measure, Pair, canonical, compared, values};
use crate::analysis::statistics::Spread;
use crate::input::value::Value;
use crate::store::table::Table;

/// One measure over all pairs of the base with one other value. Two pairs of the same two jobs count once.
#[derive(Debug, Clone, PartialEq)]
pub struct Tally {
    /// The other value.
    pub value: Value,
    /// The measure.
    pub measure: String,
    /// Number of pairs of jobs by name of [`Better`]; pending ones included.
    pub counts: BTreeMap<&'static str, usize>,
    /// Ratios of the pairs in which both jobs have the measure; `None` for a signed measure.
    pub ratio: Option<Spread>,
    /// Differences of these pairs.
    pub difference: Option<Spread>,
}

impl Tally {
    /// Counts the pairs of the base with the other value.
    pub fn of(table: &Table, pairs: &[Pair], value: Value, measure: &Measure<'_>) -> Self {
        let pairs = pairs_of_jobs(table, pairs);
        let compared: Vec<Compared> =
            pairs.iter().map(|pair| compared(table, *pair, measure)).collect();
        let mut counts = BTreeMap::new();
        for pair in &compared {
            *counts.entry(pair.better.name()).or_default() += 1;
        }
        let two_jobs = || compared.iter().filter(|pair| pair.better != Better::SameJob);
        Self {
            value,
            measure: measure.column.name.clone(),
            counts,
            ratio: Spread::of(two_jobs().filter_map(Compared::ratio)),
            difference: Spread::of(two_jobs().filter_map(Compared::difference)),
        }
    }

    /// Number of pairs with this result.
    pub fn count(&self, better: Better) -> usize {
        self.counts.get(better.name()).copied().unwrap_or(0)
    }

    /// Number of pairs of two jobs that have ended.
    pub fn pairs(&self) -> usize {
        self.counts.values().sum::<usize>()
            - self.count(Better::Pending)
            - self.count(Better::SameJob)
    }
}

/// The pairs of different jobs, each once: the first of several pairs of points that are the same two
/// jobs.
pub fn pairs_of_jobs(table: &Table, pairs: &[Pair]) -> Vec<Pair> {
    let Some(ids) = table.column("job") else { return pairs.to_vec() };
    let id = |row: usize| ids.cells[row].to_string();
    let mut seen = BTreeSet::new();
    let is_new = |pair: &&Pair| seen.insert((id(pair.base), id(pair.other)));
    pairs.iter().filter(is_new).copied().collect()
}

/// Counts pairs by other value and measure.
pub fn tallies(table: &Table, pairs: &[Pair], by: &str, measures: &[Measure<'_>]) -> Vec<Tally> {
    let Some(column) = table.column(by) else { return Vec::new() };
    let others: Vec<usize> = pairs.iter().map(|pair| pair.other).collect();
    let mut tallies = Vec::new();
    for value in values(column, &others) {
        let is_value = |pair: &&Pair| canonical(&column.cells[pair.other]) == canonical(&value);
        let of_value: Vec<Pair> = pairs.iter().filter(is_value).copied().collect();
        let of_measure = |measure| Tally::of(table, &of_value, value.clone(), measure);
        tallies.extend(measures.iter().map(of_measure));
    }
    tallies
}
