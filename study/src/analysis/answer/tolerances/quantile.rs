//! Quantiles of a sample with their intervals, whatever its distribution.
//!
//! ```text
//! quantile p    x_(⌈np⌉) of the sorted values; interval x_(l) to x_(u) with P(l ≤ Bin(n, p) < u) ≥ 95 %
//! ```

use serde::Serialize;

/// Probability that an interval misses on each side.
const MISSED: f64 = 0.025;

/// A quantile of a measure.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
pub struct Quantile {
    /// The part of the values below it.
    pub p: f64,
    /// The value, SI.
    pub value: f64,
    /// Its interval, 95 %, SI; `None` at an end where too few samples give none.
    pub between: [Option<f64>; 2],
}

impl Quantile {
    /// Of sorted values; `samples` of them are independent.
    pub(super) fn of(sorted: &[f64], p: f64, samples: usize) -> Self {
        let at = |rank: f64| {
            #[expect(
                clippy::cast_possible_truncation,
                clippy::cast_sign_loss,
                reason = "at least 0"
            )]
            let index = (rank.max(0.0) as usize).min(sorted.len() - 1);
            sorted[index]
        };
        let (n, all) = (samples as f64, sorted.len() as f64);
        let [low, high] = ranks(samples, p);
        // Ranks of the samples among all values.
        let place = |rank: usize| at((rank as f64 - 0.5) / n * all);
        Self {
            p,
            value: at(libm::ceil(all * p) - 1.0),
            between: [low.map(place), high.filter(|rank| *rank <= samples).map(place)],
        }
    }
}

/// Ranks l and u, from 1, between whose values a quantile of `n` values is in 19 of 20 cases: P(Bin(n, p) < l) and
/// P(Bin(n, p) ≥ u) are at most 2.5 %.
pub(super) fn ranks(n: usize, p: f64) -> [Option<usize>; 2] {
    // The logarithm of P(Bin = k): of many samples the probabilities at the ends are below the smallest f64.
    let mut term = n as f64 * libm::log1p(-p);
    let odds = libm::log(p / (1.0 - p));
    let mut below = 0.0;
    let (mut low, mut high) = (None, None);
    for k in 0..=n {
        // `below` is P(Bin < k).
        if below <= MISSED && k > 0 {
            low = Some(k);
        }
        if high.is_none() && 1.0 - below <= MISSED {
            high = Some(k);
        }
        below += libm::exp(term);
        term += libm::log((n - k) as f64 / (k + 1) as f64) + odds;
    }
    [low, high]
}
