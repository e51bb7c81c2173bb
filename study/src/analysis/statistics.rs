//! Statistics of a list of numbers: count, smallest, median, largest.
//!
//! ```text
//! median of x₁ ≤ … ≤ xₙ:   x_(n+1)/2 for odd n,   ½ (x_n/2 + x_n/2+1) for even n
//! ```

/// Statistics of a list of numbers.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Spread {
    /// Number of values.
    pub count: usize,
    /// The smallest value.
    pub least: f64,
    /// The middle value, or the mean of the two middle values.
    pub median: f64,
    /// The largest value.
    pub largest: f64,
}

impl Spread {
    /// Statistics of numbers in any order. NaN is ignored. `None` without numbers.
    pub fn of(numbers: impl IntoIterator<Item = f64>) -> Option<Self> {
        let mut sorted: Vec<f64> = numbers.into_iter().filter(|number| !number.is_nan()).collect();
        sorted.sort_by(f64::total_cmp);
        let (least, largest) = (*sorted.first()?, *sorted.last()?);
        let middle = sorted.len() / 2;
        let median = if sorted.len() % 2 == 1 {
            sorted[middle]
        } else {
            // Halved first: the sum of two large numbers could overflow.
            0.5 * sorted[middle - 1] + 0.5 * sorted[middle]
        };
        Some(Self { count: sorted.len(), least, median, largest })
    }
}

#[cfg(test)]
mod tests {
    use proptest::prelude::*;

    use super::*;

    #[test]
    #[expect(clippy::float_cmp, reason = "these values are exact")]
    fn the_median_ignores_nan_and_does_not_overflow() {
        assert_eq!(Spread::of([]), None);
        assert_eq!(Spread::of([f64::NAN]), None);
        assert_eq!(Spread::of([3.0, 1.0, 2.0]).unwrap().median, 2.0);
        assert_eq!(Spread::of([4.0, 1.0, 2.0, f64::NAN, 3.0]).unwrap().median, 2.5);
        assert_eq!(Spread::of([f64::MAX, f64::MAX]).unwrap().median, f64::MAX);
    }

    proptest! {
        /// Compared with counting; the order of the numbers has no effect.
        #[test]
        fn agrees_with_counting(numbers in prop::collection::vec(-1e6..1e6_f64, 1..40)) {
            let spread = Spread::of(numbers.iter().copied()).unwrap();
            let least = numbers.iter().copied().fold(f64::INFINITY, f64::min);
            let largest = numbers.iter().copied().fold(f64::NEG_INFINITY, f64::max);
            prop_assert_eq!(spread.count, numbers.len());
            prop_assert_eq!((spread.least, spread.largest), (least, largest));
            let below = numbers.iter().filter(|number| **number < spread.median).count();
            let above = numbers.iter().filter(|number| **number > spread.median).count();
            prop_assert!(2 * below <= numbers.len() && 2 * above <= numbers.len());
            let mut reversed = numbers.clone();
            reversed.reverse();
            prop_assert_eq!(Spread::of(reversed), Some(spread));
        }
    }
}
