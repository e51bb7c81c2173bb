//! What surrogates expect of a point.
//!
//! ```text
//! a(x) = ln EI(x) + Σ_j ln P(margin_j(x) > 0)                J. R. Gardner et al. (2014)
//! EI   = (b − m) Φ(u) + s φ(u),  u = (b − m)/s               J. Močkus (1975); m, s of the surrogate at x
//! b:     the smallest m among the points that keep the limits; without one EI = 1
//! ```

use crate::surrogate::{Surrogate, normal};

/// The surrogates of one point of a batch.
#[derive(Clone)]
pub(super) struct Surrogates {
    /// Of what becomes small.
    pub measure: Option<Surrogate>,
    /// Of the margin of each limit.
    pub margins: Vec<Surrogate>,
    /// b.
    pub best: Option<f64>,
}

impl Surrogates {
    /// The same, which take their means at a place as known there.
    pub fn believing(&self, place: &[f64]) -> Self {
        let believing = |of: &Surrogate| of.believing(place).unwrap_or_else(|| of.clone());
        Self {
            measure: self.measure.as_ref().map(believing),
            margins: self.margins.iter().map(believing).collect(),
            best: self.best,
        }
    }

    /// a(x).
    pub fn expects(&self, place: &[f64]) -> f64 {
        let kept = |margin: &Surrogate| {
            let (mean, deviation) = margin.at(place);
            log_part_below(mean / deviation.max(1e-9))
        };
        let kept: f64 = self.margins.iter().map(kept).sum();
        let (Some(measure), Some(best)) = (&self.measure, self.best) else { return kept };
        let (mean, deviation) = measure.at(place);
        let deviation = deviation.max(1e-12 * (1.0 + best.abs()));
        kept + log_improvement((best - mean) / deviation) + libm::log(deviation)
    }
}

/// ln Φ(u), also where Φ is 0 to f64.
fn log_part_below(u: f64) -> f64 {
    if u > -30.0 {
        libm::log(normal::part_below(u))
    } else {
        -0.5 * u * u - libm::log(-u) - LOG_ROOT_OF_TAU
    }
}

/// ln √(2π).
const LOG_ROOT_OF_TAU: f64 = 0.918_938_533_204_672_8;

/// ln (u Φ(u) + φ(u)): by its series where the sum loses its digits (S. Ament et al., 2023).
fn log_improvement(u: f64) -> f64 {
    let density = -0.5 * u * u - LOG_ROOT_OF_TAU;
    if u > -8.0 {
        libm::log(u * normal::part_below(u) + libm::exp(density))
    } else {
        density - 2.0 * libm::log(-u) + libm::log(1.0 - 3.0 / (u * u))
    }
}
