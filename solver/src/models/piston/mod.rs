//! Model `piston`: one moving mass on one gas volume. Honest physics at the least cost.
//!
//! ```text
//! m_eff z̈ = (p − p_ambient) dV/dz + g ∫ξ dm − k ⟨z − H⟩ − c ż
//! m_eff = ∫ ξ² dm                                   v(ξ) = ξ ż, ξ share of the erected height
//! V(z): Hermite cubic from (z_s, V_s) to (H, V_e), dV/dz = V/z at both ends
//! k = 2π E t cos³φh (r2 − r1)/(H ln(r2/r1)),        c = 2ζ √(k m_eff) while z > H
//! ```
//!
//! Symbols: z height of the top ring above the bottom ring, m; `z_s` stowed, H erected height, m;
//! V volume, m³; p pressure of [`crate::mechanics::gas`], Pa; g gravity along z, m/s²; E, t, ζ film modulus,
//! thickness and damping ratio; r2, r1 bottom and top radius, m; φh half top angle. The sources of
//! each are in the rooms below.
//!
//! One degree of freedom: every point of the film rises in proportion to its place on the erected
//! cone. The three heights of a history are one and the same here.
//!
//! **Limits.** No shape on the way: no rebound of single storeys, no wrinkles, no locking by folds
//! that stick, no contact and so no film that holds the stack up from below (a capsule pressed
//! below z = 0 stops as `inverted_volume`). Twist carries no inertia. Film compression, contact,
//! friction, adhesion, mesh subdivisions and the seed change nothing, so that the same scene can be
//! compared along the ladder. Against the film model on the paper's capsule
//! (5 g/s from 0) times are early by up to 25 %; peak speed comes out 65-75 % too high and peak
//! kinetic energy 40-60 %, because a lone mass spends nothing on twist, radial motion and the
//! viscosity of opening folds: read both as upper bounds. A piston deploys whenever it is given gas
//! enough, so it answers how fast, not whether.

use crate::geometry::fold::FoldPattern;
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
///
/// # Errors
/// [`SceneError`] when the scene cannot be started: the design is none, a value is out of range, or
/// the supports are not those of a piston (bottom held along z, top free along it).
pub fn solve(scene: &Scene, observer: &mut dyn Observer) -> Result<Deployment, SceneError> {
    let mut run = PistonRun::from_scene(scene)?;
    Ok(run::run(&mut run, &Timeline::new(scene), observer))
}

/// Whether a scene is sound and its supports are those of a piston.
pub(super) fn check(scene: &Scene) -> Result<(), SceneError> {
    scene.validate()?;
    if let Stepping::Stable(_) = scene.solver.stepping {
        return Err(SceneError::Invalid {
            key: "solver.cfl".to_owned(),
            problem: "model `piston` has no stable step; allowed: adaptive or fixed stepping"
                .to_owned(),
        });
    }
    from_scene::check_supports(scene)
}

impl PistonRun {
    /// The scene's piston, stowed, at time 0.
    ///
    /// # Errors
    /// As [`solve`].
    pub fn from_scene(scene: &Scene) -> Result<Self, SceneError> {
        check(scene)?;
        let pattern = FoldPattern::new(&scene.design)?;
        from_scene::build(scene, &pattern)
    }
}
