//! Upper bounds of a study.

/// What a study must not exceed.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Limits {
    /// Number of points of a grid, before its filter.
    pub points: usize,
}

impl Default for Limits {
    /// A quarter of a million points (chosen: their plan takes seconds and fits in memory).
    fn default() -> Self {
        Self { points: 250_000 }
    }
}
