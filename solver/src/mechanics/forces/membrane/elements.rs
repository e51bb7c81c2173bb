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
//! G is that of [`crate::mechanics::film_model::ElementBlock`], S(Ê) of [`crate::mechanics::material`], P of
//! [`crate::mechanics::material_loss`], D and its work of [`crate::mechanics::forces::damping`]. These
//! are the forces of [`super`], without F. A superscript ⁻ marks the previous step, stored in
//! [`ElementHistory`]. The response of an element is in [`super::response`].

#![allow(clippy::inline_always, reason = "inside the element loop")]

use super::response::{
    CONSERVATIVE, Element, ElementResponse, Law, MOVED, Metric, STORED, TimeStep, kite_response,
    load,
};
use super::{CreepStep, CreepStrain, ElementHistory};
use crate::geometry::field::Field;
use crate::mechanics::film_model::FilmModel;
use crate::platform::simd::{Columns, Lanes, NodeSum, Vectors, WIDTH, Wide, dispatch_parts};

/// Sums over all elements, lane by lane.
#[derive(Debug, Clone, Copy, Default)]
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

impl LaneSums {
    /// Adds six times the volumes and the responses of the first and the second elements of kites, from a lane on.
    #[inline(always)]
    fn add<L: Wide>(
        &mut self,
        lane: usize,
        six_volume: L,
        a: &ElementResponse<L>,
        b: &ElementResponse<L>,
    ) {
        (load::<L>(&self.six_volumes, lane) + six_volume).store(&mut self.six_volumes.0, lane);
        let numerical = a.minus_twice_numerical + b.minus_twice_numerical;
        (load::<L>(&self.minus_twice_numerical, lane) + numerical)
            .store(&mut self.minus_twice_numerical.0, lane);
        let loss = a.minus_twice_loss + b.minus_twice_loss;
        (load::<L>(&self.minus_twice_loss, lane) + loss).store(&mut self.minus_twice_loss.0, lane);
        load::<L>(&self.largest_stress, lane)
            .max(a.largest_stress)
            .max(b.largest_stress)
            .store(&mut self.largest_stress.0, lane);
    }
}

/// Edges of kites from s to a, t and b.
#[inline(always)]
fn edges<L: Wide>([s, a, t, b]: [Vectors<L>; 4]) -> [Vectors<L>; 3] {
    [a - s, t - s, b - s]
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
    let law = Law { material: &material, creep: &creep, step };
    let half = L::splat(0.5);
    let mut totals = LaneSums::default();
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
        let [a_block, b_block] = &constants[block];
        let [a_history, b_history] = &mut histories[block];
        let [a_last, b_last] = if LOSS { &last_creep[block] } else { &none };
        let [a_next, b_next] = if writes_creep { &mut next_creep[block] } else { &mut unused };
        cleared = corners.clear_sums(block, cleared, sums);
        for lane in (0..WIDTH).step_by(L::COUNT) {
            let kites = positions.corners::<L>(block, lane);
            let [p, d, q] = edges(kites);
            let (a_normal, b_normal) = (p.cross(d), d.cross(q));
            let normal = a_normal + b_normal;
            let six_volume = kites[0].dot(normal);

            let d_metric = d.dot(d) * half;
            let metrics = [
                Metric([p.dot(p) * half, p.dot(d), d_metric]),
                Metric([d_metric, d.dot(q), q.dot(q) * half]),
            ];
            let elements = [
                Element {
                    block: a_block,
                    history: &mut *a_history,
                    last_creep: a_last,
                    next_creep: &mut *a_next,
                    lane,
                },
                Element {
                    block: b_block,
                    history: &mut *b_history,
                    last_creep: b_last,
                    next_creep: &mut *b_next,
                    lane,
                },
            ];
            let [a, b] = kite_response::<L, LOSS, PASS>(&law, elements, metrics);
            totals.add(lane, six_volume, &a, &b);
            let (r, r2) = (a.minus_force_density, b.minus_force_density);
            let force_a = p.scale(r[0]) + d.scale(r[1]);
            let force_t = p.scale(r[1]) + d.scale(r[2] + r2[0]) + q.scale(r2[1]);
            let force_b = d.scale(r2[1]) + q.scale(r2[2]);
            let film = [-(force_a + force_t + force_b), force_a, force_t, force_b];
            corners.scatter((block, lane), &film, &[normal, a_normal, b_normal], sums);
        }
    }
    totals
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

dispatch_parts! {
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
