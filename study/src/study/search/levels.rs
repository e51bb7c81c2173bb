//! What is known along one search: the outcome at each value, the border, the next values to run.

use super::Search;
use crate::input::value::Value;
use crate::job::proportion::Proportion;

/// One value of a search, with its runs.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Level {
    /// The value, SI.
    pub value: f64,
    /// Of the runs that can be judged: how many meet the criterion.
    pub met: Proportion,
    /// Number of those that may meet it within their uncertainty.
    pub uncertain: usize,
    /// Number of runs that ended and cannot be judged: failed, infeasible, without the measure.
    pub not_judged: usize,
    /// Number of runs that have not ended.
    pub open: usize,
}

impl Level {
    /// The outcome, where it is decided: one run decides alone, several by the Wilson interval.
    pub fn outcome(&self, replicates: usize) -> Option<bool> {
        let sure = |proportion: Proportion| {
            if replicates > 1 { proportion.majority() } else { Some(proportion.met > 0) }
        };
        // Runs within their uncertainty speak for neither side.
        let may = Proportion { met: self.met.met + self.uncertain, ..self.met };
        match (sure(self.met), sure(may)) {
            _ if self.met.of == 0 => None,
            (Some(true), _) => Some(true),
            (_, Some(false)) => Some(false),
            _ => None,
        }
    }
}

/// What a search found.
#[derive(Debug, Clone, PartialEq)]
pub enum SearchResult {
    /// Some of its runs have not ended.
    Open,
    /// The outcome changes once, in this interval.
    Border {
        /// The nearest value below at which the outcome is decided.
        low: f64,
        /// The nearest value above.
        high: f64,
        /// Whether the criterion is met below the border.
        met_below: bool,
    },
    /// The outcome changes more than once, in these intervals.
    NotMonotone(Vec<[f64; 2]>),
    /// The outcome is the same at every value at which it is decided.
    NoChange {
        /// Whether the criterion is met.
        met: bool,
    },
    /// The outcome is decided at no value.
    Undecided,
}

/// The search along one axis, all other parameters being equal.
#[derive(Debug, Clone, PartialEq)]
pub struct Border {
    /// The other parameters, without replicates.
    pub parameters: Vec<(String, Value)>,
    /// Its values, from the smallest to the largest.
    pub levels: Vec<Level>,
    /// What it found.
    pub outcome: SearchResult,
    /// Whether the filter of the study removed a value that the search needed: it ended there.
    pub filtered: bool,
}

/// The outcome of these levels, in order of their values.
pub(super) fn outcome(levels: &[Level], replicates: usize) -> SearchResult {
    if levels.iter().any(|level| level.open > 0) {
        return SearchResult::Open;
    }
    let decided: Vec<(f64, bool)> =
        levels.iter().filter_map(|level| Some((level.value, level.outcome(replicates)?))).collect();
    let changes: Vec<[f64; 2]> = decided
        .windows(2)
        .filter(|pair| pair[0].1 != pair[1].1)
        .map(|pair| [pair[0].0, pair[1].0])
        .collect();
    match (changes.as_slice(), decided.first()) {
        (_, None) => SearchResult::Undecided,
        ([], Some((_, met))) => SearchResult::NoChange { met: *met },
        ([[low, high]], Some((_, met))) => {
            SearchResult::Border { low: *low, high: *high, met_below: *met }
        }
        _ => SearchResult::NotMonotone(changes),
    }
}

/// The values to run next, in increasing order; none where the search has ended. Where one outcome alone is decided, the
/// ends of its range move towards the values that are not: up to there something is known.
pub(super) fn next(search: &Search, levels: &[Level], replicates: usize) -> Vec<f64> {
    let [low, high] = match outcome(levels, replicates) {
        SearchResult::Border { low, high, .. } => [low, high],
        SearchResult::NoChange { .. } => {
            let decided = levels.iter().map(|level| level.outcome(replicates).is_some());
            let decided: Vec<bool> = decided.collect();
            let ends = levels.windows(2).zip(decided.windows(2));
            let ends = ends.filter(|(_, decided)| decided[0] != decided[1]).map(|(pair, _)| pair);
            return ends.filter_map(|pair| search.middle(pair[0].value, pair[1].value)).collect();
        }
        _ => return Vec::new(),
    };
    let inside =
        levels.iter().map(|level| level.value).filter(|value| low < *value && *value < high);
    let inside: Vec<f64> = inside.collect();
    let intervals = match inside.as_slice() {
        [] => vec![[low, high]],
        // Values between them are not decided: each end moves towards them.
        [first, .., last] => vec![[low, *first], [*last, high]],
        [only] => vec![[low, *only], [*only, high]],
    };
    intervals.into_iter().filter_map(|[low, high]| search.middle(low, high)).collect()
}

#[cfg(test)]
mod tests {
    use super::super::{Criterion, Spacing};
    use super::*;

    fn search(tolerance: f64, spacing: Spacing) -> Search {
        let criterion = Criterion::Deployed;
        let ends = [1.0, 9.0];
        Search { column: 0, ends, spacing, criterion, tolerance, integer: false }
    }

    /// Runs a search against a rule: number of runs of `replicates` that meet the criterion at a value.
    fn run(search: &Search, replicates: usize, rule: &dyn Fn(f64) -> usize) -> Vec<Level> {
        let level = |value: f64| Level {
            value,
            met: Proportion { met: rule(value), of: replicates },
            uncertain: 0,
            not_judged: 0,
            open: 0,
        };
        let mut levels: Vec<Level> = search.scan().into_iter().map(level).collect();
        for _ in 0..100 {
            let new = next(search, &levels, replicates);
            if new.is_empty() {
                break;
            }
            levels.extend(new.into_iter().map(level));
            levels.sort_by(|a, b| a.value.total_cmp(&b.value));
        }
        levels
    }

    #[test]
    fn a_search_encloses_the_border_within_its_tolerance() {
        for (tolerance, spacing) in
            [(0.0125, Spacing::Linear), (0.01, Spacing::Linear), (0.02, Spacing::Log)]
        {
            for border in [1.001, 2.7, 5.0, 8.99] {
                let search = search(tolerance, spacing);
                let levels = run(&search, 1, &|value| usize::from(value > border));
                let SearchResult::Border { low, high, met_below } = outcome(&levels, 1) else {
                    panic!("no border at {border}")
                };
                assert!(low <= border && border < high && !met_below, "{border}: {low} to {high}");
                assert!(high - low <= 0.19, "{border}: {low} to {high}");
                assert!(
                    levels.len() <= 5 + search.most_values_after_scan(),
                    "{border}: {}",
                    levels.len()
                );
                assert!(levels.len() < 13, "{border}: {}", levels.len());
            }
        }
    }

    #[test]
    fn replicates_give_the_interval_in_which_one_half_lies() {
        // Five of five below 4, none above 6, three between.
        let rule = |value: f64| {
            if value < 4.0 {
                5
            } else if value > 6.0 {
                0
            } else {
                3
            }
        };
        let search = search(0.0125, Spacing::Linear);
        let levels = run(&search, 5, &rule);
        let SearchResult::Border { low, high, met_below } = outcome(&levels, 5) else { panic!() };
        assert!(met_below && low < 4.0 && high > 6.0);
        assert!(4.0 - low <= 0.1 && high - 6.0 <= 0.1, "{low} to {high}");
    }

    #[test]
    fn what_changes_twice_is_not_monotone_and_what_never_changes_has_no_border() {
        let search = search(0.0125, Spacing::Linear);
        let twice = run(&search, 1, &|value| usize::from((3.0..6.0).contains(&value)));
        assert_eq!(outcome(&twice, 1), SearchResult::NotMonotone(vec![[1.0, 3.0], [5.0, 7.0]]));
        assert_eq!(twice.len(), 5, "no more jobs");
        let never = run(&search, 1, &|_| 1);
        assert_eq!((outcome(&never, 1), never.len()), (SearchResult::NoChange { met: true }, 5));
        let mixed = run(&search, 5, &|_| 3);
        assert_eq!((outcome(&mixed, 5), mixed.len()), (SearchResult::Undecided, 5));
        // All of five below 4, then no longer decided: the end of what is known is found.
        let partly = run(&search, 5, &|value| if value < 4.0 { 5 } else { 3 });
        assert_eq!(outcome(&partly, 5), SearchResult::NoChange { met: true });
        let decided = partly.iter().filter(|level| level.outcome(5).is_some());
        let end = decided.map(|level| level.value).fold(0.0, f64::max);
        assert!(4.0 - end <= 0.1 && end < 4.0 && partly.len() < 13, "{end} {}", partly.len());
    }

    #[test]
    fn runs_that_cannot_be_judged_decide_nothing_and_open_ones_wait() {
        let mut levels = run(&search(0.375, Spacing::Linear), 1, &|value| usize::from(value > 4.0));
        levels[1].met = Proportion::default();
        levels[1].not_judged = 1;
        let search = search(0.0125, Spacing::Linear);
        assert_eq!(
            outcome(&levels, 1),
            SearchResult::Border { low: 1.0, high: 5.0, met_below: false }
        );
        assert_eq!(next(&search, &levels, 1), [2.0, 4.0]);
        levels[4].open = 1;
        assert_eq!((outcome(&levels, 1), next(&search, &levels, 1)), (SearchResult::Open, vec![]));
    }
}
