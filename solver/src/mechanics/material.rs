//! The film as a material: plane-stress St Venant-Kirchhoff, relaxed to a tension field.
//!
//! ```text
//! W_full     = E/(2(1−ν²)) (e1² + e2² + 2ν e1 e2)
//! W_relaxed  = W_full          taut       e2 + ν e1 > 0
//!            = E/2 e1²         wrinkled   e2 + ν e1 ≤ 0 < e1
//!            = 0               slack      e1 ≤ 0
//! W          = W_relaxed + c (W_full − W_relaxed)                     S = ∂W/∂e
//! ```
//!
//! Symbols: e Green strain, e1 ≥ e2 its principal values; W energy per reference volume, J/m³;
//! S second Piola-Kirchhoff stress, Pa; E, ν, c of [`crate::scene::Film`]. The relaxed energy is
//! that of A. C. Pipkin, "The relaxed energy density for isotropic elastic membranes" (1986), for
//! this material. It is continuously differentiable: stress is continuous between regimes.
//!
//! Principal values are m ± r with m = (exx + eyy)/2, r² = ((exx − eyy)/2)² + exy². Where e1 = e2
//! the film is taut or slack, both stresses are isotropic, and no principal direction is needed. S is
//! always coaxial with e, so two values define it: its mean and a secant shear modulus.

#![allow(clippy::inline_always, reason = "inside the element loop")]

use serde::{Deserialize, Serialize};

use crate::platform::fault_injection::{Fault, Term};
use crate::platform::simd::{Lanes, Wide};
use crate::scene::Film;

/// Upper bound of S1/E. Chosen: no polymer film is linear in Green strain at three times its length.
pub const MAX_STRESS_RATIO: f64 = 4.0;

/// A symmetric tensor in the plane of the developed film.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct PlaneTensor {
    /// First diagonal entry.
    pub xx: f64,
    /// Second diagonal entry.
    pub yy: f64,
    /// Off-diagonal entry.
    pub xy: f64,
}

impl PlaneTensor {
    /// Centre and radius of Mohr's circle: mean and half the difference of the principal values.
    fn mohr_circle(self) -> (f64, f64) {
        let half = 0.5 * (self.xx - self.yy);
        (0.5 * (self.xx + self.yy), (half * half + self.xy * self.xy).sqrt())
    }

    /// Principal values, the larger first.
    pub fn principal(self) -> (f64, f64) {
        let (mean, radius) = self.mohr_circle();
        (mean + radius, mean - radius)
    }
}

/// State of the film at a strain.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum Regime {
    /// In tension in both principal directions.
    Taut,
    /// In tension in one principal direction, wrinkled across it.
    Wrinkled,
    /// Free of stress.
    Slack,
}

/// Stress of one element.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Stress {
    /// S, Pa.
    pub tensor: PlaneTensor,
    /// S1, its larger principal value, Pa.
    pub largest: f64,
}

/// The constitutive law of the film: energy density W (J/m³) and second Piola-Kirchhoff stress S (Pa).
///
/// ```text
/// W_full     = E/(2(1−ν²)) (e1² + e2² + 2ν e1 e2)        W = W_relaxed + c (W_full − W_relaxed)
/// W_relaxed  = W_full | E/2 e1² | 0                       taut | wrinkled | slack
/// S_full     = E/(1−ν²) ((1−ν) e + ν tr(e) 1)             S = S_relaxed + c (S_full − S_relaxed)
/// S_relaxed  = S_full | E e1 n1⊗n1 | 0                    taut | wrinkled | slack
/// ```
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Material {
    /// E, Pa.
    pub youngs_modulus: f64,
    /// ν.
    pub poisson_ratio: f64,
    /// c, compression fraction, 0 to 1.
    pub compression: f64,
    /// E/(1−ν²), Pa.
    plane_modulus: f64,
}

impl Material {
    /// The material of a film.
    pub fn new(film: &Film) -> Self {
        Self {
            youngs_modulus: film.youngs_modulus,
            poisson_ratio: film.poisson_ratio,
            compression: film.compression,
            plane_modulus: film.youngs_modulus / (1.0 - film.poisson_ratio * film.poisson_ratio),
        }
    }

    /// Injects a fault into one constant, for tests only.
    pub(crate) fn inject_fault(&mut self, fault: Fault) {
        match fault.term {
            Term::PlaneModulus => self.plane_modulus *= fault.factor,
            Term::WrinkledModulus => self.youngs_modulus *= fault.factor,
            Term::PoissonRatio => self.poisson_ratio *= fault.factor,
            _ => {}
        }
    }

    /// E/(1−ν²), Pa.
    pub fn plane_modulus(&self) -> f64 {
        self.plane_modulus
    }

    /// C as the factors of (exx + eyy) and of (exx − eyy, 2 exy) that give the mean stress and the half
    /// difference and shear, Pa.
    pub fn stiffness(&self) -> [f64; 2] {
        let (k, nu) = (self.plane_modulus, self.poisson_ratio);
        [0.5 * k * (1.0 + nu), 0.5 * k * (1.0 - nu)]
    }

    /// The regime at a strain.
    pub fn regime(&self, strain: PlaneTensor) -> Regime {
        let (e1, e2) = strain.principal();
        if e2 + self.poisson_ratio * e1 > 0.0 {
            Regime::Taut
        } else if e1 > 0.0 {
            Regime::Wrinkled
        } else {
            Regime::Slack
        }
    }

    /// W, J/m³.
    pub fn energy_density(&self, strain: PlaneTensor) -> f64 {
        let (e1, e2) = strain.principal();
        let full =
            0.5 * self.plane_modulus * (e1 * e1 + e2 * e2 + 2.0 * self.poisson_ratio * e1 * e2);
        let relaxed = match self.regime(strain) {
            Regime::Taut => full,
            Regime::Wrinkled => 0.5 * self.youngs_modulus * e1 * e1,
            Regime::Slack => 0.0,
        };
        relaxed + self.compression * (full - relaxed)
    }

    /// S of eight elements at their strains.
    ///
    /// ```text
    /// taut       mean = E/(2(1−ν)) (e1 + e2)       G = E/(2(1+ν))
    /// wrinkled   mean = E e1/2                     G = E e1/(2 (e1 − e2))
    /// ```
    ///
    /// E e1 n1⊗n1 = E e1 (1 + (e − mean(e) 1)/r)/2 with r = (e1 − e2)/2. Wrinkled film has e1 > e2, so
    /// the division is valid where its result is selected.
    #[inline(always)]
    pub fn response<L: Wide>(&self, strain: MohrCircle<L>) -> StressResponse<L> {
        let MohrCircle { sum, diameter, .. } = strain;
        let nu = self.poisson_ratio;
        let [full_mean, full_shear] = self.stiffness();
        let twice_e1 = sum + diameter;
        let wrinkled_mean = twice_e1 * (0.25 * self.youngs_modulus);
        // 2 (e2 + ν e1).
        let taut = sum * (1.0 + nu) - diameter * (1.0 - nu);
        let c = self.compression;
        // A function, not a closure: a closure is not inlined into another target feature.
        let mean = select_regime(taut, twice_e1, wrinkled_mean, sum * full_mean, c);
        let wrinkled_modulus = wrinkled_mean.over(diameter);
        let full_modulus = L::splat(full_shear);
        let shear_modulus = select_regime(taut, twice_e1, wrinkled_modulus, full_modulus, c);
        StressResponse { mean, shear_modulus, largest: mean + shear_modulus * diameter }
    }

    /// S of one element: one lane of [`Self::response`].
    pub fn stress(&self, strain: PlaneTensor) -> Stress {
        let PlaneTensor { xx, yy, xy } = strain;
        let strain = MohrCircle::of(Lanes::splat(xx), Lanes::splat(yy), Lanes::splat(2.0 * xy));
        let StressResponse { mean, shear_modulus, largest } = self.response(strain);
        let (mean, shear_modulus) = (mean.0[0], shear_modulus.0[0]);
        let (half_difference, shear) = (shear_modulus * (xx - yy), shear_modulus * (2.0 * xy));
        let tensor =
            PlaneTensor { xx: mean + half_difference, yy: mean - half_difference, xy: shear };
        Stress { tensor, largest: largest.0[0] }
    }
}

/// Mohr's circles of eight strains, every quantity doubled.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct MohrCircle<L> {
    /// exx + eyy: twice the centre.
    pub sum: L,
    /// exx − eyy.
    pub difference: L,
    /// 2 exy.
    pub shear: L,
    /// e1 − e2: twice the radius.
    pub diameter: L,
}

impl<L: Wide> MohrCircle<L> {
    /// From exx, eyy and 2 exy.
    #[inline(always)]
    pub fn of(xx: L, yy: L, shear: L) -> Self {
        Self::of_difference(xx + yy, xx - yy, shear)
    }

    /// From exx + eyy, exx − eyy and 2 exy.
    #[inline(always)]
    pub fn of_difference(sum: L, difference: L, shear: L) -> Self {
        let diameter = (difference * difference + shear * shear).sqrt();
        Self { sum, difference, shear, diameter }
    }
}

/// Stresses of eight elements, coaxial with their strains:
/// Sxx, Syy = mean ± G (exx − eyy), Sxy = G 2 exy.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct StressResponse<L> {
    /// (Sxx + Syy)/2, Pa.
    pub mean: L,
    /// G, secant shear modulus (S1 − S2)/(2 (e1 − e2)), Pa.
    pub shear_modulus: L,
    /// S1, Pa.
    pub largest: L,
}

/// Selects `full` where `taut` > 0; elsewhere `wrinkled` where `e1` > 0, or 0, blended with `full` by
/// the compression fraction.
#[inline(always)]
fn select_regime<L: Wide>(taut: L, e1: L, wrinkled: L, full: L, compression: f64) -> L {
    let relaxed = e1.if_positive(wrinkled, L::splat(0.0));
    // Without compression the blend is skipped: 0 times `full` adds nothing.
    let blend = if compression > 0.0 { relaxed + (full - relaxed) * compression } else { relaxed };
    taut.if_positive(full, blend)
}

#[cfg(test)]
#[expect(clippy::float_cmp, reason = "these values are exact")]
mod tests;
