//! Cost of the jobs of a plan.

use billow_solver::scene::ModelKind;

use crate::input::value::short_number;
use crate::job::cost::Costs;
use crate::job::point::Point;
use crate::print::{count, duration};

/// Most meshes that are built for an estimate.
const MAX_MESHES: usize = 100;

/// Estimated cost of jobs, as text, with the wall time on a number of threads; `None` without jobs. A study that searches
/// runs these jobs first.
pub(super) fn forecast(points: &[&Point], of_search: bool, threads: usize) -> Option<String> {
    let title = if of_search { "forecast of the first generation" } else { "forecast" };
    let mut costs = Costs::default();
    let (mut seconds, mut longest) = (0.0, 0.0);
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
        let of_job = costs.seconds(scene);
        seconds += of_job;
        longest = f64::max(longest, of_job);
        jobs += 1;
        element_steps += cost.elements as f64 * cost.steps as f64;
    }
    let text = if jobs > 0 {
        format!(
            "{} of film, about {} million element-steps, about {} of core time, {} on {}",
            count(jobs, "job"),
            short_number(libm::round(element_steps / 1e6)),
            duration(libm::ceil(seconds)),
            duration(libm::ceil(longest.max(seconds / threads as f64))),
            count(threads, "thread")
        )
    } else {
        format!("{} without film, less than a second each", count(points.len(), "job"))
    };
    (!points.is_empty()).then(|| format!("{title}: {text}"))
}
