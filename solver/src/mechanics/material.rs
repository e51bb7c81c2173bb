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
//! this material. It is continuously differentiable: stress has no jump between regimes.
//!
//! Principal values are m ± r with m = (exx + eyy)/2, r² = ((exx − eyy)/2)² + exy². Where e1 = e2
//! no direction is needed: the film is then taut or slack, and both stresses are isotropic forms.
//! Every S is coaxial with e, so two numbers tell it: its mean and its secant shear modulus.

#![allow(clippy::inline_always, reason = "inside the element loop")]

use serde::{Deserialize, Serialize};

use crate::platform::fault_injection::{Fault, Term};
use crate::platform::simd::{Lanes, Wide};
use crate::scene::Film;

/// A symmetric tensor in the developed plane.
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
    /// Mean and half the difference of the principal values.
    fn circle(self) -> (f64, f64) {
        let half = 0.5 * (self.xx - self.yy);
        (0.5 * (self.xx + self.yy), (half * half + self.xy * self.xy).sqrt())
    }

    /// Principal values, the larger first.
    pub fn principal(self) -> (f64, f64) {
        let (mean, radius) = self.circle();
        (mean + radius, mean - radius)
    }
}

/// What the film does at a strain.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum Regime {
    /// Stretched both ways.
    Taut,
    /// Stretched one way, folded up in wrinkles the other.
    Wrinkled,
    /// Not stretched at all.
    Slack,
}

/// Stress of one element.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Stress {
    /// S, Pa.
    pub tensor: PlaneTensor,
    /// Its larger principal value, Pa.
    pub largest: f64,
}

/// Constants of the film.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Material {
    /// E, Pa.
    pub youngs_modulus: f64,
    /// ν.
    pub poisson_ratio: f64,
    /// c.
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

    /// A fault of one constant, the others as they were: tests only.
    pub(crate) fn suffer(&mut self, fault: Fault) {
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

    /// C:e, Pa: the stress of the film if it bore compression as it bears tension.
    pub fn full_stress(&self, strain: PlaneTensor) -> PlaneTensor {
        let (k, nu) = (self.plane_modulus, self.poisson_ratio);
        PlaneTensor {
            xx: (strain.xx + strain.yy * nu) * k,
            yy: (strain.yy + strain.xx * nu) * k,
            xy: strain.xy * (k * (1.0 - nu)),
        }
    }

    /// S of eight elements at their strains, told by its own circle.
    #[inline(always)]
    pub fn response<L: Wide>(&self, strain: Circle<L>) -> Response<L> {
        let Circle { sum, diameter, .. } = strain;
        let (k, nu) = (self.plane_modulus, self.poisson_ratio);
        // E e1 n⊗n with n⊗n = (1 + deviator/r)/2; wrinkled film has e2 < e1, so r > 0 where this is
        // taken.
        let twice = sum + diameter;
        let tension = twice * (0.25 * self.youngs_modulus);
        let taut = sum * (1.0 + nu) - diameter * (1.0 - nu);
        let c = self.compression;
        // No closure: one is not inlined into another instruction set.
        let mean = relaxed(taut, twice, tension, sum * (0.5 * k * (1.0 + nu)), c);
        let shear_modulus = tension.over(diameter);
        let shear_modulus = relaxed(taut, twice, shear_modulus, L::splat(0.5 * k * (1.0 - nu)), c);
        Response { mean, shear_modulus, largest: mean + shear_modulus * diameter }
    }

    /// S of one element: one lane of [`Self::response`].
    pub fn stress(&self, strain: PlaneTensor) -> Stress {
        let PlaneTensor { xx, yy, xy } = strain;
        let circle = Circle::of(Lanes::splat(xx), Lanes::splat(yy), Lanes::splat(2.0 * xy));
        let Response { mean, shear_modulus, largest } = self.response(circle);
        let (mean, shear_modulus) = (mean.0[0], shear_modulus.0[0]);
        let (half, shear) = (shear_modulus * (xx - yy), shear_modulus * (2.0 * xy));
        let tensor = PlaneTensor { xx: mean + half, yy: mean - half, xy: shear };
        Stress { tensor, largest: largest.0[0] }
    }
}

/// Mohr's circles of eight strains, all twice their size.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Circle<L> {
    /// exx + eyy.
    pub sum: L,
    /// exx − eyy.
    pub difference: L,
    /// 2 exy.
    pub shear: L,
    /// e1 − e2.
    pub diameter: L,
}

impl<L: Wide> Circle<L> {
    /// Of exx, eyy and 2 exy.
    #[inline(always)]
    pub fn of(xx: L, yy: L, shear: L) -> Self {
        Self::told(xx + yy, xx - yy, shear)
    }

    /// Of their sum, their difference and 2 exy.
    #[inline(always)]
    pub fn told(sum: L, difference: L, shear: L) -> Self {
        let diameter = (difference * difference + shear * shear).sqrt();
        Self { sum, difference, shear, diameter }
    }
}

/// Stresses of eight elements, coaxial with their strains: Sxx and Syy are mean ± G (exx − eyy), Sxy is
/// G 2 exy; Pa.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Response<L> {
    /// (Sxx + Syy)/2.
    pub mean: L,
    /// G, secant: (S1 − S2)/2 over e1 − e2.
    pub shear_modulus: L,
    /// S1.
    pub largest: L,
}

/// What taut film has where `taut` is above 0, else what wrinkled film has where `e1` is, else nought;
/// the last two with a share of the first.
#[inline(always)]
fn relaxed<L: Wide>(taut: L, e1: L, wrinkled: L, full: L, compression: f64) -> L {
    let relaxed = e1.if_positive(wrinkled, L::splat(0.0));
    // A share of nought is nothing, whatever its sign.
    let blend = if compression > 0.0 { relaxed + (full - relaxed) * compression } else { relaxed };
    taut.if_positive(full, blend)
}

#[cfg(test)]
#[expect(clippy::float_cmp, reason = "these values are exact")]
mod tests {
    use super::*;

    fn material(compression: f64) -> Material {
        Material::new(&Film { compression, viscosity: 0.0, ..Film::PAPER })
    }

    fn turned(e1: f64, e2: f64, angle: f64) -> PlaneTensor {
        let (sin, cos) = libm::sincos(angle);
        PlaneTensor {
            xx: e1 * cos * cos + e2 * sin * sin,
            yy: e1 * sin * sin + e2 * cos * cos,
            xy: (e1 - e2) * sin * cos,
        }
    }

    const STRAINS: [(f64, f64, Regime); 6] = [
        (2e-3, 1e-3, Regime::Taut),
        (2e-3, -5e-4, Regime::Taut),
        (2e-3, -1e-3, Regime::Wrinkled),
        (1e-3, -5e-2, Regime::Wrinkled),
        (-1e-4, -2e-3, Regime::Slack),
        (-2e-3, -2e-3, Regime::Slack),
    ];

    #[test]
    fn stress_is_the_derivative_of_energy_in_every_regime() {
        for c in [0.0, 1e-3, 0.3, 1.0] {
            let material = material(c);
            for (e1, e2, regime) in STRAINS {
                for angle in [0.0, 0.4, 2.0] {
                    let strain = turned(e1, e2, angle);
                    assert_eq!(material.regime(strain), regime);
                    let stress = material.stress(strain).tensor;
                    let h = 1e-7;
                    let slope = |dxx: f64, dyy: f64, dxy: f64| {
                        let at = |s: f64| {
                            material.energy_density(PlaneTensor {
                                xx: strain.xx + s * dxx,
                                yy: strain.yy + s * dyy,
                                xy: strain.xy + s * dxy,
                            })
                        };
                        (at(h) - at(-h)) / (2.0 * h)
                    };
                    let scale = 1e-6 * material.youngs_modulus * 2e-3;
                    assert!((stress.xx - slope(1.0, 0.0, 0.0)).abs() < scale, "{strain:?} {c}");
                    assert!((stress.yy - slope(0.0, 1.0, 0.0)).abs() < scale, "{strain:?} {c}");
                    // Both off-diagonal entries move together.
                    assert!((2.0 * stress.xy - slope(0.0, 0.0, 1.0)).abs() < scale, "{strain:?}");
                }
            }
        }
    }

    #[test]
    fn stress_has_no_jump_between_regimes() {
        let material = material(0.0);
        let near = |a: PlaneTensor, b: PlaneTensor| {
            let [a, b] = [a, b].map(|e| material.stress(e).tensor);
            let gap = (a.xx - b.xx).abs() + (a.yy - b.yy).abs() + (a.xy - b.xy).abs();
            assert!(gap < 1e-9 * material.youngs_modulus, "{a:?} {b:?}");
        };
        let small = 1e-11;
        near(turned(1e-3, -0.3e-3 + small, 0.7), turned(1e-3, -0.3e-3 - small, 0.7));
        near(turned(small, -1e-3, 0.7), turned(-small, -1e-3, 0.7));
        near(turned(small, small, 0.7), turned(-small, -small, 0.7));
    }

    #[test]
    fn full_compression_is_linear() {
        let material = material(1.0);
        for (e1, e2, _) in STRAINS {
            let strain = turned(e1, e2, 1.0);
            let stress = material.stress(strain);
            let full = material.full_stress(strain);
            let scale = material.youngs_modulus * 1e-15;
            assert!((stress.tensor.xx - full.xx).abs() < scale);
            assert!((stress.tensor.xy - full.xy).abs() < scale);
            assert!((stress.largest - full.principal().0).abs() < 100.0 * scale);
        }
    }

    #[test]
    fn slack_and_unstrained_film_bear_nothing() {
        let material = material(0.0);
        for strain in [PlaneTensor::default(), turned(-1e-3, -1e-3, 0.0)] {
            assert_eq!(material.stress(strain).tensor, PlaneTensor::default());
            assert_eq!(material.stress(strain).largest, 0.0);
            assert_eq!(material.energy_density(strain), 0.0);
        }
    }

    #[test]
    fn the_largest_stress_is_the_tensors_own() {
        for c in [0.0, 0.2] {
            let material = material(c);
            for (e1, e2, _) in STRAINS {
                let stress = material.stress(turned(e1, e2, 0.3));
                let own = stress.tensor.principal().0;
                assert!((stress.largest - own).abs() < 1e-9 * material.youngs_modulus);
            }
        }
    }
}
