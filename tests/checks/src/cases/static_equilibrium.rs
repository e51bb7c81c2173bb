//! What the static cases share: the static equilibrium of a scene, and means over nodes.

use std::ops::ControlFlow;

use billow_solver::scene::film_scene::FilmScene;
use billow_solver::statics::{self, StaticSolution};
use nalgebra::Vector3;

use super::Rig;

/// The static equilibrium of a scene, and a note on its cost.
///
/// # Errors
/// Why no equilibrium was found.
pub fn equilibrium(rig: &Rig, scene: &FilmScene) -> Result<(StaticSolution, String), String> {
    equilibrium_from(rig, scene, None)
}

/// The static equilibrium of a scene; the search starts from the equilibrium at another
/// overpressure (Pa).
///
/// # Errors
/// As [`equilibrium`].
pub fn equilibrium_from(
    rig: &Rig,
    scene: &FilmScene,
    known: Option<(&StaticSolution, f64)>,
) -> Result<(StaticSolution, String), String> {
    let state = statics::solve_from(&rig.on_instruction_set(scene), known, &mut |_| {
        ControlFlow::Continue(())
    })
    .map_err(|error| error.to_string())?;
    let note = format!("{} elements, {} Newton steps", state.model.elements(), state.iterations);
    Ok((state, note))
}

/// Mean of a quantity over nodes.
pub fn mean(state: &StaticSolution, nodes: &[u32], of: impl Fn(Vector3<f64>) -> f64) -> f64 {
    let sum: f64 = nodes.iter().map(|node| of(state.positions.get(*node as usize))).sum();
    sum / nodes.len() as f64
}
