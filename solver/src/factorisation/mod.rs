//! Sparse Cholesky factorisation of a film's stiffness, front by front.
//!
//! ```text
//! K + diag(shift) = L Lᵀ
//! ```
//!
//! [`unknowns`]: displacements along the free directions of the supports. [`order`]: nested dissection of the
//! nodes. [`plan`]: the fronts of a film. [`dense`]: the elimination of one front. [`factor`]: the whole.
//! [`conjugate_gradients`]: where the factor is that of another matrix. Statics and implicit integrators share them.
//! [`constant`]: a matrix that stays while it is solved often.

pub mod conjugate_gradients;
pub mod constant;
pub mod dense;
pub mod factor;
pub mod order;
pub mod plan;
pub mod unknowns;
