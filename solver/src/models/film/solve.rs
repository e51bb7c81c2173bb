//! Runs of a scene: from the start, or from a checkpoint.

use super::{FilmRun, Rings, any_mesh, capsule, cfl_of};
use crate::geometry::mesh::Shape;
use crate::integrators::StoredFilm;
use crate::models::run::{Observer, Run};
use crate::models::{ResumeError, Stored};
use crate::output::checkpoint::Checkpoint;
use crate::output::outcome::Deployment;
use crate::platform::simd::InstructionSet;
use crate::scene::error::SceneError;
use crate::scene::film_scene::{FilmContact, FilmScene};
use crate::scene::timeline::Timeline;
use crate::scene::{Design, Scene};

/// Runs a scene as film with this contact and CFL number.
pub fn solve(
    instruction_set: InstructionSet,
    scene: &Scene,
    cfl: f64,
    contact: Option<FilmContact>,
    observer: &mut dyn Observer,
) -> Result<Deployment, SceneError> {
    complete(instruction_set, scene, (cfl, contact), None, observer)
}

/// Runs a scene with the contact and the CFL number of the scene.
pub fn solve_scene(
    instruction_set: InstructionSet,
    scene: &Scene,
    observer: &mut dyn Observer,
) -> Result<Deployment, SceneError> {
    let how = (cfl_of(scene)?, Some(FilmContact::of(&scene.contact)));
    complete(instruction_set, scene, how, None, observer)
}

/// Continues a run of [`solve_scene`] from its checkpoint.
pub fn resume_scene(
    instruction_set: InstructionSet,
    scene: &Scene,
    stored: &Stored<'_>,
    observer: &mut dyn Observer,
) -> Result<Deployment, ResumeError> {
    let checkpoint = Checkpoint::from_text(stored.text, stored.fingerprint)?;
    let how = (cfl_of(scene)?, Some(FilmContact::of(&scene.contact)));
    Ok(complete(instruction_set, scene, how, Some(checkpoint), observer)?)
}

/// A run at a CFL number with a contact, from time 0 or from a checkpoint.
fn complete(
    instruction_set: InstructionSet,
    scene: &Scene,
    (cfl, contact): (f64, Option<FilmContact>),
    checkpoint: Option<Checkpoint<StoredFilm, Run>>,
    observer: &mut dyn Observer,
) -> Result<Deployment, SceneError> {
    let (film, rings) = at_start(instruction_set, scene, cfl, contact)?;
    if !observer.prepares() {
        return Ok(Deployment::cancelled());
    }
    let (mut model, run) = match checkpoint {
        None => (FilmRun::of(&film, rings)?, Run::default()),
        Some(stored) => FilmRun::resume(&film, rings, &[], stored)?,
    };
    if !observer.prepares() {
        return Ok(Deployment::cancelled());
    }
    Ok(run.complete(&mut model, &Timeline::new(scene), observer))
}

/// The film of a scene as it starts, with this contact, and the rings of a capsule. Contact without a distance has the
/// default one of the design or of the mesh.
pub fn at_start(
    instruction_set: InstructionSet,
    scene: &Scene,
    cfl: f64,
    contact: Option<FilmContact>,
) -> Result<(FilmScene, Option<Rings>), SceneError> {
    match &scene.design {
        Design::Capsule(design) => {
            let height = design.stowed_height;
            let shape = Shape::Stowed(height);
            let (film, mesh) = capsule::film_scene(instruction_set, scene, shape, cfl)?;
            let resolved = |contact| capsule::resolved_contact(contact, design);
            let film = FilmScene { contact: contact.map(resolved).transpose()?, ..film };
            Ok((film, Some(Rings::of(&mesh, height))))
        }
        Design::Mesh(design) => {
            let film = any_mesh::at_start(instruction_set, scene, &design.film, cfl)?;
            let contact = contact.map(|contact| any_mesh::resolved_contact(contact, &design.film));
            Ok((FilmScene { contact, ..film }, None))
        }
    }
}
