//! Model `storeys`: rings of film that rise, turn and widen, on one gas volume.
//!
//! ```text
//! each ring and each line half way up a storey, in eight strips:   m ẍ = −∂/∂x (film energy) + (p − p_a) ∂V/∂x + m g
//! film    tension field of Green strain along the strip, around the axis, and shear
//! V       Σ π/3 Δz (ra² + ra rb + rb²), mean of the strips         p of [`crate::mechanics::gas`]
//! ```
//!
//! Coordinates of a ring: height, twist and radius. A strip is an eighth of the circumference. It has its own
//! coordinates, and shares with the others the gas alone; so storeys open, rebound and turn in every strip
//! for itself, and the top ring moves by their mean. The modules below give equations and sources.
//!
//! A static V(z, twist) cannot stand for the folded storey: at rest, film at a given height fills its whole
//! cone, while film that is pulled up is drawn towards the axis. So the radius is a coordinate, with its inertia.
//!
//! **Limits.** No panels and facets: what folds within a ring has no inertia and no energy. No contact, so
//! no friction, no adhesion, and film that falls back passes through film; no compression, so the model
//! cannot lock. The loss of motion within a ring is a multiple of the film's ([`UNRESOLVED_LOSS`]).

use crate::models::run::{self, Observer};
use crate::output::outcome::Deployment;
use crate::platform::simd::{InstructionSet, WIDTH};
use crate::scene::Scene;
use crate::scene::error::SceneError;
use crate::scene::timeline::Timeline;

pub(super) mod from_scene;
mod kernel;
mod motion;
mod rest;
mod strip;

pub use motion::StoreysRun;

/// Strips around the axis: one a lane.
pub const STRIPS: usize = WIDTH;

/// Loss factor of a strip over that of the film. Calibrated: median `t_90_z_rim` of film at 8 subdivisions on
/// 15 designs (docs/theory/storeys.md). The film loses energy in vibrations of its facets, which a strip does
/// not have.
pub const UNRESOLVED_LOSS: f64 = 2.9;

/// Runs a scene as storeys.
pub fn solve(
    instruction_set: InstructionSet,
    scene: &Scene,
    observer: &mut dyn Observer,
) -> Result<Deployment, SceneError> {
    let mut run = StoreysRun::from_scene(instruction_set, scene)?;
    Ok(run::run(&mut run, &Timeline::new(scene), observer))
}

impl StoreysRun {
    /// The storeys of a scene, stowed, at time 0.
    pub fn from_scene(instruction_set: InstructionSet, scene: &Scene) -> Result<Self, SceneError> {
        from_scene::check(scene)?;
        let pattern = scene.design.pattern()?;
        Ok(from_scene::build(instruction_set, scene, &pattern))
    }
}
