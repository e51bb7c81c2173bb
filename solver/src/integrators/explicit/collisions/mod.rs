//! Impulses before a drift: friction, and what keeps film from passing through film and plates.
//!
//! Contact gives forces and says which motion is safe; that a colliding pair gets an impulse instead of a
//! shorter step is the choice of this integrator.

mod friction;
mod plates;
mod response;
mod step;

pub(super) use friction::apply_friction;
pub(super) use plates::resolve as resolve_plate;
pub(super) use response::resolve_pairs;
pub(super) use step::{CollisionStep, Impulses};
