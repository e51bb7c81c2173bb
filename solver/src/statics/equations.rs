//! The linear system of the Newton steps of a film with its supports, and its memory.
//!
//! ```text
//! (K + μ ω² M) d = r
//! ```
//!
//! Symbols: K tangent stiffness; M lumped mass; ω largest frequency of an element; μ a shift; d and r
//! displacements and forces along the unknowns.

use crate::factorisation::conjugate_gradients::conjugate_gradients;
use crate::factorisation::factor::{Elimination, Factor};
use crate::factorisation::unknowns::Unknowns;
use crate::geometry::field::Field;
use crate::mechanics::forces::tangent::{self, Stiffness};
use crate::system::{FilmSystem, TermStiffness};

/// Residual of conjugate gradients over the right side, in the norm of P⁻¹. Chosen: Newton's method then converges fast.
const MAX_RESIDUAL: f64 = 1e-3;

/// The equations of a film with its supports. They serve any number of loads and positions.
pub(super) struct Equations {
    /// The unknowns of the film with its supports.
    pub(super) unknowns: Unknowns,
    elimination: Elimination,
    factor: Factor,
    stiffness: Vec<Stiffness>,
    terms: TermStiffness,
    faces: Vec<[u32; 3]>,
    /// μ ω² M along the unknowns.
    shifts: Vec<f64>,
}

impl Equations {
    /// The equations of this film and these supports, whatever the load. The order of elimination depends on
    /// the positions (m).
    pub(super) fn new(film: &FilmSystem, positions: &Field) -> Self {
        let unknowns = Unknowns::new(&film.model, &film.supports);
        let (faces, terms) = (film.model.faces(), TermStiffness::new(film));
        let elimination = Elimination::new(&faces, &terms.nodes, &unknowns, positions);
        Self {
            unknowns,
            elimination,
            factor: Factor::default(),
            stiffness: Vec::new(),
            terms,
            faces,
            shifts: Vec::new(),
        }
    }

    /// Computes the stiffness of every face and patch at an overpressure (Pa) and positions (m).
    pub(super) fn assemble(&mut self, film: &FilmSystem, overpressure: f64, positions: &Field) {
        self.stiffness.clear();
        let faces = film.face_stiffness(&[], positions, overpressure);
        self.stiffness.extend(faces.map(|(_, stiffness)| stiffness));
        self.terms.prepare(film, positions, overpressure, &film.unyielded());
    }

    /// Factorises the stiffness with the shift μ ω² M. `false` if the matrix is not positive definite.
    pub(super) fn factor(&mut self, film: &FilmSystem, shift: f64) -> bool {
        let omega = film.model.largest_frequency();
        let factor = shift * omega * omega;
        self.shifts = self.unknowns.mass.iter().map(|mass| mass * factor).collect();
        let (set, matrices) =
            (film.instruction_set, (&self.stiffness[..], &self.terms.patches[..]));
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
        self.terms.add_product(film, &moves, &mut forces);
        tangent::add_products(&self.faces, &self.stiffness, &moves, &mut forces);
        let mut out: Vec<f64> = self.shifts.iter().zip(d).map(|(shift, d)| shift * d).collect();
        self.unknowns.add(&forces, &mut out);
        out
    }
}
