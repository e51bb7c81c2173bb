//! The pass over the elements, eight kites at a time: what each does to its nodes, told by its metric.
//!
//! ```text
//! p = x1 − x0, q = x2 − x0      m = (p·p/2, p·q, q·q/2)      E = G m − (1/2, 1/2, 0)
//! S_v = 2ζ/ω_e C:(E − E⁻)/Δt    work S_v takes on the way here: ½ A t (S_v + S_v⁻):(E − E⁻)
//! r = A t Gᵀ (S + S_v)          f1 = −(r1 p + r2 q)  f2 = −(r2 p + r3 q)  f0 = −(f1 + f2)
//! ```
//!
//! with G of [`ElementBlock`], S of [`crate::mechanics::material`] and `S_v` of [`crate::mechanics::forces::damping`]: the
//! forces of [`super`]'s equations without an F. What was a step Δt ago has a ⁻, and is remembered
//! ([`ViscousHistory`]). The halves of a kite share the edge from s to t, last in the first and first in the second.

#![allow(clippy::inline_always, reason = "inside the element loop")]

use super::ViscousHistory;
use crate::geometry::field::Field;
use crate::mechanics::film_model::{ElementBlock, FilmModel};
use crate::mechanics::material::{Circle, Material, Response};
use crate::platform::simd::{Columns, Lanes, NodeSum, Vectors, Wide, dispatch_wide};

/// Sums over all elements, lane by lane.
#[derive(Debug, Clone, Copy)]
pub(super) struct LaneSums {
    /// Six times the volumes, m³.
    pub volumes: Lanes,
    /// Minus twice the works viscosity took on the way here, J.
    pub works: Lanes,
    /// The largest principal stresses, Pa.
    pub largest: Lanes,
}

/// Of the edges p and q: p·p/2, p·q, q·q/2.
#[derive(Clone, Copy)]
struct Metric<L>([L; 3]);

impl<L: Wide> Metric<L> {
    /// Exx + Eyy, Exx − Eyy, 2 Exy.
    #[inline(always)]
    fn strain(self, block: &ElementBlock) -> [L; 3] {
        let Self([pp, pq, qq]) = self;
        let [a, b, d] = all::<L, 3>(&block.inverse);
        let (along, across) = (b * pp, d * pq);
        let lean = along + across;
        // Both more than the strain by 1/2.
        let (xx, yy) = ((a * a) * pp, b * lean + (d * d) * qq);
        [xx + yy - L::splat(1.0), xx - yy, a * (along + lean)]
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

/// Double contraction of a stress and a strain, told as [`ViscousHistory`] tells them.
#[inline(always)]
fn contract<L: Wide>([mean, half, xy]: [L; 3], [sum, difference, shear]: [L; 3]) -> L {
    mean * sum + half * difference + xy * shear
}

/// Edges from s to a, t and b.
#[inline(always)]
fn edges<L: Wide>([s, a, t, b]: [Vectors<L>; 4]) -> [Vectors<L>; 3] {
    [a - s, t - s, b - s]
}

/// What eight elements tell of themselves.
struct ElementResponse<L> {
    /// −r, N/m.
    pull: [L; 3],
    /// Minus twice the work viscosity took, J.
    taken: L,
    /// Larger principal stresses, Pa.
    largest: L,
}

/// How long the way here took.
#[derive(Clone, Copy)]
enum Step<L> {
    /// Its inverse, 1/s.
    Inverse(L),
    /// No time: nothing moved, and `S_v` is what it was.
    None,
}

/// Of eight elements at their metric; what they remember becomes what is here.
#[inline(always)]
fn told<L: Wide>(
    material: &Material,
    block: &ElementBlock,
    metric: Metric<L>,
    step: Step<L>,
    past: &mut ViscousHistory,
) -> ElementResponse<L> {
    // The root is long in coming: what does not wait for it stands between.
    let strain = metric.strain(block);
    let circle = Circle::told(strain[0], strain[1], strain[2]);
    let (there, before) = (all::<L, 3>(&past.strain), all::<L, 3>(&past.drag));
    past.strain = [strain[0].lanes(), strain[1].lanes(), strain[2].lanes()];
    let (viscous, taken) = match step {
        Step::Inverse(inverse) => {
            let change = [strain[0] - there[0], strain[1] - there[1], strain[2] - there[2]];
            let nu = material.poisson_ratio;
            let drag = of::<L>(&block.drag);
            let mean = drag * (inverse * (0.5 * (1.0 + nu)));
            let shear = drag * (inverse * (0.5 * (1.0 - nu)));
            let viscous = [mean * change[0], shear * change[1], shear * change[2]];
            let both = [viscous[0] + before[0], viscous[1] + before[1], viscous[2] + before[2]];
            (viscous, contract(both, change))
        }
        Step::None => (before, L::splat(0.0)),
    };
    past.drag = [viscous[0].lanes(), viscous[1].lanes(), viscous[2].lanes()];

    let Response { mean, shear_modulus, largest } = material.response(circle);
    let minus_volume = of::<L>(&block.minus_volume);
    let shear_modulus = shear_modulus * minus_volume;
    let mean = mean * minus_volume + viscous[0];
    let half = shear_modulus * circle.difference + viscous[1];
    let (xx, yy) = (mean + half, mean - half);
    let xy = shear_modulus * circle.shear + viscous[2];
    let [a, b, d] = all::<L, 3>(&block.inverse);
    let across = a * xy;
    let lean = b * yy + across;
    let pull = [(a * a) * xx + b * (lean + across), d * lean, (d * d) * yy];
    ElementResponse { pull, taken, largest }
}

#[inline(always)]
fn element_kernel<L: Wide>(
    model: &FilmModel,
    positions: &Field,
    step: Step<L>,
    past: &mut [[ViscousHistory; 2]],
    sums: &mut [NodeSum],
) -> LaneSums {
    let material = model.material;
    let half = L::splat(0.5);
    let (mut volumes, mut works, mut largest) = (L::splat(0.0), L::splat(0.0), L::splat(0.0));
    let targets = &model.blocks;
    let mut begun = 0;
    if targets.blocks() == 0 {
        sums.fill(NodeSum::default());
    }
    let blocks = targets.blocks();
    let (constants, past) = (&model.constants[..blocks], &mut past[..blocks]);
    let places = Columns::new(&model.blocks, [&positions.x, &positions.y, &positions.z]);
    for own in 0..blocks {
        let ([first_block, second_block], [early, later]) = (&constants[own], &mut past[own]);
        let corners = places.corners::<L>(own);
        let [p, d, q] = edges(corners);
        let (first_normal, second_normal) = (p.cross(d), d.cross(q));
        let normal = first_normal + second_normal;
        let enclosed = corners[0].dot(normal);

        let shared = d.dot(d) * half;
        let metric = Metric([p.dot(p) * half, p.dot(d), shared]);
        let one = told(&material, first_block, metric, step, early);
        let metric = Metric([shared, d.dot(q), q.dot(q) * half]);
        let other = told(&material, second_block, metric, step, later);

        let taken = one.taken + other.taken;
        largest = largest.max(one.largest).max(other.largest);
        works = works + taken;
        volumes = volumes + enclosed;
        let (r, s) = (one.pull, other.pull);
        let at_a = p.scale(r[0]) + d.scale(r[1]);
        let at_t = p.scale(r[1]) + d.scale(r[2] + s[0]) + q.scale(s[1]);
        let at_b = d.scale(s[1]) + q.scale(s[2]);
        let film = [-(at_a + at_t + at_b), at_a, at_t, at_b];
        begun = targets.begin(own, begun, sums);
        targets.scatter(own, &film, &[normal, first_normal, second_normal], sums);
    }
    LaneSums { volumes: volumes.lanes(), works: works.lanes(), largest: largest.lanes() }
}

/// Which kernel a step of this length (s) asks for is known before the first element.
#[inline(always)]
fn any_kernel<L: Wide>(
    model: &FilmModel,
    positions: &Field,
    step: f64,
    past: &mut [[ViscousHistory; 2]],
    sums: &mut [NodeSum],
) -> LaneSums {
    if step > 0.0 {
        let step = Step::Inverse(L::splat(1.0 / step));
        element_kernel::<L>(model, positions, step, past, sums)
    } else {
        element_kernel::<L>(model, positions, Step::None, past, sums)
    }
}

dispatch_wide! {
    /// Adds forces and normals of all elements to their nodes, and gives their sums.
    pub(super) fn element_pass / any_kernel(
        model: &FilmModel,
        positions: &Field,
        step: f64,
        past: &mut [[ViscousHistory; 2]],
        sums: &mut [NodeSum],
    ) -> LaneSums
}
