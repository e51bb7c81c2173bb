//! Overrides of keys that the grid varies.

use super::Grid;
use crate::input::keys::numerical;
use crate::input::keys::{KEYS, position};
use crate::input::source::Source;
use crate::platform::error::InputError;
use crate::study::target::Target;

/// The key of the mesh.
const MESH: usize = position(KEYS, numerical::MESH);

/// Refuses an override of a key that the grid varies: it has no effect.
pub(in crate::study) fn refuse_varied(grid: &Grid, source: &Source) -> Result<(), InputError> {
    for (path, _) in &source.sets {
        let varied = grid.columns.iter().enumerate().find(|(index, column)| {
            let on_axis = grid.axes.iter().any(|axis| axis.columns.contains(index));
            on_axis && matches!(column.target, Target::Key(key) if KEYS[key].path == path)
        });
        if let Some((index, column)) = varied {
            let name = &column.name;
            if grid.meshes().len() > 1 && KEYS[MESH].path == path {
                let problem =
                    "solver.meshes gives the meshes of each point, so the override has no effect";
                let allowed = "--set 'solver.meshes=[4, 8]'";
                return Err(source.error(path, "", problem, allowed));
            }
            if grid.is_replicate(index) {
                let problem = "the study repeats each point with values of this key, so the override has no effect";
                let allowed = format!("--set 'replicates.{name}=[…]'");
                return Err(source.error(path, "", problem, allowed));
            }
            return Err(source.error(
                path,
                "",
                "the grid varies this key together with others (zip), so the override has no effect",
                format!("--set 'grid.zip=[{{\"{name}\": […], …}}]'"),
            ));
        }
    }
    Ok(())
}
