//! The linear system of the Newton steps of a film with its supports, and its memory.
//!
//! ```text
//! (K + μ ω² M) d = r
//! ```
//!
//! Symbols: K tangent stiffness; M lumped mass; ω largest frequency of an element; μ a shift; d and r
//! displacements and forces along the unknowns.

use nalgebra::{DMatrix, SVector};

use crate::factorisation::conjugate_gradients::conjugate_gradients;
use crate::factorisation::factor::{Elimination, Factor};
use crate::factorisation::unknowns::Unknowns;
use crate::geometry::field::Field;
use crate::mechanics::forces::tangent::Stiffness;
use crate::system::FilmSystem;

/// Residual of conjugate gradients over the right side, in the norm of P⁻¹. Chosen: Newton's method then converges fast.
const MAX_RESIDUAL: f64 = 1e-3;

/// The equations of a film with its supports. They serve any number of loads and positions.
pub(super) struct Equations {
    /// The unknowns of the film with its supports.
    pub(super) unknowns: Unknowns,
    elimination: Elimination,
    factor: Factor,
    stiffness: Vec<Stiffness>,
    patches: Vec<DMatrix<f64>>,
    faces: Vec<[u32; 3]>,
    shifts: Vec<f64>,
    /// Positions that the stiffness is of, m; only for further energies.
    at: Field,
}

impl Equations {
    /// The equations of this film and these supports, whatever the load. The order of elimination depends on
    /// the positions (m).
    pub(super) fn new(film: &FilmSystem, positions: &Field) -> Self {
        let unknowns = Unknowns::new(&film.model, &film.supports);
        let (faces, patches) = (film.model.faces(), film.patches());
        let elimination = Elimination::new(&faces, &patches, &unknowns, positions);
        let zeros = |nodes: &Vec<u32>| DMatrix::zeros(3 * nodes.len(), 3 * nodes.len());
        Self {
            unknowns,
            elimination,
            factor: Factor::default(),
            stiffness: Vec::new(),
            patches: patches.iter().map(zeros).collect(),
            faces,
            shifts: Vec::new(),
            at: Field::zeros(0),
        }
    }

    /// Computes the stiffness of every face and patch at an overpressure (Pa) and positions (m).
    pub(super) fn assemble(&mut self, film: &FilmSystem, overpressure: f64, positions: &Field) {
        self.stiffness.clear();
        let faces = film.face_stiffness(&[], positions, overpressure);
        self.stiffness.extend(faces.map(|(_, stiffness)| stiffness));
        if !film.energy_terms.is_empty() {
            film.patch_stiffness(positions, &mut self.patches);
            self.at.clone_from(positions);
        }
    }

    /// Factorises the stiffness with the shift μ ω² M. `false` if the matrix is not positive definite.
    pub(super) fn factor(&mut self, film: &FilmSystem, shift: f64) -> bool {
        let omega = film.model.largest_frequency();
        let factor = shift * omega * omega;
        self.shifts = self.unknowns.mass.iter().map(|mass| mass * factor).collect();
        let (set, matrices) = (film.instruction_set, (&self.stiffness[..], &self.patches[..]));
        self.elimination.factor(set, matrices, &self.shifts, &mut self.factor)
    }

    /// Displacements (m) from forces (N), both along the unknowns, by the factor in memory; with further energies, by
    /// conjugate gradients that it preconditions.
    pub(super) fn solve(&mut self, film: &FilmSystem, forces: &[f64]) -> Vec<f64> {
        let set = film.instruction_set;
        let factored = |all: &mut Self, r: &[f64]| all.elimination.solve(set, &mut all.factor, r);
        let first = factored(self, forces);
        if film.energy_terms.is_empty() {
            return first;
        }
        conjugate_gradients(self, (forces, first), MAX_RESIDUAL, factored, |all, d| {
            all.product(film, d)
        })
    }

    /// (K + μ ω² M) d of film with further energies.
    fn product(&self, film: &FilmSystem, d: &[f64]) -> Vec<f64> {
        let mut moves = Field::zeros(film.model.nodes());
        self.unknowns.shift(&mut moves, d, 1.0);
        let mut forces = Field::zeros(film.model.nodes());
        film.add_term_products((&self.at, &self.patches), &moves, &mut forces);
        for (nodes, stiffness) in self.faces.iter().zip(&self.stiffness) {
            let u = nodes.map(|node| moves.get(node as usize));
            let f = stiffness * SVector::<f64, 9>::from_fn(|row, _| u[row / 3][row % 3]);
            for (corner, node) in nodes.iter().enumerate() {
                let node = *node as usize;
                forces.set(node, forces.get(node) + f.fixed_rows::<3>(3 * corner));
            }
        }
        let mut out: Vec<f64> = self.shifts.iter().zip(d).map(|(shift, d)| shift * d).collect();
        self.unknowns.add(&forces, &mut out);
        out
    }
}
