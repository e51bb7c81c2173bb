//! The search of a border: the value of one parameter at which a verdict, or a limit, changes.
//!
//! ```text
//! first generation:  five values from low to high, evenly spaced (or in their logarithm)
//! next generation:   the middle of the interval in which the outcome changes
//! end:               interval ≤ tolerance, no change, or more than one change ("not monotone")
//! ```
//! With replicates an outcome counts where the Wilson interval of k of n does not contain one half; the
//! border is then the interval between the nearest such values of both outcomes.

mod levels;
mod read;
pub(crate) mod replay;

pub use levels::{Border, Level, SearchResult};
pub(super) use read::is_search;

use crate::input::value::Value;
use crate::job::result_limit::ResultLimit;

/// Number of values with which a search begins. Chosen: enough to see that an outcome changes twice.
const SCAN: usize = 5;

/// A search along one axis.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct Search {
    /// Position of its column in the grid.
    pub column: usize,
    /// Smallest and largest value, SI.
    pub ends: [f64; 2],
    /// Spacing of the values.
    pub spacing: Spacing,
    /// What must hold.
    pub criterion: Criterion,
    /// Width of the interval at which the search ends, as a fraction: of `high − low`; with logarithmic spacing
    /// of the value.
    pub tolerance: f64,
    /// Whether the key holds whole numbers.
    pub integer: bool,
}

/// Spacing of the values of a search.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Spacing {
    /// Even.
    Linear,
    /// Even in the logarithm.
    Log,
}

/// What must hold on one side of the border.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Criterion {
    /// The verdict is `deployed`.
    Deployed,
    /// The limit at this position is met.
    Limit(usize),
    /// Every limit is met.
    Safe,
}

impl Criterion {
    /// What must hold, as text: `safe`, `deployed`, `peak_vz < 25 m/s`. `limits` are those of the study.
    pub fn text(self, limits: &[ResultLimit]) -> String {
        match self {
            Self::Deployed => "deployed".to_owned(),
            Self::Safe => "safe".to_owned(),
            Self::Limit(index) => limits.get(index).map_or_else(String::new, ToString::to_string),
        }
    }
}

impl Search {
    /// A value of the key.
    pub fn value(&self, number: f64) -> Value {
        #[expect(clippy::cast_possible_truncation, reason = "whole numbers of a key")]
        if self.integer { Value::Integer(number as i64) } else { Value::Number(number) }
    }

    /// The values with which the search begins.
    pub fn scan(&self) -> Vec<f64> {
        let [low, high] = self.ends;
        let inner = (1..SCAN - 1).map(|index| {
            let fraction = index as f64 / (SCAN - 1) as f64;
            self.rounded(match self.spacing {
                Spacing::Linear => low + fraction * (high - low),
                Spacing::Log => low * libm::pow(high / low, fraction),
            })
        });
        let mut values: Vec<f64> = std::iter::once(low).chain(inner).chain([high]).collect();
        values.dedup();
        values
    }

    /// The value between two others at which the search goes on; `None` where the interval is as small as
    /// asked for.
    pub fn middle(&self, low: f64, high: f64) -> Option<f64> {
        let (reached, middle) = match self.spacing {
            Spacing::Linear => (high - low <= self.resolution(low), 0.5 * low + 0.5 * high),
            Spacing::Log => {
                (high <= low * (1.0 + self.tolerance), libm::sqrt(low) * libm::sqrt(high))
            }
        };
        let middle = self.rounded(middle);
        (!reached && low < middle && middle < high).then_some(middle)
    }

    /// Largest number of values of one search after its scan, where one end of the border moves.
    pub fn most_values_after_scan(&self) -> usize {
        self.scan().windows(2).map(|ends| self.most_between(ends[0], ends[1])).max().unwrap_or(0)
    }

    fn most_between(&self, low: f64, high: f64) -> usize {
        let Some(middle) = self.middle(low, high) else { return 0 };
        let above = self.most_between(middle, high);
        // Halves of whole numbers differ; others do not.
        let below = if self.integer { self.most_between(low, middle) } else { 0 };
        1 + above.max(below)
    }

    /// A whole number where the key has them; otherwise four significant digits, where the interval is much
    /// wider.
    fn rounded(&self, value: f64) -> f64 {
        if self.integer {
            return libm::round(value);
        }
        let short = format!("{value:.3e}").parse().unwrap_or(value);
        if (short - value).abs() <= 0.01 * self.resolution(value) { short } else { value }
    }

    /// Width of the interval at which the search ends, near a value.
    fn resolution(&self, value: f64) -> f64 {
        self.tolerance
            * match self.spacing {
                Spacing::Linear => self.ends[1] - self.ends[0],
                Spacing::Log => value,
            }
    }
}
