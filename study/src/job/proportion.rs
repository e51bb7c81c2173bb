//! k of n: a proportion over replicates, with its 95 % interval.
//!
//! ```text
//! Wilson (1927):  (p + z²/2n ± z √(p(1 − p)/n + z²/4n²)) / (1 + z²/n),   p = k/n,  z = 1.959964
//! ```

use std::fmt;

use serde::Serialize;

/// 97.5 % point of the normal distribution: a two-sided interval of 95 %.
pub const Z: f64 = 1.959_963_984_540_054;

/// k of n.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, Serialize)]
pub struct Proportion {
    /// Number of those that meet a condition.
    pub met: usize,
    /// Number of all that were judged.
    pub of: usize,
}

impl Proportion {
    /// The proportion of these truth values.
    pub fn count(judged: impl IntoIterator<Item = bool>) -> Self {
        judged.into_iter().fold(Self::default(), |known, met| Self {
            met: known.met + usize::from(met),
            of: known.of + 1,
        })
    }

    /// The Wilson interval of the probability, 95 %; from 0 to 1 without any.
    pub fn wilson(self) -> [f64; 2] {
        self.wilson_of(self.of)
    }

    /// The same where only this number of the n are independent.
    pub fn wilson_of(self, independent: usize) -> [f64; 2] {
        if self.of == 0 || independent == 0 {
            return [0.0, 1.0];
        }
        let n = independent as f64;
        let p = self.met as f64 / self.of as f64;
        let spread = Z * libm::sqrt(p * (1.0 - p) / n + Z * Z / (4.0 * n * n));
        let middle = p + Z * Z / (2.0 * n);
        let scale = 1.0 + Z * Z / n;
        // At p = 0 and 1 the ends are 0 and 1 up to rounding.
        let low = if self.met == 0 { 0.0 } else { (middle - spread) / scale };
        let high = if self.met == self.of { 1.0 } else { (middle + spread) / scale };
        [low, high]
    }

    /// Whether the probability is above one half (`true`) or below (`false`), where the interval does not contain
    /// one half.
    pub fn majority(self) -> Option<bool> {
        let [low, high] = self.wilson();
        if low > 0.5 {
            Some(true)
        } else if high < 0.5 {
            Some(false)
        } else {
            None
        }
    }

    /// Whether some meet the condition and some do not.
    pub fn is_mixed(self) -> bool {
        0 < self.met && self.met < self.of
    }
}

impl fmt::Display for Proportion {
    /// "4 of 5 (38 to 96 %)"; without the interval for none or one.
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "{} of {}", self.met, self.of)?;
        if self.of > 1 {
            let [low, high] = self.wilson().map(|end| 100.0 * end);
            write!(f, " ({low:.0} to {high:.0} %)")?;
        }
        Ok(())
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn intervals_are_those_of_published_tables() {
        // Newcombe (1998), Statistics in Medicine 17, 857: Wilson score intervals, 95 %.
        for (met, of, low, high) in [
            (81, 263, 0.2553, 0.3662),
            (15, 148, 0.0624, 0.1605),
            (0, 20, 0.0, 0.1611),
            (1, 29, 0.0061, 0.1718),
        ] {
            let interval = Proportion { met, of }.wilson();
            assert!((interval[0] - low).abs() < 6e-5, "{met}/{of}: {interval:?}");
            assert!((interval[1] - high).abs() < 6e-5, "{met}/{of}: {interval:?}");
        }
    }

    #[test]
    fn five_equal_results_decide_and_three_do_not() {
        let majority = |met, of| Proportion { met, of }.majority();
        assert_eq!(majority(5, 5), Some(true));
        assert_eq!(majority(0, 5), Some(false));
        assert_eq!(majority(4, 5), None);
        assert_eq!((majority(3, 3), majority(4, 4)), (None, Some(true)));
        assert_eq!(majority(0, 0), None);
    }

    #[test]
    fn shows_its_interval() {
        let five = Proportion::count([true, true, false, true, true]);
        assert_eq!(five.to_string(), "4 of 5 (38 to 96 %)");
        assert!(five.is_mixed());
        assert_eq!(Proportion { met: 1, of: 1 }.to_string(), "1 of 1");
    }
}
