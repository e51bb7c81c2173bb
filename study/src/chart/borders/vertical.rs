//! The vertical axis of the chart of borders: the values of the search, with its spacing.

use crate::render::figure::plot::Rule;
use crate::render::figure::scale::Spread;
use crate::study::{Border, Level};

/// Space at both ends of the vertical axis, as a fraction of its length: arrows stand there.
const PADDING: f64 = 0.12;

/// The vertical axis.
pub(super) struct Vertical {
    pub(super) spread: Spread,
    /// Ends of the axis.
    pub(super) range: [f64; 2],
    /// Ends of the search.
    ends: [f64; 2],
}

impl Vertical {
    pub(super) fn new(shown: &[f64], found: &[Option<&Border>]) -> Self {
        let low = shown.iter().copied().fold(f64::INFINITY, f64::min);
        let high = shown.iter().copied().fold(f64::NEG_INFINITY, f64::max);
        let (low, high) = if low < high { (low, high) } else { (0.0, 1.0) };
        let levels = found.iter().flatten().next().map_or(&[][..], |border| &border.levels);
        let spread =
            if is_logarithmic(levels) && low > 0.0 { Spread::Logarithmic } else { Spread::Linear };
        let range = match spread {
            Spread::Linear => {
                let padding = PADDING * (high - low);
                [low - padding, high + padding]
            }
            Spread::Logarithmic => {
                let padding = libm::pow(high / low, PADDING);
                [low / padding, high * padding]
            }
        };
        Self { spread, range, ends: [low, high] }
    }

    /// The ends of the search.
    pub(super) fn rules(&self) -> Vec<Rule> {
        let rule = |value: f64| Rule { value, text: String::new(), closed: None };
        self.ends.map(rule).to_vec()
    }

    /// The middle of an interval on this axis.
    pub(super) fn middle(&self, low: f64, high: f64) -> f64 {
        match self.spread {
            Spread::Logarithmic if low > 0.0 => libm::sqrt(low) * libm::sqrt(high),
            _ => 0.5 * (low + high),
        }
    }
}

/// Whether the levels of a search are spaced evenly in their logarithm: the geometric mean of its ends is a
/// level rather than the arithmetic mean.
fn is_logarithmic(levels: &[Level]) -> bool {
    let (Some(first), Some(last)) = (levels.first(), levels.last()) else { return false };
    let (low, high) = (first.value, last.value);
    let distance = |mean: f64| {
        let gaps = levels.iter().map(|level| (level.value - mean).abs() / mean);
        gaps.fold(f64::INFINITY, f64::min)
    };
    low > 0.0 && distance(libm::sqrt(low * high)) < distance(0.5 * (low + high))
}
