//! Fold patterns of inflatable capsules and their deployment: pure computation.
//!
//! A [`Scene`](scene::Scene) holds everything one run needs. [`solve`](models::solve) turns it into a
//! [`Deployment`](output::outcome::Deployment): history, measures and audit. This crate knows nothing of
//! studies, files, clocks, threads or terminals.
//!
//! **Units.** SI throughout, `f64`, angles in radians.
//!
//! **Frame.** z is the axis of the capsule and points from the bottom ring (z = 0) to the top. Angles are
//! counter-clockwise seen from above. The nodes of a triangle are counter-clockwise seen from outside, so
//! normals point outward.
//!
//! **Bits.** Transcendental functions come from the `libm` crate alone, and no operation is contracted to
//! a fused multiply-add. A job gives the same bits on any x86-64 machine and on every instruction set.
//!
//! **Folders.** Each uses only those below it:
//!
//! | folder | holds |
//! |---|---|
//! | [`models`] | the models: piston, storeys, film; the run loop |
//! | [`statics`] | static equilibrium |
//! | [`integrators`] | time integration: explicit central differences, Dormand-Prince |
//! | [`system`] | film as a system: constants, state, forces and energies of any state |
//! | [`output`] | history, frames, measures, ledger, audit, events, checkpoint |
//! | [`factorisation`] | sparse factorisation of the film's stiffness |
//! | [`collision`] | broad phase, distances, contact, intersections, tunnelling monitor |
//! | [`mechanics`] | material, membrane, pressure, gas, supports |
//! | [`scene`] | everything one run needs: plain data |
//! | [`geometry`] | fold pattern, mesh, topology, OBJ and FOLD text |
//! | [`platform`] | vector instructions, stopwatch, fault injection |
//!
//! Equation numbers refer to "Research on the Folding Patterns and Deployment Dynamics of Inflatable
//! Capsule Structures", unless a comment names another source.

pub mod bending;
pub mod collision;
pub mod factorisation;
pub mod geometry;
pub mod integrators;
pub mod mechanics;
pub mod models;
pub mod output;
pub mod platform;
pub mod scene;
pub mod statics;
pub mod system;

/// Version of the physics: part of every job id. It increases with every change of the solver that changes
/// a result.
pub const PHYSICS_VERSION: u32 = 7;
