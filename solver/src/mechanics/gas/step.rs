//! One step of the gas whose volume went from one value to another: conservative, second order.
//!
//! ```text
//! p dV:   ½ (p0 + p1) (V1 − V0)                        implicit in p1
//! heat:   h A Δt (T_film − (1 − θ) T0 − θ T1)          θ = 1/(1 − e^−z) − 1/z, z = h A Δt/(m cv)
//! leak:   ½ (ṁ0 + ṁ1) Δt                               ṁ1 of a first pass (Heun)
//! inflow: exact
//! ```
//!
//! T and p are linear in U, so U1 has a closed form. θ is ½ for slow exchange and makes a volume of
//! constant mass relax exactly as e^−z, however fast. What the balance loses the books gain: mass
//! and energy are kept to rounding. The work is the film's own entry too, with the same dV.

use super::{FASTEST_EXCHANGE, Gas, GasState};
use crate::platform::fault_injection::{Fault, Term};
use crate::scene::HeatTransfer;
use crate::scene::inflow::Inflow;

/// What one step did.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct GasStep {
    /// The gas after it.
    pub state: GasState,
    /// Pressure after it, Pa.
    pub pressure: f64,
    /// Mass leaked, kg.
    pub mass_out: f64,
    /// Enthalpy let in, J.
    pub enthalpy_in: f64,
    /// Enthalpy leaked, J.
    pub enthalpy_out: f64,
    /// Heat given by the film, J.
    pub heat: f64,
    /// Work done by the gas, J.
    pub work: f64,
}

/// Leak during a step: rates averaged over it.
#[derive(Clone, Copy, Default)]
struct Leak {
    /// kg/s.
    mass: f64,
    /// W.
    enthalpy: f64,
}

impl GasStep {
    /// A fault of the balances, so that the books still tell what should have been: tests only.
    pub(crate) fn suffer(&mut self, gas: &Gas, volume: f64, mass_in: f64, fault: Fault) {
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
    /// Steps the gas by `time` (s) while its volume goes `from` one value `to` another (m³).
    pub fn step(&self, state: GasState, from: f64, to: f64, time: f64, inflow: Inflow) -> GasStep {
        let at_start = self.leak(state, from, inflow);
        let first = self.step_with(at_start, state, from, to, time, inflow);
        if at_start.mass == 0.0 && self.leak(first.state, to, inflow).mass == 0.0 {
            return first;
        }
        let at_end = self.leak(first.state, to, inflow);
        let mean = Leak {
            mass: 0.5 * (at_start.mass + at_end.mass),
            enthalpy: 0.5 * (at_start.enthalpy + at_end.enthalpy),
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
        let mass = state.mass + inflow.mass * time - mass_out;
        let enthalpy_in = self.cp * inflow.mass_temperature * time;
        let enthalpy_out = leak.enthalpy * time;
        let before = self.pressure(state, from);
        let growth = to - from;
        let (internal_energy, heat, work);
        match self.heat_transfer {
            HeatTransfer::Isothermal => {
                internal_energy = mass * self.cv * self.film_temperature;
                let after = self.pressure(GasState { mass, internal_energy }, to);
                work = 0.5 * (before + after) * growth;
                let start = state.mass * self.cv * self.film_temperature;
                heat = internal_energy - start - enthalpy_in + enthalpy_out + work;
            }
            HeatTransfer::Coefficient(coefficient) => {
                let started = state.mass > 0.0;
                let temperature =
                    if started { self.temperature(state) } else { self.first_temperature(inflow) };
                // Heat capacity of the gas in the middle of the step and after it.
                let capacity = 0.5 * (state.mass + mass) * self.cv;
                let rate = (coefficient * self.film_area).min(capacity / FASTEST_EXCHANGE);
                let exchange = rate * time;
                let late = if exchange > 0.0 && capacity > 0.0 {
                    late_share(exchange / capacity)
                } else {
                    0.5
                };
                let per_energy = if mass > 0.0 { exchange * late / (mass * self.cv) } else { 0.0 };
                let given = exchange * (self.film_temperature - (1.0 - late) * temperature);
                let push = 0.5 * (self.gamma() - 1.0) * growth / to;
                let known =
                    state.internal_energy + enthalpy_in - enthalpy_out - 0.5 * before * growth
                        + if mass > 0.0 { given } else { 0.0 };
                internal_energy = known / (1.0 + push + per_energy);
                work = 0.5 * before * growth + push * internal_energy;
                heat = if mass > 0.0 { given - per_energy * internal_energy } else { 0.0 };
            }
        }
        let state = GasState { mass, internal_energy };
        let pressure = self.pressure(state, to);
        GasStep { state, pressure, mass_out, enthalpy_in, enthalpy_out, heat, work }
    }
}

/// θ(z) = 1/(1 − e^−z) − 1/z, from ½ at 0 to 1.
fn late_share(z: f64) -> f64 {
    if z < 1e-3 {
        // The terms of its series that matter here; the closed form would cancel.
        return 0.5 + z / 12.0 - z * z * z / 720.0;
    }
    -1.0 / libm::expm1(-z) - 1.0 / z
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::scene::GasSupply;
    use crate::scene::paper::nitrogen_supply;

    fn gas(heat_transfer: HeatTransfer, leak_area: f64) -> Gas {
        let supply = GasSupply { heat_transfer, leak_area, ..nitrogen_supply() };
        Gas::new(&supply, 293.0, 2.0)
    }

    #[test]
    fn late_share_is_smooth_where_its_forms_meet() {
        let (below, above) = (late_share(1e-3 * (1.0 - 1e-12)), late_share(1e-3));
        assert!((below - above).abs() < 1e-12, "{below} {above}");
        assert!((late_share(50.0) - 0.98).abs() < 1e-12);
    }

    #[test]
    fn cooling_is_exact_whatever_the_step() {
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
        let gas = gas(HeatTransfer::Coefficient(0.0), 0.0);
        let error = |steps: u32| {
            let mut state = gas.at_temperature(0.002, 300.0);
            let volume = |k: u32| 0.1 + 0.1 * f64::from(k) / f64::from(steps);
            for k in 0..steps {
                state = gas.step(state, volume(k), volume(k + 1), 1.0, Inflow::default()).state;
            }
            gas.temperature(state) / (300.0 * libm::pow(0.5, gas.gamma() - 1.0)) - 1.0
        };
        let (coarse, fine) = (error(50), error(100));
        assert!(fine.abs() < 1e-5 && (coarse / fine - 4.0).abs() < 0.05, "{coarse} {fine}");
    }

    #[test]
    fn steps_agree_with_the_rates_to_second_order() {
        let inflow = Inflow { mass: 0.004, mass_temperature: 0.004 * 320.0 };
        for heat in [HeatTransfer::Coefficient(3.0), HeatTransfer::Isothermal] {
            let gas = gas(heat, 2e-5);
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
    fn the_books_balance() {
        let inflow = Inflow { mass: 0.004, mass_temperature: 0.004 * 320.0 };
        for heat in [HeatTransfer::Coefficient(3.0), HeatTransfer::Isothermal] {
            for mass in [0.0, 1e-12, 1e-3] {
                let gas = gas(heat, 2e-5);
                let state = gas.at_temperature(mass, 293.0);
                let step = gas.step(state, 0.2, 0.21, 1e-3, inflow);
                let gained = step.enthalpy_in - step.enthalpy_out + step.heat - step.work;
                let change = step.state.internal_energy - state.internal_energy;
                assert!((gained - change).abs() < 1e-13, "{gained} {change}");
                let gained = 0.004 * 1e-3 - step.mass_out;
                assert!((step.state.mass - mass - gained).abs() < 1e-18);
            }
        }
    }
}
