//! Membrane forces of the film, and ∂V/∂x.
//!
//! ```text
//! F = [x1 − x0, x2 − x0] Dm⁻¹     E = (FᵀF − 1)/2     energy = A t W(E)
//! [f1, f2] = −A t F (S + D) Dm⁻ᵀ                      f0 = −(f1 + f2)
//! ∂V/∂x_i = Σ_e (x1 − x0) × (x2 − x0)/6               over the elements e at node i
//! ```
//!
//! Constant-strain triangles, total Lagrangian: S of [`crate::mechanics::material`], with the creep of
//! [`crate::mechanics::material_loss`]; D, the numerical stress, of [`super::damping`]. The loop over
//! the elements (`elements`) uses the metric of their edges instead of F.

use nalgebra::Vector3;

use crate::geometry::field::Field;
use crate::mechanics::closure::NormalSums;
use crate::mechanics::film_model::FilmModel;
use crate::mechanics::material_loss::Creep;
use crate::platform::simd::{InstructionSet, NodeSum};

mod creep_strain;
mod element_history;
mod elements;
mod response;
mod strain;

pub use creep_strain::{CreepStep, CreepStrain};
pub use element_history::{ElementHistory, numerical_forces, stored_energy, stress_on_fraction};
pub use strain::{deformation_gradient, strain, strain_energy, strain_of};

use elements::{LaneSums, sum_elements};

/// Sums over all elements.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct MembraneSums {
    /// Six times the volume enclosed by the film and the closing faces, m³.
    pub six_volumes: f64,
    /// Numerical dissipation of the step, J: what numerical damping and the time step took from the film.
    pub numerical_dissipation: f64,
    /// Material loss of the step, J.
    pub material_loss: f64,
    /// Largest principal second Piola-Kirchhoff stress, Pa, without the numerical stress.
    pub largest_stress: f64,
}

impl LaneSums {
    fn sums(self, creep: &Creep) -> MembraneSums {
        MembraneSums {
            six_volumes: self.six_volumes.sum(),
            numerical_dissipation: -0.5 * self.minus_twice_numerical.sum() / (1.0 + creep.ratio),
            material_loss: -0.5 * self.minus_twice_loss.sum() * creep.ratio / (1.0 + creep.ratio),
            largest_stress: self.largest_stress.largest(),
        }
    }
}

/// Computes the membrane forces and ∂V/∂x of all nodes at these positions (m), into `out`: the conservative
/// part and the numerical stress.
///
/// `step` is the time since the previous call, s. Where it is 0 (no previous call, or nothing moved),
/// creep strain and numerical stress are the stored ones. Replaces `histories` by those of these
/// positions, and writes the creep strain after the step beside that before it.
///
/// # Panics
/// If film with loss comes without creep strains.
pub fn assemble_membrane(
    instruction_set: InstructionSet,
    model: &FilmModel,
    positions: &Field,
    step: f64,
    creep: &mut CreepStep<'_>,
    histories: &mut [[ElementHistory; 2]],
    out: &mut NodeForces,
) -> MembraneSums {
    sum_elements(instruction_set, model, positions, Some(step), creep, histories, &mut out.sums)
        .sums(&model.creep)
}

/// The conservative part of [`assemble_membrane`]: elastic forces at a fixed creep strain, and ∂V/∂x. Sets
/// strain and stress of `histories`; their numerical stress is neither read nor written.
pub fn assemble_conservative(
    instruction_set: InstructionSet,
    model: &FilmModel,
    positions: &Field,
    creep: &[[CreepStrain; 2]],
    histories: &mut [[ElementHistory; 2]],
    out: &mut NodeForces,
) -> MembraneSums {
    let mut creep = CreepStep { last: creep, next: &mut [] };
    sum_elements(instruction_set, model, positions, None, &mut creep, histories, &mut out.sums)
        .sums(&model.creep)
}

/// Factor from the sum of the normals (x1 − x0) × (x2 − x0) at a node to ∂V/∂x; V = Σ x0·(x1 × x2)/6.
pub const NORMAL_TO_GRADIENT: f64 = 1.0 / 6.0;

/// Forces on the nodes.
#[derive(Debug, Clone, PartialEq)]
pub struct NodeForces {
    /// Membrane force and 6 ∂V/∂x of each node.
    pub sums: Vec<NodeSum>,
    /// Contact force on each node, N.
    pub contact: Field,
    /// Force of further energy terms on each node, N; empty without them.
    pub terms: Field,
}

impl NodeForces {
    /// Zero forces on the nodes of a model.
    pub fn new(model: &FilmModel) -> Self {
        let sums = vec![NodeSum::default(); model.nodes()];
        Self { sums, contact: Field::zeros(model.nodes()), terms: Field::zeros(0) }
    }

    /// Membrane force on a node, N.
    #[inline]
    pub fn film(&self, node: usize) -> Vector3<f64> {
        let [x, y, z, _] = self.sums[node].film;
        Vector3::new(x, y, z)
    }

    /// ∂V/∂x of a node, m².
    #[inline]
    pub fn area(&self, node: usize) -> Vector3<f64> {
        let [x, y, z, _] = self.sums[node].normal;
        Vector3::new(x, y, z) * NORMAL_TO_GRADIENT
    }

    /// Membrane forces on all nodes, N.
    pub fn films(&self) -> Field {
        Field::of(&(0..self.sums.len()).map(|node| self.film(node)).collect::<Vec<_>>())
    }

    /// ∂V/∂x of all nodes, m².
    pub fn areas(&self) -> Field {
        Field::of(&(0..self.sums.len()).map(|node| self.area(node)).collect::<Vec<_>>())
    }

    /// Sets the membrane force (N) on a node.
    pub(crate) fn set_film(&mut self, node: usize, force: Vector3<f64>) {
        self.sums[node].film[..3].copy_from_slice(force.as_slice());
    }

    /// Multiplies ∂V/∂x of a node by a factor.
    pub(crate) fn scale_area(&mut self, node: usize, factor: f64) {
        self.sums[node].normal.iter_mut().for_each(|entry| *entry *= factor);
    }
}

impl NormalSums for NodeForces {
    fn take_normal(&mut self, node: usize) -> Vector3<f64> {
        let [x, y, z, _] = core::mem::take(&mut self.sums[node].normal);
        Vector3::new(x, y, z)
    }

    fn add_normal(&mut self, node: usize, normal: Vector3<f64>) {
        for (sum, entry) in self.sums[node].normal.iter_mut().zip(&normal) {
            *sum += entry;
        }
    }
}
