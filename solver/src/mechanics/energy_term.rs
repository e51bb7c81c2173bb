//! A further energy of the film, beside those of membrane, gas, gravity and contact.
//!
//! ```text
//! f = −∂Π/∂x        K = ∂²Π/∂x²        ω² ≤ largest eigenvalue of M⁻¹ K
//! ```
//!
//! Every integrator adds the terms of its system to forces, energy and stable step. A system without terms
//! pays nothing for them.

use core::fmt;

use nalgebra::Matrix3;

use crate::geometry::field::Field;

/// Receives the 3 × 3 blocks of a stiffness: two nodes, and ∂²Π/∂x₁∂x₂, N/m. Blocks of the same nodes add up;
/// both blocks of two different nodes are given.
pub type Blocks<'a> = &'a mut dyn FnMut([u32; 2], &Matrix3<f64>);

/// An energy that is a function of the positions of the nodes.
pub trait EnergyTerm: fmt::Debug + Send + Sync {
    /// Π at these positions (m), J.
    fn energy(&self, positions: &Field) -> f64;

    /// Adds −∂Π/∂x of each node (N) to `forces`.
    fn add_forces(&self, positions: &Field, forces: &mut Field);

    /// Gives the blocks of K at these positions (m).
    fn stiffness(&self, positions: &Field, add: Blocks<'_>);

    /// Upper bound of what the term adds to the square of any frequency of film with these masses (kg),
    /// rad²/s².
    fn frequency_squared(&self, mass: &[f64]) -> f64;
}
