//! The static reference: static equilibria of a design with which a deployment is compared.
//!
//! ```text
//! design shape   at the overpressure p with p r/(E t) = 1e-4      levels of the times
//! final shape    at the final overpressure: mean over the last tenth of the run      ratios, verdict
//! ```
//!
//! Symbols: r mean radius of the rings, E Young's modulus, t thickness. The design shape is the same
//! whatever gas a run gets, so equal motion has equal times. The final shape is that of the gas that the
//! run really has, so film that stretches is compared with stretched film.

use crate::output::history::History;
use crate::scene::timeline::Timeline;

/// p r/(E t) of the design shape. Chosen: film is taut and its strain is about 1e-4, so the shape hardly
/// depends on the film.
pub const DESIGN_LOAD: f64 = 1e-4;

/// Overpressure of the design shape, Pa: from the mean radius (m), Young's modulus (Pa) and thickness (m).
pub fn design_overpressure(mean_radius: f64, youngs_modulus: f64, thickness: f64) -> f64 {
    DESIGN_LOAD * youngs_modulus * thickness / mean_radius
}

/// Volume and height of a static equilibrium.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct StaticShape {
    /// Overpressure, Pa.
    pub overpressure: f64,
    /// Volume, m³.
    pub volume: f64,
    /// Mean height of the top ring; of film without rings its whole height, m.
    pub height: f64,
}

/// Why there is no static equilibrium to compare a run with.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
pub enum NoReference {
    /// The search found no equilibrium.
    #[error("no static equilibrium was found at {overpressure} Pa: {problem}")]
    NoEquilibrium {
        /// Overpressure, Pa.
        overpressure: f64,
        /// How the search ended.
        problem: String,
    },
    /// The overpressure is beyond every film.
    #[error(
        "the final overpressure is {overpressure} Pa; static equilibria are searched up to {largest} Pa \
         for this design"
    )]
    Overload {
        /// Mean overpressure of the last tenth, Pa.
        overpressure: f64,
        /// Largest overpressure of a search, Pa.
        largest: f64,
    },
    /// The capsule of the static equilibria cannot be built.
    #[error("the capsule of the static equilibria cannot be built: {0}")]
    NoCapsule(String),
    /// The search was stopped: the whole run ends.
    #[error("the search for a static equilibrium was stopped")]
    Stopped,
}

/// What a run is compared with.
#[derive(Debug, Clone, PartialEq)]
pub struct Reference {
    /// The design shape.
    pub design: Result<StaticShape, NoReference>,
    /// The shape at the final overpressure.
    pub end: Result<StaticShape, NoReference>,
}

impl Reference {
    /// The same shape for times and ratios.
    pub fn constant(shape: StaticShape) -> Self {
        Self { design: Ok(shape), end: Ok(shape) }
    }
}

/// Final overpressure of a run, Pa: mean over its last tenth; `None` without samples.
pub fn final_overpressure(history: &History, timeline: &Timeline) -> Option<f64> {
    let (time, pressure) = (history.column("time"), history.column("pressure"));
    let from = last_tenth(time)?;
    Some(mean(&time[from..], &pressure[from..]) - timeline.ambient_pressure)
}

/// Index of the first sample of the last tenth; `None` without samples.
pub(super) fn last_tenth(time: &[f64]) -> Option<usize> {
    let (first, last) = (time.first()?, time.last()?);
    let start = last - 0.1 * (last - first) - 1e-12 * last;
    Some(time.partition_point(|t| *t < start))
}

/// Mean over time of a series that is linear between samples. There is at least one sample.
pub(super) fn mean(time: &[f64], values: &[f64]) -> f64 {
    let span = time[time.len() - 1] - time[0];
    if span <= 0.0 {
        return values[values.len() - 1];
    }
    let areas =
        time.windows(2).zip(values.windows(2)).map(|(t, v)| 0.5 * (t[1] - t[0]) * (v[0] + v[1]));
    areas.sum::<f64>() / span
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    #[expect(clippy::float_cmp, reason = "these values are exact")]
    fn the_mean_is_weighted_by_time() {
        assert!((mean(&[0.0, 1.0, 1.5], &[0.0, 2.0, 2.0]) - 2.0 / 1.5).abs() < 1e-15);
        assert_eq!(mean(&[3.0], &[7.0]), 7.0);
        assert_eq!(last_tenth(&[]), None);
        let time: Vec<f64> = (0..=100).map(|k| f64::from(k) * 0.01).collect();
        assert_eq!(last_tenth(&time), Some(90));
    }

    #[test]
    fn a_reason_names_the_overpressure() {
        let text = NoReference::Overload { overpressure: 3.5, largest: 2.0 }.to_string();
        assert!(text.contains("3.5 Pa"), "{text}");
    }
}
