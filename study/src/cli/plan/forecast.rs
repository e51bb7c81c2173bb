//! What the jobs of a plan will cost.

use std::collections::{BTreeMap, BTreeSet};

use billow_solver::models::{self, Cost};
use billow_solver::scene::ModelKind;

use crate::cli::print::{count, duration};
use crate::input::value::short_number;
use crate::job::point::Point;
use crate::job::{JobId, canonical_json};

/// Nanoseconds an element takes on one core for each step of film that never gets calm, about: measured
/// on the paper's capsule, which does, at n 4 to 8 over 0.5 s.
const NS: f64 = 17.0;
/// Seconds the static states of a design take on one core, c eᵏ of its elements: 0.6, 6 and 78 s were
/// measured at n 8, 16 and 32 (the factors of sparse matrices grow faster than they do).
const STATES: f64 = 4.3e-7;
const STATES_POWER: f64 = 1.75;
/// Meshes that are made to foretell a cost, at most.
const MESHES: usize = 100;

/// What jobs will cost, about, their static states included but for those `known_states`; nothing where
/// there are none.
pub(super) fn forecast(points: &[&Point], mut known_states: BTreeSet<JobId>) -> Option<String> {
    let mut known: BTreeMap<String, Cost> = BTreeMap::new();
    let mut states = 0.0;
    let (mut jobs, mut element_steps) = (0_usize, 0.0);
    for point in points {
        let scene = &point.job.scene;
        if scene.solver.model == ModelKind::Piston {
            continue;
        }
        let decides = (&scene.design, &scene.film, &scene.solver, scene.outputs.sample_interval);
        let key = canonical_json(&decides);
        if !known.contains_key(&key) {
            if known.len() == MESHES {
                return Some(format!(
                    "forecast: over {MESHES} meshes, none made to foretell a cost"
                ));
            }
            known.insert(key.clone(), models::cost(scene).ok()?);
        }
        let cost = known[&key];
        if let Some(of) = models::reference_scene(scene)
            && known_states.insert(JobId::of(&of))
        {
            states += STATES * libm::pow(cost.elements as f64, STATES_POWER);
        }
        jobs += 1;
        element_steps += cost.elements as f64 * cost.steps as f64;
    }
    let text = if jobs > 0 {
        format!(
            "{} of film, about {} million element-steps, about {} of one core",
            count(jobs, "job"),
            short_number(libm::round(element_steps / 1e6)),
            duration(libm::ceil(element_steps * NS * 1e-9 + states))
        )
    } else {
        format!("{} without film, well under a second each", count(points.len(), "job"))
    };
    (!points.is_empty()).then(|| format!("forecast: {text}"))
}
