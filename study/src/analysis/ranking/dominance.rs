//! Whether one candidate is not worse than another one in anything, and better in something.

use super::order::missed;
use super::{Basis, Field, is_better};
use crate::analysis::compare::{ROUNDING, Range, median_range};
use crate::job::result_limit::Condition;

/// How one candidate stands to another one in one quantity.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum Stands {
    Better,
    Equal,
    Worse,
}

impl Field<'_> {
    /// Whether a candidate dominates another one, over the sets of both.
    pub(super) fn dominates(&self, a: usize, b: usize) -> bool {
        let first = match self.basis {
            Basis::Limits => vec![
                self.by_number(a, b, &|point| self.points.is_safe(point)),
                self.by_runs(a, b),
                self.by_margin(a, b),
            ],
            Basis::Verdicts => {
                vec![self.by_number(a, b, &|point| self.points.deploys(point)), self.by_runs(a, b)]
            }
            Basis::Measures => Vec::new(),
        };
        let measures = (0..self.measures.len()).map(|measure| self.by_measure(measure, a, b));
        let all: Vec<Stands> = first.into_iter().chain(measures).collect();
        !all.contains(&Stands::Worse) && all.contains(&Stands::Better)
    }

    /// The points of a candidate.
    fn of(&self, candidate: usize) -> Vec<usize> {
        self.sets.iter().filter_map(|set| set[candidate]).collect()
    }

    /// By the number of points for which a condition holds.
    fn by_number(&self, a: usize, b: usize, holds: &dyn Fn(usize) -> Option<bool>) -> Stands {
        let number = |candidate| {
            self.of(candidate).into_iter().filter(|point| holds(*point) == Some(true)).count()
        };
        let (a, b) = (number(a), number(b));
        stands(a > b, a == b)
    }

    /// By the proportion of runs that are not safe, or do not deploy.
    fn by_runs(&self, a: usize, b: usize) -> Stands {
        let order = missed(self.missed(&self.of(a)), self.missed(&self.of(b)));
        stands(order.is_lt(), order.is_eq())
    }

    /// By the worst margin, up to the spread of its measure.
    fn by_margin(&self, a: usize, b: usize) -> Stands {
        match (self.worst(&self.of(a)), self.worst(&self.of(b))) {
            (Some((a, of_a)), Some((b, of_b))) => {
                let width = f64::max(self.margin_width(a, &of_a), self.margin_width(b, &of_b));
                stands(a > b, (a - b).abs() <= width)
            }
            (a, b) => stands(a.is_some(), a.is_some() == b.is_some()),
        }
    }

    /// Up to which difference margins are equal: the spread of the measure, as far from the bound as its value.
    fn margin_width(&self, margin: f64, measure: &str) -> f64 {
        let tolerance = self.measures.iter().find(|known| known.column.name == measure);
        let limit = self.limits.iter().find(|limit| limit.measure.name() == measure);
        match (tolerance, limit.map(|limit| &limit.condition)) {
            (Some(measure), Some(Condition::Bound { bound, above, .. }))
                if *bound > 0.0 && !measure.tolerance.absolute =>
            {
                let over_bound = if *above { 1.0 + margin } else { 1.0 - margin };
                measure.tolerance.limit * over_bound.abs()
            }
            _ => ROUNDING,
        }
    }

    /// By the medians of a measure over the sets in which both have it. Having it is better than not.
    fn by_measure(&self, measure: usize, a: usize, b: usize) -> Stands {
        let (of_a, of_b): (Vec<Range>, Vec<Range>) = self
            .sets
            .iter()
            .filter_map(|set| Some((self.range(measure, set, a)?, self.range(measure, set, b)?)))
            .unzip();
        if let (Some(a), Some(b)) = (median_range(&of_a), median_range(&of_b)) {
            let measure = &self.measures[measure];
            return stands(is_better(measure, a[1], b[1]), measure.are_equal(a, b));
        }
        match (self.has(measure, a), self.has(measure, b)) {
            // In different sets: nothing can be said, so nothing is dominated.
            (true | false, true) => Stands::Worse,
            (true, false) => Stands::Better,
            (false, false) => Stands::Equal,
        }
    }
}

fn stands(better: bool, equal: bool) -> Stands {
    match (equal, better) {
        (true, _) => Stands::Equal,
        (false, true) => Stands::Better,
        (false, false) => Stands::Worse,
    }
}
