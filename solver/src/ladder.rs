//! Models from cheap to full behind one interface: Scene → Deployment.
//!
//! [`solve`] runs the models a scene can name. [`film`] is not among them yet: it
//! is reached by its own name alone.

use crate::deployment::{Deployment, Observer};
use crate::fold::FoldError;
use crate::scene::{ModelKind, Scene};

pub mod film;
pub mod piston;

/// Why a scene cannot be run at all (a run that stops short is no error: see
/// [`crate::deployment::Stop`]).
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
pub enum SceneError {
    /// The fold design is invalid or infeasible.
    #[error(transparent)]
    Fold(#[from] FoldError),
    /// A key of the scene is out of range, or asks for what the model cannot do.
    #[error("{key}: {problem}")]
    Invalid {
        /// Dotted key, as in the scene's JSON.
        key: String,
        /// What is wrong, what is allowed.
        problem: String,
    },
}

/// Whether the model a scene names can run it, as far as that shows without solving its pattern.
///
/// # Errors
/// [`SceneError::Invalid`] with the key, what is wrong and, after a semicolon, what is allowed.
pub fn check(scene: &Scene) -> Result<(), SceneError> {
    match scene.solver.model {
        ModelKind::Piston => piston::check(scene),
    }
}

/// Runs a scene on the model it names.
///
/// # Errors
/// [`SceneError`] when the scene cannot be started.
pub fn solve(scene: &Scene, observer: &mut dyn Observer) -> Result<Deployment, SceneError> {
    match scene.solver.model {
        ModelKind::Piston => piston::solve(scene, observer),
    }
}
