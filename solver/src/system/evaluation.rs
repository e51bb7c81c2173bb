//! The conservative part: energies and forces at any positions.
//!
//! ```text
//! Π(x) = strain + contact + gas + gravity + planes + terms       f = −∂Π/∂x
//! gas      U (V₀/V)^(γ−1) + p_ambient V      at the entropy of the state; isothermal −m R T ln V + p_ambient V
//! fixed overpressure      −p V
//! gravity  −g·Σ m x            planes  −Σ F n·x
//! ```
//!
//! Creep strain, what terms have yielded, and the history of contact are those of the state: they change only when a
//! step is committed.

use super::{FilmState, FilmSystem, PressureLoad, Workspace};
use crate::geometry::field::Field;
use crate::mechanics::forces::membrane::stored_energy;
use crate::scene::HeatTransfer;

/// Energies (J) at positions, and what follows from them. The forces are in the workspace.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct Evaluation {
    /// Energy stored in the film: elastic energy and that of creep.
    pub strain: f64,
    /// Energy of contacts and plates, repulsive and adhesive.
    pub contact: f64,
    /// Energy of gas and ambient pressure, or minus p V under a fixed overpressure.
    pub pressure: f64,
    /// Potential energy of the weight.
    pub gravity: f64,
    /// Potential energy of the constant forces on rigid planes.
    pub planes: f64,
    /// Energy of further terms.
    pub terms: f64,
    /// Enclosed volume, m³.
    pub volume: f64,
    /// Gas pressure at the entropy of the state, or the fixed overpressure, Pa.
    pub gas_pressure: f64,
    /// −V/p dp/dV of the gas; 0 under a fixed overpressure.
    pub gas_exponent: f64,
    /// Largest principal stress, Pa.
    pub largest_stress: f64,
}

impl Evaluation {
    /// Π, J.
    pub fn energy(&self) -> f64 {
        self.strain + self.contact + self.pressure + self.gravity + self.planes + self.terms
    }
}

impl FilmSystem {
    /// Energies and forces at these positions (m) and this time (s), for the histories of a state. Writes to
    /// the workspace alone: forces, and the contacts of the trial. Vertices of closing faces that belong to no
    /// film must be where [`Self::place_closing_nodes`] puts them.
    pub fn evaluate(
        &self,
        state: &FilmState,
        positions: &Field,
        time: f64,
        workspace: &mut Workspace,
    ) -> Evaluation {
        workspace.prepare_search(self, positions);
        let mut sums = workspace.membrane(self, state, positions, None);
        workspace.add_other_forces(self, positions, &mut sums);
        self.term_forces(positions, &state.yielded, &mut workspace.forces);
        workspace.contact_at(self, state, positions, time);
        let volume = sums.six_volumes / 6.0;
        let (gas_pressure, pressure, gas_exponent) = self.pressure_energy(state, volume);
        let weight = |(mass, x): (&f64, nalgebra::Vector3<f64>)| mass * self.gravity.dot(&x);
        let planes = self.supports.bodies.iter().filter_map(|body| {
            let node = *body.nodes.first()? as usize;
            Some(body.plane.force * body.plane.normal.dot(&positions.get(node)))
        });
        Evaluation {
            strain: stored_energy(&self.model, &state.creep, &workspace.histories),
            contact: self.contact_energy(workspace),
            pressure,
            gravity: -self.model.mass.iter().zip(positions.iter()).map(weight).sum::<f64>(),
            planes: -planes.sum::<f64>(),
            terms: self.term_energy(positions, &state.yielded),
            volume,
            gas_pressure,
            gas_exponent,
            largest_stress: sums.largest_stress,
        }
    }

    /// Moves the vertices of closing faces that belong to no film to where their rims put them.
    pub fn place_closing_nodes(&self, positions: &mut Field) {
        self.model.closure_nodes.place(positions);
    }

    /// Pressure (Pa), energy (J) and −V/p dp/dV of the gas of a state in another volume (m³), without inflow, leak
    /// and heat; isothermal gas keeps its temperature.
    fn pressure_energy(&self, state: &FilmState, volume: f64) -> (f64, f64, f64) {
        match self.pressure_load {
            PressureLoad::Overpressure(pressure) => (pressure, -pressure * volume, 0.0),
            PressureLoad::Gas(gas) => {
                let after = gas.expansion(state.gas, state.volume, volume);
                let stored = match gas.heat_transfer {
                    HeatTransfer::Isothermal => -after.work,
                    HeatTransfer::Coefficient(_) => after.state.internal_energy,
                };
                let energy = stored + gas.ambient_pressure * volume;
                (after.pressure, energy, gas.exponent(after.state))
            }
        }
    }

    /// Energy of the contacts of a trial, J.
    fn contact_energy(&self, workspace: &Workspace) -> f64 {
        let (Some(model), Some(contact)) = (&self.contact, &workspace.contact) else { return 0.0 };
        let pairs = contact.trial.contacts.iter().map(|contact| {
            contact.stored_energy(contact.gap)
                - contact.adhesive_energy(contact.gap, model.adhesion.range)
        });
        let plates = contact.trial.plates.iter().map(|plate| plate.energy);
        pairs.sum::<f64>() + plates.sum::<f64>()
    }

    /// Share of these displacements (m), 0 to 1, that brings no film into film or a plate from these positions
    /// (m) at this time (s): each pair keeps a tenth of its distance. 1 without contact.
    pub fn safe_step(
        &self,
        (positions, time): (&Field, f64),
        displacements: &Field,
        workspace: &mut Workspace,
    ) -> f64 {
        workspace.prepare_search(self, positions);
        let (Some(model), Some(contact)) = (&self.contact, &mut workspace.contact) else {
            return 1.0;
        };
        let largest = displacements.iter().map(|u| u.norm()).fold(0.0, f64::max);
        contact.list.prepare_step(model, positions, &mut contact.progress, largest);
        let candidates = &contact.list.candidates;
        model.safe_step(candidates, positions, displacements, time)
    }
}
