//! Mass flow through the leak orifice and the vent: isentropic, choked or subsonic, towards the lower pressure.
//!
//! ```text
//! ṁ = C_d A √(p ρ) √γ (2/(γ+1))^((γ+1)/(2(γ−1)))          choked,   r ≤ (2/(γ+1))^(γ/(γ−1))
//! ṁ = C_d A √(p ρ) √(2γ/(γ−1) (r^(2/γ) − r^((γ+1)/γ)))    subsonic, r = p_ambient/p < 1
//! ```
//!
//! p and ρ are those of the side that the gas leaves. Air outside counts as the gas inside, at film
//! temperature. These are the equations of one-dimensional isentropic flow (any text on gas dynamics) with
//! √(p ρ) for p/√(R T), which is finite for T → 0. Symbols: `C_d` discharge coefficient, A area, m².

/// Leak orifice for one gas.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Orifice {
    /// γ = cp/cv.
    gamma: f64,
    /// `C_d` A, m².
    effective_area: f64,
    /// (2/(γ+1))^(γ/(γ−1)): the flow is choked at `p_ambient`/p up to this ratio.
    critical_ratio: f64,
    /// √γ (2/(γ+1))^((γ+1)/(2(γ−1))).
    pub(super) choked_factor: f64,
}

impl Orifice {
    pub(super) fn new(gamma: f64, effective_area: f64) -> Self {
        let base = 2.0 / (gamma + 1.0);
        let excess = gamma - 1.0;
        Self {
            gamma,
            effective_area,
            critical_ratio: libm::pow(base, gamma / excess),
            choked_factor: gamma.sqrt() * libm::pow(base, (gamma + 1.0) / (2.0 * excess)),
        }
    }

    /// The orifice for gas of this γ.
    pub(super) fn of_gamma(self, gamma: f64) -> Self {
        Self::new(gamma, self.effective_area)
    }

    /// The orifice with this `C_d` A (m²) more.
    pub(super) fn wider(self, effective_area: f64) -> Self {
        Self { effective_area: self.effective_area + effective_area, ..self }
    }

    /// Outflow, kg/s, of gas at pressure p (Pa) and density ρ (kg/m³) to the pressure `ambient` (Pa);
    /// 0 where p is not above `ambient`.
    pub(super) fn mass_flow(self, pressure: f64, density: f64, ambient: f64) -> f64 {
        let flows = self.effective_area > 0.0 && pressure > ambient && density > 0.0;
        if !flows {
            return 0.0;
        }
        let flux = (pressure * density).sqrt();
        let ratio = ambient / pressure;
        if ratio <= self.critical_ratio {
            return self.effective_area * self.choked_factor * flux;
        }
        let gamma = self.gamma;
        // r^(2/γ) − r^((γ+1)/γ) = r^(2/γ) (1 − r^((γ−1)/γ)), which avoids cancellation for r → 1.
        let expansion = -libm::expm1((gamma - 1.0) / gamma * libm::log(ratio));
        let flow_function = 2.0 * gamma / (gamma - 1.0) * libm::pow(ratio, 2.0 / gamma) * expansion;
        self.effective_area * flux * flow_function.max(0.0).sqrt()
    }
}

#[cfg(test)]
#[expect(clippy::float_cmp, reason = "these values are exact")]
mod tests {
    use super::*;

    #[test]
    fn flow_is_continuous_goes_downhill_and_follows_bernoulli_where_slow() {
        let orifice = Orifice::new(1.4, 1e-4);
        assert!((orifice.critical_ratio - 0.528_281_787_717_174).abs() < 1e-14);
        let p = 1e5;
        let flow = |ratio: f64| orifice.mass_flow(p, 1.2, ratio * p);
        let below = flow(orifice.critical_ratio * (1.0 - 1e-9));
        let above = flow(orifice.critical_ratio * (1.0 + 1e-9));
        assert!((above / below - 1.0).abs() < 1e-12);
        assert!(below > 0.0 && (flow(0.0) - below).abs() < 1e-18);
        assert_eq!(orifice.mass_flow(1e4, 0.1, 1e5), 0.0);
        assert_eq!(orifice.mass_flow(1e5, 1.2, 1e5), 0.0);
        let (p, density) = (100_000.01_f64, 1.2_f64);
        let bernoulli = 1e-4 * (2.0 * density * (p - 1e5)).sqrt();
        assert!((orifice.mass_flow(p, density, 1e5) / bernoulli - 1.0).abs() < 1e-6);
    }
}
