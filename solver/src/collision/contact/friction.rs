//! Coulomb friction between films.
//!
//! ```text
//! v_t = Σ w_i v_i without its normal part       J = −min(μ F h, m |v_t|) v_t/|v_t|
//! ```
//!
//! Symbols: F force that presses the pair together, N; h time of the kick, s; m mass of the pair. An
//! impulse never turns the motion round, so it takes energy whatever the step; what it takes is
//! its trapezoid, −½ J·(v⁻ + v⁺).

use super::distance::Closest;
use super::{ContactModel, ContactState, at};
use crate::geometry::field::Field;
use crate::mechanics::film_model::FilmModel;
use crate::mechanics::supports::Supports;

impl ContactModel {
    /// Takes tangential motion out of the velocities (m/s) after a kick over `kick` (s); `before`:
    /// velocities before it.
    #[expect(clippy::too_many_arguments, reason = "one pass over what rubs")]
    pub fn rub(
        &self,
        model: &FilmModel,
        supports: &Supports,
        places: &Field,
        before: &Field,
        velocities: &mut Field,
        kick: f64,
        meeting: &mut ContactState,
    ) {
        if self.friction == 0.0 {
            return;
        }
        let ContactState { contacts, rubbed, .. } = meeting;
        for contact in contacts {
            let nodes = contact.pair.nodes(&self.topology);
            let Closest { weights, between, squared } = contact.pair.closest(&at(places, nodes));
            let press = contact.force(squared.sqrt());
            if press == 0.0 {
                continue;
            }
            let normal = between / squared.sqrt();
            let mobility =
                |k: usize| weights[k] * weights[k] * model.inverse_mass[nodes[k] as usize];
            let mobility = (0..4).map(mobility).sum::<f64>();
            let relative = at(velocities, nodes)
                .iter()
                .zip(weights)
                .map(|(v, w)| v * w)
                .sum::<nalgebra::Vector3<f64>>();
            let sliding = relative - normal * normal.dot(&relative);
            let speed = sliding.norm();
            if speed == 0.0 || mobility == 0.0 {
                continue;
            }
            let impulse = (self.friction * press * kick).min(speed / mobility);
            let push = sliding * (-impulse / speed);
            for (node, weight) in nodes.iter().zip(weights) {
                let node = *node as usize;
                let change = supports.projector(node) * push * (weight * model.inverse_mass[node]);
                velocities.set(node, velocities.get(node) + change);
                let mean = before.get(node) + velocities.get(node);
                *rubbed -= 0.5 * model.mass[node] * change.dot(&mean);
            }
        }
    }
}
