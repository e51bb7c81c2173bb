//! Angles of one panel on a cone, and its lengths for an outer ring of radius 1 (Eqs. 3-14).
//!
//! ```text
//! tan θ2 = sin θ1 (q − tan(θ1/2)) / (cot ϕ − q cos θ1 + sin θ1),   q = cot(ϕ + β1)
//! ρ = sin ϕ / sin(ϕ + θ2)
//! ```
//!
//! with cos θ1 − 1 = −sin θ1 tan(θ1/2) inserted. On a slender cone the developed radius R = r/sin φh
//! grows without bound while the panel stays finite. A product of R and a small angle is therefore
//! computed as r (sin x/sin φh). This is accurate for every φh, and gives the cylinder at φh = 0.

use core::f64::consts::{FRAC_PI_2, PI};

use super::Lengths;

/// Angles of one panel, rad, and lengths for an outer ring of radius 1; the same in every storey.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct PanelAngles {
    /// ϕ = ∠KAD, from the radial line to AD.
    pub phi: f64,
    /// α1 = ∠EAB.
    pub alpha1: f64,
    /// α2 = ∠DEA.
    pub alpha2: f64,
    /// β1 = ∠DAE.
    pub beta1: f64,
    /// β2 = ∠AEB.
    pub beta2: f64,
    /// γ1, sector angle at an outer vertex between AD and the previous ring line.
    pub gamma1: f64,
    /// γ2, sector angle at an inner vertex between EB and the next ring line.
    pub gamma2: f64,
    /// θ1, sector angle of the panel in the developed film.
    pub theta1: f64,
    /// θ2, rotation of the inner ring relative to the outer one in the developed film.
    pub theta2: f64,
    /// ρ, `R_inner`/`R_outer`.
    pub ring_ratio: f64,
    /// Edge lengths of a panel whose outer ring has radius 1.
    pub unit_lengths: Lengths,
    /// Slant height of a storey whose outer ring has radius 1: (1 − ρ)/sin φh.
    pub unit_slant: f64,
    /// Rotation of the inner ring relative to the outer one when erected, θ2/sin φh, rad.
    pub erected_twist: f64,
}

impl PanelAngles {
    /// The panel that closes when flat-folded (Eq. 14), for N = `panels`, and ϕ and φh in rad with
    /// 0 < ϕ < π/2 − π/N and |φh| < π/2.
    pub fn closing(panels: u32, phi: f64, half_angle: f64) -> Self {
        let s = libm::sin(half_angle);
        let half_panel = PI / f64::from(panels);
        let theta1 = 2.0 * half_panel * s;
        let alpha1 = FRAC_PI_2 - half_panel - phi;
        let beta1 = half_panel - 0.5 * theta1;
        let beta2 = half_panel + 0.5 * theta1;

        let q = 1.0 / libm::tan(phi + beta1);
        let sine1 = sine_over(2.0 * half_panel, s);
        let tan_phi = libm::tan(phi);
        // tan θ2/sin φh; numerator and denominator are multiplied by tan ϕ to stay finite for ϕ → 0.
        let g = sine1 * (q - libm::tan(0.5 * theta1)) * tan_phi
            / (1.0 + tan_phi * (libm::sin(theta1) - q * libm::cos(theta1)));
        let theta2 = libm::atan(g * s);
        let sine2 = g * libm::cos(theta2);
        let unit_slant = libm::cos(phi + 0.5 * theta2) * sine2
            / (libm::cos(0.5 * theta2) * libm::sin(phi + theta2));
        let ring_ratio = 1.0 - s * unit_slant;

        let ab = 2.0 * sine_over(half_panel, s);
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

    /// Slant height (over the outer radius) and ring ratio of `closing` in the limit ϕ → 0, where a storey
    /// is tallest: slant = k ρ, ρ = 1/(1 + k sin φh), k = (sin θ1/sin φh)(cot β1 − tan(θ1/2)).
    pub fn tallest(panels: u32, half_angle: f64) -> (f64, f64) {
        let s = libm::sin(half_angle);
        let half_panel = PI / f64::from(panels);
        let beta1 = half_panel * (1.0 - s);
        let k =
            sine_over(2.0 * half_panel, s) * (1.0 / libm::tan(beta1) - libm::tan(half_panel * s));
        (k / (1.0 + k * s), 1.0 / (1.0 + k * s))
    }

    /// Whether the panel exists: all its angles and lengths are positive and finite.
    pub fn is_panel(&self) -> bool {
        let lengths = &self.unit_lengths;
        [self.phi, self.alpha1, self.alpha2, self.beta1, self.beta2, self.phi + self.theta2]
            .iter()
            .chain(&[lengths.ab, lengths.de, lengths.ad, lengths.ae, self.unit_slant])
            .all(|x| *x > 0.0 && x.is_finite())
    }
}

/// Below this angle sin x/x uses two terms of its series. Chosen: the next term, x⁴/120, is below
/// rounding.
const MAX_SINE_SERIES: f64 = 1e-9;

/// Below this angle atan(x)/x uses two terms of its series. Chosen: the next term, x⁴/5, is below
/// rounding.
const MAX_ARCTANGENT_SERIES: f64 = 1e-6;

/// sin(x s)/s, with its limit x at s = 0.
pub(super) fn sine_over(x: f64, s: f64) -> f64 {
    let xs = x * s;
    if xs.abs() < MAX_SINE_SERIES { x * (1.0 - xs * xs / 6.0) } else { libm::sin(xs) / s }
}

/// atan2(s·across, along)/s for along > 0, with its limit
/// across/along at s = 0.
pub(super) fn angle_over(across: f64, along: f64, s: f64) -> f64 {
    let x = s * across / along;
    if x.abs() < MAX_ARCTANGENT_SERIES {
        across / along * (1.0 - x * x / 3.0)
    } else {
        libm::atan2(s * across, along) / s
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn panel_of_a_near_cylinder_tends_to_that_of_the_cylinder() {
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
    fn tallest_storey_is_the_limit_of_small_phi() {
        for (panels, half_angle) in [(6, 0.13), (4, 0.0), (12, -0.2), (5, 1.2)] {
            let (slant, ratio) = PanelAngles::tallest(panels, half_angle);
            let near = PanelAngles::closing(panels, 1e-9, half_angle);
            assert!((near.unit_slant / slant - 1.0).abs() < 1e-7, "{panels} {half_angle}");
            assert!((near.ring_ratio / ratio - 1.0).abs() < 1e-7);
        }
    }

    #[test]
    fn a_widening_panel_is_a_narrowing_one_upside_down() {
        // Seen from its other ring a panel has ϕ' = ϕ + θ2 and the same edges.
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
