//! One control volume of an ideal gas with uniform pressure and temperature.
//!
//! ```text
//! dm/dt = ṁ_in − ṁ_out
//! dU/dt = ṁ_in cp T_in − ṁ_out cp T − p dV/dt + Q̇        Q̇ = h A (T_film − T)
//! T = U/(m cv)          p = (γ − 1) U/V                   γ = cp/cv, cv = cp − R        ṁ_out: `leak`
//! cp of temperature:    m u(T) = U, p = m R T/V, and h(T) in place of cp T (`scene::Species`)
//! ```
//!
//! Symbols: m mass, kg; U internal energy, J; T temperature, K; p pressure, Pa; V volume, m³;
//! h heat transfer coefficient, W/(m² K); A film area, m².
//!
//! - Without gas p = 0, and the temperature is reported as that of the film.
//! - A vent is a wider leak while it is open ([`Vent`]).
//! - The leak flows both ways. Where p < `p_ambient`, `ṁ_out` is negative: the same equations with inside and
//!   outside exchanged, for gas of the same species at film temperature outside.
//! - [`HeatTransfer::Isothermal`] is exact: T = `T_film`, and the heat follows from the balance.
//! - With h > 0 the gas approaches film temperature at the rate h A/(m cv), limited to 1/µs
//!   (`MIN_EXCHANGE_TIME`). Without that limit a nearly empty volume would need ever smaller steps.
//!
//! Every model uses this gas. The model supplies V and dV/dt, and computes the work of p on its film.

use serde::{Deserialize, Serialize};

use crate::scene::inflow::Inflow;
use crate::scene::{GasSupply, HeatTransfer, Species, Vent};

mod expansion;
mod leak;
mod slit;
mod step;

use leak::Orifice;
pub use step::GasStep;

/// State of the gas.
#[derive(Debug, Clone, Copy, PartialEq, Default, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct GasState {
    /// m, kg.
    pub mass: f64,
    /// U, J.
    pub internal_energy: f64,
}

/// Mass balance and energy balance of the gas, term by term.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct GasRates {
    /// dm/dt, kg/s.
    pub mass: f64,
    /// dU/dt, W.
    pub internal_energy: f64,
    /// `ṁ_out`, mass flow rate of the leak, kg/s; negative where gas enters from outside.
    pub mass_out: f64,
    /// `ṁ_in` cp `T_in`, enthalpy flow of the inflow, W.
    pub enthalpy_in: f64,
    /// `ṁ_out` cp T, enthalpy flow of the leak, W.
    pub enthalpy_out: f64,
    /// Q̇, heat flow from the film to the gas, W.
    pub heat: f64,
    /// p dV/dt, power of the gas on the film, W.
    pub work: f64,
}

/// Smallest time constant m cv/(h A) of the heat exchange, s. Without this limit it tends to zero with
/// the mass of the gas and makes the equations stiff. Chosen: shorter than any motion of the film.
const MIN_EXCHANGE_TIME: f64 = 1e-6;

/// Constants of the control volume during a run.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Gas {
    species: Species,
    /// cp without vibrations, J/(kg K).
    pub cp: f64,
    /// cv without vibrations, J/(kg K).
    pub cv: f64,
    /// Pressure outside, Pa.
    pub ambient_pressure: f64,
    /// `T_film`, K.
    pub film_temperature: f64,
    /// Heat exchange with the film.
    pub heat_transfer: HeatTransfer,
    /// Film area of the heat exchange, m².
    pub film_area: f64,
    orifice: Orifice,
    vent: Option<Vent>,
    discharge_coefficient: f64,
}

impl Gas {
    /// The control volume of a gas supply, inside film of this temperature (K) and area (m²).
    pub fn new(supply: &GasSupply, film_temperature: f64, film_area: f64) -> Self {
        let cp = supply.species.cp;
        let cv = cp - supply.species.gas_constant;
        Self {
            species: supply.species,
            cp,
            cv,
            ambient_pressure: supply.ambient_pressure,
            film_temperature,
            heat_transfer: supply.heat_transfer,
            film_area,
            orifice: Orifice::new(
                supply.species.gamma(film_temperature),
                supply.discharge_coefficient * supply.leak_area,
            ),
            vent: supply.vent,
            discharge_coefficient: supply.discharge_coefficient,
        }
    }

    /// γ = cp/cv without vibrations: the largest.
    pub fn gamma(&self) -> f64 {
        self.cp / self.cv
    }

    /// −V/p dp/dV without inflow, leak and heat: γ of its temperature, 1 if isothermal.
    pub fn exponent(&self, state: GasState) -> f64 {
        match self.heat_transfer {
            HeatTransfer::Isothermal => 1.0,
            HeatTransfer::Coefficient(_) if self.species.vibrates() => {
                self.species.gamma(self.temperature(state))
            }
            HeatTransfer::Coefficient(_) => self.gamma(),
        }
    }

    /// Internal energy, J, of a mass (kg) at a temperature (K).
    fn internal_energy(&self, mass: f64, temperature: f64) -> f64 {
        mass * self.cv * temperature + mass * self.species.vibration_energy(temperature)
    }

    /// The leak at this temperature inside, K.
    fn orifice(&self, temperature: f64) -> Orifice {
        if self.species.vibrates() {
            return self.orifice.of_gamma(self.species.gamma(temperature));
        }
        self.orifice
    }

    /// State of gas with this mass (kg) and temperature (K).
    pub fn at_temperature(&self, mass: f64, temperature: f64) -> GasState {
        GasState { mass, internal_energy: self.internal_energy(mass, temperature) }
    }

    /// T, K; the film temperature where there is no gas.
    pub fn temperature(&self, state: GasState) -> f64 {
        match self.heat_transfer {
            HeatTransfer::Isothermal => self.film_temperature,
            HeatTransfer::Coefficient(_) => {
                let temperature = if self.species.vibrates() {
                    self.species.temperature(state.internal_energy / state.mass, 0.0)
                } else {
                    state.internal_energy / (state.mass * self.cv)
                };
                let valid = state.mass > 0.0 && temperature.is_finite() && temperature >= 0.0;
                if valid { temperature } else { self.film_temperature }
            }
        }
    }

    /// p, Pa, in the volume V (m³).
    pub fn pressure(&self, state: GasState, volume: f64) -> f64 {
        let internal_energy = match self.heat_transfer {
            HeatTransfer::Isothermal => state.mass * self.cv * self.film_temperature,
            // Without that of vibrations, which make no pressure. An energy below 0 shows as such a pressure.
            HeatTransfer::Coefficient(_) if self.species.vibrates() && state.mass > 0.0 => {
                let energy = state.internal_energy / state.mass;
                state.mass * self.cv * self.species.temperature(energy, 0.0)
            }
            HeatTransfer::Coefficient(_) => state.internal_energy,
        };
        (self.gamma() - 1.0) * internal_energy / volume
    }

    /// T, K, of gas that enters an empty volume: the limit of both balances for m → 0. m cv T =
    /// ṁ cp `T_in` t with m = ṁ t gives T = γ `T_in`; the heat vanishes with m (`MIN_EXCHANGE_TIME`). With
    /// this value the rates are continuous at m = 0.
    fn first_temperature(&self, inflow: Inflow) -> f64 {
        match self.heat_transfer {
            HeatTransfer::Coefficient(_) if inflow.mass_flow_rate > 0.0 => {
                if self.species.vibrates() {
                    let enthalpy = self.enthalpy_flow(inflow) / inflow.mass_flow_rate;
                    return self.species.temperature(enthalpy, 0.0);
                }
                self.gamma() * inflow.temperature_flow / inflow.mass_flow_rate
            }
            _ => self.film_temperature,
        }
    }

    /// Enthalpy flow of an inflow, W.
    fn enthalpy_flow(&self, inflow: Inflow) -> f64 {
        self.cp * inflow.temperature_flow + inflow.vibration_flow
    }

    /// Both balances at the volume V (m³) that changes at dV/dt (m³/s).
    pub fn rates(
        &self,
        state: GasState,
        volume: f64,
        volume_rate: f64,
        inflow: Inflow,
    ) -> GasRates {
        let temperature =
            if state.mass > 0.0 { self.temperature(state) } else { self.first_temperature(inflow) };
        let pressure = self.pressure(state, volume);
        let backwards = pressure < self.ambient_pressure;
        let upstream = if backwards { self.film_temperature } else { temperature };
        let mut orifice = self.orifice(upstream);
        if let Some(vent) = self.vent.filter(|_| inflow.vent_open) {
            let area = vent.open_area(pressure - self.ambient_pressure);
            orifice = orifice.wider(self.discharge_coefficient * area);
        }
        let vibration = self.species.vibration_energy(upstream);
        let outflow = orifice.mass_flow(pressure, state.mass / volume, self.ambient_pressure);
        let (mass_out, enthalpy_out) = if backwards {
            // p = (cp − cv) ρ T outside.
            let density = self.ambient_pressure / ((self.cp - self.cv) * self.film_temperature);
            let back = orifice.mass_flow(self.ambient_pressure, density, pressure);
            (-back, -back * self.cp * self.film_temperature - back * vibration)
        } else {
            (outflow, outflow * self.cp * temperature + outflow * vibration)
        };
        let enthalpy_in = self.enthalpy_flow(inflow);
        let work = pressure * volume_rate;
        let mass = inflow.mass_flow_rate - mass_out;
        let without_heat = enthalpy_in - enthalpy_out - work;
        let (internal_energy, heat) = match self.heat_transfer {
            HeatTransfer::Coefficient(coefficient) => {
                let exchange = coefficient * self.film_area;
                let exchange = exchange.min(state.mass * self.cv / MIN_EXCHANGE_TIME);
                let heat = exchange * (self.film_temperature - temperature);
                (without_heat + heat, heat)
            }
            HeatTransfer::Isothermal => {
                let vibration = self.species.vibration_energy(self.film_temperature);
                let internal_energy = self.cv * self.film_temperature * mass + vibration * mass;
                (internal_energy, internal_energy - without_heat)
            }
        };
        GasRates { mass, internal_energy, mass_out, enthalpy_in, enthalpy_out, heat, work }
    }
}

#[cfg(test)]
#[expect(clippy::float_cmp, reason = "these values are exact")]
mod tests {
    use super::*;
    use crate::scene::Species;
    use crate::scene::paper::nitrogen_supply;

    const NITROGEN: Species = Species::NITROGEN;

    fn gas(heat_transfer: HeatTransfer, leak_area: f64) -> Gas {
        let supply = GasSupply { heat_transfer, leak_area, ..nitrogen_supply() };
        Gas::new(&supply, 293.0, 2.0)
    }

    #[test]
    fn pressure_follows_the_ideal_gas_law() {
        let gas = gas(HeatTransfer::Coefficient(0.0), 0.0);
        let state = gas.at_temperature(0.003, 250.0);
        let expected = 0.003 * NITROGEN.gas_constant * 250.0 / 0.2;
        assert!((gas.pressure(state, 0.2) / expected - 1.0).abs() < 1e-14);
        assert!((gas.temperature(state) / 250.0 - 1.0).abs() < 1e-14);
    }

    #[test]
    fn empty_volume_has_zero_pressure_and_film_temperature() {
        for heat in [HeatTransfer::Coefficient(5.0), HeatTransfer::Isothermal] {
            let gas = gas(heat, 1e-4);
            let rates = gas.rates(GasState::default(), 0.01, 1.0, Inflow::default());
            assert_eq!(gas.temperature(GasState::default()), 293.0);
            assert_eq!(gas.pressure(GasState::default(), 0.01), 0.0);
            assert_eq!([rates.mass, rates.internal_energy, rates.heat, rates.work], [0.0; 4]);
        }
    }

    #[test]
    fn rates_of_nearly_no_gas_are_finite() {
        let gas = gas(HeatTransfer::Coefficient(0.3), 1e-4);
        for mass in [f64::MIN_POSITIVE, 1e-320, 1e-200, 1e-30] {
            for internal_energy in [0.0, 1e-310, 1e-30] {
                let state = GasState { mass, internal_energy };
                let rates = gas.rates(state, 0.01, 1.0, Inflow::default());
                assert!(rates.internal_energy.is_finite() && rates.mass.is_finite(), "{state:?}");
            }
        }
    }

    /// A vessel of 0.01 m³ of isothermal gas in a vacuum, with a vent, after this time (s) of steps.
    fn vented(vent: Vent, mass: f64, inflow: Inflow, time: f64) -> (Gas, GasState) {
        let heat_transfer = HeatTransfer::Isothermal;
        let supply = GasSupply { heat_transfer, vent: Some(vent), ..nitrogen_supply() };
        let gas = Gas::new(&supply, 293.0, 1.0);
        let mut state = gas.at_temperature(mass, 293.0);
        for _ in 0..20_000 {
            state = gas.step(state, 0.01, 0.01, time / 20_000.0, inflow).state;
        }
        (gas, state)
    }

    #[test]
    fn a_vented_vessel_empties_exponentially_and_a_relief_valve_holds_its_pressure() {
        let vent = Vent { area: 1e-4, from: 0.0, to: 1.0, opens_at: 0.0, full_at: 0.0 };
        // Choked isothermal blow-down: m = m0 exp(−t C_d A √(R T) f/V), f of the choked flow.
        let open = Inflow { vent_open: true, ..Inflow::default() };
        let (gas, state) = vented(vent, 0.01, open, 0.5);
        let speed = (NITROGEN.gas_constant * 293.0).sqrt() * gas.orifice.choked_factor;
        let discharge = nitrogen_supply().discharge_coefficient;
        let expected = 0.01 * libm::exp(-0.5 * discharge * 1e-4 * speed / 0.01);
        assert!((state.mass / expected - 1.0).abs() < 1e-6, "{} {expected}", state.mass);
        // It is shut.
        assert_eq!(vented(vent, 0.01, Inflow::default(), 0.5).1.mass, 0.01);
        // With an inflow the pressure rests where the valve lets out as much: A(p) p f √(1/(R T)) = ṁ.
        let valve = Vent { opens_at: 2000.0, full_at: 3000.0, ..vent };
        let flow = Inflow {
            mass_flow_rate: 2e-4,
            temperature_flow: 2e-4 * 293.0,
            vent_open: true,
            ..Inflow::default()
        };
        let (gas, state) = vented(valve, 0.0, flow, 16.0);
        let pressure = gas.pressure(state, 0.01);
        let out = discharge * valve.open_area(pressure) * pressure * gas.orifice.choked_factor
            / (NITROGEN.gas_constant * 293.0).sqrt();
        assert!(
            (out / 2e-4 - 1.0).abs() < 1e-6 && pressure > 2000.0 && pressure < 3000.0,
            "{pressure}"
        );
        // Below its opening pressure it is shut.
        assert_eq!(vented(valve, 1e-4, open, 0.5).1.mass, 1e-4);
    }

    #[test]
    fn gas_enters_through_the_leak_from_a_higher_ambient_pressure() {
        let supply = GasSupply {
            ambient_pressure: 1e5,
            leak_area: 1e-4,
            discharge_coefficient: 1.0,
            heat_transfer: HeatTransfer::Coefficient(0.0),
            ..nitrogen_supply()
        };
        let gas = Gas::new(&supply, 293.0, 1.0);
        let still = Inflow::default();
        // Into a vacuum: choked, with the enthalpy of the gas outside.
        let empty = gas.rates(GasState::default(), 0.01, 0.0, still);
        let flux = (1e5 * 1e5 / (NITROGEN.gas_constant * 293.0)).sqrt();
        let choked = 1e-4 * flux * 0.684_731_5;
        assert!((-empty.mass_out / choked - 1.0).abs() < 1e-4, "{} {choked}", empty.mass_out);
        assert_eq!(empty.enthalpy_out, empty.mass_out * NITROGEN.cp * 293.0);
        // It fills the volume adiabatically to γ T, and then nothing flows.
        let mut state = GasState::default();
        let (mut entered, mut enthalpy) = (0.0, 0.0);
        for _ in 0..20_000 {
            let step = gas.step(state, 0.01, 0.01, 5e-5, still);
            (entered, enthalpy) = (entered - step.mass_out, enthalpy - step.enthalpy_out);
            state = step.state;
        }
        assert!((gas.pressure(state, 0.01) / 1e5 - 1.0).abs() < 1e-6);
        assert!((gas.temperature(state) / (gas.gamma() * 293.0) - 1.0).abs() < 1e-6);
        assert!((state.mass / entered - 1.0).abs() < 1e-12);
        assert!((state.internal_energy / enthalpy - 1.0).abs() < 1e-12);
    }

    #[test]
    fn isothermal_heat_closes_the_energy_balance() {
        let gas = gas(HeatTransfer::Isothermal, 1e-4);
        let state = gas.at_temperature(0.002, 293.0);
        let inflow =
            Inflow { mass_flow_rate: 0.01, temperature_flow: 0.01 * 350.0, ..Inflow::default() };
        let rates = gas.rates(state, 0.1, 0.7, inflow);
        let balance = rates.enthalpy_in - rates.enthalpy_out - rates.work + rates.heat;
        assert!((balance - rates.internal_energy).abs() < 1e-12 * rates.enthalpy_in);
        assert!((rates.internal_energy - rates.mass * gas.cv * 293.0).abs() < 1e-12);
    }
}
