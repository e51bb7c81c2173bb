//! Collision detection and contact: broad phase, distances, contact model, collision response,
//! intersections, and the monitor that counts passages of film through film.

pub mod broad_phase;
pub mod contact;
pub mod monitor;
