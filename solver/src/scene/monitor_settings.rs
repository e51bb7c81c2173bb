//! Settings of the tunnelling monitor, which detects film that passes through film.

/// Settings of the tunnelling monitor.
///
/// The monitor compares two frames that are `block` steps apart. In a random choice of blocks, the
/// dense ones, it checks every step.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct MonitorSettings {
    /// Steps in a block, at least 1.
    pub block: u32,
    /// One block in this number is dense; 1 for all blocks.
    pub dense_block_period: u64,
    /// Seed of the choice of dense blocks.
    pub seed: u64,
}

impl MonitorSettings {
    /// Every step, for small scenes.
    pub const EVERY_STEP: Self = Self { block: 1, dense_block_period: 1, seed: 0 };
    /// Blocks of 128 steps, one in a hundred of them dense.
    pub const FRAMES: Self = Self { block: 128, dense_block_period: 100, seed: 0 };

    /// Whether the block that starts after `steps` steps is dense. The choice is the hash `SplitMix64`
    /// (G. L. Steele et al., "Fast splittable pseudorandom number generators", 2014) of seed and number.
    pub(crate) fn is_dense_block(&self, steps: u64) -> bool {
        let mut z =
            self.seed.wrapping_add(steps.wrapping_add(1).wrapping_mul(0x9E37_79B9_7F4A_7C15));
        z = (z ^ (z >> 30)).wrapping_mul(0xBF58_476D_1CE4_E5B9);
        z = (z ^ (z >> 27)).wrapping_mul(0x94D0_49BB_1331_11EB);
        (z ^ (z >> 31)).is_multiple_of(self.dense_block_period)
    }
}
