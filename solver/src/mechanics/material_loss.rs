//! Loss of the film's material: a standard linear solid whose spring is the tension field.
//!
//! ```text
//! E = (Ê + g P)/(1 + g)           Ê elastic strain, P creep strain        S = S(Ê) = ∂W/∂Ê
//! Ṗ = (C⁻¹:S − P)/τ
//! stored energy      ψ = W(Ê)/(1 + g) + ½ g/(1 + g) P:C:P                 ∂ψ/∂E = S
//! material loss      D = g/(1 + g) (S − C:P):C⁻¹:(S − C:P)/τ ≥ 0
//! loss factor        tan δ(ω) = g ωτ/(1 + g + ω²τ²)      largest, η = g/(2 √(1 + g)), at ωτ = √(1 + g)
//! ```
//!
//! Symbols: E Green strain; W and S of [`crate::mechanics::material`]; C plane-stress stiffness (Pa); g
//! relaxation ratio; τ relaxation time (s).
//!
//! A spring of modulus (1 + g)E in series with a Kelvin-Voigt unit of modulus (1 + g)E/g and relaxation
//! time τ. The spring goes slack and wrinkles; the unit creeps only under the stress that the spring
//! carries, so slack film does not resist, and its creep strain decays. At rest P = C⁻¹:S: the film then has
//! the modulus E. Far above 1/(2πτ) the loss factor falls as 1/ω, so the highest frequencies of a mesh are
//! hardly damped, and the law has no element size in it.
//!
//! A step advances P with the stress at its start, so the loss is right to first order in Δt/τ, and the
//! entry of a single step, a trapezoid, may be slightly negative where the driving stress changes sign.
//!
//! Sources: J. Simo and T. Hughes, "Computational Inelasticity" (1998), section 10.2 (standard solid as
//! a gradient flow of ψ); the tension field as its spring is billow's.

#![expect(clippy::inline_always, reason = "inside the element loop")]

use crate::mechanics::material::{Material, PlaneTensor};
use crate::mechanics::tensor::add;
use crate::platform::simd::Wide;
use crate::scene::Film;

/// Creep strain that has decayed: P far below it is kept to the multiples of its last digit. Chosen: its squares are far
/// above the smallest numbers, and it is far below the last digit of any strain that a stress belongs to.
const DECAYED: f64 = 1e-60;

/// Constants of creep.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Creep {
    /// g; 0 for film without loss.
    pub ratio: f64,
    /// τ, s.
    pub time: f64,
    /// C as the factors of (Exx + Eyy) and of (Exx − Eyy, 2 Exy), Pa.
    pub stiffness: [f64; 2],
    /// C⁻¹, the inverse factors, 1/Pa.
    pub compliance: [f64; 2],
}

impl Creep {
    /// The creep of a film of this material.
    pub fn new(film: &Film, material: &Material) -> Self {
        let eta = film.loss_factor;
        let ratio = 2.0 * eta * (eta + (1.0 + eta * eta).sqrt());
        let stiffness = material.stiffness();
        Self {
            ratio,
            time: (1.0 + ratio).sqrt() / (2.0 * core::f64::consts::PI * film.loss_frequency),
            stiffness,
            compliance: stiffness.map(|factor| 1.0 / factor),
        }
    }

    /// 1 − exp(−Δt/τ): the share of the way to its rest that P goes in a step of `length` (s).
    pub fn share(&self, length: f64) -> f64 {
        if self.ratio > 0.0 { -libm::expm1(-length / self.time) } else { 0.0 }
    }

    /// P after a step that adds ΔP to it.
    ///
    /// P of slack film halves every 0.7 τ. After 700 τ, 0.1 s of the default film, it would be subnormal, and arithmetic on
    /// subnormal numbers takes many times as long on most processors; so P has a smallest digit.
    #[inline(always)]
    pub fn after_step<L: Wide>(creep_strain: [L; 3], creep_step: [L; 3]) -> [L; 3] {
        let decayed = L::splat(DECAYED);
        let [sum, difference, shear] = add(creep_strain, creep_step);
        [(sum + decayed) - decayed, (difference + decayed) - decayed, (shear + decayed) - decayed]
    }

    /// √(1 + g): the frequency of fast vibrations over that of film without loss.
    pub fn frequency_factor(&self) -> f64 {
        (1.0 + self.ratio).sqrt()
    }

    /// P of film at rest at a strain, as (Pxx + Pyy, Pxx − Pyy, 2 Pxy).
    pub fn at_rest(&self, material: &Material, strain: PlaneTensor) -> [f64; 3] {
        let PlaneTensor { xx, yy, xy } = material.stress(strain).tensor;
        let [mean, deviator] = self.compliance;
        [0.5 * (xx + yy) * mean, 0.5 * (xx - yy) * deviator, xy * deviator]
    }

    /// ψ, J/m³, of this elastic strain, stress and creep strain, in the components of
    /// [`crate::mechanics::forces::membrane`]. W is of second degree in each regime: W = ½ S:Ê.
    pub fn stored_energy(&self, strain: [f64; 3], stress: [f64; 3], creep: [f64; 3]) -> f64 {
        let elastic: f64 = strain.iter().zip(stress).map(|(e, s)| e * s).sum();
        if self.ratio == 0.0 {
            return 0.5 * elastic;
        }
        let [mean, deviator] = self.stiffness;
        let [sum, difference, shear] = creep;
        let stored = sum * sum * mean + (difference * difference + shear * shear) * deviator;
        0.5 * (elastic + self.ratio * stored) / (1.0 + self.ratio)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::mechanics::tensor::scale;
    use crate::platform::simd::Lanes;

    #[test]
    fn the_peak_of_the_loss_factor_is_the_one_asked_for() {
        let film = Film { loss_factor: 0.03, loss_frequency: 80.0, ..Film::PAPER };
        let creep = Creep::new(&film, &Material::new(&film));
        let loss = |frequency: f64| {
            let x = core::f64::consts::TAU * frequency * creep.time;
            creep.ratio * x / (1.0 + creep.ratio + x * x)
        };
        assert!((loss(80.0) - 0.03).abs() < 1e-14);
        assert!(loss(79.0) < 0.03 && loss(81.0) < 0.03);
        assert!(loss(8000.0) < 6.1e-4);
    }

    #[test]
    fn creep_of_slack_film_decays_without_subnormal_numbers_and_other_creep_keeps_its_bits() {
        let creep = Creep::new(&Film::PAPER, &Material::new(&Film::PAPER));
        let share = creep.share(5e-6);
        let mut strain = [1e-3, -2e-3, 1e-40].map(Lanes::splat);
        for _ in 0..100_000 {
            strain = Creep::after_step(strain, scale(strain, Lanes::splat(-share)));
        }
        for strain in strain.map(|lanes| lanes.0[0]) {
            assert!(strain.abs() < 1e-70 && (strain == 0.0 || (strain * strain).is_normal()));
        }
        for strain in [0.0, 1e-3, -3.7e-9, 1.1e-43] {
            let [sum, ..] =
                Creep::after_step([strain; 3].map(Lanes::splat), [Lanes::splat(0.0); 3]);
            assert_eq!(sum.0[0].to_bits(), strain.to_bits());
        }
    }

    #[test]
    fn film_without_loss_does_not_creep() {
        let film = Film { loss_factor: 0.0, ..Film::PAPER };
        let creep = Creep::new(&film, &Material::new(&film));
        assert!(creep.ratio.abs() <= 0.0 && creep.share(1.0).abs() <= 0.0);
        assert!((creep.frequency_factor() - 1.0).abs() <= 0.0);
    }
}
