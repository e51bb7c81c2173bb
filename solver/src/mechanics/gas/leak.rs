//! The leak orifice: isentropic outflow, choked or subsonic.

/// An orifice for one gas.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Orifice {
    gamma: f64,
    /// `C_d` A, m².
    effective_area: f64,
    /// (2/(γ+1))^(γ/(γ−1)): `p_ambient`/p at and below which the flow is choked.
    critical_ratio: f64,
    /// √γ (2/(γ+1))^((γ+1)/(2(γ−1))).
    choked_factor: f64,
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

    /// Mass flow out, kg/s, of gas at pressure p (Pa) and density ρ (kg/m³) into `ambient` (Pa);
    /// 0 where p does not exceed it. p √(1/(R T)) is written √(p ρ), which is sound at T → 0.
    pub(super) fn mass_flow(self, pressure: f64, density: f64, ambient: f64) -> f64 {
        let drives = self.effective_area > 0.0 && pressure > ambient && density > 0.0;
        if !drives {
            return 0.0;
        }
        let flux = (pressure * density).sqrt();
        let ratio = ambient / pressure;
        if ratio <= self.critical_ratio {
            return self.effective_area * self.choked_factor * flux;
        }
        let gamma = self.gamma;
        // r^(2/γ) − r^((γ+1)/γ) = r^(2/γ) (1 − r^((γ−1)/γ)): no cancellation as r → 1.
        let expansion = -libm::expm1((gamma - 1.0) / gamma * libm::log(ratio));
        let shape = 2.0 * gamma / (gamma - 1.0) * libm::pow(ratio, 2.0 / gamma) * expansion;
        self.effective_area * flux * shape.max(0.0).sqrt()
    }
}

#[cfg(test)]
#[expect(clippy::float_cmp, reason = "these values are exact")]
mod tests {
    use super::*;

    #[test]
    fn choked_and_subsonic_meet_at_the_critical_ratio() {
        let orifice = Orifice::new(1.4, 1e-4);
        assert!((orifice.critical_ratio - 0.528_281_787_717_174).abs() < 1e-14);
        let p = 1e5;
        let at = |ratio: f64| orifice.mass_flow(p, 1.2, ratio * p);
        let below = at(orifice.critical_ratio * (1.0 - 1e-9));
        let above = at(orifice.critical_ratio * (1.0 + 1e-9));
        assert!((above / below - 1.0).abs() < 1e-12);
        assert!(below > 0.0 && (at(0.0) - below).abs() < 1e-18);
    }

    #[test]
    fn nothing_flows_back() {
        let orifice = Orifice::new(1.4, 1e-4);
        assert_eq!(orifice.mass_flow(1e4, 0.1, 1e5), 0.0);
        assert_eq!(orifice.mass_flow(1e5, 1.2, 1e5), 0.0);
    }

    #[test]
    fn slow_outflow_is_bernoullis() {
        let (p, density) = (100_000.01_f64, 1.2_f64);
        let orifice = Orifice::new(1.4, 1e-4);
        let bernoulli = 1e-4 * (2.0 * density * (p - 1e5)).sqrt();
        assert!((orifice.mass_flow(p, density, 1e5) / bernoulli - 1.0).abs() < 1e-6);
    }
}
