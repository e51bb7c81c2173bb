//! The loop over the elements, eight kites at a time: forces on the nodes from the metric of the edges.
//!
//! ```text
//! element, edges p = x1 − x0 and q = x2 − x0:
//!   metric              m = (p·p/2, p·q, q·q/2)
//!   Green strain        E = G m − (1/2, 1/2, 0)
//!   creep strain        P = P⁻ + (1 − exp(−Δt/τ)) (C⁻¹:S⁻ − P⁻)
//!   elastic strain      Ê = E + g (E − P)
//!   stress              S = S(Ê)
//!   numerical stress    D = (κ + 2ζ/(ω_e Δt)) (S − S⁻)
//!   force densities     r = A t Gᵀ (S + D)                        N/m, force over edge length
//!   nodal forces        f1 = −(r1 p + r2 q)    f2 = −(r2 p + r3 q)    f0 = −(f1 + f2)
//!
//! strain and stress as three components, E:S = e·s:
//!   e = (Exx + Eyy, Exx − Eyy, 2 Exy)        s = ((Sxx + Syy)/2, (Sxx − Syy)/2, Sxy)
//!
//! kite s, a, t, b with edges p = a − s, d = t − s, q = b − s; r of (s, a, t), r' of (s, t, b):
//!   f_a = −(r1 p + r2 d)    f_t = −(r2 p + (r3 + r'1) d + r'2 q)    f_b = −(r'2 d + r'3 q)
//!   f_s = −(f_a + f_t + f_b)
//! ```
//!
//! G is that of [`ElementBlock`], S(Ê) of [`crate::mechanics::material`], P of
//! [`crate::mechanics::material_loss`], D and its work of [`crate::mechanics::forces::damping`]. These
//! are the forces of [`super`], without F. A superscript ⁻ marks the previous step, stored in
//! [`ElementHistory`].

#![allow(clippy::inline_always, reason = "inside the element loop")]

use super::{CreepStep, CreepStrain, ElementHistory};
use crate::geometry::field::Field;
use crate::mechanics::film_model::{ElementBlock, FilmModel};
use crate::mechanics::material::{Material, MohrCircle, StressResponse};
use crate::mechanics::material_loss::Creep;
use crate::mechanics::tensor::{add, contract, isotropic, scale, subtract};
use crate::platform::simd::{Columns, Lanes, NodeSum, Vectors, Wide, dispatch_wide};

/// Sums over all elements, lane by lane.
#[derive(Debug, Clone, Copy)]
pub(super) struct LaneSums {
    /// Six times the enclosed volume, m³.
    pub six_volumes: Lanes,
    /// Minus twice the numerical dissipation of the step, times 1 + g, J.
    pub minus_twice_numerical: Lanes,
    /// Minus twice the material loss of the step, times (1 + g)/g, J.
    pub minus_twice_loss: Lanes,
    /// Largest principal stress, Pa.
    pub largest_stress: Lanes,
}

/// Metric of the edges p and q: (p·p/2, p·q, q·q/2), m².
#[derive(Clone, Copy)]
struct Metric<L>([L; 3]);

impl<L: Wide> Metric<L> {
    /// Green strain (Exx + Eyy, Exx − Eyy, 2 Exy).
    ///
    /// ```text
    /// Exx + ½ = a² m1      Eyy + ½ = b (b m1 + d m2) + d² m3      2 Exy = a (b m1 + (b m1 + d m2))
    /// ```
    #[inline(always)]
    fn strain(self, block: &ElementBlock) -> [L; 3] {
        let Self([m1, m2, m3]) = self;
        let [a, b, d] = load_all::<L, 3>(&block.inverse_shape);
        let (b_m1, d_m2) = (b * m1, d * m2);
        let b_m1_d_m2 = b_m1 + d_m2;
        // Exx + ½ and Eyy + ½.
        let (xx, yy) = ((a * a) * m1, b * b_m1_d_m2 + (d * d) * m3);
        [xx + yy - L::splat(1.0), xx - yy, a * (b_m1 + b_m1_d_m2)]
    }
}

#[inline(always)]
fn load<L: Wide>(lanes: &Lanes) -> L {
    L::load(&lanes.0, 0)
}

#[inline(always)]
fn load_all<L: Wide, const N: usize>(lanes: &[Lanes; N]) -> [L; N] {
    let mut all = [L::splat(0.0); N];
    for k in 0..N {
        all[k] = load(&lanes[k]);
    }
    all
}

/// Edges of kites from s to a, t and b.
#[inline(always)]
fn edges<L: Wide>([s, a, t, b]: [Vectors<L>; 4]) -> [Vectors<L>; 3] {
    [a - s, t - s, b - s]
}

/// Writes three components to a stored tensor.
#[inline(always)]
fn store<L: Wide>(a: [L; 3], stored: &mut [Lanes; 3]) {
    *stored = [a[0].lanes(), a[1].lanes(), a[2].lanes()];
}

/// Result of eight elements.
struct ElementResponse<L> {
    /// −r, N/m.
    minus_force_density: [L; 3],
    /// Minus twice the numerical dissipation of the step, J.
    minus_twice_numerical: L,
    /// Minus twice the material loss of the step, J.
    minus_twice_loss: L,
    /// Larger principal stress, Pa.
    largest_stress: L,
}

/// The step that led to the current positions.
#[derive(Clone, Copy)]
struct TimeStep {
    /// 1/Δt, 1/s; 0 in a step of no time, in which nothing moved and P and D are the stored ones.
    inverse: f64,
    /// 1 − exp(−Δt/τ).
    creep_share: f64,
}

/// What a pass over the elements includes: only forces that are derivatives of an energy.
const CONSERVATIVE: u8 = 0;
/// The same and the numerical stress that is stored; nothing moved since.
const STORED: u8 = 1;
/// The same and the numerical stress and the creep of a step of some length.
const MOVED: u8 = 2;

/// Response of eight elements at their metric. Replaces the stored values by the current ones; the creep
/// strain after the step is written beside that before it.
///
/// `LOSS`: whether the film creeps; `PASS`: [`CONSERVATIVE`], [`STORED`] or [`MOVED`].
#[inline(always)]
fn element_response<L: Wide, const LOSS: bool, const PASS: u8>(
    (material, creep): (&Material, &Creep),
    block: &ElementBlock,
    metric: Metric<L>,
    step: TimeStep,
    history: &mut ElementHistory,
    (last_creep, next_creep): (&CreepStrain, &mut CreepStrain),
) -> ElementResponse<L> {
    let zero = L::splat(0.0);
    let total_strain = metric.strain(block);
    let last_stress = load_all::<L, 3>(&history.stress);
    let mut strain = total_strain;
    let (mut creep_step, mut minus_twice_loss) = ([zero; 3], zero);
    let (mut last_driving, mut weighted_creep) = ([zero; 3], [zero; 3]);
    if LOSS {
        let mut creep_strain = load_all::<L, 3>(&last_creep.0);
        if PASS == MOVED {
            last_driving = subtract(last_stress, isotropic(creep_strain, creep.stiffness));
            creep_step =
                scale(isotropic(last_driving, creep.compliance), L::splat(step.creep_share));
            creep_strain = add(creep_strain, creep_step);
            store(creep_strain, &mut next_creep.0);
            weighted_creep = isotropic(creep_strain, creep.stiffness);
        }
        let overstrain = scale(subtract(strain, creep_strain), L::splat(creep.ratio));
        strain = add(strain, overstrain);
    }
    // The square root in `MohrCircle` has a long latency: independent work follows it.
    let circle = MohrCircle::of_difference(strain[0], strain[1], strain[2]);
    let last_strain = load_all::<L, 3>(&history.strain);
    let last_numerical =
        if PASS == CONSERVATIVE { [zero; 3] } else { load_all::<L, 3>(&history.numerical_stress) };
    store(strain, &mut history.strain);
    let StressResponse { mean, shear_modulus, largest } = material.response(circle);
    let stress = [mean, shear_modulus * circle.difference, shear_modulus * circle.shear];
    store(stress, &mut history.stress);

    let minus_volume = load::<L>(&block.minus_volume);
    let (mut numerical, mut minus_twice_numerical) = (last_numerical, zero);
    if PASS == MOVED {
        let (strain_step, stress_step) =
            (subtract(strain, last_strain), subtract(stress, last_stress));
        // Twice the energy that a step of mean stress (S + S⁻)/2 misses, and the work ΔS:ΔÊ.
        let twice_missed = contract(stress, last_strain) - contract(last_stress, strain);
        let work = contract(stress_step, strain_step).max(L::splat(f64::MIN_POSITIVE));
        let half = L::splat(0.5);
        // κ, from −½ to ½: rounding alone takes the quotient out of these bounds.
        let share = (twice_missed * half).over(work);
        let share = -((-share.max(-half)).max(-half));
        let damping = load::<L>(&block.damping_time) * step.inverse;
        numerical = scale(stress_step, share + damping);
        store(numerical, &mut history.numerical_stress);
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
    let [a, b, d] = load_all::<L, 3>(&block.inverse_shape);
    let a_xy = a * xy;
    let b_yy_a_xy = b * yy + a_xy;
    let minus_force_density = [(a * a) * xx + b * (b_yy_a_xy + a_xy), d * b_yy_a_xy, (d * d) * yy];
    ElementResponse {
        minus_force_density,
        minus_twice_numerical,
        minus_twice_loss,
        largest_stress: largest,
    }
}

#[inline(always)]
fn element_kernel<L: Wide, const LOSS: bool, const PASS: u8>(
    model: &FilmModel,
    positions: &Field,
    step: TimeStep,
    creep_step: &mut CreepStep<'_>,
    histories: &mut [[ElementHistory; 2]],
    sums: &mut [NodeSum],
) -> LaneSums {
    let (material, creep) = (model.material, model.creep);
    let law = (&material, &creep);
    let half = L::splat(0.5);
    let (mut six_volumes, mut largest_stress) = (L::splat(0.0), L::splat(0.0));
    let (mut numerical, mut loss) = (L::splat(0.0), L::splat(0.0));
    let corners = &model.corners;
    let mut cleared = 0;
    if corners.blocks() == 0 {
        sums.fill(NodeSum::default());
    }
    let blocks = corners.blocks();
    let (constants, histories) = (&model.constants[..blocks], &mut histories[..blocks]);
    let positions = Columns::new(&model.corners, [&positions.x, &positions.y, &positions.z]);
    let creep_blocks = if LOSS { blocks } else { 0 };
    let last_creep = &creep_step.last[..creep_blocks];
    let writes_creep = LOSS && PASS == MOVED;
    let next_creep = &mut creep_step.next[..if writes_creep { blocks } else { 0 }];
    let (none, mut unused) = ([CreepStrain::default(); 2], [CreepStrain::default(); 2]);
    for block in 0..blocks {
        let [first_block, second_block] = &constants[block];
        let [first_history, second_history] = &mut histories[block];
        let [first_last, second_last] = if LOSS { &last_creep[block] } else { &none };
        let [first_next, second_next] =
            if writes_creep { &mut next_creep[block] } else { &mut unused };
        let kites = positions.corners::<L>(block);
        let [p, d, q] = edges(kites);
        let (first_normal, second_normal) = (p.cross(d), d.cross(q));
        let normal = first_normal + second_normal;
        let six_volume = kites[0].dot(normal);

        let d_metric = d.dot(d) * half;
        let metric = Metric([p.dot(p) * half, p.dot(d), d_metric]);
        let first = element_response::<L, LOSS, PASS>(
            law,
            first_block,
            metric,
            step,
            first_history,
            (first_last, first_next),
        );
        let metric = Metric([d_metric, d.dot(q), q.dot(q) * half]);
        let second = element_response::<L, LOSS, PASS>(
            law,
            second_block,
            metric,
            step,
            second_history,
            (second_last, second_next),
        );

        largest_stress = largest_stress.max(first.largest_stress).max(second.largest_stress);
        numerical = numerical + (first.minus_twice_numerical + second.minus_twice_numerical);
        loss = loss + (first.minus_twice_loss + second.minus_twice_loss);
        six_volumes = six_volumes + six_volume;
        let (r, r2) = (first.minus_force_density, second.minus_force_density);
        let force_a = p.scale(r[0]) + d.scale(r[1]);
        let force_t = p.scale(r[1]) + d.scale(r[2] + r2[0]) + q.scale(r2[1]);
        let force_b = d.scale(r2[1]) + q.scale(r2[2]);
        let film = [-(force_a + force_t + force_b), force_a, force_t, force_b];
        cleared = corners.clear_sums(block, cleared, sums);
        corners.scatter(block, &film, &[normal, first_normal, second_normal], sums);
    }
    LaneSums {
        six_volumes: six_volumes.lanes(),
        minus_twice_numerical: numerical.lanes(),
        minus_twice_loss: loss.lanes(),
        largest_stress: largest_stress.lanes(),
    }
}

/// Selects the kernel before the loop. `step`: the length of the step, s, or `None` for the conservative
/// part alone.
#[inline(always)]
fn step_kernel<L: Wide>(
    model: &FilmModel,
    positions: &Field,
    step: Option<f64>,
    creep: &mut CreepStep<'_>,
    histories: &mut [[ElementHistory; 2]],
    sums: &mut [NodeSum],
) -> LaneSums {
    let length = step.unwrap_or(0.0);
    let inverse = if length > 0.0 { 1.0 / length } else { 0.0 };
    let time = TimeStep { inverse, creep_share: model.creep.share(length) };
    match (model.creep.ratio > 0.0, step) {
        (false, None) => {
            element_kernel::<L, false, CONSERVATIVE>(model, positions, time, creep, histories, sums)
        }
        (true, None) => {
            element_kernel::<L, true, CONSERVATIVE>(model, positions, time, creep, histories, sums)
        }
        (false, Some(length)) if length > 0.0 => {
            element_kernel::<L, false, MOVED>(model, positions, time, creep, histories, sums)
        }
        (true, Some(length)) if length > 0.0 => {
            element_kernel::<L, true, MOVED>(model, positions, time, creep, histories, sums)
        }
        (false, Some(_)) => {
            element_kernel::<L, false, STORED>(model, positions, time, creep, histories, sums)
        }
        (true, Some(_)) => {
            element_kernel::<L, true, STORED>(model, positions, time, creep, histories, sums)
        }
    }
}

dispatch_wide! {
    /// Sets `sums` to the forces and normals of all elements, and returns the sums over the elements.
    pub(super) fn sum_elements / step_kernel(
        model: &FilmModel,
        positions: &Field,
        step: Option<f64>,
        creep: &mut CreepStep<'_>,
        histories: &mut [[ElementHistory; 2]],
        sums: &mut [NodeSum],
    ) -> LaneSums
}
