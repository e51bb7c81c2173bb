//! Estimated cost of jobs, without running them.
//!
//! ```text
//! time on one core ≈ 17 ns · elements · steps                film
//!                  ≈ 5 ms                                    without film
//! ```

use std::collections::BTreeMap;

use billow_solver::models::{self, Cost};
use billow_solver::scene::{ModelKind, Scene};

use super::canonical_json;

/// Time per element and step on one core, ns, while the film is not quiescent. Source: measured on the
/// capsule of the paper, n = 4 to 8, 0.5 s.
pub const NS_PER_ELEMENT_STEP: f64 = 17.0;
/// Time of a job without film on one core, s. Source: measured, with its files.
const SECONDS_WITHOUT_FILM: f64 = 5e-3;

/// Costs of scenes. The mesh of each kind is built once.
#[derive(Debug, Default)]
pub struct Costs {
    /// By the parts of a scene on which they depend; `None` for a scene without a mesh.
    known: BTreeMap<String, Option<Cost>>,
}

impl Costs {
    /// Elements and steps of a scene of film; `None` without film, and where no mesh can be built.
    pub fn of(&mut self, scene: &Scene) -> Option<Cost> {
        if scene.solver.model != ModelKind::Film {
            return None;
        }
        // The cost depends on these parts of the scene only.
        let parts = (&scene.design, &scene.film, &scene.solver, scene.outputs.sample_interval);
        let key = canonical_json(&parts);
        *self.known.entry(key).or_insert_with(|| models::cost(scene).ok())
    }

    /// Number of meshes that were built.
    pub fn meshes(&self) -> usize {
        self.known.len()
    }

    /// Time of a scene on one core, s.
    pub fn seconds(&mut self, scene: &Scene) -> f64 {
        let cost = self.of(scene);
        cost.map_or(SECONDS_WITHOUT_FILM, |cost| {
            cost.elements as f64 * cost.steps as f64 * NS_PER_ELEMENT_STEP * 1e-9
        })
    }
}
