//! The film's own forces: elastic and viscous, and the oriented areas pressure acts on.
//!
//! ```text
//! F = [x1 − x0, x2 − x0] Dm⁻¹     E = (FᵀF − 1)/2     energy = A t W(E)
//! [f1, f2] = −A t F (S + S_v) Dm⁻ᵀ                    f0 = −(f1 + f2)
//! ```
//!
//! Constant-strain triangles, total Lagrangian: S of [`crate::mechanics::material`], `S_v` of
//! [`super::damping`]. The oriented area is (x1 − x0) × (x2 − x0)/6, a third for each corner. The pass
//! over all elements (`elements`) goes by the metric of their edges instead of F.

use nalgebra::Vector3;

use crate::geometry::field::Field;
use crate::mechanics::film_model::FilmModel;
use crate::mechanics::material::PlaneTensor;
use crate::platform::simd::{InstructionSet, NodeSum};

mod elements;
mod viscous_history;

pub use viscous_history::{ViscousHistory, viscous_forces};

use elements::{LaneSums, element_pass};

/// Sums over all elements of one pass.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct Sums {
    /// Six times the volume enclosed by film (and closing faces), m³.
    pub six_volumes: f64,
    /// Work taken by viscosity on the way here, J: of the mean of its stress there and here.
    pub viscous_work: f64,
    /// Largest principal second Piola-Kirchhoff stress, Pa, without its viscous part.
    pub largest_stress: f64,
}

impl LaneSums {
    fn sums(self) -> Sums {
        Sums {
            six_volumes: self.volumes.sum(),
            viscous_work: -0.5 * self.works.sum(),
            largest_stress: self.largest.largest(),
        }
    }
}

/// Forces and areas of the film on its nodes at these positions (m), `step` (s) after the pass before;
/// 0 where none was, or nothing has moved since: then `S_v` is the one remembered.
pub fn assemble_membrane(
    path: InstructionSet,
    model: &FilmModel,
    positions: &Field,
    step: f64,
    past: &mut [[ViscousHistory; 2]],
    out: &mut NodeForces,
) -> Sums {
    element_pass(path, model, positions, step, past, &mut out.sums).sums()
}

/// F of an element by columns.
fn gradient(model: &FilmModel, field: &Field, element: usize) -> [Vector3<f64>; 2] {
    let [x0, x1, x2] = model.triangles[element].map(|node| field.get(node as usize));
    let [a, b, c, d] = model.inverse_shape.each_ref().map(|column| column[element]);
    let (p, q) = (x1 - x0, x2 - x0);
    [p * a + q * c, p * b + q * d]
}

/// Green strain of an element at these positions (m).
pub fn strain(model: &FilmModel, positions: &Field, element: usize) -> PlaneTensor {
    let [f, g] = gradient(model, positions, element);
    PlaneTensor { xx: (f.dot(&f) - 1.0) * 0.5, yy: (g.dot(&g) - 1.0) * 0.5, xy: f.dot(&g) * 0.5 }
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

/// What a node has of an element's normal (x1 − x0) × (x2 − x0) in ∂V/∂x.
pub(crate) const SIXTH: f64 = 1.0 / 6.0;

/// Forces summed to nodes.
#[derive(Debug, Clone, PartialEq)]
pub struct NodeForces {
    /// Of the film, and ∂V/∂x: node by node, as elements add to them and as the kick wants them.
    pub(crate) sums: Vec<NodeSum>,
    /// Of contact, N.
    pub contact: Field,
}

impl NodeForces {
    /// Room for a model's nodes.
    pub fn new(model: &FilmModel) -> Self {
        let sums = vec![NodeSum::default(); model.nodes()];
        Self { sums, contact: Field::zeros(model.nodes()) }
    }

    /// Elastic and viscous force on a node, N.
    #[inline]
    pub fn film(&self, node: usize) -> Vector3<f64> {
        let [x, y, z, _] = self.sums[node].film;
        Vector3::new(x, y, z)
    }

    /// ∂V/∂x of a node, m².
    #[inline]
    pub fn area(&self, node: usize) -> Vector3<f64> {
        let [x, y, z, _] = self.sums[node].normal;
        Vector3::new(x, y, z) * SIXTH
    }

    /// Those forces of all nodes, N.
    pub fn films(&self) -> Field {
        Field::of(&(0..self.sums.len()).map(|node| self.film(node)).collect::<Vec<_>>())
    }

    /// ∂V/∂x of all nodes, m².
    pub fn areas(&self) -> Field {
        Field::of(&(0..self.sums.len()).map(|node| self.area(node)).collect::<Vec<_>>())
    }

    pub(crate) fn set_film(&mut self, node: usize, force: Vector3<f64>) {
        self.sums[node].film[..3].copy_from_slice(force.as_slice());
    }

    /// Adds a sixth of a normal (m²) to ∂V/∂x of a node.
    pub(crate) fn add_normal(&mut self, node: usize, normal: Vector3<f64>) {
        for (sum, entry) in self.sums[node].normal.iter_mut().zip(&normal) {
            *sum += entry;
        }
    }

    /// Multiplies ∂V/∂x of a node.
    pub(crate) fn scale_area(&mut self, node: usize, factor: f64) {
        self.sums[node].normal.iter_mut().for_each(|entry| *entry *= factor);
    }
}
