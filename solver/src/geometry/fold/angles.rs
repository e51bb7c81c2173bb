//! One panel on a cone: every angle and, for an outer ring of radius 1, every length (Eqs. 3-14).
//!
//! ```text
//! tan θ2 = sin θ1 (q − tan(θ1/2)) / (cot ϕ − q cos θ1 + sin θ1),   q = cot(ϕ + β1)
//! ρ = sin ϕ / sin(ϕ + θ2)
//! ```
//!
//! (the ring ratio of physics, with cos θ1 − 1 = −sin θ1 tan(θ1/2) put in). On a slender cone R, the
//! developed radius, grows without bound while the panel stays what it is. So every quantity that
//! holds R times a small angle is computed as radius times (sine over sin φh), which is as exact on a
//! near-cylinder as on a cone and has the cylinder as its plain value at φh = 0.

use core::f64::consts::{FRAC_PI_2, PI};

use super::Lengths;

/// The angles of one panel, rad; the same in every storey.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct PanelAngles {
    /// ∠KAD, from the radial line to AD.
    pub phi: f64,
    /// ∠EAB.
    pub alpha1: f64,
    /// ∠DEA.
    pub alpha2: f64,
    /// ∠DAE.
    pub beta1: f64,
    /// ∠AEB.
    pub beta2: f64,
    /// Sector angle at an outer vertex between AD and the ring line behind it.
    pub gamma1: f64,
    /// Sector angle at an inner vertex between EB and the ring line ahead of it.
    pub gamma2: f64,
    /// Panel's share of the developed sector.
    pub theta1: f64,
    /// Turn of the inner ring against the outer, developed.
    pub theta2: f64,
    /// ρ, `R_inner`/`R_outer`.
    pub ring_ratio: f64,
    /// Edge lengths of a panel whose outer ring has radius 1.
    pub unit_lengths: Lengths,
    /// Slant height of a storey whose outer ring has radius 1: (1 − ρ)/sin φh.
    pub unit_slant: f64,
    /// Turn of the inner ring against the outer when erected: θ2/sin φh.
    pub erected_twist: f64,
}

impl PanelAngles {
    /// The panel that closes when flat folded (Eq. 14), for `panels` = N, ϕ and φh in rad with
    /// 0 < ϕ < π/2 − π/N and |φh| < π/2.
    pub fn closing(panels: u32, phi: f64, half_angle: f64) -> Self {
        let s = libm::sin(half_angle);
        let turn = PI / f64::from(panels);
        let theta1 = 2.0 * turn * s;
        let alpha1 = FRAC_PI_2 - turn - phi;
        let beta1 = turn - 0.5 * theta1;
        let beta2 = turn + 0.5 * theta1;

        let q = 1.0 / libm::tan(phi + beta1);
        let sine1 = sine_over(2.0 * turn, s);
        let tan_phi = libm::tan(phi);
        // tan θ2 / sin φh, both fractions multiplied by tan ϕ so that ϕ → 0 stays finite.
        let g = sine1 * (q - libm::tan(0.5 * theta1)) * tan_phi
            / (1.0 + tan_phi * (libm::sin(theta1) - q * libm::cos(theta1)));
        let theta2 = libm::atan(g * s);
        let sine2 = g * libm::cos(theta2);
        let unit_slant = libm::cos(phi + 0.5 * theta2) * sine2
            / (libm::cos(0.5 * theta2) * libm::sin(phi + theta2));
        let ring_ratio = 1.0 - s * unit_slant;

        let ab = 2.0 * sine_over(turn, s);
        let sine12 = sine1 * libm::cos(theta2) + libm::cos(theta1) * sine2;
        let unit_lengths = Lengths {
            ab,
            de: ab * ring_ratio,
            ad: sine2 / libm::sin(phi + theta2),
            ae: sine12 / libm::sin(phi + beta1 + theta1 + theta2),
        };
        Self {
            phi,
            alpha1,
            alpha2: alpha1 - theta2,
            beta1,
            beta2,
            gamma1: FRAC_PI_2 - 0.5 * theta1 + phi,
            gamma2: FRAC_PI_2 + 0.5 * theta1 + theta2 + phi,
            theta1,
            theta2,
            ring_ratio,
            unit_lengths,
            unit_slant,
            erected_twist: angle_over(g, 1.0, s),
        }
    }

    /// The slant height and ring ratio that `closing` tends to as ϕ → 0, where a storey is as tall
    /// as it can be: with k = (sin θ1/sin φh)(cot β1 − tan(θ1/2)), ρ = 1/(1 + k sin φh).
    pub fn tallest(panels: u32, half_angle: f64) -> (f64, f64) {
        let s = libm::sin(half_angle);
        let turn = PI / f64::from(panels);
        let beta1 = turn * (1.0 - s);
        let k = sine_over(2.0 * turn, s) * (1.0 / libm::tan(beta1) - libm::tan(turn * s));
        (k / (1.0 + k * s), 1.0 / (1.0 + k * s))
    }

    /// Whether every angle that must be positive is: the panel then exists.
    pub fn is_panel(&self) -> bool {
        let lengths = &self.unit_lengths;
        [self.phi, self.alpha1, self.alpha2, self.beta1, self.beta2, self.phi + self.theta2]
            .iter()
            .chain(&[lengths.ab, lengths.de, lengths.ad, lengths.ae, self.unit_slant])
            .all(|x| *x > 0.0 && x.is_finite())
    }
}

/// sin(x s)/s, with its limit x at s = 0.
pub(super) fn sine_over(x: f64, s: f64) -> f64 {
    let xs = x * s;
    if xs.abs() < 1e-9 { x * (1.0 - xs * xs / 6.0) } else { libm::sin(xs) / s }
}

/// The angle of (along, across·s) over s, atan2(s·across, along)/s for along > 0, with its limit
/// across/along at s = 0.
pub(super) fn angle_over(across: f64, along: f64, s: f64) -> f64 {
    let x = s * across / along;
    if x.abs() < 1e-6 {
        across / along * (1.0 - x * x / 3.0)
    } else {
        libm::atan2(s * across, along) / s
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn near_cylinder_is_continuous_with_the_cylinder() {
        let cylinder = PanelAngles::closing(6, 0.5, 0.0);
        for half_angle in [1e-3, 1e-6, 1e-9, 1e-12, 1e-300, -1e-9] {
            let cone = PanelAngles::closing(6, 0.5, half_angle);
            let bound = 10.0 * f64::abs(half_angle) + 1e-15;
            assert!((cone.unit_slant - cylinder.unit_slant).abs() < bound, "{half_angle}");
            assert!((cone.unit_lengths.ae - cylinder.unit_lengths.ae).abs() < bound);
            assert!((cone.erected_twist - cylinder.erected_twist).abs() < bound);
        }
        // h (tan(ϕ + π/N) − tan ϕ) = 2π/N, the parallelogram of the cylinder.
        let rise = 2.0 * PI / 6.0 / (libm::tan(0.5 + PI / 6.0) - libm::tan(0.5));
        assert!((cylinder.unit_slant - rise).abs() < 1e-15);
        assert!((cylinder.ring_ratio - 1.0).abs() < 1e-300);
    }

    #[test]
    fn tallest_is_the_limit_of_small_phi() {
        for (panels, half_angle) in [(6, 0.13), (4, 0.0), (12, -0.2), (5, 1.2)] {
            let (slant, ratio) = PanelAngles::tallest(panels, half_angle);
            let near = PanelAngles::closing(panels, 1e-9, half_angle);
            assert!((near.unit_slant / slant - 1.0).abs() < 1e-7, "{panels} {half_angle}");
            assert!((near.ring_ratio / ratio - 1.0).abs() < 1e-7);
        }
    }

    #[test]
    fn upside_down_is_the_same_panel() {
        // A widening panel is a narrowing one seen from its other ring: ϕ' = ϕ + θ2, sides equal.
        let narrow = PanelAngles::closing(6, 0.55, 0.13);
        let wide = PanelAngles::closing(6, narrow.phi + narrow.theta2, -0.13);
        assert!(wide.is_panel());
        let scale = narrow.unit_lengths.de / wide.unit_lengths.ab;
        assert!((wide.unit_lengths.de * scale - narrow.unit_lengths.ab).abs() < 1e-14);
        assert!((wide.unit_lengths.ad * scale - narrow.unit_lengths.ad).abs() < 1e-14);
        assert!((wide.unit_lengths.ae * scale - narrow.unit_lengths.ae).abs() < 1e-14);
        assert!((wide.ring_ratio * narrow.ring_ratio - 1.0).abs() < 1e-14);
    }
}
