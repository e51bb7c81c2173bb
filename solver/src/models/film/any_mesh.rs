//! Film from a mesh as the film of a scene: its shape at the start, or free of stress, and its contact.

use crate::models::film::imperfection;
use crate::platform::simd::InstructionSet;
use crate::scene::error::SceneError;
use crate::scene::film_scene::{FilmContact, FilmScene};
use crate::scene::{MeshFilm, Scene};

use super::capsule::assembled;

/// The film of a scene at the start, with the imperfection of its seed, without contact, at this CFL number. Nodes of
/// supports stay where they are.
pub(super) fn at_start(
    instruction_set: InstructionSet,
    scene: &Scene,
    film: &MeshFilm,
    cfl: f64,
) -> Result<FilmScene, SceneError> {
    scene.validate()?;
    let mut shell = film.shell.clone();
    let amplitude = scene.imperfection_amplitude.unwrap_or(film.imperfection_amplitude);
    let mut held = vec![false; shell.positions.len()];
    for node in film.supports.iter().flat_map(|support| &support.nodes) {
        held[*node as usize] = true;
    }
    imperfection::displace(&mut shell.positions, &held, scene.seed, amplitude);
    Ok(assembled(instruction_set, scene, shell, film.supports.clone(), cfl))
}

/// The film of a scene where it is free of stress, without contact; where its mesh does not know that shape, as it starts
/// without imperfection.
pub(super) fn unstressed(
    instruction_set: InstructionSet,
    scene: &Scene,
    film: &MeshFilm,
    cfl: f64,
) -> Result<FilmScene, SceneError> {
    scene.validate()?;
    let mut shell = film.shell.clone();
    if let Some(positions) = &film.unstressed {
        shell.positions.clone_from(positions);
    }
    Ok(assembled(instruction_set, scene, shell, film.supports.clone(), cfl))
}

/// Contact of this film: with its distance where none is given, and without its pairs that touch at the start.
pub(super) fn resolved_contact(contact: FilmContact, film: &MeshFilm) -> FilmContact {
    let distance = Some(contact.distance.unwrap_or(film.contact_distance));
    FilmContact { distance, ignored: film.ignored.clone(), ..contact }
}
