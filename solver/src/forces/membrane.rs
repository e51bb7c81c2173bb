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
use crate::material::{PlaneLanes, PlaneTensor};
use crate::model::FilmModel;
use crate::simd::{Lanes, Vectors, WIDTH, dispatch};
use crate::state::Field;

/// What one element pass leaves for the node pass.
#[derive(Debug, Clone, PartialEq)]
pub struct ElementForces {
    /// Elastic and viscous force on the elements' first, second and third corners, N.
    pub film: [Field; 3],
    /// Viscous force on them, N.
    pub viscous: [Field; 3],
    /// Each element's share of ∂V/∂x at each of its corners, m².
    pub area: Field,
}

impl ElementForces {
    /// Room for a model's elements.
    pub fn new(model: &FilmModel) -> Self {
        let zeros = || Field::zeros(model.padded());
        Self {
            film: core::array::from_fn(|_| zeros()),
            viscous: core::array::from_fn(|_| zeros()),
            area: zeros(),
        }
    }
}

/// Sums over all elements of one pass.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct Sums {
    /// Six times the volume enclosed by film (and closing faces), m³.
    pub six_volumes: f64,
    /// Power taken by viscosity, W.
    pub viscous_power: f64,
    /// Largest principal second Piola-Kirchhoff stress, Pa, without its viscous part.
    pub largest_stress: f64,
}

/// F by columns.
#[inline(always)]
fn gradient([a, b, c, d]: [Lanes; 4], [p, q]: [Vectors; 2]) -> [Vectors; 2] {
    [p.scale(a) + q.scale(c), p.scale(b) + q.scale(d)]
}

#[inline(always)]
fn edges([a, b, c]: [Vectors; 3]) -> [Vectors; 2] {
    [b - a, c - a]
}

#[inline(always)]
fn green([f, g]: [Vectors; 2]) -> PlaneLanes {
    let one = Lanes::splat(1.0);
    PlaneLanes { xx: (f.dot(f) - one) * 0.5, yy: (g.dot(g) - one) * 0.5, xy: f.dot(g) * 0.5 }
}

/// Sum of two rates of the same entry: Ė of F and Ḟ.
#[inline(always)]
fn green_rate([f, g]: [Vectors; 2], [fr, gr]: [Vectors; 2]) -> PlaneLanes {
    PlaneLanes { xx: f.dot(fr), yy: g.dot(gr), xy: (f.dot(gr) + g.dot(fr)) * 0.5 }
}

/// A field at the corners of a block of eight elements.
#[inline(always)]
fn corners_of(model: &FilmModel, field: &Field, block: usize) -> [Vectors; 3] {
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
fn corner_forces(
    [a, b, c, d]: [Lanes; 4],
    volume: Lanes,
    [f, g]: [Vectors; 2],
    s: PlaneLanes,
) -> [Vectors; 3] {
    let (p, q) = (f.scale(s.xx) + g.scale(s.xy), f.scale(s.xy) + g.scale(s.yy));
    let loss = -volume;
    let first = (p.scale(a) + q.scale(b)).scale(loss);
    let second = (p.scale(c) + q.scale(d)).scale(loss);
    [-(first + second), first, second]
}

#[inline(always)]
fn store(out: &mut Field, at: usize, vectors: Vectors) {
    vectors.x.store(&mut out.x, at);
    vectors.y.store(&mut out.y, at);
    vectors.z.store(&mut out.z, at);
}

#[inline(always)]
fn element_kernel(
    model: &FilmModel,
    positions: &Field,
    velocities: &Field,
    out: &mut ElementForces,
) -> Sums {
    let material = model.material;
    let (mut volumes, mut power, mut largest) =
        (Lanes::default(), Lanes::default(), Lanes::splat(0.0));
    for block in 0..model.blocks.blocks() {
        let at = block * WIDTH;
        let [d11, d12, d21, d22] = &model.inverse_shape;
        let shape = [
            Lanes::load(d11, at),
            Lanes::load(d12, at),
            Lanes::load(d21, at),
            Lanes::load(d22, at),
        ];
        let volume = Lanes::load(&model.volume, at);
        let corners = corners_of(model, positions, block);
        let edge = edges(corners);
        let slope = gradient(shape, edge);
        let (stress, most) = material.stresses(green(slope));
        let rate = green_rate(slope, gradient(shape, edges(corners_of(model, velocities, block))));
        let viscous = viscous_stress(&material, Lanes::load(&model.viscous_time, at), rate);

        let elastic = corner_forces(shape, volume, slope, stress);
        let drag = corner_forces(shape, volume, slope, viscous);
        for corner in 0..3 {
            store(&mut out.film[corner], at, elastic[corner] + drag[corner]);
            store(&mut out.viscous[corner], at, drag[corner]);
        }
        store(&mut out.area, at, edge[0].cross(edge[1]).scale(Lanes::splat(1.0 / 6.0)));

        volumes += corners[0].dot(corners[1].cross(corners[2]));
        power += viscous.contract(rate) * volume;
        largest = largest.max(most);
    }
    Sums {
        six_volumes: volumes.sum(),
        viscous_power: power.sum(),
        largest_stress: largest.largest(),
    }
}

dispatch! {
    /// The element pass, at positions (m) and the velocities (m/s) viscosity takes.
    pub fn element_pass / element_kernel(
        model: &FilmModel,
        positions: &Field,
        velocities: &Field,
        out: &mut ElementForces,
    ) -> Sums
}

/// Green strain of an element at these positions (m).
pub fn strain(model: &FilmModel, positions: &Field, element: usize) -> PlaneTensor {
    let [a, b, c] = model.triangles[element].map(|node| {
        let place = positions.get(node as usize);
        Vectors { x: Lanes::splat(place.x), y: Lanes::splat(place.y), z: Lanes::splat(place.z) }
    });
    let shape = model.inverse_shape.each_ref().map(|column| Lanes::splat(column[element]));
    green(gradient(shape, edges([a, b, c]))).first()
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
    /// Viscous, N.
    pub viscous: Field,
    /// ∂V/∂x, m².
    pub area: Field,
    /// Of contact, N.
    pub contact: Field,
}

impl NodeForces {
    /// Room for a model's nodes.
    pub fn new(model: &FilmModel) -> Self {
        let zeros = || Field::zeros(model.nodes());
        Self { film: zeros(), viscous: zeros(), area: zeros(), contact: zeros() }
    }
}

/// The node pass: sums the corners of each node in the order of elements, then the closing faces.
pub fn node_pass(model: &FilmModel, elements: &ElementForces, out: &mut NodeForces) {
    for node in 0..model.nodes() {
        let own = model.first_corner[node] as usize..model.first_corner[node + 1] as usize;
        let (mut film, mut viscous, mut area) =
            (Vector3::zeros(), Vector3::zeros(), Vector3::zeros());
        for corner in &model.corners[own] {
            let (element, corner) = (*corner as usize / 4, *corner as usize % 4);
            film += elements.film[corner].get(element);
            viscous += elements.viscous[corner].get(element);
            area += elements.area.get(element);
        }
        out.film.set(node, film);
        out.viscous.set(node, viscous);
        out.area.set(node, area);
    }
}
