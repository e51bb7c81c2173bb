//! Which of two candidates comes first.
//!
//! Margins and medians are compared to nine significant digits, so that rounding errors decide nothing. Values
//! that are rounded first stay transitive, as an order must be; values equal within a tolerance are not.

use std::cmp::Ordering;

use super::{Basis, Candidate, Field, penalty};
use crate::job::proportion::Proportion;

/// Significant digits of the margins and medians that order candidates. Chosen: far above rounding errors.
const DIGITS: usize = 9;

impl Field<'_> {
    /// The order of two candidates, the better one first.
    pub(super) fn compare(&self, a: &Candidate, b: &Candidate) -> Ordering {
        let not_safe = |c: &Candidate| c.points - c.safe;
        let not_deployed = |c: &Candidate| c.points - c.deployed;
        let first = match self.basis {
            Basis::Limits => not_safe(a).cmp(&not_safe(b)).then_with(|| missed(a.missed, b.missed)),
            Basis::Verdicts => {
                not_deployed(a).cmp(&not_deployed(b)).then_with(|| missed(a.missed, b.missed))
            }
            Basis::Measures => a.failed.cmp(&b.failed),
        };
        first.then_with(|| self.measures(a, b))
    }

    /// By the medians of the measures, one after the other, the smallest margin among them where it is asked for. A candidate
    /// without a value comes last.
    fn measures(&self, a: &Candidate, b: &Candidate) -> Ordering {
        let penalties = |one: &Candidate| -> Vec<Option<f64>> {
            let medians = self.measures.iter().zip(&one.measures);
            let medians =
                medians.map(|(measure, spread)| Some(penalty(measure, spread.as_ref()?.median)));
            let mut all: Vec<Option<f64>> = medians.collect();
            if let Some(place) = self.margin_at {
                all.insert(place, one.margin.as_ref().map(|(margin, _)| -margin));
            }
            all
        };
        let orders = penalties(a).into_iter().zip(penalties(b)).map(|pair| match pair {
            (Some(a), Some(b)) => rounded(a).total_cmp(&rounded(b)),
            (a, b) => b.is_some().cmp(&a.is_some()),
        });
        orders.fold(Ordering::Equal, Ordering::then)
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
