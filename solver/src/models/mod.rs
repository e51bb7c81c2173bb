//! Models, from cheap to complete, behind one interface: `Scene` → `Deployment`.
//!
//! [`solve`] runs the model that a scene names. A model that a function below leaves out does not compile.
//!
//! A run of the film model is compared with static equilibria of the same mesh, after it ended
//! ([`ladder`]). [`reference_scene`] says which scene they belong to, so that runs of one design share
//! them.

use crate::models::film::Ladder;
use crate::models::run::Observer;
use crate::output::checkpoint::CheckpointError;
use crate::output::outcome::Deployment;
use crate::platform::simd::InstructionSet;
use crate::scene::error::SceneError;
use crate::scene::{ModelKind, Scene};

pub mod film;
pub mod piston;
pub mod run;
pub mod storeys;

/// A checkpoint that was stored.
#[derive(Debug, Clone, Copy)]
pub struct Stored<'a> {
    /// Fingerprint of its scene.
    pub fingerprint: &'a str,
    /// Its text.
    pub text: &'a str,
}

/// Why a run cannot be resumed.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
pub enum ResumeError {
    /// The scene cannot be started either.
    #[error(transparent)]
    Scene(#[from] SceneError),
    /// The checkpoint is damaged, or another one; the run can start from its beginning.
    #[error(transparent)]
    Checkpoint(#[from] CheckpointError),
}

/// Checks a scene for its model, as far as possible without solving its fold pattern.
///
/// # Errors
/// [`SceneError::Invalid`] with the key, the problem and, after a semicolon, what is allowed.
pub fn check(scene: &Scene) -> Result<(), SceneError> {
    match scene.solver.model {
        ModelKind::Piston => piston::check(scene),
        ModelKind::Storeys => storeys::from_scene::check(scene),
        ModelKind::Film => film::check(scene),
    }
}

/// The expected cost of a run.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub struct Cost {
    /// Elements of the mesh; 0 for a model without a mesh.
    pub elements: u64,
    /// Estimated number of steps if the film is never quiescent; 0 for a model that chooses its steps
    /// during the run.
    pub steps: u64,
}

/// The expected cost of a run of a scene.
pub fn cost(scene: &Scene) -> Result<Cost, SceneError> {
    match scene.solver.model {
        ModelKind::Piston | ModelKind::Storeys => Ok(Cost::default()),
        ModelKind::Film => film::cost(scene),
    }
}

/// The scene with whose [`ladder`] a run of this scene is compared. Everything that does not affect
/// static equilibria has its default, so equal ladders have equal scenes. `None` for a model that has its
/// equilibria in closed form.
pub fn reference_scene(scene: &Scene) -> Option<Scene> {
    (scene.solver.model == ModelKind::Film).then(|| film::reference_scene(scene))
}

/// The static equilibria of a [`reference_scene`], computed as they are asked for.
pub fn ladder(instruction_set: InstructionSet, scene: &Scene) -> Result<Ladder, SceneError> {
    if scene.solver.model == ModelKind::Film {
        return Ladder::new(instruction_set, scene);
    }
    let problem =
        "only model `film` has a ladder; others have their static equilibria in closed form";
    Err(SceneError::invalid("solver.model", problem))
}

/// Runs a scene on the model it names. A model with static equilibria in closed form judges its run; any
/// other run is judged with [`Deployment::judge`]. Every instruction set gives the same bits.
pub fn solve(
    instruction_set: InstructionSet,
    scene: &Scene,
    observer: &mut dyn Observer,
) -> Result<Deployment, SceneError> {
    match scene.solver.model {
        ModelKind::Piston => piston::solve(scene, observer),
        ModelKind::Storeys => storeys::solve(instruction_set, scene, observer),
        ModelKind::Film => film::solve_scene(instruction_set, scene, observer),
    }
}

/// Continues a run from a checkpoint, with the bits of a run that was never stopped. Only film has checkpoints.
pub fn resume(
    instruction_set: InstructionSet,
    scene: &Scene,
    stored: &Stored<'_>,
    observer: &mut dyn Observer,
) -> Result<Deployment, ResumeError> {
    match scene.solver.model {
        ModelKind::Film => film::resume_scene(instruction_set, scene, stored, observer),
        ModelKind::Piston | ModelKind::Storeys => {
            let problem = "this model has no checkpoints; model `film` has";
            Err(CheckpointError::Invalid(problem.to_owned()).into())
        }
    }
}
