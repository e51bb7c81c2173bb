//! Upper bounds of a study.

/// What a study must not exceed.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct PlanSize {
    /// Number of points of a grid, before its filter.
    pub points: usize,
}

impl Default for PlanSize {
    /// A quarter of a million points (chosen: their plan takes seconds and fits in memory).
    fn default() -> Self {
        Self { points: 250_000 }
    }
}
