//! What surrogates expect of a point.
//!
//! ```text
//! a(x) = ln EI(x) + Σ_j ln P(margin_j(x) > 0)                J. R. Gardner et al. (2014)
//! EI   = (b − m) Φ(u) + s φ(u),  u = (b − m)/s               J. Močkus (1975); m, s of the surrogate at x
//! y    = ρ c(x) + δ(x)           c of a cheap model, δ what it leaves (M. C. Kennedy and A. O'Hagan, 2000): m and s of
//!                                y are those of ρ c and δ; ρ by least squares
//! b:     the smallest m among the points that keep the limits; without one EI = 1
//! ```

use crate::surrogate::{Surrogate, normal};

/// What is expected of one number, y.
#[derive(Clone)]
pub(super) struct Expected {
    /// c and ρ, where they foresee points left out better than a surrogate alone.
    cheap: Option<(Surrogate, f64)>,
    /// δ, or y itself.
    rest: Surrogate,
}

impl Expected {
    /// Of these values, one at each point; `cheap` is the surrogate of the same number of the cheap model. `None` where all
    /// values are alike.
    pub fn fit(
        points: &[Vec<f64>],
        values: &[f64],
        words: &[bool],
        cheap: Option<&Surrogate>,
    ) -> Option<Self> {
        let alone = Self { cheap: None, rest: Surrogate::fit(points, values, words)? };
        let Some(cheap) = cheap else { return Some(alone) };
        let at: Vec<f64> = points.iter().map(|point| cheap.at(point).0).collect();
        let slope = slope(&at, values);
        let rest: Vec<f64> = values.iter().zip(&at).map(|(value, at)| value - slope * at).collect();
        let rest = Surrogate::fit(points, &rest, words)
            .filter(|rest| rest.error_left_out() < alone.rest.error_left_out());
        Some(rest.map_or(alone, |rest| Self { cheap: Some((cheap.clone(), slope)), rest }))
    }

    /// Mean and standard deviation at a point.
    pub fn at(&self, point: &[f64]) -> (f64, f64) {
        let (mean, deviation) = self.rest.at(point);
        let Some((cheap, slope)) = &self.cheap else { return (mean, deviation) };
        let (known, uncertain) = cheap.at(point);
        (mean + slope * known, libm::hypot(deviation, slope * uncertain))
    }

    /// The same, which takes its mean at a point as known there.
    pub fn believing(&self, point: &[f64]) -> Option<Self> {
        let cheap = match &self.cheap {
            Some((cheap, slope)) => Some((cheap.believing(point)?, *slope)),
            None => None,
        };
        Some(Self { cheap, rest: self.rest.believing(point)? })
    }
}

/// The slope of the straight line through values over others.
fn slope(over: &[f64], values: &[f64]) -> f64 {
    let mean = |of: &[f64]| of.iter().sum::<f64>() / of.len() as f64;
    let (a, b) = (mean(over), mean(values));
    let both: f64 = over.iter().zip(values).map(|(x, y)| (x - a) * (y - b)).sum();
    let square: f64 = over.iter().map(|x| (x - a) * (x - a)).sum();
    if square > 0.0 { both / square } else { 0.0 }
}

/// The surrogates of one point of a batch.
#[derive(Clone)]
pub(super) struct Surrogates {
    /// Of what becomes small.
    pub measure: Option<Expected>,
    /// Of the margin of each limit.
    pub margins: Vec<Expected>,
    /// b.
    pub best: Option<f64>,
}

impl Surrogates {
    /// The same, which take their means at a place as known there.
    pub fn believing(&self, place: &[f64]) -> Self {
        let believing = |of: &Expected| of.believing(place).unwrap_or_else(|| of.clone());
        Self {
            measure: self.measure.as_ref().map(believing),
            margins: self.margins.iter().map(believing).collect(),
            best: self.best,
        }
    }

    /// a(x).
    pub fn expects(&self, place: &[f64]) -> f64 {
        let kept = |margin: &Expected| {
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
