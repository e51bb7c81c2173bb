//! Coulomb friction between films.
//!
//! ```text
//! v_t = Σ w_i v_i without its normal part       J = −min(μ F h, m |v_t|) v_t/|v_t|
//! ```
//!
//! Symbols: `w_i` weights of the closest points, F normal force of the pair, N; h duration of the kick,
//! s; m reduced mass of the pair, kg. An impulse never reverses the sliding. Like those of collisions, the
//! impulses are counted when the step has all of them: [`CollisionStep::dissipation`].

use super::step::{CollisionStep, Impulses};
use crate::collision::contact::distance::Closest;
use crate::collision::contact::{Contact, ContactModel};

/// Reduces the tangential velocities of contacts after a kick of `kick_length` (s), and gives the impulses.
pub(in crate::integrators::explicit) fn apply_friction(
    contact_model: &ContactModel,
    contacts: &[Contact],
    step: &mut CollisionStep<'_>,
    kick_length: f64,
) -> Impulses {
    let mut impulses = Impulses::new();
    if contact_model.friction == 0.0 {
        return impulses;
    }
    let film = step.film;
    for contact in contacts {
        let nodes = contact.pair.nodes(&contact_model.mesh.topology);
        let Closest { weights, between, squared } = contact.pair.closest(&step.positions.at(nodes));
        let normal_force = contact.repulsive_force(squared.sqrt());
        if normal_force == 0.0 {
            continue;
        }
        let normal = between / squared.sqrt();
        let mobility_of = |k: usize| weights[k] * weights[k] * film.inverse_mass[nodes[k] as usize];
        let mobility = (0..4).map(mobility_of).sum::<f64>();
        let relative = step
            .velocities
            .at(nodes)
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
            let impulse = projector * impulse * weight;
            let velocity = step.velocities.get(node);
            step.velocities.set(node, velocity + impulse * film.inverse_mass[node]);
            impulses.push((node, impulse));
        }
    }
    impulses
}
