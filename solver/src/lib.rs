//! Fold patterns of inflatable capsules and their deployment: pure computation.
//!
//! A [`Scene`](scene::Scene) holds everything one run needs; [`solve`](models::solve) turns it
//! into a [`Deployment`](deployment::Deployment) of history, measures and audit. Nothing here
//! knows of studies, files, clocks, threads or
//! terminals.
//!
//! **Units.** SI throughout, `f64`, angles in radians.
//!
//! **Frame.** z is the axis of the capsule, pointing from the bottom ring (z = 0) to the top;
//! angles turn counter-clockwise seen from above; triangles wind counter-clockwise seen from
//! outside, so normals point outward.
//!
//! **Bits.** Transcendental functions come from the `libm` crate alone, additions are plain, so a
//! job gives the same bits on any x86-64 machine.
//!
//! **Reading order.** [`fold`] (the geometry of the paper), [`mesh`] (nodes and triangles of a
//! pattern), [`scene`], [`gas`], [`ladder`] (the models), [`deployment`], [`ledger`],
//! [`measures`], [`audit`].
//!
//! The equation numbers are those of "Research on the Folding Patterns and Deployment Dynamics of
//! Inflatable Capsule Structures" unless a comment says otherwise.

pub mod collision;
pub mod geometry;
pub mod integrators;
pub mod mechanics;
pub mod models;
pub mod output;
pub mod platform;
pub mod scene;
pub mod statics;

/// Number of the physics: part of every job id, raised whenever a change of the solver changes
/// any result.
pub const PHYSICS_VERSION: u32 = 4;
