//! Coulomb friction between films.
//!
//! ```text
//! v_t = Σ w_i v_i without its normal part       J = −min(μ F h, m |v_t|) v_t/|v_t|
//! ```
//!
//! Symbols: `w_i` weights of the closest points, F normal force of the pair, N; h duration of the kick,
//! s; m reduced mass of the pair, kg. An impulse never reverses the sliding, so friction dissipates
//! energy at any step. The dissipation is the trapezoid −½ J·(v⁻ + v⁺).

use super::step::CollisionStep;
use crate::collision::contact::distance::Closest;
use crate::collision::contact::pair::vectors_of;
use crate::collision::contact::{Contact, ContactModel};

/// Reduces the tangential velocities of contacts after a kick of `kick_length` (s). The dissipated
/// energy is added to `dissipation`, J.
pub(in crate::integrators::explicit) fn apply_friction(
    contact_model: &ContactModel,
    contacts: &[Contact],
    step: &mut CollisionStep<'_>,
    kick_length: f64,
    dissipation: &mut f64,
) {
    if contact_model.friction == 0.0 {
        return;
    }
    let (film, before) = (step.film, step.velocities_before_kick);
    for contact in contacts {
        let nodes = contact.pair.nodes(&contact_model.mesh.topology);
        let Closest { weights, between, squared } =
            contact.pair.closest(&vectors_of(step.positions, nodes));
        let normal_force = contact.repulsive_force(squared.sqrt());
        if normal_force == 0.0 {
            continue;
        }
        let normal = between / squared.sqrt();
        let mobility_of = |k: usize| weights[k] * weights[k] * film.inverse_mass[nodes[k] as usize];
        let mobility = (0..4).map(mobility_of).sum::<f64>();
        let relative = vectors_of(step.velocities, nodes)
            .iter()
            .zip(weights)
            .map(|(v, w)| v * w)
            .sum::<nalgebra::Vector3<f64>>();
        let sliding = relative - normal * normal.dot(&relative);
        let speed = sliding.norm();
        if speed == 0.0 || mobility == 0.0 {
            continue;
        }
        let magnitude = (contact_model.friction * normal_force * kick_length).min(speed / mobility);
        let impulse = sliding * (-magnitude / speed);
        for (node, weight) in nodes.iter().zip(weights) {
            let node = *node as usize;
            let projector = step.supports.projector(node);
            let change = projector * impulse * (weight * film.inverse_mass[node]);
            step.velocities.set(node, step.velocities.get(node) + change);
            let sum = before.get(node) + step.velocities.get(node);
            *dissipation -= 0.5 * film.mass[node] * change.dot(&sum);
        }
    }
}
