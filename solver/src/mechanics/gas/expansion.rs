//! Gas whose volume changes while none enters, leaves or is heated from outside.
//!
//! ```text
//! adiabatic    U' = U (V/V')^(γ−1)        work = U − U'        cp of temperature: isentropic (`scene::Species`)
//! isothermal   U' = U                     work = heat = p V ln(V'/V)
//! ```

use super::{Gas, GasState, GasStep};
use crate::scene::HeatTransfer;

impl Gas {
    /// The gas of a volume (m³) after its expansion to another one; isothermal gas keeps its temperature.
    pub fn expansion(&self, state: GasState, from: f64, to: f64) -> GasStep {
        let (state, work, heat) = match self.heat_transfer {
            HeatTransfer::Isothermal => {
                let work = self.pressure(state, from) * from * libm::log(to / from);
                (state, work, work)
            }
            HeatTransfer::Coefficient(_) => {
                let after = if self.species.vibrates() && state.mass > 0.0 {
                    let before = self.temperature(state);
                    let after = self.species.after_volume_ratio(before, to / from);
                    self.internal_energy(state.mass, after)
                } else {
                    state.internal_energy * libm::pow(from / to, self.gamma() - 1.0)
                };
                let work = state.internal_energy - after;
                (GasState { internal_energy: after, ..state }, work, 0.0)
            }
        };
        let pressure = self.pressure(state, to);
        let (mass_out, enthalpy_in, enthalpy_out) = (0.0, 0.0, 0.0);
        GasStep { state, pressure, mass_out, enthalpy_in, enthalpy_out, heat, work }
    }
}
