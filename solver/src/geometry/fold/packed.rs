//! Twist of a storey that is packed to a low rise.
//!
//! The N-gons keep their size, so the folded edges AD and AE strain slightly. The twist τ minimises their
//! strain. With P the outer circumradius, h the rise of the storey, L the length of an edge in the
//! pattern, and the squared distances
//!
//! ```text
//! d²(τ) = P² (1 + ρ² − 2 ρ cos τ) + h²        AD at τ, AE at τ + 2π/N
//! ```
//!
//! the sum of the squared Green strains (d² − L²)/(2 L²) of AD and AE is least. Storeys are similar, so
//! all lengths here are in units of P.

use core::f64::consts::PI;

use super::FoldPattern;

/// Longest stride of the bracketing search over its range, from the flat twist to −π/N. Chosen: a
/// thousandth, shorter than the distance between roots.
const MAX_STRIDE: f64 = 1e-3;

/// First stride over the longest one. Chosen: strides double, so a thousandth adds 10 strides at most.
const FIRST_STRIDE: f64 = 1e-3;

/// A storey whose outer N-gon has circumradius 1.
pub(super) struct PackedStorey {
    ring_ratio: f64,
    /// L² of AD and AE.
    squared: [f64; 2],
    /// Sine and cosine of 2π/N.
    panel: (f64, f64),
    /// π/N, rad.
    half_panel: f64,
    /// Twist at h = 0, rad.
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

    /// Twist at a rise (over P), rad: the largest root not above the flat twist of the derivative of the
    /// sum of squared strains.
    pub(super) fn twist(&self, rise: f64) -> f64 {
        let slope = |twist| -> f64 {
            self.strains(rise, twist).iter().map(|(strain, derivative)| strain * derivative).sum()
        };
        let (mut low, mut high) = (self.flat_twist, self.flat_twist);
        // The edges are too long at the flat twist, and less twist shortens them. At a twist of −π/N,
        // AD and AE would be equal; no rise leads there. The strides are short at first, so that a low
        // rise needs few, and stay short enough not to skip a root.
        let max_stride = MAX_STRIDE * (self.flat_twist + self.half_panel);
        let mut stride = FIRST_STRIDE * max_stride;
        while slope(low) > 0.0 && low > -self.half_panel {
            high = low;
            low -= stride;
            stride = max_stride.min(2.0 * stride);
        }
        loop {
            let middle = 0.5 * (low + high);
            if middle <= low || middle >= high {
                return middle;
            }
            if slope(middle) > 0.0 { high = middle } else { low = middle }
        }
    }

    /// Largest magnitude of the Green strain of the folded edges at a rise (over P).
    pub(super) fn strain(&self, rise: f64) -> f64 {
        self.strains(rise, self.twist(rise))
            .iter()
            .fold(0.0, |largest: f64, (strain, _)| largest.max(strain.abs()))
    }

    /// Green strain of AD and of AE, each with its derivative by the twist.
    fn strains(&self, rise: f64, twist: f64) -> [(f64, f64); 2] {
        let ratio = self.ring_ratio;
        let (sin, cos) = libm::sincos(twist);
        let next_corner =
            (sin * self.panel.1 + cos * self.panel.0, cos * self.panel.1 - sin * self.panel.0);
        [((sin, cos), self.squared[0]), (next_corner, self.squared[1])].map(
            |((sin, cos), squared)| {
                let distance_squared = 1.0 + ratio * ratio - 2.0 * ratio * cos + rise * rise;
                ((distance_squared - squared) / (2.0 * squared), ratio * sin / squared)
            },
        )
    }
}
