//! What a run has done so far, in joules.

use nalgebra::Vector3;

use super::{Explicit, PressureLoad};
use crate::mechanics::forces::membrane::strain_energy;
use crate::output::ledger::{GasBalance, Ledger};

impl Explicit {
    /// Elastic energy, J.
    pub fn strain_energy(&self) -> f64 {
        strain_energy(&self.model, &self.state.places)
    }

    /// The film's side of the ledger.
    pub fn ledger(&self) -> Ledger {
        let works = self.state.works;
        Ledger {
            kinetic: self.kinetic_energy(),
            strain: self.strain_energy(),
            gas_work: works.gas,
            ambient_work: works.ambient,
            gravity_work: self
                .setting
                .gravity
                .dot(&(self.first_moment() - Vector3::from(self.state.start_moment))),
            support_work: works.support,
            viscous_work: works.viscous,
            damping_work: works.damping,
            contact: -works.contact,
            friction_work: self.state.meeting.friction_dissipation
                + self.state.meeting.collision_dissipation,
        }
    }

    /// The gas's side of the ledger; the mass let in is the loop's. A fixed overpressure has none.
    pub fn books(&self) -> GasBalance {
        let gas_work = match self.setting.interior {
            PressureLoad::Gas(_) => self.state.works.gas,
            PressureLoad::Overpressure(_) => 0.0,
        };
        GasBalance {
            mass: self.state.gas.mass,
            internal_energy: self.state.gas.internal_energy,
            gas_work,
            ..self.state.books
        }
    }

    /// Σ m x, kg m.
    pub(super) fn first_moment(&self) -> Vector3<f64> {
        let nodes = self.model.mass.iter().zip(self.state.places.iter());
        nodes.map(|(mass, place)| place * *mass).sum()
    }
}
