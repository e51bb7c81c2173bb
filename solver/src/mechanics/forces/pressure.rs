//! Pressure on closed film: enclosed volume and its exact gradient.
//!
//! ```text
//! V = Σ_e x0·(x1 × x2)/6            f_i = (p − p_ambient) ∂V/∂x_i
//! ∂V/∂x_i = Σ_e (x1 − x0) × (x2 − x0)/6      over the elements e at node i
//! ```
//!
//! Divergence theorem over the closed surface. The gradient uses oriented areas, which do not depend on
//! the origin; over the closed fan of elements at a node they sum to the derivative of V. The work of
//! the gas through V and that of the film through f are therefore the same p dV.
//! [`super::membrane::assemble_membrane`] computes the part of the film, [`add_closure`] that of the
//! closing faces.

use nalgebra::Vector3;

use super::membrane::NodeForces;
use crate::geometry::field::Field;
use crate::mechanics::closure::NormalSums as _;
use crate::mechanics::film_model::FilmModel;
use crate::mechanics::supports::Supports;

/// Enclosed volume at these positions (m), m³.
pub fn volume(model: &FilmModel, positions: &Field) -> f64 {
    let six: f64 = model
        .triangles
        .iter()
        .chain(&model.closure)
        .map(|triangle| {
            let [a, b, c] = positions.at(*triangle);
            a.dot(&b.cross(&c))
        })
        .sum();
    six / 6.0
}

/// Adds the normals of the closing faces to those of the film; those of vertices without film go to their
/// rims. Returns six times their part of the volume, m³.
pub fn add_closure(model: &FilmModel, positions: &Field, forces: &mut NodeForces) -> f64 {
    let mut six = 0.0;
    for face in &model.closure {
        let [a, b, c] = positions.at(*face);
        let normal = (b - a).cross(&(c - a));
        for node in face {
            forces.add_normal(*node as usize, normal);
        }
        six += a.dot(&b.cross(&c));
    }
    model.closure_nodes.distribute(positions, forces);
    six
}

/// ω² of the gas as a spring, rad²/s²: `γ p/V Σ |P ∂V/∂x_i|²/m_i`.
///
/// `stiffness` is the bulk stiffness γ p (Pa), `volume` is V (m³), P projects onto the free directions.
/// An upper bound of what the gas adds to ω² of any mode. A rigid plane counts as one node with the
/// mass of the plane and its film.
pub fn gas_frequency_squared(
    model: &FilmModel,
    supports: &Supports,
    forces: &NodeForces,
    stiffness: f64,
    volume: f64,
) -> f64 {
    let node_mobility =
        |node: usize, area: Vector3<f64>| area.norm_squared() * model.inverse_mass[node];
    let mut mobility = 0.0;
    for node in 0..model.nodes() {
        mobility += node_mobility(node, forces.area(node).component_mul(&supports.free.get(node)));
    }
    // An oblique node was counted with its axis-aligned part: replace that by its projection.
    for (node, projector) in &supports.oblique {
        let node = *node as usize;
        let axis_aligned = forces.area(node).component_mul(&supports.free.get(node));
        mobility +=
            node_mobility(node, projector * forces.area(node)) - node_mobility(node, axis_aligned);
    }
    for body in &supports.bodies {
        let area: f64 =
            body.nodes.iter().map(|node| forces.area(*node as usize).dot(&body.plane.normal)).sum();
        mobility += area * area / body.mass(model);
    }
    stiffness / volume * mobility
}
