//! Which of two candidates comes first.
//!
//! Margins and medians are compared to nine significant digits, so that rounding errors decide nothing. Values
//! that are rounded first stay transitive, as an order must be; values equal within a tolerance are not.

use std::cmp::Ordering;

use super::{Basis, Candidate, Field, is_better};
use crate::job::proportion::Proportion;

/// Significant digits of the margins and medians that order candidates. Chosen: far above rounding errors.
const DIGITS: usize = 9;

impl Field<'_> {
    /// The order of two candidates, the better one first.
    pub(super) fn compare(&self, a: &Candidate, b: &Candidate) -> Ordering {
        let not_safe = |c: &Candidate| c.points - c.safe;
        let not_deployed = |c: &Candidate| c.points - c.deployed;
        let first = match self.basis {
            Basis::Limits => {
                let points = not_safe(a).cmp(&not_safe(b));
                points.then_with(|| missed(a.missed, b.missed)).then_with(|| margins(a, b))
            }
            Basis::Verdicts => {
                not_deployed(a).cmp(&not_deployed(b)).then_with(|| missed(a.missed, b.missed))
            }
            Basis::Measures => a.failed.cmp(&b.failed),
        };
        first.then_with(|| self.measures(a, b))
    }

    /// By the medians of the measures, one after the other. A candidate without a median comes last.
    fn measures(&self, a: &Candidate, b: &Candidate) -> Ordering {
        let medians =
            |c: &Candidate, index: usize| c.measures[index].map(|spread| rounded(spread.median));
        let orders = self.measures.iter().enumerate().map(|(index, measure)| {
            match (medians(a, index), medians(b, index)) {
                (Some(a), Some(b)) if is_better(measure, a, b) => Ordering::Less,
                (Some(a), Some(b)) if is_better(measure, b, a) => Ordering::Greater,
                (a, b) => b.is_some().cmp(&a.is_some()),
            }
        });
        orders.fold(Ordering::Equal, Ordering::then)
    }
}

/// By the worst margin, the larger one first. A candidate without one comes last.
fn margins(a: &Candidate, b: &Candidate) -> Ordering {
    match (&a.margin, &b.margin) {
        (Some((a, _)), Some((b, _))) => rounded(*b).total_cmp(&rounded(*a)),
        (a, b) => b.is_some().cmp(&a.is_some()),
    }
}

/// By the proportion of runs that miss, the smaller one first: k₁/n₁ against k₂/n₂, without division.
fn missed(a: Proportion, b: Proportion) -> Ordering {
    (a.met * b.of).cmp(&(b.met * a.of))
}

/// A number to nine significant digits; −0 is 0.
fn rounded(number: f64) -> f64 {
    format!("{number:.*e}", DIGITS - 1).parse().unwrap_or(number) + 0.0
}
