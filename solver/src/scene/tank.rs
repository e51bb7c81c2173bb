//! Blow-down of a tank: the inflow from a vessel of constant volume without heat exchange, through an orifice.
//!
//! ```text
//! T = T₀ (m/m₀)^(γ−1)     p = p₀ (m/m₀)^γ                                     gas in the tank, isentropic
//! −dm/dt = A p/√(R T) f     f = √γ (2/(γ+1))^((γ+1)/(2(γ−1)))                 choked: p_out/p ≤ (2/(γ+1))^(γ/(γ−1))
//!                           f = √(2γ/(γ−1) (r^(2/γ) − r^((γ+1)/γ)))           else, r = p_out/p
//! choked all the time: m = m₀ (1 + (γ−1)/2 w t)^(−2/(γ−1)),  w = A p₀ f/(√(R T₀) m₀)
//! cp of temperature: isentropic T, p and m as `Species` has them; γ that of T
//! ```
//! A area of the orifice times its discharge coefficient, `p_out` pressure where the gas flows to. Source: J. D. Anderson,
//! "Modern Compressible Flow", 3rd ed., chapter 5; for the closed form any text on blow-down.

use super::{InflowWindow, Species};

/// Windows of a blow-down. Chosen: the rate is then within a tenth in each, mass and energy are exact at their ends.
const WINDOWS: u32 = 64;
/// Part of the gas that stays in a tank that blows into vacuum. Chosen: it has no effect.
const REMAINS: f64 = 1e-3;
/// Pressure of a tank at the end over that where its gas flows to. Chosen: the flow then is a hundredth of a choked one.
const EQUAL: f64 = 1.0001;
/// Parts of a window over which the time is integrated by Simpson's rule; even.
const PARTS: u32 = 8;

/// A tank at the time at which its orifice opens.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Tank {
    /// Gas in it, kg.
    pub mass: f64,
    /// Its pressure, Pa.
    pub pressure: f64,
    /// Its temperature, K.
    pub temperature: f64,
    /// Area of the orifice times its discharge coefficient, m².
    pub orifice_area: f64,
}

impl Tank {
    /// The inflow from time `from` (s) on, against this pressure (Pa); none where the tank has no more.
    pub fn windows(&self, species: &Species, from: f64, outside: f64) -> Vec<InflowWindow> {
        // Pressure over that at the start, at the end.
        let least = libm::pow(REMAINS, species.gamma(self.temperature));
        let end = (EQUAL * outside / self.pressure).max(least);
        if end >= 1.0 {
            return Vec::new();
        }
        let temperature = |pressure| species.after_pressure_ratio(self.temperature, pressure);
        // Mass in the tank over that at the start.
        let fraction = |pressure: f64| pressure * self.temperature / temperature(pressure);
        // The pressure after part k of all.
        let at = |k: f64| libm::pow(end, k / f64::from(WINDOWS));
        let mut windows = Vec::new();
        let mut time = from;
        for window in 0..WINDOWS {
            let point = |part: u32| at(f64::from(window) + f64::from(part) / f64::from(PARTS));
            // dt = dm/rate, with m as a function of ln p, in which the points are equally far apart.
            let slope = |part: u32| {
                let (pressure, now) = (point(part), temperature(point(part)));
                let rate = self.rate(species, pressure, now, outside);
                self.mass * fraction(pressure) / species.gamma(now) / rate
            };
            let step = -libm::log(end) / f64::from(WINDOWS) / f64::from(PARTS);
            let weight = |part: u32| match part {
                0 | PARTS => 1.0,
                _ if part % 2 == 1 => 4.0,
                _ => 2.0,
            };
            let sum: f64 = (0..=PARTS).map(|part| weight(part) * slope(part)).sum();
            let to = time + sum * step / 3.0;
            let [before, after] = [point(0), point(PARTS)].map(fraction);
            let mass = self.mass * (before - after);
            // The enthalpy that leaves is the internal energy that the tank loses.
            let [had, keeps] = [point(0), point(PARTS)].map(|pressure| {
                let now = temperature(pressure);
                fraction(pressure) * (species.cv() * now + species.vibration_energy(now))
            });
            let enthalpy = (had - keeps) / (before - after);
            windows.push(InflowWindow {
                from: time,
                to,
                mass_flow_rate: mass / (to - time),
                temperature: species.temperature(enthalpy, species.gas_constant),
            });
            time = to;
        }
        windows
    }

    /// Mass flow rate at a pressure of the tank, over that at the start, and its temperature (K), kg/s.
    fn rate(&self, species: &Species, pressure: f64, temperature: f64, outside: f64) -> f64 {
        let gamma = species.gamma(temperature);
        let critical = libm::pow(2.0 / (gamma + 1.0), gamma / (gamma - 1.0));
        let ratio = (outside / (pressure * self.pressure)).min(1.0);
        let flow = if ratio <= critical {
            gamma.sqrt() * libm::pow(2.0 / (gamma + 1.0), (gamma + 1.0) / (2.0 * (gamma - 1.0)))
        } else {
            let powers = libm::pow(ratio, 2.0 / gamma) - libm::pow(ratio, (gamma + 1.0) / gamma);
            (2.0 * gamma / (gamma - 1.0) * powers).sqrt()
        };
        let speed = (species.gas_constant * temperature).sqrt();
        self.orifice_area * pressure * self.pressure / speed * flow
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const NITROGEN: Species = Species::constant(296.803, 1038.81);

    fn tank() -> Tank {
        Tank { mass: 2e-3, pressure: 5e6, temperature: 293.0, orifice_area: 1e-7 }
    }

    #[test]
    fn a_choked_tank_follows_the_closed_form() {
        let (tank, gamma): (Tank, f64) = (tank(), 1038.81 / (1038.81 - 296.803));
        let windows = tank.windows(&NITROGEN, 0.5, 0.0);
        // Anderson's flow through a throat, written with the numbers of nitrogen.
        let first = 1e-7 * 5e6 / (296.803_f64 * 293.0).sqrt()
            * gamma.sqrt()
            * libm::pow(2.0 / (gamma + 1.0), (gamma + 1.0) / (2.0 * (gamma - 1.0)));
        let w = first / tank.mass;
        let mass =
            |t: f64| tank.mass * libm::pow(1.0 + 0.5 * (gamma - 1.0) * w * t, -2.0 / (gamma - 1.0));
        let (mut inside, mut enthalpy) = (0.0, 0.0);
        for window in &windows {
            let entered = window.mass_flow_rate * (window.to - window.from);
            inside += entered;
            enthalpy += entered * NITROGEN.cp * window.temperature;
            assert!((tank.mass - inside - mass(window.to - 0.5)).abs() < 1e-7 * tank.mass);
        }
        assert!((windows[0].from - 0.5).abs() < 1e-15);
        assert!((windows[0].mass_flow_rate / first - 1.0).abs() < 0.1);
        // The tank loses what its gas had: internal energy of all less that of what remains.
        let cv = NITROGEN.cp - NITROGEN.gas_constant;
        let remains = tank.mass * REMAINS;
        let lost = cv * tank.temperature * (tank.mass - remains * libm::pow(REMAINS, gamma - 1.0));
        assert!((inside / (tank.mass - remains) - 1.0).abs() < 1e-12);
        assert!((enthalpy / lost - 1.0).abs() < 1e-12);
    }

    #[test]
    fn a_tank_of_carbon_dioxide_loses_what_its_gas_had() {
        let gas = Species::CARBON_DIOXIDE;
        let windows = tank().windows(&gas, 0.0, 101_325.0);
        let (mut inside, mut enthalpy) = (0.0, 0.0);
        for window in &windows {
            let entered = window.mass_flow_rate * (window.to - window.from);
            inside += entered;
            let specific_enthalpy =
                gas.cp * window.temperature + gas.vibration_energy(window.temperature);
            enthalpy += entered * specific_enthalpy;
        }
        let energy = |t: f64| gas.cv() * t + gas.vibration_energy(t);
        let remains = gas.after_pressure_ratio(293.0, EQUAL * 101_325.0 / 5e6);
        let rest = tank().mass * EQUAL * 101_325.0 / 5e6 * 293.0 / remains;
        let lost = tank().mass * energy(293.0) - rest * energy(remains);
        assert!((inside / (tank().mass - rest) - 1.0).abs() < 1e-12);
        assert!((enthalpy / lost - 1.0).abs() < 1e-12);
    }

    #[test]
    fn a_tank_ends_at_the_pressure_outside_and_halves_of_an_orifice_take_twice_as_long() {
        let outside = 101_325.0;
        let windows = tank().windows(&NITROGEN, 0.0, outside);
        let gamma = 1038.81 / (1038.81 - 296.803);
        let inside: f64 = windows.iter().map(|w| w.mass_flow_rate * (w.to - w.from)).sum();
        let remains = libm::pow(EQUAL * outside / 5e6, 1.0 / gamma);
        assert!((inside / (2e-3 * (1.0 - remains)) - 1.0).abs() < 1e-12);
        let half = Tank { orifice_area: 0.5e-7, ..tank() }.windows(&NITROGEN, 0.0, outside);
        let end = |windows: &[InflowWindow]| windows[windows.len() - 1].to;
        assert!((end(&half) / end(&windows) - 2.0).abs() < 1e-12);
        // Into a quarter of the choked pressure ratio the flow is subsonic from the start.
        let low = Tank { pressure: 1.2 * outside, ..tank() };
        let rates: Vec<f64> =
            low.windows(&NITROGEN, 0.0, outside).iter().map(|w| w.mass_flow_rate).collect();
        assert!(rates.windows(2).all(|pair| pair[1] < pair[0]) && rates[63] < 0.1 * rates[0]);
        assert!(Tank { pressure: outside, ..tank() }.windows(&NITROGEN, 0.0, outside).is_empty());
    }
}
