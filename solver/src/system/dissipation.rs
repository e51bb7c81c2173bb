//! The dissipative part: forces that depend on velocities, and the power they take.
//!
//! ```text
//! viscosity      D = 2ζ/ω_e (S(x + h v) − S(x))/h        f = −A t F D Dm⁻ᵀ
//! friction       f = −min(μ F, m |v_t|/h) v_t/|v_t|      at each contact
//! mass damping   f = −c m v
//! ```
//!
//! Symbols: h step, s; the rest as in [`crate::mechanics::forces::damping`] and in the contact model. A pure
//! function of its arguments: an integrator whose steps carry a numerical stress along has its own form of
//! the first line.

use nalgebra::Vector3;

use super::{FilmState, FilmSystem};
use crate::collision::contact::distance::Closest;
use crate::collision::contact::pair::vectors_of;
use crate::geometry::field::Field;
use crate::mechanics::forces::membrane::{deformation_gradient, strain};
use crate::mechanics::material::PlaneTensor;

/// Power (W) of each dissipative force along the velocities: negative where it takes energy.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct Dissipation {
    /// Of numerical damping.
    pub viscosity: f64,
    /// Of friction between film and film.
    pub friction: f64,
    /// Of mass damping.
    pub mass_damping: f64,
}

impl FilmSystem {
    /// Adds the dissipative forces (N) of a state with these velocities (m/s) over a step (s) to `forces`.
    /// Creep is not a force: its loss is in the history of the material. The film's stress is that of film
    /// without loss.
    pub fn dissipate(
        &self,
        state: &FilmState,
        velocities: &Field,
        step: f64,
        forces: &mut Field,
    ) -> Dissipation {
        Dissipation {
            viscosity: self.viscosity(state, velocities, step, forces),
            friction: self.friction(state, velocities, step, forces),
            mass_damping: self.damp_masses(velocities, forces),
        }
    }

    fn viscosity(
        &self,
        state: &FilmState,
        velocities: &Field,
        step: f64,
        forces: &mut Field,
    ) -> f64 {
        if self.numerical_damping == 0.0 {
            return 0.0;
        }
        let (model, positions) = (&self.model, &state.positions);
        let mut next = positions.clone();
        for node in 0..model.nodes() {
            next.set(node, positions.get(node) + velocities.get(node) * step);
        }
        let stress = |x: &Field, element| model.material.stress(strain(model, x, element)).tensor;
        let mut power = 0.0;
        for (element, triangle) in model.triangles.iter().enumerate() {
            let factor = model.damping_time[element] / step;
            let (now, then) = (stress(positions, element), stress(&next, element));
            let PlaneTensor { xx, yy, xy } = PlaneTensor {
                xx: (then.xx - now.xx) * factor,
                yy: (then.yy - now.yy) * factor,
                xy: (then.xy - now.xy) * factor,
            };
            let [a, b, c, d] = model.inverse_shape.each_ref().map(|column| column[element]);
            let [f, g] = deformation_gradient(model, positions, element);
            let (p, q) = (f * xx + g * xy, f * xy + g * yy);
            let volume = -model.volume[element];
            let (first, second) = ((p * a + q * b) * volume, (p * c + q * d) * volume);
            for (node, force) in triangle.iter().zip([-(first + second), first, second]) {
                let node = *node as usize;
                forces.set(node, forces.get(node) + force);
                power += force.dot(&velocities.get(node));
            }
        }
        power
    }

    fn friction(
        &self,
        state: &FilmState,
        velocities: &Field,
        step: f64,
        forces: &mut Field,
    ) -> f64 {
        let Some(model) = self.contact.as_ref().filter(|model| model.friction > 0.0) else {
            return 0.0;
        };
        let mut power = 0.0;
        for contact in &state.contact.contacts {
            let nodes = contact.pair.nodes(&model.mesh.topology);
            let Closest { weights, between, squared } =
                contact.pair.closest(&vectors_of(&state.positions, nodes));
            let gap = squared.sqrt();
            let normal_force = contact.repulsive_force(gap);
            if normal_force == 0.0 {
                continue;
            }
            let normal = between / gap;
            let relative: Vector3<f64> =
                vectors_of(velocities, nodes).iter().zip(weights).map(|(v, w)| v * w).sum();
            let sliding = relative - normal * normal.dot(&relative);
            let mobility: f64 = nodes
                .iter()
                .zip(weights)
                .map(|(node, weight)| weight * weight * self.model.inverse_mass[*node as usize])
                .sum();
            let speed = sliding.norm();
            if speed == 0.0 || mobility == 0.0 {
                continue;
            }
            let magnitude = (model.friction * normal_force).min(speed / (mobility * step));
            let force = sliding * (-magnitude / speed);
            for (node, weight) in nodes.iter().zip(weights) {
                let node = *node as usize;
                forces.set(node, forces.get(node) + force * weight);
            }
            power += force.dot(&relative);
        }
        power
    }

    fn damp_masses(&self, velocities: &Field, forces: &mut Field) -> f64 {
        if self.mass_damping == 0.0 {
            return 0.0;
        }
        let mut power = 0.0;
        for (node, mass) in self.model.mass.iter().enumerate() {
            let force = velocities.get(node) * (-self.mass_damping * mass);
            forces.set(node, forces.get(node) + force);
            power += force.dot(&velocities.get(node));
        }
        power
    }
}
