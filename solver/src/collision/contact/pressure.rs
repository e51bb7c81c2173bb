//! Interlayer pressure and gaps: how strongly films press on each other, and how near they are.
//!
//! ```text
//! interlayer pressure at a node = Σ |w| F over its contacts / film area of the node
//! ```
//!
//! Symbols: w weight of the node in the closest points of a contact, F repulsive force, N.

use super::distance::Closest;
use super::model::ContactModel;
use super::state::ContactState;
use crate::geometry::field::Field;

/// Interlayer pressure of a whole film.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct InterlayerPressure {
    /// Largest interlayer pressure at a node, Pa.
    pub largest: f64,
    /// Mean over the area in contact, Pa.
    pub mean: f64,
    /// Share of the film's area that is in contact.
    pub area_fraction: f64,
}

impl ContactModel {
    /// Distance of each node to other film at these positions (m), from its contacts; at most the contact
    /// distance.
    pub fn node_gaps(&self, positions: &Field, state: &ContactState) -> Vec<f64> {
        let mut gaps = vec![self.distance; positions.len()];
        for contact in &state.contacts {
            let nodes = contact.pair.nodes(&self.mesh.topology);
            let gap = contact.pair.closest(&positions.at(nodes)).squared.sqrt();
            for node in nodes {
                let least = &mut gaps[node as usize];
                *least = least.min(gap);
            }
        }
        gaps
    }

    /// Interlayer pressure at these positions (m). `areas`: film area of each node, m².
    pub fn interlayer_pressure(
        &self,
        positions: &Field,
        areas: &[f64],
        state: &ContactState,
    ) -> InterlayerPressure {
        let mut forces = vec![0.0; areas.len()];
        for contact in &state.contacts {
            let nodes = contact.pair.nodes(&self.mesh.topology);
            let Closest { weights, squared, .. } = contact.pair.closest(&positions.at(nodes));
            let force = contact.repulsive_force(squared.sqrt());
            for (node, weight) in nodes.iter().zip(weights) {
                forces[*node as usize] += weight.abs() * force;
            }
        }
        let (mut largest, mut total_force, mut contact_area) = (0.0_f64, 0.0, 0.0);
        for (force, area) in forces.iter().zip(areas).filter(|(force, _)| **force > 0.0) {
            largest = largest.max(force / area);
            total_force += force;
            contact_area += area;
        }
        let film_area: f64 = areas.iter().sum();
        let mean = if contact_area > 0.0 { total_force / contact_area } else { 0.0 };
        InterlayerPressure { largest, mean, area_fraction: contact_area / film_area }
    }
}
