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
use crate::mechanics::film_model::FilmModel;
use crate::mechanics::forces::tangent::{self, Stiffness};
use crate::mechanics::supports::Supports;
use crate::platform::simd::InstructionSet;

/// The system of a film with its supports. It serves any number of loads and positions.
pub(super) struct System {
    /// The unknowns of the film with its supports.
    pub(super) unknowns: Unknowns,
    elimination: Elimination,
    factor: Factor,
    stiffness: Vec<Stiffness>,
    shifts: Vec<f64>,
}

impl System {
    /// The system of this film and these supports, whatever the load. The order of elimination depends on
    /// the positions (m).
    pub(super) fn new(model: &FilmModel, supports: &Supports, positions: &Field) -> Self {
        let unknowns = Unknowns::new(model, supports);
        let elimination = Elimination::new(model, &unknowns, positions);
        let (factor, stiffness, shifts) = (Factor::default(), Vec::new(), Vec::new());
        Self { unknowns, elimination, factor, stiffness, shifts }
    }

    /// Computes the stiffness of every face at an overpressure (Pa) and positions (m), film first.
    pub(super) fn assemble(&mut self, model: &FilmModel, overpressure: f64, positions: &Field) {
        let film = (0..model.elements()).map(|element| {
            let mut stiffness = tangent::elastic(model, positions, element);
            let face = model.triangles[element];
            tangent::add_pressure(&mut stiffness, face, positions, overpressure);
            stiffness
        });
        let closure =
            model.closure.iter().map(|face| tangent::pressure(*face, positions, overpressure));
        self.stiffness.clear();
        self.stiffness.extend(film.chain(closure));
    }

    /// Factorises the stiffness with the shift μ ω² M (ω in rad/s). `false` if the matrix is not positive
    /// definite.
    pub(super) fn factor(
        &mut self,
        instruction_set: InstructionSet,
        shift: f64,
        omega: f64,
    ) -> bool {
        let factor = shift * omega * omega;
        self.shifts.clear();
        self.shifts.extend(self.unknowns.mass.iter().map(|mass| mass * factor));
        self.elimination.factor(instruction_set, &self.stiffness, &self.shifts, &mut self.factor)
    }

    /// Displacements (m) from forces (N), both along the unknowns, by the factor in memory.
    pub(super) fn solve(&mut self, instruction_set: InstructionSet, forces: &[f64]) -> Vec<f64> {
        self.elimination.solve(instruction_set, &mut self.factor, forces)
    }
}
