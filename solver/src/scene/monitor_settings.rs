//! How closely a run is monitored for passages of film through film.

/// How a run is watched.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct MonitorSettings {
    /// Steps between two audit frames, at least 1.
    pub block: u32,
    /// One block in so many is looked at step by step, chosen by the seed; 1 for all.
    pub every_step_of_one_in: u64,
    /// Seed of the choice.
    pub seed: u64,
}

impl MonitorSettings {
    /// Every step: for small scenes.
    pub const EVERY_STEP: Self = Self { block: 1, every_step_of_one_in: 1, seed: 0 };
    /// Frames 50 steps apart, every step of one block in a hundred.
    pub const FRAMES: Self = Self { block: 50, every_step_of_one_in: 100, seed: 0 };

    /// Whether each step of the block after so many steps is looked at (`SplitMix64` of seed
    /// and number).
    pub(crate) fn closely(&self, steps: u64) -> bool {
        let mut z =
            self.seed.wrapping_add(steps.wrapping_add(1).wrapping_mul(0x9E37_79B9_7F4A_7C15));
        z = (z ^ (z >> 30)).wrapping_mul(0xBF58_476D_1CE4_E5B9);
        z = (z ^ (z >> 27)).wrapping_mul(0x94D0_49BB_1331_11EB);
        (z ^ (z >> 31)).is_multiple_of(self.every_step_of_one_in)
    }
}
