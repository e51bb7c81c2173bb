//! Flow of gas at pressure p through a long slit (gap h, length L) into a vacuum, m³/s of gas at p for each metre.
//!
//! ```text
//! viscous         h³ p/(24 μ L) (1 + 6·1.1466 Kn)     Kn = λ/h, λ = (μ/p) √(π R T/2): slip of the first order
//! free molecular  h W √(R T/(2π))                     W = (h/L)(ln(L/h) + ½), at most 1
//! choked          h √(R T) √γ (2/(γ+1))^((γ+1)/(2(γ−1)))
//! ```
//!
//! The larger of the first two, at most the third: within tens of percent of measured flow (H. Ogiwara and others, JAEA,
//! slits of 0.1 mm; the transition has its least conductance near h = 1.2 λ). A smaller difference of pressure drives
//! less, in proportion where molecules do not collide.

use super::Gas;

/// Viscosity μ, Pa s: of nitrogen at 293 K, for every gas. That of others is 0.5 to 1.25 times this.
const VISCOSITY: f64 = 1.76e-5;
/// Slip coefficient of a wall that reflects diffusely.
const SLIP: f64 = 1.1466;

impl Gas {
    /// Conductance of a slit of this gap and length (m) for gas of this pressure (Pa) and temperature (K), m²/s.
    pub fn slit_conductance(&self, pressure: f64, temperature: f64, gap: f64, length: f64) -> f64 {
        use core::f64::consts::{FRAC_PI_2, PI};
        let speed = ((self.cp - self.cv) * temperature).sqrt();
        // λ p, so that an empty capsule needs no division.
        let path = VISCOSITY * FRAC_PI_2.sqrt() * speed;
        let viscous =
            gap * gap * (gap * pressure + 6.0 * SLIP * path) / (24.0 * VISCOSITY * length);
        let ratio = gap / length;
        let passed = if ratio < 1.0 { (ratio * (0.5 - libm::log(ratio))).min(1.0) } else { 1.0 };
        let free = if gap > 0.0 { gap * passed * speed / (2.0 * PI).sqrt() } else { 0.0 };
        viscous.max(free).min(gap * speed * self.orifice(temperature).choked_factor)
    }
}

#[cfg(test)]
mod tests {
    use crate::mechanics::gas::Gas;
    use crate::scene::paper::nitrogen_supply;

    #[test]
    fn conductance_is_that_of_the_three_regimes() {
        let gas = Gas::new(&nitrogen_supply(), 293.0, 1.0);
        // Width 3.1 m, length 50 mm, nitrogen at 293 K: m³/s of each formula, computed by hand.
        let cases = [
            (3.3, 1e-3, 0.0322, 0.01),    // free molecular
            (1150.0, 1e-3, 0.1754, 0.01), // viscous, slip 4 %
            (1150.0, 5e-3, 3.13, 0.01),   // choked: 202 m³/s through a square metre
            (0.0, 1e-3, 0.0322, 0.01),
        ];
        for (pressure, gap, expected, tolerance) in cases {
            let found = 3.1 * gas.slit_conductance(pressure, 293.0, gap, 0.05);
            assert!((found / expected - 1.0_f64).abs() < tolerance, "{pressure} {gap}: {found}");
        }
        assert!(gas.slit_conductance(3.3, 293.0, 0.0, 0.05) == 0.0);
    }
}
