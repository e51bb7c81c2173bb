//! The response of the two elements of kites to their metrics: strain, creep, stress, numerical stress, force densities.
//! [`super::elements`] has the equations.

#![allow(clippy::inline_always, reason = "inside the element loop")]

use super::{CreepStrain, ElementHistory};
use crate::mechanics::film_model::ElementBlock;
use crate::mechanics::material::{Material, MohrCircle, StressResponse};
use crate::mechanics::material_loss::Creep;
use crate::mechanics::tensor::{add, contract, isotropic, scale, subtract};
use crate::platform::simd::{Lanes, Wide};

/// Metric of the edges p and q: (p·p/2, p·q, q·q/2), m².
#[derive(Clone, Copy)]
pub(super) struct Metric<L>(pub [L; 3]);

impl<L: Wide> Metric<L> {
    /// Green strain (Exx + Eyy, Exx − Eyy, 2 Exy).
    ///
    /// ```text
    /// Exx + ½ = a² m1      Eyy + ½ = b (b m1 + d m2) + d² m3      2 Exy = a (b m1 + (b m1 + d m2))
    /// ```
    #[inline(always)]
    fn strain(self, block: &ElementBlock, lane: usize) -> [L; 3] {
        let Self([m1, m2, m3]) = self;
        let [a, b, d] = load_all::<L, 3>(&block.inverse_shape, lane);
        let (b_m1, d_m2) = (b * m1, d * m2);
        let b_m1_d_m2 = b_m1 + d_m2;
        // Exx + ½ and Eyy + ½.
        let (xx, yy) = ((a * a) * m1, b * b_m1_d_m2 + (d * d) * m3);
        [xx + yy - L::splat(1.0), xx - yy, a * (b_m1 + b_m1_d_m2)]
    }
}

#[inline(always)]
pub(super) fn load<L: Wide>(lanes: &Lanes, lane: usize) -> L {
    L::load(&lanes.0, lane)
}

#[inline(always)]
fn load_all<L: Wide, const N: usize>(lanes: &[Lanes; N], lane: usize) -> [L; N] {
    let mut all = [L::splat(0.0); N];
    for k in 0..N {
        all[k] = load(&lanes[k], lane);
    }
    all
}

/// Writes three components to a stored tensor, from a lane on.
#[inline(always)]
fn store<L: Wide>(a: [L; 3], stored: &mut [Lanes; 3], lane: usize) {
    for k in 0..3 {
        a[k].store(&mut stored[k].0, lane);
    }
}

/// Result of eight elements.
pub(super) struct ElementResponse<L> {
    /// −r, N/m.
    pub minus_force_density: [L; 3],
    /// Minus twice the numerical dissipation of the step, J.
    pub minus_twice_numerical: L,
    /// Minus twice the material loss of the step, J.
    pub minus_twice_loss: L,
    /// Larger principal stress, Pa.
    pub largest_stress: L,
}

/// The step that led to the current positions.
#[derive(Clone, Copy)]
pub(super) struct TimeStep {
    /// 1/Δt, 1/s; 0 in a step of no time, in which nothing moved and P and D are the stored ones.
    pub inverse: f64,
    /// 1 − exp(−Δt/τ).
    pub creep_share: f64,
}

/// What a pass over the elements includes: only forces that are derivatives of an energy.
pub(super) const CONSERVATIVE: u8 = 0;
/// The same and the numerical stress that is stored; nothing moved since.
pub(super) const STORED: u8 = 1;
/// The same and the numerical stress and the creep of a step of some length.
pub(super) const MOVED: u8 = 2;

/// The film and the step that led to the current positions.
pub(super) struct Law<'a> {
    pub material: &'a Material,
    pub creep: &'a Creep,
    pub step: TimeStep,
}

/// Eight elements: their constants and their state, with the creep strain before and after the step.
pub(super) struct Element<'a> {
    pub block: &'a ElementBlock,
    pub history: &'a mut ElementHistory,
    pub last_creep: &'a CreepStrain,
    pub next_creep: &'a mut CreepStrain,
    /// Their first lane.
    pub lane: usize,
}

/// The strain of eight elements, and what the creep of the step adds to it.
#[derive(Clone, Copy)]
struct Strained<L> {
    /// Ê.
    strain: [L; 3],
    circle: MohrCircle<L>,
    /// ΔP.
    creep_step: [L; 3],
    /// C:P⁻ subtracted from S⁻, and C:P.
    last_driving: [L; 3],
    weighted_creep: [L; 3],
}

/// The strain of eight elements at their metric. The creep strain after the step is written beside that before it.
///
/// `LOSS`: whether the film creeps; `PASS`: [`CONSERVATIVE`], [`STORED`] or [`MOVED`].
#[inline(always)]
fn strained<L: Wide, const LOSS: bool, const PASS: u8>(
    Law { creep, step, .. }: &Law<'_>,
    Element { block, history, last_creep, next_creep, lane }: &mut Element<'_>,
    metric: Metric<L>,
) -> Strained<L> {
    let zero = L::splat(0.0);
    let mut strain = metric.strain(block, *lane);
    let (mut creep_step, mut last_driving, mut weighted_creep) = ([zero; 3], [zero; 3], [zero; 3]);
    if LOSS {
        let mut creep_strain = load_all::<L, 3>(&last_creep.0, *lane);
        if PASS == MOVED {
            let last_stress = load_all::<L, 3>(&history.stress, *lane);
            last_driving = subtract(last_stress, isotropic(creep_strain, creep.stiffness));
            creep_step =
                scale(isotropic(last_driving, creep.compliance), L::splat(step.creep_share));
            creep_strain = Creep::after_step(creep_strain, creep_step);
            store(creep_strain, &mut next_creep.0, *lane);
            weighted_creep = isotropic(creep_strain, creep.stiffness);
        }
        let overstrain = scale(subtract(strain, creep_strain), L::splat(creep.ratio));
        strain = add(strain, overstrain);
    }
    let circle = MohrCircle::of_difference(strain[0], strain[1], strain[2]);
    Strained { strain, circle, creep_step, last_driving, weighted_creep }
}

/// The stress of eight elements, and what the numerical stress of the step needs of it.
#[derive(Clone, Copy)]
struct Stressed<L> {
    stress: [L; 3],
    largest_stress: L,
    strain_step: [L; 3],
    stress_step: [L; 3],
    twice_missed: L,
    /// κ before it is bounded, from −½ to ½.
    share: L,
}

/// The stress of eight elements at their strain. Replaces the stored strain and stress by the current ones.
#[inline(always)]
fn stressed<L: Wide, const PASS: u8>(
    Law { material, .. }: &Law<'_>,
    Element { history, lane, .. }: &mut Element<'_>,
    Strained { strain, circle, .. }: &Strained<L>,
) -> Stressed<L> {
    let zero = L::splat(0.0);
    let last_strain = load_all::<L, 3>(&history.strain, *lane);
    let last_stress = load_all::<L, 3>(&history.stress, *lane);
    store(*strain, &mut history.strain, *lane);
    let StressResponse { mean, shear_modulus, largest } = material.response(*circle);
    let stress = [mean, shear_modulus * circle.difference, shear_modulus * circle.shear];
    store(stress, &mut history.stress, *lane);
    let (mut strain_step, mut stress_step) = ([zero; 3], [zero; 3]);
    let (mut twice_missed, mut share) = (zero, zero);
    if PASS == MOVED {
        (strain_step, stress_step) =
            (subtract(*strain, last_strain), subtract(stress, last_stress));
        // Twice the energy that a step of mean stress (S + S⁻)/2 misses, and the work ΔS:ΔÊ.
        twice_missed = contract(stress, last_strain) - contract(last_stress, *strain);
        let work = contract(stress_step, strain_step).max(L::splat(f64::MIN_POSITIVE));
        share = (twice_missed * L::splat(0.5)).over(work);
    }
    Stressed { stress, largest_stress: largest, strain_step, stress_step, twice_missed, share }
}

/// The response of eight elements to their strain and stress. Replaces the stored numerical stress by the current one.
#[inline(always)]
fn response<L: Wide, const LOSS: bool, const PASS: u8>(
    Law { creep, step, .. }: &Law<'_>,
    Element { block, history, lane, .. }: &mut Element<'_>,
    Strained { creep_step, last_driving, weighted_creep, .. }: Strained<L>,
    stressed: Stressed<L>,
) -> ElementResponse<L> {
    let zero = L::splat(0.0);
    let Stressed { stress, largest_stress, strain_step, stress_step, twice_missed, share } =
        stressed;
    let last_numerical = if PASS == CONSERVATIVE {
        [zero; 3]
    } else {
        load_all::<L, 3>(&history.numerical_stress, *lane)
    };
    let minus_volume = load::<L>(&block.minus_volume, *lane);
    let (mut numerical, mut minus_twice_numerical) = (last_numerical, zero);
    let mut minus_twice_loss = zero;
    if PASS == MOVED {
        // Rounding alone takes κ out of its bounds.
        let half = L::splat(0.5);
        let share = -((-share.max(-half)).max(-half));
        let damping = load::<L>(&block.damping_time, *lane) * step.inverse;
        numerical = scale(stress_step, share + damping);
        store(numerical, &mut history.numerical_stress, *lane);
        let displacement = if LOSS {
            add(strain_step, scale(creep_step, L::splat(creep.ratio)))
        } else {
            strain_step
        };
        let twice_work = contract(add(numerical, last_numerical), displacement) - twice_missed;
        minus_twice_numerical = minus_volume * twice_work;
        if LOSS {
            let driving = subtract(stress, weighted_creep);
            minus_twice_loss = minus_volume * contract(add(driving, last_driving), creep_step);
        }
    }

    // −A t (s + d), then its components.
    let [mean, half_difference, xy] = scale(add(stress, numerical), minus_volume);
    let (xx, yy) = (mean + half_difference, mean - half_difference);
    // Gᵀ: r1 = a² Sxx + b (b Syy + 2 a Sxy)    r2 = d (b Syy + a Sxy)    r3 = d² Syy.
    let [a, b, d] = load_all::<L, 3>(&block.inverse_shape, *lane);
    let a_xy = a * xy;
    let b_yy_a_xy = b * yy + a_xy;
    let minus_force_density = [(a * a) * xx + b * (b_yy_a_xy + a_xy), d * b_yy_a_xy, (d * d) * yy];
    ElementResponse { minus_force_density, minus_twice_numerical, minus_twice_loss, largest_stress }
}

/// Both elements of kites at their metrics. Each part is computed for both before the next part: a square root and a
/// quotient have a long latency, which work on the other element fills.
#[inline(always)]
pub(super) fn kite_response<L: Wide, const LOSS: bool, const PASS: u8>(
    law: &Law<'_>,
    [mut a, mut b]: [Element<'_>; 2],
    metrics: [Metric<L>; 2],
) -> [ElementResponse<L>; 2] {
    let first = strained::<L, LOSS, PASS>(law, &mut a, metrics[0]);
    let second = strained::<L, LOSS, PASS>(law, &mut b, metrics[1]);
    let first_stress = stressed::<L, PASS>(law, &mut a, &first);
    let second_stress = stressed::<L, PASS>(law, &mut b, &second);
    let first = response::<L, LOSS, PASS>(law, &mut a, first, first_stress);
    [first, response::<L, LOSS, PASS>(law, &mut b, second, second_stress)]
}
