//! Pressure on closed film: volume and its exact gradient.
//!
//! ```text
//! V = Σ_e x0·(x1 × x2)/6            f_i = (p − p_ambient) ∂V/∂x_i
//! ∂V/∂x_i = Σ_e (x1 − x0) × (x2 − x0)/6      over the elements e at node i
//! ```
//!
//! Divergence theorem over the closed surface. The gradient is written by oriented areas, which do
//! not depend on the origin; round the closed fan of a node they add up to the derivative of V.
//! Whatever the gas does through V and the film through f is thus the same p dV. The areas come
//! from [`super::membrane::element_pass`].

use crate::model::FilmModel;
use crate::state::Field;

/// Enclosed volume at these positions (m), m³.
pub fn volume(model: &FilmModel, positions: &Field) -> f64 {
    let six: f64 = model
        .triangles
        .iter()
        .map(|triangle| {
            let [a, b, c] = triangle.map(|node| positions.get(node as usize));
            a.dot(&b.cross(&c))
        })
        .sum();
    six / 6.0
}

/// ω² of the gas as a spring (rad²/s²): `γ p/V Σ |∂V/∂x_i|²/m_i`, an upper bound of what gas of
/// bulk stiffness γ p adds to any mode.
pub fn gas_frequency_squared(model: &FilmModel, area: &Field, stiffness: f64, volume: f64) -> f64 {
    let mobility: f64 =
        area.iter().zip(&model.mass).map(|(area, mass)| area.norm_squared() / mass).sum();
    stiffness / volume * mobility
}
