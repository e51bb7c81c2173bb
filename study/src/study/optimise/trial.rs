//! The points of a search, and which are the best.

use std::cmp::Ordering;

use crate::input::value::Value;
use crate::job::JobId;

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
    /// For each limit the margin of the run that is nearest to it or farthest beyond, its known uncertainty taken off, between
    /// −1 and 1; `None` where a run cannot be judged.
    pub margins: Vec<Option<f64>>,
    /// Whether every run has a result, and keeps every limit as far as is known.
    pub keeps_limits: bool,
    /// What it varies that is at an end of its range, and whether that is the upper one.
    pub at_end: Vec<(String, bool)>,
    /// Whether all of its runs have ended.
    pub ended: bool,
}

impl Trial {
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
    /// The smallest value that a surrogate expects of as many points spread evenly; `None` for two measures.
    pub of_even_points: Option<f64>,
    /// Number of points in all.
    pub budget: usize,
    /// Whether no other point is to be tried: the budget is used up, or all others are refused or are jobs that it knows.
    pub ended: bool,
}

/// The order of two measures, those that are not known last.
fn by_measure(a: Option<f64>, b: Option<f64>) -> Ordering {
    a.unwrap_or(f64::INFINITY).total_cmp(&b.unwrap_or(f64::INFINITY))
}

/// The best of the points that keep the limits: in order, or the front of two measures.
pub(super) fn best(trials: &[Trial]) -> Vec<usize> {
    let mut kept: Vec<usize> = (0..trials.len()).filter(|k| trials[*k].keeps_limits).collect();
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
    let mut front: Vec<usize> = kept
        .iter()
        .copied()
        .filter(|k| !kept.iter().any(|other| other != k && dominates(other, k)))
        .collect();
    front.sort_by(|a, b| by_measure(measures(a)[0], measures(b)[0]));
    front
}
