//! The audit of motion: nodes move as the velocities of the method say, and as nothing else.
//!
//! ```text
//! a x' = b x − c x⁻ + h u                  what a method says of a step       central differences: a = b = 1, c = 0
//! q = Σ w_i (x_i + 0.8 y_i + 0.6 z_i)      follows the same law               |q(x) − expected| ≤ 1e-12 Σ w_i L
//! ```
//!
//! Symbols: x⁻, x, x' positions before the last step, before and after this one, m; h step, s; u velocities that
//! moved the nodes, m/s; w pseudo-random weights between ½ and 1½, 0 for a node without mass; L size of the film, m.
//!
//! One sum a step stands for all nodes: no motion of nodes that are moved by anything else leaves it as expected, but
//! for coincidence. Its expected value is carried from step to step from velocities alone; positions are read
//! every [`PERIOD`] steps and at the end of an interval. So a step that is taken twice, or a node that is
//! elsewhere, is found in the step it happens or up to [`PERIOD`] steps later.

use super::interface::StepMotion;
use super::virtual_displacement::weight;
use crate::geometry::field::Field;
use crate::platform::simd::{Column, InstructionSet, WIDTH, Wide, dispatch_wide};
use crate::system::FilmSystem;

/// Steps between two readings of the positions. Chosen: a reading costs as much as the carrying of one step.
const PERIOD: u32 = 16;
/// Factors of the axes: no direction of an axis or of a diagonal is without weight. Chosen.
const AXES: [f64; 3] = [1.0, 0.8, 0.6];
/// Largest difference of the sum from its expected value over Σ w L. Chosen: a hundred times the rounding of the tests.
const MAX_DIFFERENCE: f64 = 1e-12;

/// The weighted sum of the positions, and what it must be.
#[derive(Debug, Clone)]
pub(super) struct MotionAudit {
    instruction_set: InstructionSet,
    weights: Column,
    /// Largest difference from the expected sum, m.
    bound: f64,
    /// Sums expected now and before the last step, m; `None` where nothing is known.
    expected: [Option<f64>; 2],
    /// Steps since the positions were read.
    unread: u32,
    /// Σ w m and Σ w/m of the start.
    masses: [f64; 2],
}

impl MotionAudit {
    pub(super) fn start(system: &FilmSystem) -> Self {
        let mass = &system.model.mass;
        let of_node = |(node, mass): (usize, &f64)| if *mass > 0.0 { weight(node) } else { 0.0 };
        let weights: Column = mass.iter().enumerate().map(of_node).collect();
        let bound = MAX_DIFFERENCE * weights.iter().sum::<f64>() * system.model.size();
        let instruction_set = system.instruction_set;
        let masses = masses(&weights, system);
        Self { instruction_set, weights, bound, expected: [None, None], unread: 0, masses }
    }

    /// Whether the nodes have the masses of the start.
    pub(super) fn keeps_masses(&self, system: &FilmSystem) -> bool {
        masses(&self.weights, system).map(f64::to_bits) == self.masses.map(f64::to_bits)
    }

    fn sum(&self, field: &Field) -> f64 {
        weighted_sum(self.instruction_set, &self.weights, field)
    }

    /// Whether positions (m) are where the steps so far lead.
    pub(super) fn agrees(&mut self, positions: &Field) -> bool {
        let Some(expected) = self.expected[0] else { return true };
        self.unread = 0;
        let sum = self.sum(positions);
        self.expected[0] = Some(sum);
        // Written so that NaN disagrees.
        (sum - expected).abs() <= self.bound
    }

    /// Adds a step. Returns whether its start, if it is read, is where the steps before it lead.
    pub(super) fn add(&mut self, motion: &StepMotion<'_>) -> bool {
        let [a, b, c] = motion.coefficients;
        self.unread += 1;
        let several = c != 0.0;
        let agrees = if self.expected[0].is_none() {
            self.expected[0] = Some(self.sum(motion.from));
            true
        } else if several || self.unread > PERIOD {
            self.agrees(motion.from)
        } else {
            true
        };
        let [now, before] = self.expected;
        let moved = motion.length * self.sum(motion.velocities);
        let next = match (now, before) {
            (Some(now), Some(before)) if several => Some((b * now - c * before + moved) / a),
            (Some(now), _) if !several => Some((b * now + moved) / a),
            _ => None,
        };
        self.expected = [next, now];
        agrees
    }
}

/// Σ w m and Σ w/m of the nodes.
fn masses(weights: &[f64], system: &FilmSystem) -> [f64; 2] {
    [&system.model.mass[..], &system.model.inverse_mass]
        .map(|column| column.iter().zip(weights).map(|(value, weight)| value * weight).sum())
}

#[allow(clippy::inline_always, reason = "inside the node loop")]
#[inline(always)]
fn weighted_sum_kernel<L: Wide>(weights: &[f64], field: &Field) -> f64 {
    let nodes = weights.len();
    let [x, y, z] = [&field.x[..nodes], &field.y[..nodes], &field.z[..nodes]];
    let [p, q, r] = AXES;
    let in_blocks = nodes - nodes % WIDTH;
    let mut sums = L::splat(0.0);
    for first in (0..in_blocks).step_by(WIDTH) {
        let along = L::load(x, first) * p + L::load(y, first) * q + L::load(z, first) * r;
        sums = sums + along * L::load(weights, first);
    }
    let mut sum = sums.lanes().sum();
    for node in in_blocks..nodes {
        sum += (x[node] * p + y[node] * q + z[node] * r) * weights[node];
    }
    sum
}

dispatch_wide! {
    /// Σ w (x + 0.8 y + 0.6 z) of a field.
    fn weighted_sum / weighted_sum_kernel(weights: &[f64], field: &Field) -> f64
}
