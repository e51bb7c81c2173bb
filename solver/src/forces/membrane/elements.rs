//! The pass over the elements, eight kites at a time: what each does to its nodes, told by its metric.
//!
//! ```text
//! p = x1 − x0, q = x2 − x0      m = (p·p/2, p·q, q·q/2)      e = G m − (1/2, 1/2, 0)
//! u = ẋ1 − ẋ0, w = ẋ2 − ẋ0      ṁ = (p·u, p·w + q·u, q·w)    ė = G ṁ
//! r = A t Gᵀ (S + S_v)          f1 = −(r1 p + r2 q)  f2 = −(r2 p + r3 q)  f0 = −(f1 + f2)
//! ```
//!
//! with G of [`ElementBlock`], S of [`crate::material`] and `S_v` of [`crate::forces::damping`]: the
//! forces of [`super`]'s equations without an F. The metric a way h before had the rate
//! ṁ − h (u·u, 2 u·w, w·w) along the same velocities. The halves of a kite share the edge from s to t,
//! last in the first and first in the second.

#![allow(clippy::inline_always, reason = "inside the element loop")]

use super::Drag;
use crate::material::{Circle, Material, Response};
use crate::model::{ElementBlock, FilmModel};
use crate::simd::{Columns, Corners, Lanes, NodeSum, Vectors, Wide, dispatch_wide};
use crate::state::Field;

/// Blocks that follow each other, and where what they give goes.
pub(super) struct Share<'a> {
    /// The first of them.
    pub first: usize,
    /// Where their corners add to.
    pub targets: &'a Corners,
    /// What is remembered of them.
    pub drag: &'a mut [Drag],
    /// Forces and normals, begun anew.
    pub sums: &'a mut [NodeSum],
    /// Volumes and powers of each block, where they are kept; else empty.
    pub terms: &'a mut [[Lanes; 2]],
}

/// Sums over the elements of a share, lane by lane.
#[derive(Debug, Clone, Copy)]
pub(super) struct LaneSums {
    /// Six times the volumes, m³.
    pub volumes: Lanes,
    /// Minus the powers viscosity takes, W.
    pub power: Lanes,
    /// The largest principal stresses, Pa.
    pub largest: Lanes,
}

/// Of the edges p and q: p·p/2, p·q, q·q/2, or their rates.
#[derive(Clone, Copy)]
struct Metric<L>([L; 3]);

impl<L: Wide> Metric<L> {
    /// Exx, Eyy, 2 Exy.
    #[inline(always)]
    fn strain(self, block: &ElementBlock) -> [L; 3] {
        let Self([pp, pq, qq]) = self;
        let (half, [b0, b1, b2], [c0, c1]) =
            (L::splat(0.5), all::<L, 3>(&block.yy), all::<L, 2>(&block.shear));
        [of::<L>(&block.xx) * pp - half, b0 * pp + b1 * pq + b2 * qq - half, c0 * pp + c1 * pq]
    }

    /// The strain's rate, of the metric's.
    #[inline(always)]
    fn strain_rate(self, block: &ElementBlock) -> [L; 3] {
        let Self([pp, pq, qq]) = self;
        let ([b0, b1, b2], [c0, c1]) = (all::<L, 3>(&block.yy), all::<L, 2>(&block.shear));
        [of::<L>(&block.xx) * pp, b0 * pp + b1 * pq + b2 * qq, c0 * pp + c1 * pq]
    }
}

#[inline(always)]
fn of<L: Wide>(lanes: &Lanes) -> L {
    L::load(&lanes.0, 0)
}

#[inline(always)]
fn all<L: Wide, const N: usize>(lanes: &[Lanes; N]) -> [L; N] {
    let mut all = [L::splat(0.0); N];
    for k in 0..N {
        all[k] = of(&lanes[k]);
    }
    all
}

/// Double contraction of a stress (xx, yy, xy) and a strain rate (xx, yy, 2xy).
#[inline(always)]
fn contract<L: Wide>([xx, yy, xy]: [L; 3], rate: [L; 3]) -> L {
    xx * rate[0] + yy * rate[1] + xy * rate[2]
}

/// Edges from s to a, t and b.
#[inline(always)]
fn edges<L: Wide>([s, a, t, b]: [Vectors<L>; 4]) -> [Vectors<L>; 3] {
    [a - s, t - s, b - s]
}

/// What eight elements tell of themselves.
struct Told<L> {
    /// −r, N/m.
    pull: [L; 3],
    /// Minus the power viscosity takes, W.
    taken: L,
    /// Larger principal stresses, Pa.
    largest: L,
}

/// Of eight elements at their metric, at its rate here and a way before, and what they had there.
#[inline(always)]
fn told<L: Wide>(
    material: &Material,
    block: &ElementBlock,
    metric: Metric<L>,
    [rate, rate_before]: [Metric<L>; 2],
    remembered: &mut [Lanes; 3],
) -> Told<L> {
    // The root is long in coming: what does not wait for it stands between.
    let [xx, yy, shear] = metric.strain(block);
    let circle = Circle::of(xx, yy, shear);
    let [xx, yy, shear] = rate.strain_rate(block);
    let (nu, drag) = (L::splat(material.poisson_ratio), of::<L>(&block.drag));
    let half_shear = L::splat(0.5 * (1.0 - material.poisson_ratio));
    let viscous = [drag * (xx + nu * yy), drag * (yy + nu * xx), (drag * half_shear) * shear];
    let taken = contract(viscous, [xx, yy, shear]);
    let taken = taken + contract(all::<L, 3>(remembered), rate_before.strain_rate(block));
    let [xx, yy, xy] = viscous;
    *remembered = [xx.lanes(), yy.lanes(), xy.lanes()];

    let Response { mean, shear_modulus, largest } = material.response(circle);
    let minus_volume = of::<L>(&block.minus_volume);
    let (mean, shear_modulus) = (mean * minus_volume, shear_modulus * minus_volume);
    let bent = shear_modulus * circle.difference;
    let xx = mean + xx + bent;
    let yy = mean + yy - bent;
    let xy = xy + shear_modulus * circle.shear;
    let ([b0, b1, b2], [c0, c1]) = (all::<L, 3>(&block.yy), all::<L, 2>(&block.shear));
    let pull = [of::<L>(&block.xx) * xx + b0 * yy + c0 * xy, b1 * yy + c1 * xy, b2 * yy];
    Told { pull, taken, largest }
}

#[inline(always)]
fn element_kernel<L: Wide, const KEPT: bool>(
    model: &FilmModel,
    positions: &Field,
    velocities: &Field,
    way: f64,
    share: Share<'_>,
) -> LaneSums {
    let material = model.material;
    let (half, way, twice) = (L::splat(0.5), L::splat(way), L::splat(way + way));
    let (mut volumes, mut power, mut largest) = (L::splat(0.0), L::splat(0.0), L::splat(0.0));
    let Share { first, targets, drag, sums, terms } = share;
    sums.fill(NodeSum::default());
    let end = first + targets.blocks();
    let (constants, drag) = (&model.constants[first..end], &mut drag[..end - first]);
    let nodes = &model.blocks;
    let places = Columns::new(nodes, [&positions.x, &positions.y, &positions.z]);
    let speeds = Columns::new(nodes, [&velocities.x, &velocities.y, &velocities.z]);
    for own in 0..end - first {
        let ([first_block, second_block], remembered) = (&constants[own], &mut drag[own].0);
        let corners = places.corners::<L>(first + own);
        let [p, d, q] = edges(corners);
        let (first_normal, second_normal) = (p.cross(d), d.cross(q));
        let normal = first_normal + second_normal;
        let enclosed = corners[0].dot(normal);
        let [u, e, w] = edges(speeds.corners::<L>(first + own));

        let shared = d.dot(d) * half;
        let [pd, dq] = [p.dot(d), d.dot(q)];
        let metrics =
            [Metric([p.dot(p) * half, pd, shared]), Metric([shared, dq, q.dot(q) * half])];
        let [uu, pe, ee] = [p.dot(u), p.dot(e) + d.dot(u), d.dot(e)];
        let [dw, ww] = [d.dot(w) + q.dot(e), q.dot(w)];
        let ee_before = ee - e.dot(e) * way;
        let rates_before = [
            Metric([uu - u.dot(u) * way, pe - u.dot(e) * twice, ee_before]),
            Metric([ee_before, dw - e.dot(w) * twice, ww - w.dot(w) * way]),
        ];
        let [metric, later_metric] = metrics;
        let [before, later_before] = rates_before;
        let [early, later] = remembered;
        let rates = [Metric([uu, pe, ee]), before];
        let one = told(&material, first_block, metric, rates, early);
        let rates = [Metric([ee, dw, ww]), later_before];
        let other = told(&material, second_block, later_metric, rates, later);

        let taken = one.taken + other.taken;
        largest = largest.max(one.largest).max(other.largest);
        if KEPT {
            terms[own] = [enclosed.lanes(), taken.lanes()];
        } else {
            power = power + taken;
            volumes = volumes + enclosed;
        }
        let (r, s) = (one.pull, other.pull);
        let at_a = p.scale(r[0]) + d.scale(r[1]);
        let at_t = p.scale(r[1]) + d.scale(r[2] + s[0]) + q.scale(s[1]);
        let at_b = d.scale(s[1]) + q.scale(s[2]);
        let film = [-(at_a + at_t + at_b), at_a, at_t, at_b];
        targets.scatter(own, &film, &[normal, first_normal, second_normal], sums);
    }
    LaneSums { volumes: volumes.lanes(), power: power.lanes(), largest: largest.lanes() }
}

#[inline(always)]
fn summed_kernel<L: Wide>(
    model: &FilmModel,
    positions: &Field,
    velocities: &Field,
    way: f64,
    share: Share<'_>,
) -> LaneSums {
    element_kernel::<L, false>(model, positions, velocities, way, share)
}

#[inline(always)]
fn kept_kernel<L: Wide>(
    model: &FilmModel,
    positions: &Field,
    velocities: &Field,
    way: f64,
    share: Share<'_>,
) -> LaneSums {
    element_kernel::<L, true>(model, positions, velocities, way, share)
}

dispatch_wide! {
    /// Adds forces and normals of the elements of a share to where they go, and gives their sums.
    pub(super) fn element_pass / summed_kernel(
        model: &FilmModel,
        positions: &Field,
        velocities: &Field,
        way: f64,
        share: Share<'_>,
    ) -> LaneSums
}

dispatch_wide! {
    /// The same; volumes and powers are kept a block in `terms` and are none in the sums.
    pub(super) fn element_pass_kept / kept_kernel(
        model: &FilmModel,
        positions: &Field,
        velocities: &Field,
        way: f64,
        share: Share<'_>,
    ) -> LaneSums
}
