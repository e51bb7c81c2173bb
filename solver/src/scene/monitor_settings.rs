//! Settings of the tunnelling monitor, which detects film that passes through film.

use crate::platform::random::hash;

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

    /// Whether the block that starts after `steps` steps is dense.
    pub(crate) fn is_dense_block(&self, steps: u64) -> bool {
        hash(self.seed, steps.wrapping_add(1)).is_multiple_of(self.dense_block_period)
    }
}
