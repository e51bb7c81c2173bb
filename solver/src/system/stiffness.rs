//! The stiffness ∂²Π/∂x² at positions that were just evaluated, block by block.
//!
//! ```text
//! K = membrane + pressure on faces                                   given face by face
//!   + contact + plates                                               given as 3 × 3 blocks
//!   + further energies + pressure on vertices without film           given patch by patch
//!   + (γ p/V) ∂V/∂x (∂V/∂x)ᵀ                                         gas: of rank one, given apart
//! ```
//!
//! The pressure on a face is given with its symmetric part; the rest cancels over a closed surface
//! ([`crate::mechanics::forces::tangent`]). A block of a vertex without film belongs to its rim
//! ([`crate::mechanics::forces::closure`]).

use nalgebra::{DMatrix, DVector};

use super::{Evaluation, FilmSystem, PressureLoad, Workspace};
use crate::geometry::field::Field;
use crate::mechanics::energy_term::{Blocks, Prepared};
use crate::mechanics::forces::closure;
use crate::mechanics::forces::membrane::CreepStrain;
use crate::mechanics::forces::tangent::{self, Stiffness};

/// The gas as a stiffness of rank one.
#[derive(Debug, Clone, PartialEq)]
pub struct GasStiffness {
    /// γ p/V, or p/V for isothermal gas, N/m⁵.
    pub factor: f64,
    /// ∂V/∂x of each node, m².
    pub gradient: Field,
}

/// The stiffness of the further energies and of closing faces at some positions, patch by patch.
#[derive(Debug, Clone)]
pub struct TermStiffness {
    /// Nodes of each patch, term by term; then the rims of the closing faces.
    pub nodes: Vec<Vec<u32>>,
    /// Matrix of each patch, N/m.
    pub patches: Vec<DMatrix<f64>>,
    /// Number of patches of each term.
    counts: Vec<usize>,
    /// The positions, m.
    positions: Field,
}

impl TermStiffness {
    /// Zero stiffness of the patches of a system.
    pub fn new(system: &FilmSystem) -> Self {
        let of_terms: Vec<_> = system.energy_terms.iter().map(|term| term.patches()).collect();
        let counts = of_terms.iter().map(Vec::len).collect();
        let mut nodes: Vec<Vec<u32>> = of_terms.into_iter().flatten().collect();
        nodes.extend(system.model.closure_nodes.rims());
        let zeros = |nodes: &Vec<u32>| DMatrix::zeros(3 * nodes.len(), 3 * nodes.len());
        let patches = nodes.iter().map(zeros).collect();
        Self { nodes, patches, counts, positions: Field::zeros(0) }
    }

    /// Computes it at these positions (m) and this overpressure (Pa), with what the terms have yielded.
    pub fn prepare(
        &mut self,
        system: &FilmSystem,
        positions: &Field,
        overpressure: f64,
        yielded: &[Vec<f64>],
    ) {
        if self.nodes.is_empty() {
            return;
        }
        self.positions.clone_from(positions);
        let mut rest = &mut self.patches[..];
        for ((term, count), yielded) in system.energy_terms.iter().zip(&self.counts).zip(yielded) {
            let (of_term, others) = rest.split_at_mut(*count);
            term.stiffness(positions, yielded, of_term);
            rest = others;
        }
        closure::stiffness(&system.model.closure_nodes, positions, overpressure, rest);
    }

    /// Adds K u, N, of displacements u (m) to `products`.
    pub fn add_product(&self, system: &FilmSystem, displacements: &Field, products: &mut Field) {
        let (positions, mut rest) = (&self.positions, &self.patches[..]);
        for (term, count) in system.energy_terms.iter().zip(&self.counts) {
            let (patches, others) = rest.split_at(*count);
            term.add_product(&Prepared { positions, patches }, displacements, products);
            rest = others;
        }
        for (patch, nodes) in rest.iter().zip(&self.nodes[self.nodes.len() - rest.len()..]) {
            let of_node = |row: usize| displacements.get(nodes[row / 3] as usize)[row % 3];
            let product = patch * DVector::from_fn(3 * nodes.len(), |row, _| of_node(row));
            for (index, node) in nodes.iter().enumerate() {
                let node = *node as usize;
                products.set(node, products.get(node) + product.fixed_rows::<3>(3 * index));
            }
        }
    }
}

impl FilmSystem {
    /// Nodes and stiffness of every element with its pressure, then those of the closing faces; at these positions
    /// (m), creep strains and this overpressure (Pa).
    pub fn face_stiffness<'a>(
        &'a self,
        creep: &'a [[CreepStrain; 2]],
        positions: &'a Field,
        overpressure: f64,
    ) -> impl Iterator<Item = ([u32; 3], Stiffness)> + 'a {
        let elements = tangent::elements(&self.model, creep, positions);
        let loaded = elements.map(move |(nodes, mut stiffness)| {
            tangent::add_pressure(&mut stiffness, nodes, positions, overpressure);
            (nodes, stiffness)
        });
        let closure = self.model.closure.iter();
        loaded.chain(
            closure.map(move |face| (*face, tangent::pressure(*face, positions, overpressure))),
        )
    }

    /// Gives the blocks of contact and plates at these positions (m) and this time (s), which the workspace is of.
    pub fn pair_stiffness(
        &self,
        (positions, time): (&Field, f64),
        workspace: &Workspace,
        add: Blocks<'_>,
    ) {
        if let (Some(model), Some(contact)) = (&self.contact, &workspace.contact) {
            model.stiffness(&self.model, &contact.trial, positions, time, add);
        }
    }

    /// The stiffness of the gas at the positions that `evaluation` and the workspace are of; `None` under a fixed
    /// overpressure.
    pub fn gas_stiffness(
        &self,
        evaluation: &Evaluation,
        workspace: &Workspace,
    ) -> Option<GasStiffness> {
        let PressureLoad::Gas(_) = self.pressure_load else { return None };
        let factor = evaluation.gas_exponent * evaluation.gas_pressure / evaluation.volume;
        Some(GasStiffness { factor, gradient: workspace.forces.areas() })
    }
}
