//! Which values and sets have comparable medians, and which of these are the best and the worst.
//!
//! Of all choices of values, the one with the most independent comparisons is taken:
//!
//! ```text
//! (values − 1) · sets → max
//! ```

use serde::{Deserialize, Serialize};

use crate::analysis::compare::{Measure, Range};
use crate::job::row::BetterSide;

/// One row of a set per value of the parameter.
pub(in crate::analysis) type Set = Vec<Option<usize>>;

/// The best and the worst values of a parameter by one measure: positions in `Effect::values`, the
/// extreme one first, then those that are equal to it up to the tolerance.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, Deserialize)]
pub enum Extremes {
    /// All medians are equal up to the tolerance.
    Equal,
    /// The measure has a better side. `best` is empty when no value deploys in all its jobs.
    Judged {
        /// The values with the best medians of those that deploy in all their jobs.
        best: Vec<usize>,
        /// The values with the worst medians.
        worst: Vec<usize>,
    },
    /// Neither side is better, or no spread of the measure is known.
    Range {
        /// The values with the lowest medians.
        lowest: Vec<usize>,
        /// The values with the highest medians.
        highest: Vec<usize>,
    },
}

/// The values and the sets with the most independent comparisons, of those sets in which every one of these
/// values has a job; `None` when no set has two values.
pub(in crate::analysis) fn block(sets: &[Set], values: usize) -> Option<(Vec<usize>, Vec<&Set>)> {
    let number = |index: &usize| sets.iter().filter(|set| set[*index].is_some()).count();
    let mut order: Vec<usize> = (0..values).collect();
    // The sort is stable: values of equally many sets stay in plan order.
    order.sort_by_key(|index| std::cmp::Reverse(number(index)));
    let mut complete: Vec<&Set> = sets.iter().collect();
    let mut best: Option<(usize, usize)> = None;
    for (others, index) in order.iter().enumerate() {
        complete.retain(|set| set[*index].is_some());
        let comparisons = others * complete.len();
        if comparisons > 0 && best.is_none_or(|(_, most)| comparisons >= most) {
            best = Some((others + 1, comparisons));
        }
    }
    let (number, _) = best?;
    let chosen = order[..number].to_vec();
    let block = sets.iter().filter(|set| chosen.iter().all(|index| set[*index].is_some()));
    Some((chosen.clone(), block.collect()))
}

/// The best and the worst of some medians with their ranges. `always` says which values deploy in all their
/// jobs.
pub(super) fn extremes(
    ranges: &[Option<Range>],
    measure: &Measure<'_>,
    always: &[bool],
    side: BetterSide,
) -> Extremes {
    let mut order: Vec<(usize, Range)> =
        ranges.iter().enumerate().filter_map(|(index, range)| Some((index, (*range)?))).collect();
    order.sort_by(|a, b| a.1[1].total_cmp(&b.1[1]));
    let (Some(lowest), Some(highest)) = (order.first(), order.last()) else {
        return Extremes::Equal;
    };
    let equals = |a: &(usize, Range), b: &(usize, Range)| measure.are_equal(a.1, b.1);
    if order.iter().all(|value| equals(lowest, value) && equals(highest, value)) {
        return Extremes::Equal;
    }
    let tied = |order: &mut dyn Iterator<Item = &(usize, Range)>| -> Vec<usize> {
        let Some(extreme) = order.next() else { return Vec::new() };
        let equal = order.filter(|value| equals(extreme, value));
        [extreme.0].into_iter().chain(equal.map(|(index, _)| *index)).collect()
    };
    let deploys = |entry: &&(usize, Range)| always[entry.0];
    let (lowest, highest) = (tied(&mut order.iter()), tied(&mut order.iter().rev()));
    match side {
        BetterSide::Smaller => {
            let best = tied(&mut order.iter().filter(deploys));
            Extremes::Judged { best, worst: highest }
        }
        BetterSide::Larger => {
            let best = tied(&mut order.iter().rev().filter(deploys));
            Extremes::Judged { best, worst: lowest }
        }
        BetterSide::Neither => Extremes::Range { lowest, highest },
    }
}
