//! Model `piston`: one moving mass on one gas volume. The cheapest model.
//!
//! ```text
//! m_eff z̈ = (p − p_ambient) dV/dz + g ∫ξ dm − k ⟨z − H⟩ − c ż
//! m_eff = ∫ ξ² dm                                   v(ξ) = ξ ż, ξ height over erected height
//! V(z): Hermite cubic from (z_s, V_s) to (H, V_e), dV/dz = V/z at both ends
//! k = 2π E t cos³φh (r2 − r1)/(H ln(r2/r1)),        c = 2ζ √(k m_eff) while z > H
//! ```
//!
//! Symbols: z height of the top ring above the bottom ring, m; `z_s` stowed, H erected height, m;
//! V volume, m³; p pressure of [`crate::mechanics::gas`], Pa; g gravity along z, m/s²; E, t, ζ film modulus,
//! thickness and damping ratio; r2, r1 bottom and top radius, m; φh half top angle. The modules
//! below give the source of each equation.
//!
//! One degree of freedom: every point of the film rises in proportion to its height on the erected cone.
//! The three heights of a history are equal.
//!
//! **Limits.** The model has no shape: no rebound of single storeys, no wrinkles, no folds that stick. It
//! has no contact, so nothing supports the stack from below; a capsule pressed below z = 0 stops as
//! `inverted_volume`. Twist has no inertia. Film compression, contact, friction, adhesion, mesh
//! subdivisions and the seed have no effect, so the same scene runs on every model. Compared with the
//! film model on the paper's capsule (5 g/s from time 0), times are up to 25 % too early, the peak upward velocity
//! is 65-75 % too high and the peak kinetic energy 40-60 % too high: a single mass spends no energy on
//! twist, radial motion and the loss in opening folds. Read both as upper bounds. A piston deploys
//! whenever it has enough gas, so its verdict says nothing of locking.

use crate::models::run::{self, Observer};
use crate::output::outcome::Deployment;
use crate::scene::error::SceneError;
use crate::scene::timeline::Timeline;
use crate::scene::{Scene, Stepping};

mod end_film;
mod from_scene;
mod mass;
mod motion;
mod volume;

pub use end_film::{EndFilm, EndState};
pub use mass::MovingMass;
pub use motion::{Motion, Piston, PistonRun, PistonState};
pub use volume::{Stroke, VolumeLaw};

/// Runs a scene as a piston.
pub fn solve(scene: &Scene, observer: &mut dyn Observer) -> Result<Deployment, SceneError> {
    let mut run = PistonRun::from_scene(scene)?;
    Ok(run::run(&mut run, &Timeline::new(scene), observer))
}

/// Checks a scene, its stepping and its supports for this model.
pub(super) fn check(scene: &Scene) -> Result<(), SceneError> {
    scene.validate()?;
    scene.design.folded()?;
    if let Stepping::Stable(_) = scene.solver.stepping {
        let problem = "model `piston` has no stable step; allowed: adaptive or fixed stepping";
        return Err(SceneError::invalid("solver.cfl", problem));
    }
    from_scene::check_supports(scene)
}

impl PistonRun {
    /// The piston of a scene, stowed, at time 0.
    pub fn from_scene(scene: &Scene) -> Result<Self, SceneError> {
        check(scene)?;
        let pattern = scene.design.pattern()?;
        from_scene::build(scene, &pattern)
    }
}
