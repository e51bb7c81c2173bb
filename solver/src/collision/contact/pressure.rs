//! How hard film lies on film.
//!
//! ```text
//! interlayer pressure at a node:  Σ |w| F over its contacts / its share of film area
//! ```

use super::distance::Closest;
use super::{ContactModel, ContactState, at};
use crate::geometry::field::Field;

/// Contact in numbers.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct Interlayer {
    /// Largest interlayer pressure at a node, Pa.
    pub largest: f64,
    /// Its mean over the area in contact, Pa.
    pub mean: f64,
    /// Share of the film's area in contact.
    pub area_fraction: f64,
}

impl ContactModel {
    /// Interlayer pressure at these places (m); `areas`: film area of each node, m².
    pub fn interlayer(&self, places: &Field, areas: &[f64], meeting: &ContactState) -> Interlayer {
        let mut pressed = vec![0.0; areas.len()];
        for contact in &meeting.contacts {
            let nodes = contact.pair.nodes(&self.topology);
            let Closest { weights, squared, .. } = contact.pair.closest(&at(places, nodes));
            let force = contact.force(squared.sqrt());
            for (node, weight) in nodes.iter().zip(weights) {
                pressed[*node as usize] += weight.abs() * force;
            }
        }
        let (mut largest, mut force, mut area) = (0.0_f64, 0.0, 0.0);
        for (own, share) in pressed.iter().zip(areas).filter(|(own, _)| **own > 0.0) {
            largest = largest.max(own / share);
            force += own;
            area += share;
        }
        let whole: f64 = areas.iter().sum();
        let mean = if area > 0.0 { force / area } else { 0.0 };
        Interlayer { largest, mean, area_fraction: area / whole }
    }
}
