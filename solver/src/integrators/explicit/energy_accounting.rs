//! Energy accounting of a run: the entries of the film's ledger and of the gas balance, in joules.
//!
//! ```text
//! kinetic  ½ Σ m v⁻·v⁺ + ½ Σ M u⁻ u⁺        v nodes, u rigid planes
//! gravity  g · Σ m (x − x⁰)
//! ```
//!
//! Signs and meaning of every entry: [`Ledger`] and [`GasBalance`].

use nalgebra::Vector3;

use super::{Explicit, PressureLoad};
use crate::mechanics::forces::membrane::stored_energy;
use crate::output::ledger::{GasBalance, Ledger};

impl Explicit {
    /// Energy stored in the film, J: elastic energy and that of creep.
    pub fn strain_energy(&self) -> f64 {
        stored_energy(&self.model, &self.state.element_history)
    }

    /// The energy ledger of the film.
    pub fn ledger(&self) -> Ledger {
        let works = self.state.works;
        let contact_state = &self.state.contact_state;
        Ledger {
            kinetic: self.kinetic_energy(),
            strain: self.strain_energy(),
            gas_work: works.gas,
            ambient_work: works.ambient,
            gravity_work: self
                .parameters
                .gravity
                .dot(&(self.first_moment() - Vector3::from(self.state.start_moment))),
            support_work: works.support,
            material_loss: works.material_loss,
            numerical_dissipation: works.numerical_dissipation,
            damping_work: works.damping,
            contact: -works.contact,
            contact_dissipation: contact_state.friction_dissipation
                + contact_state.collision_dissipation,
        }
    }

    /// The balance of the gas. The run adds the mass let in, which follows from the inflow schedule.
    /// Under a fixed overpressure every entry is 0.
    pub fn gas_balance(&self) -> GasBalance {
        let gas_work = match self.parameters.pressure_load {
            PressureLoad::Gas(_) => self.state.works.gas,
            PressureLoad::Overpressure(_) => 0.0,
        };
        GasBalance {
            mass: self.state.gas.mass,
            internal_energy: self.state.gas.internal_energy,
            gas_work,
            ..self.state.gas_balance
        }
    }

    /// First moment of mass Σ m x, kg m.
    pub(super) fn first_moment(&self) -> Vector3<f64> {
        let nodes = self.model.mass.iter().zip(self.state.positions.iter());
        nodes.map(|(mass, position)| position * *mass).sum()
    }
}
