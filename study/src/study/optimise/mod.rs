//! The section `optimise` of a study: a search of the point with the smallest measure that keeps the limits.
//!
//! ```text
//! first generation:  points of the Sobol' sequence: 2 (inputs + 1), at least 8; of film, of which the model of storeys
//!                    says something before it runs (prior.rs), inputs + 1, at least 4
//! next generation:   a batch of points, each the one where a surrogate expects most (acquisition.rs), until the budget is
//!                    used up
//! then:              the best point on two finer meshes; where it does not keep the limits there, the next best
//! ```
//! A point counts by the median of its runs, and keeps a limit if every run does, its known uncertainty counted.

mod acquisition;
mod expected;
mod prior;
mod proposed;
mod read;
mod replay;
mod trial;

use crate::input::value::Value;
use crate::job::row::ColumnId;
use crate::surrogate::Coordinate;

pub(in crate::study) use prior::POINTS as PRIOR_POINTS;
pub use proposed::Proposed;
pub(crate) use replay::Replay;
pub use trial::{Optimum, Trial};

/// Points of the first generation at least, without a prior and with one.
const MIN_FIRST: usize = 8;
const MIN_FIRST_WITH_PRIOR: usize = 4;

/// A search of an optimum.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct Optimise {
    /// What it makes small: one measure, or two of which neither is sacrificed.
    pub minimise: Vec<ColumnId>,
    /// Positions of the columns of the grid that it varies.
    pub columns: Vec<usize>,
    /// The range of each.
    pub coordinates: Vec<Coordinate>,
    /// Number of points in all.
    pub budget: usize,
    /// Number of points of a generation after the first.
    pub batch: usize,
    /// Another seed gives other points.
    pub seed: u32,
    /// Whether a cheap model says something of its points before they run.
    pub has_prior: bool,
}

impl Optimise {
    /// Number of points of the first generation.
    pub fn first(&self) -> usize {
        let inputs = self.columns.len();
        let first = if self.has_prior {
            (inputs + 1).max(MIN_FIRST_WITH_PRIOR)
        } else {
            (2 * (inputs + 1)).max(MIN_FIRST)
        };
        first.min(self.budget)
    }

    /// The values of a point of the unit cube.
    fn values(&self, point: &[f64]) -> Vec<Value> {
        self.coordinates.iter().zip(point).map(|(of, place)| of.value(*place)).collect()
    }

    /// The place of these values.
    fn place(&self, values: &[Value]) -> Vec<f64> {
        self.coordinates.iter().zip(values).map(|(of, value)| of.place(value)).collect()
    }

    /// The values of what it varies among those of all columns.
    fn varied(&self, values: &[Value]) -> Vec<Value> {
        self.columns.iter().map(|column| values[*column].clone()).collect()
    }

    /// The first points: those of the Sobol' sequence, each once.
    pub fn first_values(&self) -> Vec<Vec<Value>> {
        let mut all: Vec<Vec<Value>> = Vec::new();
        for values in sobol(self.columns.len(), self.seed)
            .map(|point| self.values(&point))
            .take(64 * self.budget)
        {
            if all.len() == self.first() {
                break;
            }
            if !all.contains(&values) {
                all.push(values);
            }
        }
        all
    }
}

/// Points of the scrambled Sobol' sequence.
fn sobol(inputs: usize, seed: u32) -> impl Iterator<Item = Vec<f64>> {
    #[expect(clippy::cast_possible_truncation, reason = "at most 16 inputs")]
    let inputs = inputs as u32;
    let point = move |k| (0..inputs).map(|j| f64::from(sobol_burley::sample(k, j, seed))).collect();
    (0..1 << 16).map(point)
}

#[cfg(test)]
mod tests;
