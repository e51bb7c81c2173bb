//! The linear system of the Newton steps of a film with its supports, and its memory.
//!
//! ```text
//! (K + μ ω² M) d = r
//! ```
//!
//! Symbols: K tangent stiffness; M lumped mass; ω largest frequency of an element; μ a shift; d and r
//! displacements and forces along the unknowns.

use crate::factorisation::factor::{Elimination, Factor};
use crate::factorisation::unknowns::Unknowns;
use crate::geometry::field::Field;
use crate::mechanics::forces::tangent::Stiffness;
use crate::system::FilmSystem;

/// The equations of a film with its supports. They serve any number of loads and positions.
pub(super) struct Equations {
    /// The unknowns of the film with its supports.
    pub(super) unknowns: Unknowns,
    elimination: Elimination,
    factor: Factor,
    stiffness: Vec<Stiffness>,
}

impl Equations {
    /// The equations of this film and these supports, whatever the load. The order of elimination depends on
    /// the positions (m).
    pub(super) fn new(film: &FilmSystem, positions: &Field) -> Self {
        let unknowns = Unknowns::new(&film.model, &film.supports);
        let elimination = Elimination::new(&film.model, &unknowns, positions);
        Self { unknowns, elimination, factor: Factor::default(), stiffness: Vec::new() }
    }

    /// Computes the stiffness of every face at an overpressure (Pa) and positions (m), film first.
    pub(super) fn assemble(&mut self, film: &FilmSystem, overpressure: f64, positions: &Field) {
        self.stiffness.clear();
        let faces = film.face_stiffness(&[], positions, overpressure);
        self.stiffness.extend(faces.map(|(_, stiffness)| stiffness));
    }

    /// Factorises the stiffness with the shift μ ω² M. `false` if the matrix is not positive definite.
    pub(super) fn factor(&mut self, film: &FilmSystem, shift: f64) -> bool {
        let omega = film.model.largest_frequency();
        let factor = shift * omega * omega;
        let shifts: Vec<f64> = self.unknowns.mass.iter().map(|mass| mass * factor).collect();
        let set = film.instruction_set;
        self.elimination.factor(set, &self.stiffness, &shifts, &mut self.factor)
    }

    /// Displacements (m) from forces (N), both along the unknowns, by the factor in memory.
    pub(super) fn solve(&mut self, film: &FilmSystem, forces: &[f64]) -> Vec<f64> {
        self.elimination.solve(film.instruction_set, &mut self.factor, forces)
    }
}
