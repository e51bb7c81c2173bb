//! The film's own forces: elastic and viscous, and the oriented areas pressure acts on.
//!
//! ```text
//! F = [x1 − x0, x2 − x0] Dm⁻¹     E = (FᵀF − 1)/2     energy = A t W(E)
//! [f1, f2] = −A t F (S + S_v) Dm⁻ᵀ                    f0 = −(f1 + f2)
//! ```
//!
//! Constant-strain triangles, total Lagrangian: S of [`crate::material`], `S_v` of
//! [`super::damping`]. The oriented area is (x1 − x0) × (x2 − x0)/6, a third for each corner.
//! Elements go eight at a time ([`crate::simd`]); columns are padded with elements of no volume.

#![allow(clippy::inline_always, reason = "inside the element loop")]

use nalgebra::Vector3;

use super::damping::viscous_stress;
use crate::material::{Circle, PlaneLanes, PlaneTensor};
use crate::model::FilmModel;
use crate::simd::{Corners, Lanes, NodeSum, Path, Vectors, WIDTH, Wide, dispatch, dispatch_wide};
use crate::state::Field;

mod halves;

pub use halves::Halves;

/// What a pass remembers of elements for the next: `S_v`, Pa.
#[derive(Debug, Clone, PartialEq)]
pub struct Drag {
    pub(crate) stress: [Vec<f64>; 3],
}

impl Drag {
    /// None yet, for a model's elements.
    pub fn new(model: &FilmModel) -> Self {
        Self { stress: core::array::from_fn(|_| vec![0.0; model.padded()]) }
    }
}

/// Sums over all elements of one pass.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct Sums {
    /// Six times the volume enclosed by film (and closing faces), m³.
    pub six_volumes: f64,
    /// Power taken by viscosity, W: of the stress here and, along the way here, of that of the pass
    /// before, both with the velocities given. Half the step times it is the work of the way.
    pub viscous_power: f64,
    /// Largest principal second Piola-Kirchhoff stress, Pa, without its viscous part.
    pub largest_stress: f64,
}

/// F by columns.
#[inline(always)]
fn gradient<L: Wide>([a, b, c, d]: [L; 4], [p, q]: [Vectors<L>; 2]) -> [Vectors<L>; 2] {
    [p.scale(a) + q.scale(c), p.scale(b) + q.scale(d)]
}

#[inline(always)]
fn edges<L: Wide>([a, b, c]: [Vectors<L>; 3]) -> [Vectors<L>; 2] {
    [b - a, c - a]
}

#[inline(always)]
fn green<L: Wide>([f, g]: [Vectors<L>; 2]) -> PlaneLanes<L> {
    let one = L::splat(1.0);
    PlaneLanes { xx: (f.dot(f) - one) * 0.5, yy: (g.dot(g) - one) * 0.5, xy: f.dot(g) * 0.5 }
}

/// Sum of two rates of the same entry: Ė of F and Ḟ.
#[inline(always)]
fn green_rate<L: Wide>([f, g]: [Vectors<L>; 2], [fr, gr]: [Vectors<L>; 2]) -> PlaneLanes<L> {
    PlaneLanes { xx: f.dot(fr), yy: g.dot(gr), xy: (f.dot(gr) + g.dot(fr)) * 0.5 }
}

/// `ḞᵀḞ` by its columns.
#[inline(always)]
fn gram<L: Wide>([f, g]: [Vectors<L>; 2]) -> PlaneLanes<L> {
    PlaneLanes { xx: f.dot(f), yy: g.dot(g), xy: f.dot(g) }
}

/// A field at the corners of a block of eight elements.
#[inline(always)]
fn corners_of<L: Wide>(model: &FilmModel, field: &Field, block: usize) -> [Vectors<L>; 3] {
    let columns = [&field.x[..], &field.y[..], &field.z[..]];
    let corners = &model.blocks;
    [
        corners.gather(block, 0, columns),
        corners.gather(block, 1, columns),
        corners.gather(block, 2, columns),
    ]
}

/// −A t F S Dm⁻ᵀ, and what balances it.
#[inline(always)]
fn corner_forces<L: Wide>(
    [a, b, c, d]: [L; 4],
    volume: L,
    [f, g]: [Vectors<L>; 2],
    s: PlaneLanes<L>,
) -> [Vectors<L>; 3] {
    let (p, q) = (f.scale(s.xx) + g.scale(s.xy), f.scale(s.xy) + g.scale(s.yy));
    let loss = -volume;
    let first = (p.scale(a) + q.scale(b)).scale(loss);
    let second = (p.scale(c) + q.scale(d)).scale(loss);
    [-(first + second), first, second]
}

/// Blocks that follow each other, and where what they give goes.
struct Share<'a> {
    /// The first of them.
    first: usize,
    /// For each of them, where its corners add to in `sums`.
    targets: &'a Corners,
    /// `S_v` of their elements.
    drag: [&'a mut [f64]; 3],
    /// Forces and areas.
    sums: &'a mut [NodeSum],
    /// Volumes and powers of each block, where they are kept; else empty.
    terms: &'a mut [[Lanes; 2]],
}

/// Sums over the elements of a share, lane by lane.
#[derive(Debug, Clone, Copy)]
struct LaneSums {
    volumes: Lanes,
    power: Lanes,
    largest: Lanes,
}

impl LaneSums {
    fn sums(self) -> Sums {
        Sums {
            six_volumes: self.volumes.sum(),
            viscous_power: self.power.sum(),
            largest_stress: self.largest.largest(),
        }
    }
}

#[expect(clippy::needless_range_loop, reason = "`terms` is empty where nothing is kept")]
#[inline(always)]
fn element_kernel<L: Wide, const KEPT: bool>(
    model: &FilmModel,
    positions: &Field,
    velocities: &Field,
    way: f64,
    share: Share<'_>,
) -> LaneSums {
    let material = model.material;
    let (mut volumes, mut power, mut largest) = (L::splat(0.0), L::splat(0.0), L::splat(0.0));
    let Share { first, targets, drag: [s11, s22, s12], sums, terms } = share;
    let [d11, d12, d21, d22] = &model.inverse_shape;
    let (begin, end) = (first * WIDTH, (first + targets.blocks()) * WIDTH);
    let [d11, d12] = [&d11[begin..end], &d12[begin..end]];
    let [d21, d22] = [&d21[begin..end], &d22[begin..end]];
    let (element_volume, viscous_time) =
        (&model.volume[begin..end], &model.viscous_time[begin..end]);
    for own in 0..targets.blocks() {
        let (block, at) = (first + own, own * WIDTH);
        let shape = [L::load(d11, at), L::load(d12, at), L::load(d21, at), L::load(d22, at)];
        let volume = L::load(element_volume, at);
        let corners = corners_of::<L>(model, positions, block);
        let edge = edges(corners);
        let slope = gradient(shape, edge);
        // The root is long in coming: all that does not wait for it stands between.
        let strain = green(slope);
        let circle = Circle::of(strain);

        let turn = gradient(shape, edges(corners_of(model, velocities, block)));
        let rate = green_rate(slope, turn);
        let viscous = viscous_stress(&material, L::load(viscous_time, at), rate);
        let before =
            PlaneLanes { xx: L::load(s11, at), yy: L::load(s22, at), xy: L::load(s12, at) };
        viscous.xx.store(s11, at);
        viscous.yy.store(s22, at);
        viscous.xy.store(s12, at);
        // A way ago F was F - way Ḟ.
        let taken = (before + viscous).contract(rate) - before.contract(gram(turn)) * way;
        let taken = taken * volume;
        let enclosed = corners[0].dot(corners[1].cross(corners[2]));
        if KEPT {
            terms[own] = [enclosed.lanes(), taken.lanes()];
        } else {
            power = power + taken;
            volumes = volumes + enclosed;
        }
        let area = edge[0].cross(edge[1]).scale(L::splat(1.0 / 6.0));
        let slowing = corner_forces(shape, volume, slope, viscous);

        let (stress, most) = material.stresses_in(strain, circle);
        largest = largest.max(most);
        let elastic = corner_forces(shape, volume, slope, stress);
        let film = [elastic[0] + slowing[0], elastic[1] + slowing[1], elastic[2] + slowing[2]];
        targets.scatter(own, &film, &area, sums);
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
    /// Adds forces and areas of the elements of a share to where they go, and gives their sums.
    fn element_pass / summed_kernel(
        model: &FilmModel,
        positions: &Field,
        velocities: &Field,
        way: f64,
        share: Share<'_>,
    ) -> LaneSums
}

dispatch_wide! {
    /// The same; volumes and powers are kept a block in `terms` and are none in the sums.
    fn element_pass_kept / kept_kernel(
        model: &FilmModel,
        positions: &Field,
        velocities: &Field,
        way: f64,
        share: Share<'_>,
    ) -> LaneSums
}

/// Forces and areas of the film on its nodes at these positions (m) and the velocities (m/s) viscosity
/// takes; `way` (s) times these led here from where the pass before was.
pub fn film_pass(
    path: Path,
    model: &FilmModel,
    positions: &Field,
    velocities: &Field,
    way: f64,
    drag: &mut Drag,
    out: &mut NodeForces,
) -> Sums {
    let whole = Share {
        first: 0,
        targets: &model.blocks,
        drag: drag.stress.each_mut().map(Vec::as_mut_slice),
        sums: &mut out.sums,
        terms: &mut [],
    };
    let sums = element_pass(path, model, positions, velocities, way, whole);
    land(path, &mut out.sums, &mut out.film, &mut out.area);
    sums.sums()
}

#[inline(always)]
fn land_kernel(sums: &mut [NodeSum], film: &mut Field, area: &mut Field) {
    let [fx, fy, fz] = [&mut film.x[..], &mut film.y[..], &mut film.z[..]];
    let [ax, ay, az] = [&mut area.x[..], &mut area.y[..], &mut area.z[..]];
    let firsts = fx.iter_mut().zip(fy).zip(fz);
    let seconds = ax.iter_mut().zip(ay).zip(az);
    for (sum, (((fx, fy), fz), ((ax, ay), az))) in sums.iter_mut().zip(firsts.zip(seconds)) {
        [*fx, *fy, *fz, _] = sum.film;
        [*ax, *ay, *az, _] = sum.area;
        *sum = NodeSum::default();
    }
}

dispatch! {
    /// Writes the sums of nodes to their fields and begins them anew.
    fn land / land_kernel(sums: &mut [NodeSum], film: &mut Field, area: &mut Field)
}

/// Green strain of an element at these positions (m).
pub fn strain(model: &FilmModel, positions: &Field, element: usize) -> PlaneTensor {
    let corners = corners_of_one(&model.triangles[element], positions);
    let shape = model.inverse_shape.each_ref().map(|column| Lanes::splat(column[element]));
    green(gradient(shape, edges(corners))).first()
}

/// A field at the corners of one element.
fn corners_of_one(triangle: &[u32; 3], field: &Field) -> [Vectors; 3] {
    triangle.map(|node| {
        let own = field.get(node as usize);
        Vectors { x: Lanes::splat(own.x), y: Lanes::splat(own.y), z: Lanes::splat(own.z) }
    })
}

/// Strain energy at these positions (m), J.
pub fn strain_energy(model: &FilmModel, positions: &Field) -> f64 {
    (0..model.elements())
        .map(|element| {
            let strain = strain(model, positions, element);
            model.volume[element] * model.material.energy_density(strain)
        })
        .sum()
}

/// Forces summed to nodes.
#[derive(Debug, Clone, PartialEq)]
pub struct NodeForces {
    /// Elastic and viscous, N.
    pub film: Field,
    /// ∂V/∂x, m².
    pub area: Field,
    /// Of contact, N.
    pub contact: Field,
    /// Both of the film while they are being summed; nought between passes.
    pub(crate) sums: Vec<NodeSum>,
}

impl NodeForces {
    /// Room for a model's nodes.
    pub fn new(model: &FilmModel) -> Self {
        let zeros = || Field::zeros(model.nodes());
        let sums = vec![NodeSum::default(); model.nodes()];
        Self { film: zeros(), area: zeros(), contact: zeros(), sums }
    }
}

/// Forces of viscosity alone on nodes, N: the part of [`film_pass`]'s that has `S_v`, once more.
pub fn viscous_forces(model: &FilmModel, positions: &Field, velocities: &Field) -> Field {
    let mut sum = Field::zeros(model.nodes());
    for (element, triangle) in model.triangles.iter().enumerate() {
        let shape = model.inverse_shape.each_ref().map(|column| Lanes::splat(column[element]));
        let [volume, time] =
            [&model.volume, &model.viscous_time].map(|column| Lanes::splat(column[element]));
        let slope = gradient(shape, edges(corners_of_one(triangle, positions)));
        let rate = green_rate(slope, gradient(shape, edges(corners_of_one(triangle, velocities))));
        let viscous = viscous_stress(&model.material, time, rate);
        for (node, force) in triangle.iter().zip(corner_forces(shape, volume, slope, viscous)) {
            let force = Vector3::new(force.x.0[0], force.y.0[0], force.z.0[0]);
            sum.set(*node as usize, sum.get(*node as usize) + force);
        }
    }
    sum
}
