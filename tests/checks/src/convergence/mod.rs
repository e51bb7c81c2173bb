//! Convergence with the mesh: the limit of each measure, and the table of mesh errors.

pub mod calibrate;
pub mod check;
pub mod command;
pub mod fit;
pub mod limit;
pub mod regression;
pub mod runs;

#[cfg(test)]
mod tests;

pub use calibrate::calibrate;
pub use check::{MeshCheck, check};
pub use fit::{Fit, Level, ORDERS, fit};
pub use limit::levels;
pub use runs::{MeshRun, SceneRuns, by_scene};

/// Whether a measure tends to a limit on the meshes at hand.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Trend {
    /// Limit and uncertainty together lie near the finest value.
    Limit,
    /// They do not: the measure changes too slowly, or too irregularly, for a limit to be known.
    NoLimit,
}

/// Largest distance of a limit, with its uncertainty, from the finest value, relative, for which the limit
/// counts as known. Chosen: beyond it the error would be mainly that of the limit.
const MAX_DISTANCE: f64 = 0.05;

impl Trend {
    /// Name, as in the output.
    pub fn name(self) -> &'static str {
        match self {
            Self::Limit => "limit",
            Self::NoLimit => "no limit known",
        }
    }
}

/// The trend of a measure whose values were fitted.
pub fn trend(levels: &[Level], fit: &Fit) -> Trend {
    let finest = levels.last().map_or(0.0, |level| level.value);
    let distance = (fit.limit - finest).abs() + fit.uncertainty;
    if distance <= MAX_DISTANCE * finest.abs() { Trend::Limit } else { Trend::NoLimit }
}
