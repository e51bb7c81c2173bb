//! The film's own forces: elastic and viscous, and the oriented areas pressure acts on.
//!
//! ```text
//! F = [x1 − x0, x2 − x0] Dm⁻¹     E = (FᵀF − 1)/2     energy = A t W(E)
//! [f1, f2] = −A t F (S + S_v) Dm⁻ᵀ                    f0 = −(f1 + f2)
//! ```
//!
//! Constant-strain triangles, total Lagrangian: S of [`crate::material`], `S_v` of
//! [`super::damping`]. The oriented area is (x1 − x0) × (x2 − x0)/6, a third for each corner.

use nalgebra::Vector3;

use super::damping::viscous_stress;
use crate::material::PlaneTensor;
use crate::model::FilmModel;
use crate::state::Field;

/// What one element pass leaves for the node pass.
#[derive(Debug, Clone, PartialEq)]
pub struct ElementForces {
    /// Elastic and viscous force on each corner (3 element + corner), N.
    pub film: Field,
    /// Viscous force on each corner, N.
    pub viscous: Field,
    /// Each element's share of ∂V/∂x at each of its corners, m².
    pub area: Field,
}

impl ElementForces {
    /// Room for a model's elements.
    pub fn new(model: &FilmModel) -> Self {
        let elements = model.elements();
        Self {
            film: Field::zeros(3 * elements),
            viscous: Field::zeros(3 * elements),
            area: Field::zeros(elements),
        }
    }
}

/// Sums over all elements of one pass.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct Sums {
    /// Six times the enclosed volume, m³.
    pub six_volumes: f64,
    /// Power taken by viscosity, W.
    pub viscous_power: f64,
    /// Largest principal second Piola-Kirchhoff stress, Pa, without its viscous part.
    pub largest_stress: f64,
}

/// F by columns, and the edges it comes from.
#[inline(always)]
#[expect(clippy::inline_always, reason = "inside the element loop")]
fn gradient(model: &FilmModel, element: usize, [p, q]: [Vector3<f64>; 2]) -> [Vector3<f64>; 2] {
    let [d11, d12, d21, d22] = &model.inverse_shape;
    [p * d11[element] + q * d21[element], p * d12[element] + q * d22[element]]
}

#[inline(always)]
#[expect(clippy::inline_always, reason = "inside the element loop")]
fn edges(corners: [Vector3<f64>; 3]) -> [Vector3<f64>; 2] {
    [corners[1] - corners[0], corners[2] - corners[0]]
}

#[inline(always)]
#[expect(clippy::inline_always, reason = "inside the element loop")]
fn green([f, g]: [Vector3<f64>; 2]) -> PlaneTensor {
    PlaneTensor { xx: 0.5 * (f.dot(&f) - 1.0), yy: 0.5 * (g.dot(&g) - 1.0), xy: 0.5 * f.dot(&g) }
}

/// A field at the corners of an element.
#[inline(always)]
#[expect(clippy::inline_always, reason = "inside the element loop")]
fn corners_of(field: &Field, [a, b, c]: [u32; 3]) -> [Vector3<f64>; 3] {
    [field.get(a as usize), field.get(b as usize), field.get(c as usize)]
}

/// −A t F S Dm⁻ᵀ, and what balances it.
#[inline(always)]
#[expect(clippy::inline_always, reason = "inside the element loop")]
fn corner_forces(
    model: &FilmModel,
    element: usize,
    [f, g]: [Vector3<f64>; 2],
    s: PlaneTensor,
) -> [Vector3<f64>; 3] {
    let [d11, d12, d21, d22] = &model.inverse_shape;
    let volume = model.volume[element];
    let (p, q) = (f * s.xx + g * s.xy, f * s.xy + g * s.yy);
    let first = (p * d11[element] + q * d12[element]) * -volume;
    let second = (p * d21[element] + q * d22[element]) * -volume;
    [-(first + second), first, second]
}

/// Green strain of an element at these positions (m).
pub fn strain(model: &FilmModel, positions: &Field, element: usize) -> PlaneTensor {
    let corners = corners_of(positions, model.triangles[element]);
    green(gradient(model, element, edges(corners)))
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

/// The element pass, at positions (m) and the velocities (m/s) viscosity takes.
pub fn element_pass(
    model: &FilmModel,
    positions: &Field,
    velocities: &Field,
    out: &mut ElementForces,
) -> Sums {
    let mut sums = Sums::default();
    let material = model.material;
    for (element, triangle) in model.triangles.iter().enumerate() {
        let corners = corners_of(positions, *triangle);
        let edge = edges(corners);
        let [f, g] = gradient(model, element, edge);
        let stress = material.stress(green([f, g]));
        let [fr, gr] = gradient(model, element, edges(corners_of(velocities, *triangle)));
        let rate =
            PlaneTensor { xx: f.dot(&fr), yy: g.dot(&gr), xy: 0.5 * (f.dot(&gr) + g.dot(&fr)) };
        let viscous = viscous_stress(&material, model.viscous_time[element], rate);

        let volume = model.volume[element];
        let elastic = corner_forces(model, element, [f, g], stress.tensor);
        let drag = corner_forces(model, element, [f, g], viscous);
        for corner in 0..3 {
            out.film.set(3 * element + corner, elastic[corner] + drag[corner]);
            out.viscous.set(3 * element + corner, drag[corner]);
        }
        out.area.set(element, edge[0].cross(&edge[1]) * (1.0 / 6.0));

        sums.six_volumes += corners[0].dot(&corners[1].cross(&corners[2]));
        sums.viscous_power += volume * viscous.contract(rate);
        sums.largest_stress = sums.largest_stress.max(stress.largest);
    }
    sums
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
}

impl NodeForces {
    /// Room for a model's nodes.
    pub fn new(model: &FilmModel) -> Self {
        let zeros = || Field::zeros(model.nodes());
        Self { film: zeros(), viscous: zeros(), area: zeros() }
    }
}

/// The node pass.
pub fn node_pass(model: &FilmModel, elements: &ElementForces, out: &mut NodeForces) {
    for node in 0..model.nodes() {
        let own = model.first_corner[node] as usize..model.first_corner[node + 1] as usize;
        let (mut film, mut viscous, mut area) =
            (Vector3::zeros(), Vector3::zeros(), Vector3::zeros());
        for corner in &model.corners[own] {
            let corner = *corner as usize;
            film += elements.film.get(corner);
            viscous += elements.viscous.get(corner);
            area += elements.area.get(corner / 3);
        }
        out.film.set(node, film);
        out.viscous.set(node, viscous);
        out.area.set(node, area);
    }
}
