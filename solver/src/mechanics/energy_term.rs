//! A further energy of the film, beside those of membrane, gas, gravity and contact.
//!
//! ```text
//! f = −∂Π/∂x        K = ∂²Π/∂x²        ω² ≥ largest eigenvalue of M⁻¹ K
//! ```
//!
//! Every integrator adds the terms of its system to forces, energy and stable step. A system without terms
//! pays nothing for them. A term may yield: what it keeps of that is part of the state of the film, zero at first.

use core::fmt;

use nalgebra::{DMatrix, Matrix3};

use crate::geometry::field::Field;

/// Receives the 3 × 3 blocks of a stiffness: two nodes, and ∂²Π/∂x₁∂x₂, N/m. Blocks of the same nodes add up;
/// both blocks of two different nodes are given.
pub type Blocks<'a> = &'a mut dyn FnMut([u32; 2], &Matrix3<f64>);

/// The stiffness of a term at some positions.
#[derive(Debug, Clone, Copy)]
pub struct Prepared<'a> {
    /// The positions, m.
    pub positions: &'a Field,
    /// Its patches there, N/m.
    pub patches: &'a [DMatrix<f64>],
}

/// Energies of yielding at fixed positions, J.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct Yielding {
    /// Work of the forces that remain along what yielded.
    pub work: f64,
    /// Decrease of Π, at least that work.
    pub released: f64,
}

/// An energy that is a function of the positions of the nodes, and of what the term has yielded.
pub trait EnergyTerm: fmt::Debug + Send + Sync {
    /// Π at these positions (m), J.
    fn energy(&self, positions: &Field, yielded: &[f64]) -> f64;

    /// Adds −∂Π/∂x of each node (N) to `forces`.
    fn add_forces(&self, positions: &Field, yielded: &[f64], forces: &mut Field);

    /// Number of values that the term keeps of its yielding.
    fn yield_values(&self) -> usize {
        0
    }

    /// Yields at these positions (m), at the end of a step.
    fn let_yield(&self, _positions: &Field, _yielded: &mut [f64]) -> Yielding {
        Yielding::default()
    }

    /// Sets of nodes, patches: constant.
    fn patches(&self) -> Vec<Vec<u32>>;

    /// Sets a matrix for each patch at these positions (m), N/m; row 3 c + k for the component k of its corner c. Their
    /// sum is K, or near it and easier to factorise.
    fn stiffness(&self, positions: &Field, yielded: &[f64], patches: &mut [DMatrix<f64>]);

    /// Adds K u, N, of displacements u (m) to `products`.
    fn add_product(&self, stiffness: &Prepared<'_>, displacements: &Field, products: &mut Field);

    /// Whether its forces may act every few steps of central differences instead of at each: they drive only motions that
    /// are slow.
    fn is_slow(&self) -> bool {
        false
    }

    /// Upper bound of what the term adds to the square of any frequency of film with these masses (kg),
    /// rad²/s².
    fn frequency_squared(&self, mass: &[f64]) -> f64;
}
