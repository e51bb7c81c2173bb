//! Cost of the jobs of a plan.
//!
//! ```text
//! time on one core ≈ 17 ns · Σ elements · steps + 4.3e-7 s · Σ elements^1.75
//! ```
//!
//! The first sum runs over the film jobs, the second one over the designs whose static states are not
//! known yet.

use std::collections::BTreeSet;

use billow_solver::models;
use billow_solver::scene::ModelKind;

use crate::cli::print::{count, duration};
use crate::input::value::short_number;
use crate::job::JobId;
use crate::job::cost::{Costs, NS_PER_ELEMENT_STEP};
use crate::job::point::Point;

/// Time of the static states of a design on one core: coefficient, s, and exponent of the number of
/// elements. Source: measured at n = 8, 16, 32; the factors of sparse matrices grow faster than the
/// matrices.
const STATIC_SECONDS: f64 = 4.3e-7;
const STATIC_EXPONENT: f64 = 1.75;
/// Most meshes that are built for an estimate.
const MAX_MESHES: usize = 100;

/// Estimated cost of jobs, as text; `None` without jobs. `known_states` are the static states that are
/// computed already; a study that searches runs these jobs first.
pub(super) fn forecast(
    points: &[&Point],
    mut known_states: BTreeSet<JobId>,
    of_search: bool,
) -> Option<String> {
    let title = if of_search { "forecast of the first generation" } else { "forecast" };
    let mut costs = Costs::default();
    let mut static_seconds = 0.0;
    let (mut jobs, mut element_steps) = (0_usize, 0.0);
    for point in points {
        let scene = &point.job.scene;
        if scene.solver.model != ModelKind::Film {
            continue;
        }
        if costs.meshes() > MAX_MESHES {
            return Some(format!("{title}: no estimate for more than {MAX_MESHES} meshes"));
        }
        let cost = costs.of(scene)?;
        if let Some(reference) = models::reference_scene(scene)
            && known_states.insert(JobId::of(&reference))
        {
            static_seconds += STATIC_SECONDS * libm::pow(cost.elements as f64, STATIC_EXPONENT);
        }
        jobs += 1;
        element_steps += cost.elements as f64 * cost.steps as f64;
    }
    let text = if jobs > 0 {
        format!(
            "{} of film, about {} million element-steps, about {} on one core",
            count(jobs, "job"),
            short_number(libm::round(element_steps / 1e6)),
            duration(libm::ceil(element_steps * NS_PER_ELEMENT_STEP * 1e-9 + static_seconds))
        )
    } else {
        format!("{} without film, less than a second each", count(points.len(), "job"))
    };
    (!points.is_empty()).then(|| format!("{title}: {text}"))
}
