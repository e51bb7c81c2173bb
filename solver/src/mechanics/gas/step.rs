//! One step of the gas while its volume changes from V0 to V1: conservative and second order.
//!
//! ```text
//! work:   ½ (p0 + p1) (V1 − V0)                        implicit in p1
//! heat:   h A Δt (T_film − (1 − θ) T0 − θ T1)          θ = 1/(1 − e^−z) − 1/z, z = h A Δt/(m cv)
//! leak:   ½ (ṁ0 + ṁ1) Δt                               ṁ1 from a predictor step (Heun); 0 if ṁ0 ṁ1 < 0
//! inflow: exact
//! ```
//!
//! T and p are linear in U, so U1 has a closed form; with a cp of temperature T1 is found by Newton's method. θ
//! is ½ for slow exchange; for a volume of constant mass and a gas of constant cp it reproduces the decay e^−z
//! exactly, for any z. The step reports every term of its balance, so mass and energy are conserved to rounding.
//! The energy accounting of the film uses the same dV.

use super::{Gas, GasState, MIN_EXCHANGE_TIME};
use crate::platform::fault_injection::{Fault, Term};
use crate::scene::HeatTransfer;
use crate::scene::inflow::Inflow;

/// Result of one step.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct GasStep {
    /// The gas after it.
    pub state: GasState,
    /// Pressure after it, Pa.
    pub pressure: f64,
    /// Leak mass, kg.
    pub mass_out: f64,
    /// Inflow enthalpy, J.
    pub enthalpy_in: f64,
    /// Leak enthalpy, J.
    pub enthalpy_out: f64,
    /// Heat from the film, J.
    pub heat: f64,
    /// Work of the gas, J.
    pub work: f64,
}

/// Flow rates of the leak.
#[derive(Clone, Copy, Default)]
struct Leak {
    /// Mass flow rate, kg/s.
    mass: f64,
    /// Enthalpy flow rate, W.
    enthalpy: f64,
}

impl GasStep {
    /// Injects a fault into the state, for tests only. The reported terms keep their correct values.
    pub(crate) fn inject_fault(&mut self, gas: &Gas, volume: f64, mass_in: f64, fault: Fault) {
        let excess = fault.factor - 1.0;
        let (mass, energy) = (&mut self.state.mass, &mut self.state.internal_energy);
        match fault.term {
            Term::GasWork => *energy -= excess * self.work,
            Term::GasHeat => *energy += excess * self.heat,
            Term::GasMassIn => *mass += excess * mass_in,
            Term::GasEnthalpyIn => *energy += excess * self.enthalpy_in,
            Term::GasMassOut => *mass -= excess * self.mass_out,
            Term::GasEnthalpyOut => *energy -= excess * self.enthalpy_out,
            _ => {}
        }
        let factor = if fault.term == Term::GasPressure { fault.factor } else { 1.0 };
        self.pressure = factor * gas.pressure(self.state, volume);
    }
}

impl Gas {
    /// Advances the gas by `time` (s) while its volume changes from `from` to `to` (m³).
    pub fn step(&self, state: GasState, from: f64, to: f64, time: f64, inflow: Inflow) -> GasStep {
        let leak_before = self.leak(state, from, inflow);
        let predictor = self.step_with(leak_before, state, from, to, time, inflow);
        if leak_before.mass == 0.0 && self.leak(predictor.state, to, inflow).mass == 0.0 {
            return predictor;
        }
        let leak_after = self.leak(predictor.state, to, inflow);
        if leak_before.mass * leak_after.mass < 0.0 {
            // The flow would reverse within the step: the pressures are equal but for what one step moves. Gas
            // that goes to and fro would only exchange heat.
            return self.step_with(Leak::default(), state, from, to, time, inflow);
        }
        let mean = Leak {
            mass: 0.5 * (leak_before.mass + leak_after.mass),
            enthalpy: 0.5 * (leak_before.enthalpy + leak_after.enthalpy),
        };
        self.step_with(mean, state, from, to, time, inflow)
    }

    fn leak(&self, state: GasState, volume: f64, inflow: Inflow) -> Leak {
        let rates = self.rates(state, volume, 0.0, inflow);
        Leak { mass: rates.mass_out, enthalpy: rates.enthalpy_out }
    }

    fn step_with(
        &self,
        leak: Leak,
        state: GasState,
        from: f64,
        to: f64,
        time: f64,
        inflow: Inflow,
    ) -> GasStep {
        let mass_out = leak.mass * time;
        let mass = state.mass + inflow.mass_flow_rate * time - mass_out;
        let enthalpy_in = self.enthalpy_flow(inflow) * time;
        let enthalpy_out = leak.enthalpy * time;
        let pressure_before = self.pressure(state, from);
        let growth = to - from;
        let (internal_energy, heat, work);
        match self.heat_transfer {
            HeatTransfer::Isothermal => {
                internal_energy = self.internal_energy(mass, self.film_temperature);
                let pressure_after = self.pressure(GasState { mass, internal_energy }, to);
                work = 0.5 * (pressure_before + pressure_after) * growth;
                let energy_before = self.internal_energy(state.mass, self.film_temperature);
                heat = internal_energy - energy_before - enthalpy_in + enthalpy_out + work;
            }
            HeatTransfer::Coefficient(coefficient) => {
                let any_gas = state.mass > 0.0;
                let temperature =
                    if any_gas { self.temperature(state) } else { self.first_temperature(inflow) };
                // m cv in the middle of the step, J/K.
                let heat_capacity = self.cv + self.species.vibration_heat_capacity(temperature);
                let capacity = 0.5 * (state.mass + mass) * heat_capacity;
                let rate = (coefficient * self.film_area).min(capacity / MIN_EXCHANGE_TIME);
                let exchange = rate * time;
                let theta = if exchange > 0.0 && capacity > 0.0 {
                    implicit_share(exchange / capacity)
                } else {
                    0.5
                };
                // Heat = explicit_heat − per_energy L, work = ½ p0 ΔV + per_work L, L = m cv T1 without vibrations.
                let per_energy = if mass > 0.0 { exchange * theta / (mass * self.cv) } else { 0.0 };
                let explicit_heat =
                    exchange * (self.film_temperature - (1.0 - theta) * temperature);
                let per_work = 0.5 * (self.gamma() - 1.0) * growth / to;
                let known = state.internal_energy + enthalpy_in
                    - enthalpy_out
                    - 0.5 * pressure_before * growth
                    + if mass > 0.0 { explicit_heat } else { 0.0 };
                let linear = if self.species.vibrates() && mass > 0.0 {
                    let more = self.cv * (per_work + per_energy);
                    let linear = mass * self.cv * self.species.temperature(known / mass, more);
                    internal_energy = known - (per_work + per_energy) * linear;
                    linear
                } else {
                    internal_energy = known / (1.0 + per_work + per_energy);
                    internal_energy
                };
                work = 0.5 * pressure_before * growth + per_work * linear;
                heat = if mass > 0.0 { explicit_heat - per_energy * linear } else { 0.0 };
            }
        }
        let state = GasState { mass, internal_energy };
        let pressure = self.pressure(state, to);
        GasStep { state, pressure, mass_out, enthalpy_in, enthalpy_out, heat, work }
    }
}

/// Below this z, θ uses its series: the closed form cancels there. Chosen: the first omitted term,
/// z⁵/30240, is below rounding.
const MAX_SERIES_Z: f64 = 1e-3;

/// θ(z) = 1/(1 − e^−z) − 1/z, which rises from ½ at z = 0 to 1.
fn implicit_share(z: f64) -> f64 {
    if z < MAX_SERIES_Z {
        return 0.5 + z / 12.0 - z * z * z / 720.0;
    }
    -1.0 / libm::expm1(-z) - 1.0 / z
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::scene::paper::nitrogen_supply;
    use crate::scene::{GasSupply, Species};

    fn of(species: Species, heat_transfer: HeatTransfer, leak_area: f64) -> Gas {
        let supply = GasSupply { species, heat_transfer, leak_area, ..nitrogen_supply() };
        Gas::new(&supply, 293.0, 2.0)
    }

    fn gas(heat_transfer: HeatTransfer, leak_area: f64) -> Gas {
        of(Species::NITROGEN, heat_transfer, leak_area)
    }

    /// One gas of constant cp, one whose cp changes with temperature, each with and without constant temperature.
    fn gases(leak_area: f64) -> [Gas; 4] {
        let [warm, held] = [HeatTransfer::Coefficient(3.0), HeatTransfer::Isothermal];
        let [one, other] = [Species::NITROGEN, Species::CARBON_DIOXIDE];
        [(one, warm), (one, held), (other, warm), (other, held)]
            .map(|(species, heat)| of(species, heat, leak_area))
    }

    /// 4 g/s at 320 K.
    fn inflow(gas: &Gas) -> Inflow {
        Inflow {
            mass_flow_rate: 0.004,
            temperature_flow: 0.004 * 320.0,
            vibration_flow: 0.004 * gas.species.vibration_energy(320.0),
            vent_open: false,
        }
    }

    #[test]
    fn implicit_share_is_continuous_between_series_and_closed_form() {
        let (below, above) = (implicit_share(1e-3 * (1.0 - 1e-12)), implicit_share(1e-3));
        assert!((below - above).abs() < 1e-12, "{below} {above}");
        assert!((implicit_share(50.0) - 0.98).abs() < 1e-12);
    }

    #[test]
    fn cooling_is_exact_for_every_step_length() {
        let gas = gas(HeatTransfer::Coefficient(3.0), 0.0);
        let start = gas.at_temperature(0.002, 400.0);
        for time in [1e-4, 0.1, 3.0] {
            let step = gas.step(start, 0.3, 0.3, time, Inflow::default());
            let expected = 107.0 * libm::exp(-3.0 * 2.0 * time / (0.002 * gas.cv));
            let excess = gas.temperature(step.state) - 293.0;
            assert!((excess - expected).abs() < 1e-7, "{time}: {excess} {expected}");
        }
    }

    #[test]
    fn expansion_follows_the_adiabat_to_second_order() {
        let nitrogen = gas(HeatTransfer::Coefficient(0.0), 0.0);
        let cold = 300.0 * libm::pow(0.5, nitrogen.gamma() - 1.0);
        // cp ln(T/300 K) + entropy of the vibrations = R ln(p/p0), solved by bisection.
        let other = of(Species::CARBON_DIOXIDE, HeatTransfer::Coefficient(0.0), 0.0);
        for (gas, cold) in [(nitrogen, cold), (other, 243.3293)] {
            let start = gas.at_temperature(0.002, 300.0);
            let exact = gas.temperature(gas.expansion(start, 0.1, 0.2).state);
            assert!((exact / cold - 1.0).abs() < 1e-5, "{exact} {cold}");
            let error = |steps: u32| {
                let mut state = start;
                let volume = |k: u32| 0.1 + 0.1 * f64::from(k) / f64::from(steps);
                for k in 0..steps {
                    state = gas.step(state, volume(k), volume(k + 1), 1.0, Inflow::default()).state;
                }
                gas.temperature(state) / exact - 1.0
            };
            let (coarse, fine) = (error(50), error(100));
            assert!(fine.abs() < 1e-5 && (coarse / fine - 4.0).abs() < 0.05, "{coarse} {fine}");
        }
    }

    #[test]
    fn gas_that_fills_an_empty_vessel_has_the_energy_of_its_enthalpy() {
        let gas = of(Species::CARBON_DIOXIDE, HeatTransfer::Coefficient(0.0), 0.0);
        let step = gas.step(GasState::default(), 0.1, 0.1, 0.5, inflow(&gas));
        // u(T) = h(320 K), by the tables of NIST: 404 K.
        assert!((gas.temperature(step.state) - 404.3).abs() < 0.1);
        let expected = 0.002 * 188.924 * gas.temperature(step.state) / 0.1;
        assert!((step.pressure / expected - 1.0).abs() < 1e-13);
    }

    #[test]
    fn steps_converge_to_second_order() {
        for gas in gases(2e-5) {
            let inflow = inflow(&gas);
            let run = |steps: u32| {
                let mut state = gas.at_temperature(0.001, 293.0);
                let time = 0.5 / f64::from(steps);
                let volume = |k: u32| 0.2 + 0.1 * libm::sin(f64::from(k) * time);
                for k in 0..steps {
                    state = gas.step(state, volume(k), volume(k + 1), time, inflow).state;
                }
                state
            };
            let exact = run(12_800);
            let error = |steps: u32| (run(steps).mass / exact.mass - 1.0).abs();
            let (coarse, fine) = (error(100), error(200));
            assert!(fine < 1e-5 && coarse / fine > 3.8 && coarse / fine < 4.2, "{coarse} {fine}");
        }
    }

    #[test]
    fn mass_and_energy_are_conserved() {
        for gas in gases(2e-5) {
            for mass in [0.0, 1e-12, 1e-3] {
                let state = gas.at_temperature(mass, 293.0);
                let step = gas.step(state, 0.2, 0.21, 1e-3, inflow(&gas));
                let gained = step.enthalpy_in - step.enthalpy_out + step.heat - step.work;
                let change = step.state.internal_energy - state.internal_energy;
                assert!((gained - change).abs() < 1e-13, "{gained} {change}");
                let gained = 0.004 * 1e-3 - step.mass_out;
                assert!((step.state.mass - mass - gained).abs() < 1e-18);
            }
        }
    }
}
