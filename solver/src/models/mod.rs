//! Models, from cheap to complete, behind one interface: `Scene` → `Deployment`.
//!
//! [`solve`] runs the model that a scene names. Each model is one entry of a table (`ModelEntry`);
//! a model without an entry does not compile.
//!
//! The film model compares a run with static equilibria of the same mesh ([`reference()`]). It does not
//! compute them in every run: [`reference_scene`] says which scene they belong to, so that runs of
//! one design share them.

use crate::models::run::Observer;
use crate::output::measures::Reference;
use crate::output::outcome::Deployment;
use crate::platform::simd::InstructionSet;
use crate::scene::error::SceneError;
use crate::scene::{ModelKind, Scene};

pub mod film;
pub mod piston;
pub mod run;

/// Everything in which models differ. To add a model: a variant of [`ModelKind`], a folder with its
/// entry, and an arm of [`entry`].
struct ModelEntry {
    /// Name, as in `solver.model`.
    name: &'static str,
    /// [`check`].
    check: fn(&Scene) -> Result<(), SceneError>,
    /// [`cost`].
    cost: fn(&Scene) -> Result<Cost, SceneError>,
    /// Static reference; `None` for a model that computes its own in every run.
    reference: Option<ReferenceEntry>,
    /// [`solve`].
    solve: SolveFn,
}

/// A run of a scene: [`solve`].
type SolveFn = fn(
    InstructionSet,
    &Scene,
    Option<Reference>,
    &mut dyn Observer,
) -> Result<Deployment, SceneError>;

/// A search for a static reference: [`reference()`].
type ReferenceFn =
    fn(InstructionSet, &Scene, &mut dyn FnMut() -> bool) -> Result<Reference, SceneError>;

/// The static reference of a model.
struct ReferenceEntry {
    /// [`reference_scene`].
    scene: fn(&Scene) -> Scene,
    /// [`reference()`].
    solve: ReferenceFn,
}

/// The entry of a model.
fn entry(model: ModelKind) -> ModelEntry {
    match model {
        ModelKind::Piston => piston::ENTRY,
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
///
/// # Errors
/// [`SceneError`] if the scene cannot be started.
pub fn cost(scene: &Scene) -> Result<Cost, SceneError> {
    (entry(scene.solver.model).cost)(scene)
}

/// The scene whose [`reference()`] a run of this scene is compared with. Everything that does not
/// affect static equilibria has its default, so equal references have equal scenes. `None` for a model
/// that computes its own reference.
pub fn reference_scene(scene: &Scene) -> Option<Scene> {
    entry(scene.solver.model).reference.map(|reference| (reference.scene)(scene))
}

/// The static equilibria of a [`reference_scene`]. The search calls `continues` at every iteration
/// and ends when it returns `false`.
///
/// # Errors
/// [`SceneError`] if the capsule cannot be built, has no such equilibrium, or its model has no
/// reference; or if `continues` returned `false`.
pub fn reference(
    instruction_set: InstructionSet,
    scene: &Scene,
    continues: &mut dyn FnMut() -> bool,
) -> Result<Reference, SceneError> {
    let ModelEntry { name, reference, .. } = entry(scene.solver.model);
    let Some(reference) = reference else {
        let problem = format!("model `{name}` has no stored static reference; allowed: film");
        return Err(SceneError::Invalid { key: "solver.model".to_owned(), problem });
    };
    (reference.solve)(instruction_set, scene, continues)
}

/// Runs a scene on the model it names and judges it against `reference`. Without a reference there
/// is no verdict, unless the model computes its own. Every instruction set gives the same bits.
///
/// # Errors
/// [`SceneError`] if the scene cannot be started.
pub fn solve(
    instruction_set: InstructionSet,
    scene: &Scene,
    reference: Option<Reference>,
    observer: &mut dyn Observer,
) -> Result<Deployment, SceneError> {
    (entry(scene.solver.model).solve)(instruction_set, scene, reference, observer)
}
