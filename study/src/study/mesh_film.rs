//! Film from a mesh file in a study: read once for each number of subdivisions.

use std::collections::BTreeMap;
use std::sync::Arc;

use super::column::Column;
use super::grid::Grid;
use super::meshes::SUBDIVISIONS;
use crate::input::json::Json;
use crate::input::sections::has_mesh;
use crate::input::settings::Settings;
use crate::input::source::Source;
use crate::input::value::Value;
use crate::platform::error::InputError;
use crate::scene::file::design_mesh::{self, StudyMesh};

/// Reads the film of a study with a mesh on the subdivisions of its file, by default 1, and puts the text of its
/// surfaces into the study. Returns what a reader of its results must know.
pub(super) fn read_first(
    tree: &mut Json,
    settings: &mut Settings,
    source: &Source,
) -> Result<Vec<String>, InputError> {
    if !has_mesh(tree) {
        return Ok(Vec::new());
    }
    if tree.get("design").and_then(|design| design.get("subdivisions")).is_none() {
        settings.set(SUBDIVISIONS, Value::Integer(1));
    }
    let n = settings.count("design.subdivisions", source)?;
    let Some(StudyMesh { design, stored, notes }) = design_mesh::read(tree, settings, n, source)?
    else {
        return Ok(Vec::new());
    };
    settings.meshes = Arc::new(BTreeMap::from([(n, design)]));
    design_mesh::store(tree, stored);
    Ok(notes)
}

/// Reads the film of a study with a mesh on further subdivisions.
pub(super) fn read_others(
    tree: &Json,
    settings: &mut Settings,
    meshes: &[u32],
    source: &Source,
) -> Result<(), InputError> {
    for n in meshes {
        if !settings.meshes.is_empty()
            && !settings.meshes.contains_key(n)
            && let Some(mesh) = design_mesh::read(tree, settings, *n, source)?
        {
            Arc::make_mut(&mut settings.meshes).insert(*n, mesh.design);
        }
    }
    Ok(())
}

/// Refuses keys of the fold design on the grid of film from a mesh.
pub(super) fn refuse_design_keys(
    settings: &Settings,
    grid: &Grid,
    source: &Source,
) -> Result<(), InputError> {
    let is_of_design =
        |column: &&Column| column.key.path.starts_with("design.") && column.index != SUBDIVISIONS;
    let given = grid.columns.iter().find(is_of_design).filter(|_| !settings.meshes.is_empty());
    let Some(column) = given else { return Ok(()) };
    let problem = "belongs to the fold pattern, and design.mesh has none";
    let allowed = "keys of film, gas, contact, strategies, …; a study for each mesh";
    Err(source.error(&format!("grid.{}", column.name), "", problem, allowed))
}
