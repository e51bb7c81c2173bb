//! An ideal gas whose heat capacity follows from its molecules.
//!
//! ```text
//! p = ρ R T
//! u = cv T + R Σ θ/(e^(θ/T) − 1)                       internal energy per mass, 0 at T = 0; h = u + R T
//! cv(T) = cv + R Σ x² e^x/(e^x − 1)²                   x = θ/T
//! s_v = R Σ (x/(e^x − 1) − ln(1 − e^(−x)))             entropy of the vibrations per mass
//! cp ln(T₂/T₁) + s_v(T₂) − s_v(T₁) = R ln(p₂/p₁)       isentropic; by volumes with cv and −R ln(V₂/V₁)
//! ```
//!
//! θ is the temperature of a vibration of the molecule (a harmonic oscillator): W. G. Vincenti, C. H. Kruger,
//! "Introduction to Physical Gas Dynamics" (1965), chapter IV. Without vibrations cp is constant.

use serde::{Deserialize, Serialize};

/// Vibrations of a molecule that a species can have.
const VIBRATIONS: usize = 4;
/// Newton steps at most. Chosen: from the start that is used, rounding is reached within ten.
const MAX_NEWTON_STEPS: u32 = 50;

/// An ideal gas.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Species {
    /// Specific gas constant R, J/(kg K).
    pub gas_constant: f64,
    /// Specific heat at constant pressure, J/(kg K), without that of `vibrations`; cv = cp − R.
    pub cp: f64,
    /// Temperatures θ of the vibrations, K; 0 for none.
    #[serde(default, skip_serializing_if = "none")]
    pub vibrations: [f64; VIBRATIONS],
}

fn none(vibrations: &[f64; VIBRATIONS]) -> bool {
    vibrations.iter().all(|theta| *theta <= 0.0)
}

impl Species {
    /// Nitrogen.
    ///
    /// R 296.803052 J/(kg K): 8.314462618 J/(mol K) (CODATA 2018) over the molar mass. cp
    /// 1038.81068 J/(kg K): 7 R/2, rounded.
    pub const NITROGEN: Self = Self::constant(296.803_052, 1_038.810_68);

    /// Carbon dioxide.
    ///
    /// cp 7 R/2 of a linear molecule; bending, twice, 667 1/cm, stretching 1333 and 2349 1/cm (T. Shimanouchi,
    /// NSRDS-NBS 39, 1972), times 1.4388 K cm.
    pub const CARBON_DIOXIDE: Self = Self {
        gas_constant: 188.924,
        cp: 3.5 * 188.924,
        vibrations: [959.7, 959.7, 1917.9, 3379.7],
    };

    /// A gas of constant cp, J/(kg K).
    pub const fn constant(gas_constant: f64, cp: f64) -> Self {
        Self { gas_constant, cp, vibrations: [0.0; VIBRATIONS] }
    }

    /// Whether cp changes with the temperature.
    pub fn vibrates(&self) -> bool {
        !none(&self.vibrations)
    }

    /// cv without vibrations, J/(kg K).
    pub fn cv(&self) -> f64 {
        self.cp - self.gas_constant
    }

    /// γ = cp/cv at this temperature (K).
    pub fn gamma(&self, temperature: f64) -> f64 {
        let vibrations = self.vibration_heat_capacity(temperature);
        (self.cp + vibrations) / (self.cv() + vibrations)
    }

    /// Internal energy of the vibrations per mass at this temperature (K), J/kg.
    pub fn vibration_energy(&self, temperature: f64) -> f64 {
        self.vibration(temperature, |x| temperature * x / libm::expm1(x))
    }

    /// Heat capacity of the vibrations per mass at this temperature (K), J/(kg K).
    pub fn vibration_heat_capacity(&self, temperature: f64) -> f64 {
        self.vibration(temperature, |x| {
            // x² e^x/(e^x − 1)², which is finite for large x.
            let half = x / (2.0 * libm::sinh(0.5 * x));
            half * half
        })
    }

    fn vibration_entropy(&self, temperature: f64) -> f64 {
        self.vibration(temperature, |x| x / libm::expm1(x) - libm::log1p(-libm::exp(-x)))
    }

    fn vibration(&self, temperature: f64, of: impl Fn(f64) -> f64) -> f64 {
        if temperature <= 0.0 {
            return 0.0;
        }
        let excited = self.vibrations.iter().filter(|theta| **theta > 0.0);
        self.gas_constant * excited.map(|theta| of(theta / temperature)).sum::<f64>()
    }

    /// The temperature T, K, at which u + `more` T is this energy per mass, J/kg: with 0 the inverse of u, with R that of
    /// h.
    pub fn temperature(&self, energy: f64, more: f64) -> f64 {
        let slope = self.cv() + more;
        // u is convex in T, so Newton's method falls from this start, which is above.
        let mut temperature = energy / slope;
        if !self.vibrates() {
            return temperature;
        }
        for _ in 0..MAX_NEWTON_STEPS {
            let excess = slope * temperature + self.vibration_energy(temperature) - energy;
            let next = temperature - excess / (slope + self.vibration_heat_capacity(temperature));
            // Rounding is reached, or the energy is NaN.
            let falls = next < temperature;
            if !falls {
                break;
            }
            temperature = next;
        }
        temperature
    }

    /// The temperature, K, after isentropic work from this temperature (K) to this pressure over that before.
    pub fn after_pressure_ratio(&self, temperature: f64, ratio: f64) -> f64 {
        self.isentropic(temperature, self.cp, self.gas_constant * libm::log(ratio))
    }

    /// The temperature, K, after isentropic work from this temperature (K) to this volume over that before.
    pub fn after_volume_ratio(&self, temperature: f64, ratio: f64) -> f64 {
        self.isentropic(temperature, self.cv(), -self.gas_constant * libm::log(ratio))
    }

    /// The temperature at which capacity ln T + `s_v` is larger than at this one by a difference of entropy.
    fn isentropic(&self, temperature: f64, capacity: f64, difference: f64) -> f64 {
        let mut logarithm = difference / capacity;
        if !self.vibrates() {
            return temperature * libm::exp(logarithm);
        }
        let before = self.vibration_entropy(temperature);
        for _ in 0..MAX_NEWTON_STEPS {
            let now = temperature * libm::exp(logarithm);
            let excess = capacity * logarithm + self.vibration_entropy(now) - before - difference;
            let step = excess / (capacity + self.vibration_heat_capacity(now));
            logarithm -= step;
            if step.abs() <= f64::EPSILON * logarithm.abs().max(1.0) {
                break;
            }
        }
        temperature * libm::exp(logarithm)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const CARBON_DIOXIDE: Species = Species::CARBON_DIOXIDE;

    #[test]
    fn carbon_dioxide_has_the_heat_capacity_of_the_tables() {
        // cp over R of the NIST-JANAF tables, J/(mol K), at low pressure.
        for (temperature, cp) in
            [(200.0, 32.359), (300.0, 37.221), (400.0, 41.325), (600.0, 47.321)]
        {
            let found = CARBON_DIOXIDE.cp + CARBON_DIOXIDE.vibration_heat_capacity(temperature);
            let expected = cp / 8.314_462_618 * CARBON_DIOXIDE.gas_constant;
            assert!((found / expected - 1.0_f64).abs() < 1e-3, "{temperature}: {found} {expected}");
        }
        // 9364 J/mol at 298.15 K.
        let enthalpy = CARBON_DIOXIDE.cp * 298.15 + CARBON_DIOXIDE.vibration_energy(298.15);
        assert!((enthalpy * 0.044_009_5 / 9364.0 - 1.0).abs() < 1e-3, "{enthalpy}");
    }

    #[test]
    fn derivatives_and_inverses_agree() {
        let gas = CARBON_DIOXIDE;
        for temperature in [3.0, 50.0, 190.0, 293.0, 700.0, 4000.0] {
            let step = 1e-5 * temperature;
            let [above, below] = [temperature + step, temperature - step];
            let heat = (gas.vibration_energy(above) - gas.vibration_energy(below)) / (2.0 * step);
            assert!(
                (heat - gas.vibration_heat_capacity(temperature)).abs() < 1e-6 * gas.gas_constant
            );
            let entropy =
                (gas.vibration_entropy(above) - gas.vibration_entropy(below)) / (2.0 * step);
            assert!((entropy * temperature - heat).abs() < 1e-6 * gas.gas_constant);
            for more in [0.0, gas.gas_constant, 1e5, -0.5 * gas.cv()] {
                let energy = (gas.cv() + more) * temperature + gas.vibration_energy(temperature);
                assert!((gas.temperature(energy, more) / temperature - 1.0).abs() < 1e-14);
            }
            for ratio in [1e-3, 0.7, 1.0, 1.4, 30.0] {
                let after = gas.after_volume_ratio(temperature, ratio);
                // p V ~ T.
                let same = gas.after_pressure_ratio(temperature, after / temperature / ratio);
                assert!((same / after - 1.0).abs() < 1e-12, "{temperature} {ratio} {after} {same}");
                let back = gas.after_volume_ratio(after, 1.0 / ratio);
                assert!((back / temperature - 1.0).abs() < 1e-12);
            }
        }
        assert!(gas.temperature(f64::NAN, 0.0).is_nan());
    }

    #[test]
    fn without_vibrations_the_formulas_are_those_of_constant_heat_capacity() {
        let gas = Species::NITROGEN;
        assert!((gas.temperature(gas.cv() * 250.0, 0.0) - 250.0).abs() < 1e-12);
        let cooled = 293.0 * libm::pow(2.0, 1.0 - gas.gamma(293.0));
        assert!((gas.after_volume_ratio(293.0, 2.0) / cooled - 1.0).abs() < 1e-14);
    }
}
