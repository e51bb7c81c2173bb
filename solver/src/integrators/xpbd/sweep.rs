//! Projection of the elements, and what it leaves.
//!
//! ```text
//! C = √(2 U)      U = A t W(Ê)/(1 + g) = A t S:Ê/(2 (1 + g))         ∇C = −f/C
//! Σ ∇C·W ∇C = Σ f·W f/(2 U)                                          finite as U → 0
//! α̃ λ = −C/(1 + h² Σ ∇C·W ∇C)         x ← x + h² W f/(1 + h² Σ ∇C·W ∇C)
//! residual     √Σ (C + α̃ λ)² / √Σ (C² + (α̃ λ)²)        C after all projections, λ of this substep
//! creep        P ← P + (1 − exp(−h/τ)) (C⁻¹:S − P)      at fixed positions, after the projections
//! ```
//!
//! The compliance is 1, so α̃ = 1/h². Slack elements have no energy and move nothing. Symbols: f forces of
//! an element on its nodes; Ê, S, P, g of [`crate::mechanics::material_loss`]; W mobility of a node.

#![allow(clippy::inline_always, reason = "inside the element loop")]
#![expect(clippy::needless_range_loop, reason = "an iterator is not inlined into a target feature")]

use super::constraints::Batch;
use crate::mechanics::forces::membrane::CreepStrain;
use crate::mechanics::material::{Material, MohrCircle, StressResponse};
use crate::mechanics::material_loss::Creep;
use crate::mechanics::tensor::{add, contract, isotropic, scale, subtract};
use crate::platform::simd::{Lanes, Vectors, WIDTH, Wide, dispatch_wide};

/// The material of a film.
#[derive(Clone, Copy)]
pub(super) struct Law<'a> {
    /// Tension field.
    pub material: &'a Material,
    /// Creep.
    pub creep: &'a Creep,
}

/// Sums over all elements after the projections.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub(super) struct Settled {
    /// Σ (C + α̃ λ)², J.
    pub residual: f64,
    /// Σ (C² + (α̃ λ)²), J.
    pub size: f64,
    /// Energy lost by creep, J.
    pub material_loss: f64,
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

/// Positions of the nodes of one corner.
#[inline(always)]
fn gather<L: Wide>(columns: &[&mut [f64]; 3], nodes: &[u32; WIDTH]) -> Vectors<L> {
    let mut lanes = [Lanes::default(); 3];
    for lane in 0..WIDTH {
        let node = nodes[lane] as usize;
        for axis in 0..3 {
            lanes[axis].0[lane] = columns[axis][node];
        }
    }
    let [x, y, z] = load_all(&lanes);
    Vectors { x, y, z }
}

#[inline(always)]
fn creep_of<L: Wide>(batch: &Batch, creep: &[[CreepStrain; 2]]) -> [L; 3] {
    let mut lanes = [Lanes::default(); 3];
    for lane in 0..WIDTH {
        let slot = batch.slots[lane];
        let from = &creep[slot.block][slot.half].0;
        for entry in 0..3 {
            lanes[entry].0[lane] = from[entry].0[slot.lane];
        }
    }
    load_all(&lanes)
}

/// Green strain (Exx + Eyy, Exx − Eyy, 2 Exy) of elements with these edges, as
/// [`crate::mechanics::film_model::ElementBlock`] defines it.
#[inline(always)]
fn strain<L: Wide>([a, b, d]: [L; 3], p: Vectors<L>, q: Vectors<L>) -> [L; 3] {
    let half = L::splat(0.5);
    let (b_m1, d_m2) = (b * (p.dot(p) * half), d * p.dot(q));
    let b_m1_d_m2 = b_m1 + d_m2;
    let xx = (a * a) * (p.dot(p) * half);
    let yy = b * b_m1_d_m2 + (d * d) * (q.dot(q) * half);
    [xx + yy - L::splat(1.0), xx - yy, a * (b_m1 + b_m1_d_m2)]
}

/// Elastic strain Ê at a creep strain.
#[inline(always)]
fn elastic<L: Wide>(total: [L; 3], creep_strain: [L; 3], ratio: f64) -> [L; 3] {
    add(total, scale(subtract(total, creep_strain), L::splat(ratio)))
}

/// Stress (mean, half difference, shear) at an elastic strain, Pa.
#[inline(always)]
fn stress<L: Wide>(material: &Material, strain: [L; 3]) -> [L; 3] {
    let circle = MohrCircle::of_difference(strain[0], strain[1], strain[2]);
    let StressResponse { mean, shear_modulus, .. } = material.response(circle);
    [mean, shear_modulus * circle.difference, shear_modulus * circle.shear]
}

/// W f of the three corners.
#[inline(always)]
fn moved<L: Wide>(batch: &Batch, forces: &[Vectors<L>; 3]) -> [Vectors<L>; 3] {
    let mut moves = *forces;
    for corner in 0..3 {
        let [x, y, z] = load_all::<L, 3>(&batch.mobility[corner]);
        let force = forces[corner];
        moves[corner] = Vectors { x: x * force.x, y: y * force.y, z: z * force.z };
    }
    if batch.oblique.is_empty() { moves } else { moved_obliquely(batch, forces, moves) }
}

#[inline(always)]
fn moved_obliquely<L: Wide>(
    batch: &Batch,
    forces: &[Vectors<L>; 3],
    mut moves: [Vectors<L>; 3],
) -> [Vectors<L>; 3] {
    for oblique in &batch.oblique {
        let (corner, lane) = (oblique.corner, oblique.lane);
        let force = forces[corner];
        let force = [force.x.lanes(), force.y.lanes(), force.z.lanes()];
        let mut lanes = [moves[corner].x.lanes(), moves[corner].y.lanes(), moves[corner].z.lanes()];
        for axis in 0..3 {
            let mut sum = 0.0;
            for from in 0..3 {
                sum += oblique.mobility[(axis, from)] * force[from].0[lane];
            }
            lanes[axis].0[lane] = sum;
        }
        let [x, y, z] = load_all::<L, 3>(&lanes);
        moves[corner] = Vectors { x, y, z };
    }
    moves
}

#[inline(always)]
fn sweep_kernel<L: Wide>(
    batches: &[Batch],
    law: Law<'_>,
    creep: &[[CreepStrain; 2]],
    length: f64,
    columns: &mut [&mut [f64]; 3],
    multipliers: &mut [Lanes],
) {
    let (one, zero) = (L::splat(1.0), L::splat(0.0));
    let squared = L::splat(length * length);
    let ratio = law.creep.ratio;
    for (batch, multiplier) in batches.iter().zip(multipliers) {
        let x0 = gather::<L>(columns, &batch.nodes[0]);
        let p = gather::<L>(columns, &batch.nodes[1]) - x0;
        let q = gather::<L>(columns, &batch.nodes[2]) - x0;
        let shape = load_all::<L, 3>(&batch.inverse_shape);
        let mut strain = strain(shape, p, q);
        if ratio > 0.0 {
            strain = elastic(strain, creep_of(batch, creep), ratio);
        }
        let stress = stress(law.material, strain);
        let volume = load::<L>(&batch.volume);
        let twice_energy = volume * (contract(stress, strain) * (1.0 / (1.0 + ratio)));

        // Gᵀ of −A t S, as in the element loop.
        let [mean, half_difference, xy] = scale(stress, -volume);
        let (xx, yy) = (mean + half_difference, mean - half_difference);
        let [a, b, d] = shape;
        let a_xy = a * xy;
        let b_yy_a_xy = b * yy + a_xy;
        let r = [(a * a) * xx + b * (b_yy_a_xy + a_xy), d * b_yy_a_xy, (d * d) * yy];
        let f1 = p.scale(r[0]) + q.scale(r[1]);
        let f2 = p.scale(r[1]) + q.scale(r[2]);
        let forces = [-(f1 + f2), f1, f2];

        let moves = moved(batch, &forces);
        let power = forces[0].dot(moves[0]) + forces[1].dot(moves[1]) + forces[2].dot(moves[2]);
        let divisor = twice_energy.if_positive(twice_energy, one);
        let share = one.over(one + squared * power.over(divisor));
        let share = twice_energy.if_positive(share, zero);
        *multiplier = (-(divisor.sqrt() * share)).lanes();
        let factor = squared * share;
        for corner in 0..3 {
            let Vectors { x, y, z } = moves[corner].scale(factor);
            let displacement = [x.lanes(), y.lanes(), z.lanes()];
            for lane in 0..WIDTH {
                let node = batch.nodes[corner][lane] as usize;
                for axis in 0..3 {
                    columns[axis][node] += displacement[axis].0[lane];
                }
            }
        }
    }
}

dispatch_wide! {
    /// Projects every element once, in the order of the batches, over a substep of `length` (s). Writes α̃ λ of
    /// each element.
    pub(super) fn sweep / sweep_kernel(
        batches: &[Batch],
        law: Law<'_>,
        creep: &[[CreepStrain; 2]],
        length: f64,
        columns: &mut [&mut [f64]; 3],
        multipliers: &mut [Lanes],
    )
}

#[inline(always)]
fn settle_kernel<L: Wide>(
    batches: &[Batch],
    law: Law<'_>,
    creep: &mut [[CreepStrain; 2]],
    length: f64,
    columns: &[&mut [f64]; 3],
    multipliers: &[Lanes],
) -> Settled {
    let zero = L::splat(0.0);
    let (mut residual, mut size, mut loss) = (zero, zero, zero);
    let ratio = law.creep.ratio;
    let (creep_share, inverse) = (L::splat(law.creep.share(length)), 1.0 / (1.0 + ratio));
    for (batch, multiplier) in batches.iter().zip(multipliers) {
        let x0 = gather::<L>(columns, &batch.nodes[0]);
        let p = gather::<L>(columns, &batch.nodes[1]) - x0;
        let q = gather::<L>(columns, &batch.nodes[2]) - x0;
        let total = strain(load_all::<L, 3>(&batch.inverse_shape), p, q);
        let creep_strain = if ratio > 0.0 { creep_of(batch, creep) } else { [zero; 3] };
        let strain = elastic(total, creep_strain, ratio);
        let elastic_stress = stress(law.material, strain);
        let volume = load::<L>(&batch.volume);
        let work = contract(elastic_stress, strain);
        let twice_energy = volume * (work * inverse);
        let constraint = twice_energy.if_positive(twice_energy, zero).sqrt();
        let multiplier = load::<L>(multiplier);
        let remaining = constraint + multiplier;
        residual = residual + remaining * remaining;
        size = size + (constraint * constraint + multiplier * multiplier);
        if ratio > 0.0 {
            let weighted = isotropic(creep_strain, law.creep.stiffness);
            let driving = subtract(elastic_stress, weighted);
            let step = scale(isotropic(driving, law.creep.compliance), creep_share);
            let next = add(creep_strain, step);
            let strain_after = elastic(total, next, ratio);
            let after = contract(stress(law.material, strain_after), strain_after);
            let stored = contract(weighted, creep_strain)
                - contract(isotropic(next, law.creep.stiffness), next);
            loss = loss + volume * ((work - after + stored * ratio) * (0.5 * inverse));
            let next = [next[0].lanes(), next[1].lanes(), next[2].lanes()];
            for lane in 0..batch.count {
                let slot = batch.slots[lane];
                let to = &mut creep[slot.block][slot.half].0;
                for entry in 0..3 {
                    to[entry].0[slot.lane] = next[entry].0[lane];
                }
            }
        }
    }
    Settled {
        residual: residual.lanes().sum(),
        size: size.lanes().sum(),
        material_loss: loss.lanes().sum(),
    }
}

dispatch_wide! {
    /// Measures what the projections left, and advances the creep strain over a substep of `length` (s).
    pub(super) fn settle / settle_kernel(
        batches: &[Batch],
        law: Law<'_>,
        creep: &mut [[CreepStrain; 2]],
        length: f64,
        columns: &[&mut [f64]; 3],
        multipliers: &[Lanes],
    ) -> Settled
}
