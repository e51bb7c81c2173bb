//! A storey packed to a low rise: how much it turns.
//!
//! The N-gons keep their size, so the folded edges AD and AE strain a little; the twist τ is the one
//! that keeps their lengths best. With P the outer circumradius, h the rise of the storey and the
//! squared distances
//!
//! ```text
//! d²(τ) = P² (1 + ρ² − 2 ρ cos τ) + h²        AD at τ, AE at τ + 2π/N
//! ```
//!
//! the sum of squared Green strains (d² − L²)/(2 L²) is least. Storeys are alike but for their size:
//! everything here is in units of P.

use core::f64::consts::PI;

use super::FoldPattern;

/// A storey whose outer N-gon has circumradius 1.
pub(super) struct PackedStorey {
    ring_ratio: f64,
    /// AD² and AE².
    squared: [f64; 2],
    /// Sine and cosine of 2π/N.
    panel: (f64, f64),
    half_panel: f64,
    flat_twist: f64,
}

impl PackedStorey {
    pub(super) fn of(pattern: &FoldPattern) -> Self {
        let half_panel = PI / f64::from(pattern.design.panels);
        let lengths = &pattern.angles.unit_lengths;
        let radius = 0.5 * lengths.ab / libm::sin(half_panel);
        let squared = [lengths.ad, lengths.ae].map(|length| length * length / (radius * radius));
        Self {
            ring_ratio: pattern.angles.ring_ratio,
            squared,
            panel: libm::sincos(2.0 * half_panel),
            half_panel,
            flat_twist: pattern.flat_twist(),
        }
    }

    /// Twist at a rise (over P), rad: the root, next below the flat twist, of the derivative of the
    /// summed squared strains.
    pub(super) fn twist(&self, rise: f64) -> f64 {
        let slope = |twist| -> f64 {
            self.strains(rise, twist).iter().map(|(strain, by)| strain * by).sum()
        };
        let (mut low, mut high) = (self.flat_twist, self.flat_twist);
        // Edges are too long at the flat twist, so less twist shortens them; half a panel's turn
        // backwards AD and AE would be alike, and no rise gets there. Strides start small, so that a
        // low rise is quick, and stay small enough not to step over a root.
        let longest = 1e-3 * (self.flat_twist + self.half_panel);
        let mut stride = 1e-3 * longest;
        while slope(low) > 0.0 && low > -self.half_panel {
            high = low;
            low -= stride;
            stride = longest.min(2.0 * stride);
        }
        loop {
            let middle = 0.5 * (low + high);
            if middle <= low || middle >= high {
                return middle;
            }
            if slope(middle) > 0.0 { high = middle } else { low = middle }
        }
    }

    /// Largest Green strain of the folded edges at a rise (over P), in magnitude.
    pub(super) fn strain(&self, rise: f64) -> f64 {
        self.strains(rise, self.twist(rise))
            .iter()
            .fold(0.0, |largest: f64, (strain, _)| largest.max(strain.abs()))
    }

    /// Green strain of AD and AE, and its derivative by the twist.
    fn strains(&self, rise: f64, twist: f64) -> [(f64, f64); 2] {
        let ratio = self.ring_ratio;
        let (sin, cos) = libm::sincos(twist);
        let turned =
            (sin * self.panel.1 + cos * self.panel.0, cos * self.panel.1 - sin * self.panel.0);
        [((sin, cos), self.squared[0]), (turned, self.squared[1])].map(|((sin, cos), squared)| {
            let distance_squared = 1.0 + ratio * ratio - 2.0 * ratio * cos + rise * rise;
            ((distance_squared - squared) / (2.0 * squared), ratio * sin / squared)
        })
    }
}
