//! What the static cases share: scenes brought to rest, and errors over meshes.

use std::ops::ControlFlow;

use billow_solver::scene::Film;
use billow_solver::scene::film_scene::FilmScene;
use billow_solver::statics::{self, StaticSolution};
use nalgebra::Vector3;

use super::Rig;
use super::reference::number;

/// The paper's film, without viscosity.
pub fn film() -> Film {
    Film {
        youngs_modulus: number("static_film/youngs_modulus"),
        poisson_ratio: number("static_film/poisson_ratio"),
        density: number("static_film/density"),
        thickness: number("static_film/thickness"),
        compression: 0.0,
        viscosity: 0.0,
        temperature: 293.0,
    }
}

/// A scene at rest, and a word on what it took.
///
/// # Errors
/// Why there is no such state.
pub fn at_rest(rig: &Rig, scene: &FilmScene) -> Result<(StaticSolution, String), String> {
    at_rest_from(rig, scene, None)
}

/// A scene at rest, from a state of it under another overpressure (Pa).
///
/// # Errors
/// As [`at_rest`].
pub fn at_rest_from(
    rig: &Rig,
    scene: &FilmScene,
    known: Option<(&StaticSolution, f64)>,
) -> Result<(StaticSolution, String), String> {
    let state = statics::solve_from(&rig.on_instruction_set(scene), known, &mut |_| {
        ControlFlow::Continue(())
    })
    .map_err(|error| error.to_string())?;
    let word = format!("{} elements in {} steps", state.model.elements(), state.iterations);
    Ok((state, word))
}

/// Mean of a quantity over nodes.
pub fn mean(state: &StaticSolution, nodes: &[u32], of: impl Fn(Vector3<f64>) -> f64) -> f64 {
    let sum: f64 = nodes.iter().map(|node| of(state.positions.get(*node as usize))).sum();
    sum / nodes.len() as f64
}
