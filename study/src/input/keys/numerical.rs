//! Which keys are numerical choices: they change numbers and cost, and no physics.
//!
//! The one list. A verdict that depends on such a key is not certain; work-precision diagrams call a combination of
//! their values, and of the model, a configuration.

use super::study::KEYS;
use super::table::find;
pub use super::words::{INTEGRATOR, MODEL};

/// Paths of the numerical keys.
pub const NUMERICAL: [&str; 10] = [
    SEED,
    "imperfection_amplitude",
    MESH,
    "solver.cfl",
    INTEGRATOR,
    "solver.stepping.adaptive",
    "solver.stepping.fixed",
    "film.numerical_damping",
    "contact.distance",
    "outputs.sample_interval",
];

/// The key that repeats a run with another imperfection.
pub const SEED: &str = "seed";
/// The key of the mesh of a capsule.
pub const MESH: &str = "design.subdivisions";
/// The parameter that holds its value in a table: the short name of the key.
pub const MESH_PARAMETER: &str = "subdivisions";

/// The path of a key that a parameter names; `None` for a parameter that is no key, as one of a strategy.
pub fn path(parameter: &str) -> Option<&'static str> {
    find(parameter).map(|key| KEYS[key].path)
}

/// Whether a parameter is a numerical choice.
pub fn is_numerical(parameter: &str) -> bool {
    path(parameter).is_some_and(|path| NUMERICAL.contains(&path))
}

/// Whether a parameter is a numerical choice or the model: it changes how a capsule is computed, not the capsule.
pub fn is_of_method(parameter: &str) -> bool {
    is_numerical(parameter) || path(parameter) == Some(MODEL)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_path_is_a_key() {
        for known in NUMERICAL.iter().chain([&MODEL]) {
            assert_eq!(path(known), Some(*known));
        }
        assert_eq!(path(MESH_PARAMETER), Some(MESH));
        assert!(is_numerical("cfl") && !is_numerical("model") && !is_numerical("N"));
        assert_eq!(path("strategies.rapid.release_time"), None);
    }
}
