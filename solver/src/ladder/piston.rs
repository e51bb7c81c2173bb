//! One moving mass on one gas volume.

use super::SceneError;
use crate::deployment::{Deployment, Observer};
use crate::scene::Scene;

/// Runs a scene as a piston.
///
/// # Errors
/// [`SceneError`] when the scene cannot be started.
pub fn solve(scene: &Scene, observer: &mut dyn Observer) -> Result<Deployment, SceneError> {
    let _ = (scene, observer);
    todo!()
}
