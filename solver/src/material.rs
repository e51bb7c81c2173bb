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

#![allow(clippy::inline_always, reason = "inside the element loop")]

use serde::{Deserialize, Serialize};

use crate::mutation::{Mutation, Term};
use crate::scene::Film;
use crate::simd::{Lanes, Wide};

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
    pub(crate) fn suffer(&mut self, fault: Mutation) {
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
    #[inline(always)]
    pub fn full_stress<L: Wide>(&self, strain: PlaneLanes<L>) -> PlaneLanes<L> {
        let (k, nu) = (self.plane_modulus, self.poisson_ratio);
        PlaneLanes {
            xx: (strain.xx + strain.yy * nu) * k,
            yy: (strain.yy + strain.xx * nu) * k,
            xy: strain.xy * (k * (1.0 - nu)),
        }
    }

    /// S of eight elements, and its larger principal value, Pa.
    #[inline(always)]
    pub fn stresses<L: Wide>(&self, strain: PlaneLanes<L>) -> (PlaneLanes<L>, L) {
        self.stresses_in(strain, Circle::of(strain))
    }

    /// The same where Mohr's circle of the strain is known: its root takes long, and whoever asks for it
    /// early has other work to do meanwhile.
    #[inline(always)]
    pub fn stresses_in<L: Wide>(
        &self,
        strain: PlaneLanes<L>,
        Circle { half, mean, radius }: Circle<L>,
    ) -> (PlaneLanes<L>, L) {
        let (e1, e2) = (mean + radius, mean - radius);
        let full = self.full_stress(strain);
        let full_largest = (e1 + e2 * self.poisson_ratio) * self.plane_modulus;
        // E e1 n⊗n with n⊗n = (1 + deviator/r)/2; wrinkled film has e2 < e1, so r > 0 where this is
        // taken.
        let tension = e1 * self.youngs_modulus;
        let lean = (tension * 0.5).over(radius);
        let wrinkled = PlaneLanes {
            xx: tension * 0.5 + lean * half,
            yy: tension * 0.5 - lean * half,
            xy: lean * strain.xy,
        };
        let taut = e2 + e1 * self.poisson_ratio;
        let c = self.compression;
        // No closure: one is not inlined into another instruction set.
        let tensor = PlaneLanes {
            xx: relaxed(taut, e1, wrinkled.xx, full.xx, c),
            yy: relaxed(taut, e1, wrinkled.yy, full.yy, c),
            xy: relaxed(taut, e1, wrinkled.xy, full.xy, c),
        };
        (tensor, relaxed(taut, e1, tension, full_largest, c))
    }

    /// S of one element: one lane of [`Self::stresses`].
    pub fn stress(&self, strain: PlaneTensor) -> Stress {
        let (tensor, largest) = self.stresses(PlaneLanes::splat(strain));
        Stress { tensor: tensor.first(), largest: largest.0[0] }
    }
}

/// Mohr's circles of eight tensors: half the difference of the diagonal, centre, radius.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Circle<L> {
    half: L,
    mean: L,
    radius: L,
}

impl<L: Wide> Circle<L> {
    /// Of these tensors.
    #[inline(always)]
    pub fn of(tensor: PlaneLanes<L>) -> Self {
        let half = (tensor.xx - tensor.yy) * 0.5;
        let mean = (tensor.xx + tensor.yy) * 0.5;
        Self { half, mean, radius: (half * half + tensor.xy * tensor.xy).sqrt() }
    }
}

/// The stress of taut film where `taut` is above 0, else that of wrinkled film where `e1` is, else
/// nought; the last two with a share of the first.
#[inline(always)]
fn relaxed<L: Wide>(taut: L, e1: L, wrinkled: L, full: L, compression: f64) -> L {
    let relaxed = e1.if_positive(wrinkled, L::splat(0.0));
    // A share of nought is nothing, whatever its sign.
    let blend = if compression > 0.0 { relaxed + (full - relaxed) * compression } else { relaxed };
    taut.if_positive(full, blend)
}

/// A symmetric tensor in the developed plane of each of eight elements.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct PlaneLanes<L = Lanes> {
    /// First diagonal entries.
    pub xx: L,
    /// Second diagonal entries.
    pub yy: L,
    /// Off-diagonal entries.
    pub xy: L,
}

impl PlaneLanes {
    /// The same tensor eight times.
    pub fn splat(tensor: PlaneTensor) -> Self {
        let [xx, yy, xy] = [tensor.xx, tensor.yy, tensor.xy].map(Lanes::splat);
        Self { xx, yy, xy }
    }

    /// The first element's.
    pub fn first(self) -> PlaneTensor {
        PlaneTensor { xx: self.xx.0[0], yy: self.yy.0[0], xy: self.xy.0[0] }
    }
}

impl<L: Wide> PlaneLanes<L> {
    /// Each times its own number.
    #[must_use]
    #[inline(always)]
    pub fn scale(self, factor: L) -> Self {
        Self { xx: self.xx * factor, yy: self.yy * factor, xy: self.xy * factor }
    }

    /// Double contractions.
    #[inline(always)]
    pub fn contract(self, other: Self) -> L {
        self.xx * other.xx + self.yy * other.yy + (self.xy * other.xy) * 2.0
    }
}

impl<L: Wide> core::ops::Add for PlaneLanes<L> {
    type Output = Self;
    #[inline(always)]
    fn add(self, other: Self) -> Self {
        Self { xx: self.xx + other.xx, yy: self.yy + other.yy, xy: self.xy + other.xy }
    }
}

#[cfg(test)]
#[expect(clippy::float_cmp, reason = "these values are exact")]
mod tests {
    use super::*;

    fn material(compression: f64) -> Material {
        Material::new(&Film {
            youngs_modulus: 3.45e9,
            poisson_ratio: 0.3,
            density: 1400.0,
            thickness: 25.4e-6,
            compression,
            viscosity: 0.0,
            temperature: 293.0,
        })
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
            let full = material.full_stress(PlaneLanes::splat(strain)).first();
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
