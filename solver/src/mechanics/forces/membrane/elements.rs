//! The loop over the elements, eight kites at a time: forces on the nodes from the metric of the edges.
//!
//! ```text
//! element, edges p = x1 − x0 and q = x2 − x0:
//!   metric              m = (p·p/2, p·q, q·q/2)
//!   Green strain        E = G m − (1/2, 1/2, 0)
//!   viscous stress      S_v = 2ζ/ω_e C:(E − E⁻)/Δt
//!   viscous work        ½ A t (S_v + S_v⁻):(E − E⁻)
//!   force densities     r = A t Gᵀ (S + S_v)                      N/m, force over edge length
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
//! G is that of [`ElementBlock`], S of [`crate::mechanics::material`], `S_v` of
//! [`crate::mechanics::forces::damping`]. These are the forces of [`super`], without F. A superscript ⁻
//! marks the previous step, stored in [`ViscousHistory`].

#![allow(clippy::inline_always, reason = "inside the element loop")]

use super::ViscousHistory;
use crate::geometry::field::Field;
use crate::mechanics::film_model::{ElementBlock, FilmModel};
use crate::mechanics::material::{Material, MohrCircle, StressResponse};
use crate::platform::simd::{Columns, Lanes, NodeSum, Vectors, Wide, dispatch_wide};

/// Sums over all elements, lane by lane.
#[derive(Debug, Clone, Copy)]
pub(super) struct LaneSums {
    /// Six times the enclosed volume, m³.
    pub six_volumes: Lanes,
    /// Minus twice the viscous work of the step, J.
    pub minus_twice_work: Lanes,
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

/// S:E of a stress (mean, half difference, shear) and a strain (sum, difference, shear).
#[inline(always)]
fn contract<L: Wide>([mean, half_difference, s_xy]: [L; 3], [sum, difference, shear]: [L; 3]) -> L {
    mean * sum + half_difference * difference + s_xy * shear
}

/// Edges of kites from s to a, t and b.
#[inline(always)]
fn edges<L: Wide>([s, a, t, b]: [Vectors<L>; 4]) -> [Vectors<L>; 3] {
    [a - s, t - s, b - s]
}

/// Result of eight elements.
struct ElementResponse<L> {
    /// −r, N/m.
    minus_force_density: [L; 3],
    /// Minus twice the viscous work of the step, J.
    minus_twice_work: L,
    /// Larger principal stress, Pa.
    largest_stress: L,
}

/// Duration of the step that led to the current positions.
#[derive(Clone, Copy)]
enum TimeStep<L> {
    /// 1/Δt, 1/s.
    Inverse(L),
    /// Zero: nothing moved, and `S_v` is the stored one.
    Zero,
}

/// Response of eight elements at their metric. Replaces the stored strain and viscous stress by the
/// current ones.
#[inline(always)]
fn element_response<L: Wide>(
    material: &Material,
    block: &ElementBlock,
    metric: Metric<L>,
    step: TimeStep<L>,
    history: &mut ViscousHistory,
) -> ElementResponse<L> {
    // The square root in `MohrCircle` has a long latency: independent work follows it.
    let strain = metric.strain(block);
    let circle = MohrCircle::of_difference(strain[0], strain[1], strain[2]);
    let last_strain = load_all::<L, 3>(&history.strain);
    let last_viscous = load_all::<L, 3>(&history.minus_weighted_stress);
    history.strain = [strain[0].lanes(), strain[1].lanes(), strain[2].lanes()];
    // `viscous` is −A t s_v.
    let (viscous, minus_twice_work) = match step {
        TimeStep::Inverse(inverse) => {
            let change = [
                strain[0] - last_strain[0],
                strain[1] - last_strain[1],
                strain[2] - last_strain[2],
            ];
            let nu = material.poisson_ratio;
            let viscosity = load::<L>(&block.minus_viscosity);
            let mean_factor = viscosity * (inverse * (0.5 * (1.0 + nu)));
            let shear_factor = viscosity * (inverse * (0.5 * (1.0 - nu)));
            let viscous =
                [mean_factor * change[0], shear_factor * change[1], shear_factor * change[2]];
            let sum = [
                viscous[0] + last_viscous[0],
                viscous[1] + last_viscous[1],
                viscous[2] + last_viscous[2],
            ];
            (viscous, contract(sum, change))
        }
        TimeStep::Zero => (last_viscous, L::splat(0.0)),
    };
    history.minus_weighted_stress = [viscous[0].lanes(), viscous[1].lanes(), viscous[2].lanes()];

    // −A t (s + s_v), then its components.
    let StressResponse { mean, shear_modulus, largest } = material.response(circle);
    let minus_volume = load::<L>(&block.minus_volume);
    let shear_modulus = shear_modulus * minus_volume;
    let mean = mean * minus_volume + viscous[0];
    let half_difference = shear_modulus * circle.difference + viscous[1];
    let (xx, yy) = (mean + half_difference, mean - half_difference);
    let xy = shear_modulus * circle.shear + viscous[2];
    // Gᵀ: r1 = a² Sxx + b (b Syy + 2 a Sxy)    r2 = d (b Syy + a Sxy)    r3 = d² Syy.
    let [a, b, d] = load_all::<L, 3>(&block.inverse_shape);
    let a_xy = a * xy;
    let b_yy_a_xy = b * yy + a_xy;
    let minus_force_density = [(a * a) * xx + b * (b_yy_a_xy + a_xy), d * b_yy_a_xy, (d * d) * yy];
    ElementResponse { minus_force_density, minus_twice_work, largest_stress: largest }
}

#[inline(always)]
fn element_kernel<L: Wide>(
    model: &FilmModel,
    positions: &Field,
    step: TimeStep<L>,
    histories: &mut [[ViscousHistory; 2]],
    sums: &mut [NodeSum],
) -> LaneSums {
    let material = model.material;
    let half = L::splat(0.5);
    let (mut six_volumes, mut work, mut largest_stress) =
        (L::splat(0.0), L::splat(0.0), L::splat(0.0));
    let corners = &model.corners;
    let mut cleared = 0;
    if corners.blocks() == 0 {
        sums.fill(NodeSum::default());
    }
    let blocks = corners.blocks();
    let (constants, histories) = (&model.constants[..blocks], &mut histories[..blocks]);
    let positions = Columns::new(&model.corners, [&positions.x, &positions.y, &positions.z]);
    for block in 0..blocks {
        let [first_block, second_block] = &constants[block];
        let [first_history, second_history] = &mut histories[block];
        let kites = positions.corners::<L>(block);
        let [p, d, q] = edges(kites);
        let (first_normal, second_normal) = (p.cross(d), d.cross(q));
        let normal = first_normal + second_normal;
        let six_volume = kites[0].dot(normal);

        let d_metric = d.dot(d) * half;
        let metric = Metric([p.dot(p) * half, p.dot(d), d_metric]);
        let first = element_response(&material, first_block, metric, step, first_history);
        let metric = Metric([d_metric, d.dot(q), q.dot(q) * half]);
        let second = element_response(&material, second_block, metric, step, second_history);

        let minus_twice_work = first.minus_twice_work + second.minus_twice_work;
        largest_stress = largest_stress.max(first.largest_stress).max(second.largest_stress);
        work = work + minus_twice_work;
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
        minus_twice_work: work.lanes(),
        largest_stress: largest_stress.lanes(),
    }
}

/// Selects the kernel for a step of this length (s) before the loop.
#[inline(always)]
fn step_kernel<L: Wide>(
    model: &FilmModel,
    positions: &Field,
    step: f64,
    histories: &mut [[ViscousHistory; 2]],
    sums: &mut [NodeSum],
) -> LaneSums {
    if step > 0.0 {
        let step = TimeStep::Inverse(L::splat(1.0 / step));
        element_kernel::<L>(model, positions, step, histories, sums)
    } else {
        element_kernel::<L>(model, positions, TimeStep::Zero, histories, sums)
    }
}

dispatch_wide! {
    /// Sets `sums` to the forces and normals of all elements, and returns the sums over the elements.
    pub(super) fn sum_elements / step_kernel(
        model: &FilmModel,
        positions: &Field,
        step: f64,
        histories: &mut [[ViscousHistory; 2]],
        sums: &mut [NodeSum],
    ) -> LaneSums
}
