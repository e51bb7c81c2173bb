//! Estimated cost of jobs, without running them.
//!
//! ```text
//! time on one core ≈ elements · (40 ns · steps of the first 0.3 s + 13 ns · later steps)      film
//!                  ≈ 4.3e-7 s · elements^1.75                 static states of a design, for its first job
//!                  ≈ 2 ms                                     job without film
//! ```

use std::collections::{BTreeMap, BTreeSet};

use billow_solver::models::{self, Cost};
use billow_solver::scene::{ModelKind, Scene};

use super::{JobId, canonical_json};

/// Time per element and step on one core, ns: while film unfolds, and afterwards. Source: measured on the capsule of the
/// paper, n = 4 to 16 (docs/performance.md).
const NS_PER_ELEMENT_STEP: [f64; 2] = [40.0, 13.0];
/// Simulated time in which film unfolds, s. Source: the same.
const UNFOLDING: f64 = 0.3;
/// Time of the static states of a design on one core: coefficient, s, and exponent of the number of
/// elements. Source: measured at n = 8, 16, 32; the factors of sparse matrices grow faster than the
/// matrices.
const STATIC_SECONDS: [f64; 2] = [4.3e-7, 1.75];
/// Time of a job without film on one core, s. Source: measured, with its files.
const SECONDS_WITHOUT_FILM: f64 = 2e-3;

/// Costs of scenes. The mesh of each kind is built once.
#[derive(Debug, Default)]
pub struct Costs {
    /// By the parts of a scene on which they depend; `None` for a scene without a mesh.
    known: BTreeMap<String, Option<Cost>>,
    /// Designs whose static states are computed before.
    states: BTreeSet<JobId>,
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

    /// Time of a scene on one core, s, after those that were asked for before.
    pub fn seconds(&mut self, scene: &Scene) -> f64 {
        let Some(cost) = self.of(scene) else { return SECONDS_WITHOUT_FILM };
        let elements = cost.elements as f64;
        let motion = film_seconds(elements, cost.steps as f64, scene.solver.end_time);
        let is_new = models::reference_scene(scene)
            .is_some_and(|reference| self.states.insert(JobId::of(&reference)));
        let [coefficient, exponent] = STATIC_SECONDS;
        let states = if is_new { coefficient * libm::pow(elements, exponent) } else { 0.0 };
        motion + states
    }
}

/// Time of this number of elements and steps until an end time (s) on one core, s.
pub fn film_seconds(elements: f64, steps: f64, end_time: f64) -> f64 {
    let unfolding = (UNFOLDING / end_time).min(1.0);
    let [first, later] = NS_PER_ELEMENT_STEP;
    1e-9 * elements * steps * (first * unfolding + later * (1.0 - unfolding))
}
