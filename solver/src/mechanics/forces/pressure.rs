//! Pressure on closed film: volume and its exact gradient.
//!
//! ```text
//! V = Σ_e x0·(x1 × x2)/6            f_i = (p − p_ambient) ∂V/∂x_i
//! ∂V/∂x_i = Σ_e (x1 − x0) × (x2 − x0)/6      over the elements e at node i
//! ```
//!
//! Divergence theorem over the closed surface. The gradient is written by oriented areas, which do
//! not depend on the origin; round the closed fan of a node they add up to the derivative of V.
//! Whatever the gas does through V and the film through f is thus the same p dV. The areas of film
//! come from [`super::membrane::assemble_membrane`]; those of closing faces are added here.

use nalgebra::Vector3;

use super::membrane::NodeForces;
use crate::geometry::field::Field;
use crate::mechanics::film_model::FilmModel;
use crate::mechanics::supports::Supports;

/// Enclosed volume at these positions (m), m³.
pub fn volume(model: &FilmModel, positions: &Field) -> f64 {
    let six: f64 = model
        .triangles
        .iter()
        .chain(&model.closure)
        .map(|triangle| {
            let [a, b, c] = triangle.map(|node| positions.get(node as usize));
            a.dot(&b.cross(&c))
        })
        .sum();
    six / 6.0
}

/// Adds the oriented areas of the closing faces to those of the film; gives six times their share of
/// the volume, m³.
pub fn add_closure(model: &FilmModel, positions: &Field, forces: &mut NodeForces) -> f64 {
    let mut six = 0.0;
    for face in &model.closure {
        let [a, b, c] = face.map(|node| positions.get(node as usize));
        let normal = (b - a).cross(&(c - a));
        for node in face {
            forces.add_normal(*node as usize, normal);
        }
        six += a.dot(&b.cross(&c));
    }
    six
}

/// ω² of the gas as a spring (rad²/s²): `γ p/V Σ |P ∂V/∂x_i|²/m_i`, an upper bound of what gas of
/// bulk stiffness γ p (Pa) adds to any mode; a rigid plane counts as one node of its mass.
pub fn gas_frequency_squared(
    model: &FilmModel,
    supports: &Supports,
    forces: &NodeForces,
    stiffness: f64,
    volume: f64,
) -> f64 {
    let node = |node: usize, area: Vector3<f64>| area.norm_squared() * model.inverse_mass[node];
    let mut mobility = 0.0;
    for own in 0..model.nodes() {
        mobility += node(own, forces.area(own).component_mul(&supports.free.get(own)));
    }
    for (own, projector) in &supports.oblique {
        let own = *own as usize;
        let all = forces.area(own).component_mul(&supports.free.get(own));
        mobility += node(own, projector * forces.area(own)) - node(own, all);
    }
    for body in &supports.bodies {
        let push: f64 =
            body.nodes.iter().map(|own| forces.area(*own as usize).dot(&body.plane.normal)).sum();
        mobility += push * push / body.mass(model);
    }
    stiffness / volume * mobility
}
