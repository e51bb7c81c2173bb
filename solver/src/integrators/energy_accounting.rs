//! Energy accounting of a run: what an integrator adds up step by step.
//!
//! ```text
//! gravity  g · Σ m (x − x⁰)
//! ```
//!
//! Signs and meaning of every entry: [`Ledger`] and [`GasBalance`].

use nalgebra::Vector3;
use serde::{Deserialize, Serialize};

use crate::mechanics::gas::GasStep;
use crate::output::ledger::{GasBalance, Ledger};
use crate::system::{FilmState, FilmSystem, PressureLoad};

/// What adds up since time 0.
#[derive(Debug, Clone, Copy, PartialEq, Default, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct EnergyAccounting {
    /// Accepted steps.
    pub steps: u64,
    /// Largest principal second Piola-Kirchhoff stress so far, Pa.
    pub film_stress: f64,
    /// Works.
    pub works: Works,
    /// Mass, enthalpy and heat exchanged by the gas.
    pub gas_balance: GasBalance,
    /// Energy dissipated by friction, J.
    pub friction_dissipation: f64,
    /// Energy dissipated by collision impulses of pairs and plates, J. The ledger's entry `friction_work` is
    /// the sum of this and [`Self::friction_dissipation`].
    pub collision_dissipation: f64,
    /// Number of collision impulses on pairs.
    pub collision_impulses: u64,
    /// Number of times that the candidates of contact were built without history, the first included.
    pub broad_phase_rebuilds: u64,
    /// Σ m x at time 0, kg m.
    pub start_moment: [f64; 3],
    /// Kinetic and stored energy at time 0, J.
    pub start_energy: f64,
}

/// Works since time 0, J. Positive: energy given to the film; for the last three: energy dissipated.
#[derive(Debug, Clone, Copy, PartialEq, Default, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Works {
    /// Work of the gas, or of the fixed overpressure, on the film.
    pub gas: f64,
    /// Work of the ambient pressure on the film.
    pub ambient: f64,
    /// Work of moving supports, rigid planes and plates on the film.
    pub support: f64,
    /// Work of contact forces on the film. Minus this is the stored contact energy.
    pub contact: f64,
    /// Energy lost in the material.
    pub material_loss: f64,
    /// Energy taken by numerical damping and by the time step; negative where they gave energy.
    pub numerical_dissipation: f64,
    /// Energy dissipated by mass damping.
    pub damping: f64,
}

impl EnergyAccounting {
    /// The accounting at time 0.
    pub fn start(system: &FilmSystem, state: &FilmState) -> Self {
        Self {
            broad_phase_rebuilds: u64::from(system.contact.is_some()),
            start_moment: system.first_moment(state).into(),
            ..Self::default()
        }
    }

    /// The accounting this share of the way from `self` to a later one.
    #[must_use]
    pub fn between(&self, later: &Self, share: f64) -> Self {
        let mix = |from: f64, to: f64| from + share * (to - from);
        let (a, b, c, d) = (&self.works, &later.works, &self.gas_balance, &later.gas_balance);
        Self {
            works: Works {
                gas: mix(a.gas, b.gas),
                ambient: mix(a.ambient, b.ambient),
                support: mix(a.support, b.support),
                contact: mix(a.contact, b.contact),
                material_loss: mix(a.material_loss, b.material_loss),
                numerical_dissipation: mix(a.numerical_dissipation, b.numerical_dissipation),
                damping: mix(a.damping, b.damping),
            },
            gas_balance: GasBalance {
                mass_out: mix(c.mass_out, d.mass_out),
                enthalpy_in: mix(c.enthalpy_in, d.enthalpy_in),
                enthalpy_out: mix(c.enthalpy_out, d.enthalpy_out),
                heat: mix(c.heat, d.heat),
                ..*d
            },
            ..*later
        }
    }

    /// The ledger with this kinetic energy and this energy stored in the film (J), as the method conserves
    /// them. Further energies of the system are added to the stored one.
    pub fn ledger(
        &self,
        system: &FilmSystem,
        state: &FilmState,
        kinetic: f64,
        strain: f64,
    ) -> Ledger {
        let works = self.works;
        let moved = system.first_moment(state) - Vector3::from(self.start_moment);
        let strain = strain + system.term_energy(&state.positions, &state.yielded);
        Ledger {
            kinetic,
            strain,
            gas_work: works.gas,
            ambient_work: works.ambient,
            gravity_work: system.gravity.dot(&moved),
            support_work: works.support,
            material_loss: works.material_loss,
            numerical_dissipation: works.numerical_dissipation,
            damping_work: works.damping,
            contact: -works.contact,
            contact_dissipation: self.friction_dissipation + self.collision_dissipation,
        }
    }

    /// Makes a step of the gas to a volume (m³) that of the state, and adds its entries.
    pub fn commit_gas(
        &mut self,
        system: &FilmSystem,
        state: &mut FilmState,
        step: Option<GasStep>,
        volume: f64,
    ) {
        if let (PressureLoad::Gas(gas), Some(step)) = (system.pressure_load, step) {
            state.gas = step.state;
            state.pressure = step.pressure;
            self.works.gas += step.work;
            self.works.ambient -= gas.ambient_pressure * (volume - state.volume);
            self.gas_balance.mass_out += step.mass_out;
            self.gas_balance.enthalpy_in += step.enthalpy_in;
            self.gas_balance.enthalpy_out += step.enthalpy_out;
            self.gas_balance.heat += step.heat;
        }
        state.volume = volume;
    }

    /// The balance of the gas. The run adds the mass let in, which follows from the inflow schedule.
    /// Under a fixed overpressure every entry is 0.
    pub fn gas_balance(&self, system: &FilmSystem, state: &FilmState) -> GasBalance {
        let gas_work = match system.pressure_load {
            PressureLoad::Gas(_) => self.works.gas,
            PressureLoad::Overpressure(_) => 0.0,
        };
        GasBalance {
            mass: state.gas.mass,
            internal_energy: state.gas.internal_energy,
            gas_work,
            ..self.gas_balance
        }
    }
}
