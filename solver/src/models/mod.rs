//! Models from cheap to full behind one interface: Scene → Deployment.
//!
//! [`solve`] runs the model a scene names. A model that is judged against static states of its own
//! mesh does not look for them in every run: [`reference_scene`] says which they are, so that runs of
//! one design can share them.

use crate::models::run::Observer;
use crate::output::measures::Reference;
use crate::output::outcome::Deployment;
use crate::scene::error::SceneError;
use crate::scene::{ModelKind, Scene};

pub mod film;
pub mod piston;
pub mod run;

/// Whether the model a scene names can run it, as far as that shows without solving its pattern.
///
/// # Errors
/// [`SceneError::Invalid`] with the key, what is wrong and, after a semicolon, what is allowed.
pub fn check(scene: &Scene) -> Result<(), SceneError> {
    match scene.solver.model {
        ModelKind::Piston => piston::check(scene),
        ModelKind::Film => film::check(scene),
    }
}

/// What a run takes, as far as that shows before it.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub struct Cost {
    /// Elements of the mesh; 0 for a model without one.
    pub elements: u64,
    /// Steps, about, of film that never gets calm and takes longer ones; 0 where the model chooses them on its way.
    pub steps: u64,
}

/// What a run of a scene takes.
///
/// # Errors
/// [`SceneError`] when the scene cannot be started.
pub fn cost(scene: &Scene) -> Result<Cost, SceneError> {
    match scene.solver.model {
        ModelKind::Piston => Ok(Cost::default()),
        ModelKind::Film => film::cost(scene),
    }
}

/// The scene whose [`reference()`] a run of this one is judged against: all that does not matter to
/// static states at its default, so that equal references are equal scenes. `None` for a model that
/// knows its own.
pub fn reference_scene(scene: &Scene) -> Option<Scene> {
    match scene.solver.model {
        ModelKind::Piston => None,
        ModelKind::Film => Some(film::reference_scene(scene)),
    }
}

/// Static states of a [`reference_scene`], for as long as `goes_on` says so, which is asked now and
/// then.
///
/// # Errors
/// [`SceneError`] when the capsule cannot be made, or has no such state, or `goes_on` said no.
pub fn reference(
    scene: &Scene,
    goes_on: &mut dyn FnMut() -> bool,
) -> Result<Reference, SceneError> {
    film::static_reference_while(scene, goes_on)
}

/// Runs a scene on the model it names, judged against `reference`; without one (and with a model that
/// does not know its own) there is no verdict.
///
/// # Errors
/// [`SceneError`] when the scene cannot be started.
pub fn solve(
    scene: &Scene,
    reference: Option<Reference>,
    observer: &mut dyn Observer,
) -> Result<Deployment, SceneError> {
    match scene.solver.model {
        ModelKind::Piston => piston::solve(scene, observer),
        ModelKind::Film => film::solve_scene(scene, reference, observer),
    }
}
