//! Static equilibria: the references of the paper's capsule that one job needs.

use std::time::Instant;

use billow_solver::models::{self, film};
use billow_solver::scene::{DEFAULT_CFL, ModelKind, Stepping, paper};
use billow_study::platform::error::{Error, Result};

use super::{MAX_REPEATED_WALL_TIME, Plan, Row};

/// Overpressure at the end of the job, Pa. Chosen: about that of the paper's capsule after 0.3 s at 5 g/s.
const END_OVERPRESSURE: f64 = 217.0;

/// Computes the references on a mesh; a short search is repeated and the fastest kept.
///
/// # Errors
/// If there is no equilibrium.
pub(super) fn measure(subdivisions: u32, plan: &Plan<'_>) -> Result<Row> {
    // No static equilibrium depends on the end time.
    let mut scene = paper::capsule(subdivisions, 1.0);
    scene.solver.model = ModelKind::Film;
    scene.solver.stepping = Stepping::Stable(DEFAULT_CFL);
    let failed = |why: String| Error::JobsFailed(format!("statics, n {subdivisions}: {why}"));
    let cost = models::cost(&scene).map_err(|error| failed(error.to_string()))?;
    let search = || -> Result<_> {
        let start = Instant::now();
        let reference = film::reference_scene(&scene);
        let mut ladder = models::ladder(plan.instruction_set, &reference)
            .map_err(|error| failed(error.to_string()))?;
        let design = ladder.design(&mut || true);
        let end = ladder.at(END_OVERPRESSURE, &mut || true);
        let seconds = start.elapsed().as_secs_f64();
        design.and(end).map_err(|error| failed(error.to_string()))?;
        Ok((ladder, seconds))
    };
    let (ladder, mut seconds) = search()?;
    for _ in 1..plan.repeats() {
        if seconds <= MAX_REPEATED_WALL_TIME {
            seconds = seconds.min(search()?.1);
        }
    }
    Ok(vec![
        ("subdivisions", subdivisions.into()),
        ("elements", cost.elements.into()),
        ("states", ladder.states().into()),
        ("wall_seconds", seconds.into()),
    ])
}
