//! Models, from cheap to complete, behind one interface: `Scene` → `Deployment`.
//!
//! [`solve`] runs the model that a scene names. Each model is one entry of a table (`ModelEntry`);
//! a model without an entry does not compile.
//!
//! A run of the film model is compared with static equilibria of the same mesh, after it ended
//! ([`ladder`]). [`reference_scene`] says which scene they belong to, so that runs of one design share
//! them.

use crate::models::film::{Ladder, LadderState};
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

/// Everything in which models differ. To add a model: a variant of [`ModelKind`], a folder with its
/// entry, and an arm of [`entry`].
struct ModelEntry {
    /// Name, as in `solver.model`.
    name: &'static str,
    /// [`check`].
    check: fn(&Scene) -> Result<(), SceneError>,
    /// [`cost`].
    cost: fn(&Scene) -> Result<Cost, SceneError>,
    /// Static equilibria; `None` for a model that has them in closed form.
    reference: Option<ReferenceEntry>,
    /// [`solve`].
    solve: SolveFn,
    /// [`resume`]; `None` for a model without checkpoints.
    resume: Option<ResumeFn>,
}

/// A run of a scene: [`solve`].
type SolveFn = fn(InstructionSet, &Scene, &mut dyn Observer) -> Result<Deployment, SceneError>;

/// The rest of a run: [`resume`].
type ResumeFn =
    fn(InstructionSet, &Scene, &Stored<'_>, &mut dyn Observer) -> Result<Deployment, ResumeError>;

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

/// The static equilibria of a model.
struct ReferenceEntry {
    /// [`reference_scene`].
    scene: fn(&Scene) -> Scene,
    /// [`ladder`].
    ladder: fn(InstructionSet, &Scene, &[LadderState]) -> Result<Ladder, SceneError>,
}

/// The entry of a model.
fn entry(model: ModelKind) -> ModelEntry {
    match model {
        ModelKind::Piston => piston::ENTRY,
        ModelKind::Storeys => storeys::ENTRY,
        ModelKind::Film => film::ENTRY,
    }
}

/// Checks a scene for its model, as far as possible without solving its fold pattern.
///
/// # Errors
/// [`SceneError::Invalid`] with the key, the problem and, after a semicolon, what is allowed.
pub fn check(scene: &Scene) -> Result<(), SceneError> {
    (entry(scene.solver.model).check)(scene)
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
    (entry(scene.solver.model).cost)(scene)
}

/// The scene with whose [`ladder`] a run of this scene is compared. Everything that does not affect
/// static equilibria has its default, so equal ladders have equal scenes. `None` for a model that has its
/// equilibria in closed form.
pub fn reference_scene(scene: &Scene) -> Option<Scene> {
    entry(scene.solver.model).reference.map(|reference| (reference.scene)(scene))
}

/// The static equilibria of a [`reference_scene`], computed as they are asked for; `known` are computed
/// already.
pub fn ladder(
    instruction_set: InstructionSet,
    scene: &Scene,
    known: &[LadderState],
) -> Result<Ladder, SceneError> {
    let ModelEntry { name, reference, .. } = entry(scene.solver.model);
    let Some(reference) = reference else {
        let problem =
            format!("model `{name}` has its static equilibria in closed form; allowed: film");
        return Err(SceneError::Invalid { key: "solver.model".to_owned(), problem });
    };
    (reference.ladder)(instruction_set, scene, known)
}

/// Runs a scene on the model it names. A model with static equilibria in closed form judges its run; any
/// other run is judged with [`Deployment::judge`]. Every instruction set gives the same bits.
pub fn solve(
    instruction_set: InstructionSet,
    scene: &Scene,
    observer: &mut dyn Observer,
) -> Result<Deployment, SceneError> {
    (entry(scene.solver.model).solve)(instruction_set, scene, observer)
}

/// Continues a run from a checkpoint, with the bits of a run that was never stopped.
pub fn resume(
    instruction_set: InstructionSet,
    scene: &Scene,
    stored: &Stored<'_>,
    observer: &mut dyn Observer,
) -> Result<Deployment, ResumeError> {
    let ModelEntry { name, resume, .. } = entry(scene.solver.model);
    let Some(resume) = resume else {
        let problem = format!("model `{name}` has no checkpoints");
        return Err(CheckpointError::Invalid(problem).into());
    };
    resume(instruction_set, scene, stored, observer)
}
