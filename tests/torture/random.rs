//! Random numbers that follow from a seed.

use sha2::{Digest, Sha256};

/// A generator (`SplitMix64`: Steele, Lea, Flood 2014).
pub struct Random(u64);

impl Random {
    /// The numbers of one trial.
    pub fn of_trial(seed: u64, kind: &str, number: usize) -> Self {
        let digest = Sha256::digest(format!("{seed} {kind} {number}"));
        Self(digest[..8].iter().fold(0, |state, byte| state << 8 | u64::from(*byte)))
    }

    /// The next number.
    pub fn next(&mut self) -> u64 {
        self.0 = self.0.wrapping_add(0x9E37_79B9_7F4A_7C15);
        let mixed = (self.0 ^ (self.0 >> 30)).wrapping_mul(0xBF58_476D_1CE4_E5B9);
        let mixed = (mixed ^ (mixed >> 27)).wrapping_mul(0x94D0_49BB_1331_11EB);
        mixed ^ (mixed >> 31)
    }

    /// A number below `bound`, which is not zero.
    pub fn below(&mut self, bound: usize) -> usize {
        usize::try_from(self.next() % bound as u64).unwrap_or(0)
    }

    /// A number from 0 to 1.
    pub fn fraction(&mut self) -> f64 {
        (self.next() >> 11) as f64 / (1_u64 << 53) as f64
    }

    /// One of these.
    pub fn pick<'a, T>(&mut self, items: &'a [T]) -> &'a T {
        &items[self.below(items.len())]
    }
}
