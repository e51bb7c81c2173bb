//! What a method keeps of an element from one step to the next: elastic strain, stress, numerical stress.
//!
//! ```text
//! e = (Exx + Eyy, Exx − Eyy, 2 Exy)        s = ((Sxx + Syy)/2, (Sxx − Syy)/2, Sxy)        S:E = s·e
//! ```
//!
//! The elastic strain and the stress follow from positions and creep strain; they are kept for the change of
//! the next step. The numerical stress depends on the last step. So all of it belongs to an integrator and
//! not to the state of the film.

use std::collections::BinaryHeap;

use serde::{Deserialize, Serialize};

use super::{CreepStrain, strain};
use crate::geometry::field::Field;
use crate::mechanics::film_model::FilmModel;
use crate::platform::simd::{Lanes, WIDTH};

/// Stored values of eight elements, each in its own axes
/// ([`crate::mechanics::film_model::ElementBlock`]).
#[derive(Debug, Clone, Copy, PartialEq, Default, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct ElementHistory {
    /// Elastic strain Ê.
    pub strain: [Lanes; 3],
    /// Stress S, Pa.
    pub stress: [Lanes; 3],
    /// Numerical stress D, Pa.
    pub numerical_stress: [Lanes; 3],
}

impl ElementHistory {
    /// Zero histories of the first and the second elements of each block of eight kites: right before the
    /// first call of [`super::assemble_membrane`], which sets strain and stress.
    pub fn zero(model: &FilmModel) -> Vec<[Self; 2]> {
        vec![[Self::default(); 2]; model.constants.len()]
    }
}

/// The three components of one lane.
fn lane_of(stored: &[Lanes; 3], lane: usize) -> [f64; 3] {
    stored.each_ref().map(|lanes| lanes.0[lane])
}

/// Energy Σ A t ψ stored in the film now, J: elastic energy, and that of creep
/// ([`crate::mechanics::material_loss`]).
pub fn stored_energy(
    model: &FilmModel,
    creep: &[[CreepStrain; 2]],
    histories: &[[ElementHistory; 2]],
) -> f64 {
    let (mut energy, none) = (0.0, [CreepStrain::default(); 2]);
    for (index, (constants, histories)) in model.constants.iter().zip(histories).enumerate() {
        let creep = creep.get(index).unwrap_or(&none);
        for ((block, history), creep) in constants.iter().zip(histories).zip(creep) {
            for (lane, minus_volume) in block.minus_volume.0.iter().enumerate() {
                let [strain, stress] =
                    [&history.strain, &history.stress].map(|stored| lane_of(stored, lane));
                let creep = creep.lane(lane);
                energy -= minus_volume * model.creep.stored_energy(strain, stress, creep);
            }
        }
    }
    energy
}

/// The stress (Pa) that the largest principal second Piola-Kirchhoff stress reaches on this fraction of the
/// film's reference area; 0 where less of it is in tension. Without the numerical stress.
pub fn stress_on_fraction(
    model: &FilmModel,
    histories: &[[ElementHistory; 2]],
    fraction: f64,
) -> f64 {
    let mut tensions = Vec::with_capacity(model.elements());
    let mut total = 0.0;
    for (constants, histories) in model.constants.iter().zip(histories) {
        for (block, history) in constants.iter().zip(histories) {
            for (lane, minus_volume) in block.minus_volume.0.iter().enumerate() {
                let [mean, half_difference, xy] = lane_of(&history.stress, lane);
                let stress = mean + (half_difference * half_difference + xy * xy).sqrt();
                if stress > 0.0 {
                    // Bits of positive numbers have their order.
                    tensions.push((stress.to_bits(), (-minus_volume).to_bits()));
                }
                total -= minus_volume;
            }
        }
    }
    // The fraction is small: a heap sorts no more than it needs.
    let (mut tensions, mut area) = (BinaryHeap::from(tensions), 0.0);
    while let Some((stress, volume)) = tensions.pop() {
        area += f64::from_bits(volume);
        if area >= fraction * total {
            return f64::from_bits(stress);
        }
    }
    0.0
}

/// Forces of the numerical stress on the nodes (N) at these positions (m): a part of the membrane
/// forces.
pub fn numerical_forces(
    model: &FilmModel,
    positions: &Field,
    histories: &[[ElementHistory; 2]],
) -> Field {
    let mut forces = Field::zeros(model.nodes());
    for (index, kite) in model.kites.iter().enumerate() {
        let (block, lane) = (index / WIDTH, index % WIDTH);
        let [s, a, t, b] = *kite;
        let nodes = [[s, a, t], [s, t, b]];
        for (half, [p, q]) in strain::edges_of_kite(positions, kite).into_iter().enumerate() {
            let constants = &model.constants[block][half];
            let [a, b, d] = lane_of(&constants.inverse_shape, lane);
            let [mean, half_difference, xy] =
                lane_of(&histories[block][half].numerical_stress, lane)
                    .map(|stress| stress * constants.minus_volume.0[lane]);
            let (xx, yy) = (mean + half_difference, mean - half_difference);
            // Force densities −r of the edges: Gᵀ of the stress.
            let b_yy_a_xy = b * yy + a * xy;
            let r = [a * a * xx + b * (b_yy_a_xy + a * xy), d * b_yy_a_xy, d * d * yy];
            let (first, second) = (p * r[0] + q * r[1], p * r[1] + q * r[2]);
            for (node, force) in nodes[half].into_iter().zip([-(first + second), first, second]) {
                forces.set(node as usize, forces.get(node as usize) + force);
            }
        }
    }
    forces
}

#[cfg(test)]
mod tests;
