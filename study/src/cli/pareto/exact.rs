//! The scenes with an exact answer: run once, then read from the results folder.

use super::super::instruction_set;
use crate::analysis::work_precision::{SceneRuns, from_stored};
use crate::cases::Rig;
use crate::cases::work_precision::SCENES;
use crate::platform::error::{Error, Result};
use crate::store::exact_scenes::ExactScene;
use crate::store::results::Results;

/// The runs of the scenes that are wanted. What is not stored is run on one thread and stored.
///
/// # Errors
/// A scene that fails; a file that cannot be written.
pub(super) fn scenes(
    results: &Results<'_>,
    wanted: &dyn Fn(&str) -> bool,
    quiet: bool,
) -> Result<Vec<SceneRuns>> {
    let mut stored = results.exact_scenes();
    let rig = Rig { instruction_set: instruction_set::selected()?, ..Rig::default() };
    let mut found = Vec::new();
    for scene in SCENES.iter().filter(|scene| wanted(scene.name)) {
        if let Some(known) = stored.iter().find(|known| known.name == scene.name) {
            found.push(from_stored(known));
            continue;
        }
        if !quiet {
            eprintln!("billow: runs the scene {} once (--study-only leaves it out)", scene.name);
        }
        let run: ExactScene = (scene.body)(&rig)
            .map_err(|problem| Error::JobsFailed(format!("scene {}: {problem}", scene.name)))?;
        found.push(from_stored(&run));
        stored.push(run);
        results.write_exact_scenes(&stored)?;
    }
    Ok(found)
}
