//! Quiet filling: the delayed and the preinflated case of `studies/paper.json` in tension field, once with
//! `explicit` and once with `hybrid`.
//!
//! ```text
//! speedup = wall time of explicit / wall time of hybrid      same scene, one run after the other
//! ```

use billow_solver::integrators;
use billow_solver::models::film::solve_scene;
use billow_solver::models::run::Unobserved;
use billow_solver::output::outcome::Stop;
use billow_solver::scene::{IntegratorKind, Scene};
use billow_study::input::value::Value;
use billow_study::platform::error::{Error, Result};
use billow_study::study::plan::next_jobs;
use billow_study::study::{MAX_POINTS, Study};

use super::machine::{Watch, core_share};
use super::{Effort, LARGEST_RUN, Plan, Row};

/// The shipped study.
const STUDY: &str = include_str!("../../../../studies/paper.json");
/// The strategies whose film hardly moves for most of the run.
const STRATEGIES: [&str; 2] = ["delayed", "preinflate"];
/// End time with `--quick`, s. Chosen: the burst is over, and the run takes seconds.
const QUICK_END_TIME: f64 = 0.5;

/// The meshes of this part, n. A run takes minutes at n 8 and an hour at n 16, so the larger ones need `--full`,
/// and n above 8 also its name in `--subdivisions`.
pub(super) fn meshes(plan: &Plan<'_>) -> Vec<u32> {
    let named = !plan.subdivisions.is_empty();
    let largest = match plan.effort {
        Effort::Full if !named => 8,
        Effort::Usual => 8,
        Effort::Full | Effort::Quick => LARGEST_RUN,
    };
    plan.meshes(if plan.effort == Effort::Full { &[5, 8] } else { &[5] }, largest)
}

/// Runs a mesh with every strategy, first with explicit steps and then with the hybrid.
///
/// # Errors
/// A failure of a run.
pub(super) fn measure(subdivisions: u32, plan: &Plan<'_>) -> Result<Vec<Row>> {
    let mut rows = Vec::new();
    for (strategy, mut scene) in scenes(subdivisions, plan.effort)? {
        let mut explicit = None;
        for kind in [IntegratorKind::Explicit, IntegratorKind::Hybrid] {
            scene.solver.integrator = kind;
            let (name, end) = (integrators::entry(kind).name, scene.solver.end_time);
            let run = format!("{strategy}, {name}, n {subdivisions}, {end} s");
            plan.note(&run);
            let failed = |why: String| Error::JobsFailed(format!("{run}: {why}"));
            let watch = Watch::start();
            let found = solve_scene(plan.instruction_set, &scene, &mut Unobserved);
            let (wall, on_core) = watch.seconds();
            let found = found.map_err(|error| failed(error.to_string()))?;
            if let Stop::Failed(failure) = &found.stop {
                let (kind, time) = (failure.kind.name(), failure.time);
                return Err(failed(format!("{kind} at {time} s: {}", failure.place)));
            }
            rows.push(vec![
                ("subdivisions", subdivisions.into()),
                ("strategy", strategy.into()),
                ("integrator", name.into()),
                ("end_time", end.into()),
                ("elements", found.elements.into()),
                ("steps", found.steps.into()),
                ("wall_seconds", wall.into()),
                ("wall_per_second", (wall / end).into()),
                ("core_share", core_share((wall, on_core)).into()),
                ("speedup", explicit.map(|seconds: f64| seconds / wall).into()),
                ("ledger_residual", found.audit.ledger_residual.into()),
                ("passages", found.audit.passages.into()),
                ("volume", found.history.column("volume").last().copied().into()),
            ]);
            explicit = Some(wall);
        }
    }
    Ok(rows)
}

/// The scenes of the strategies on a mesh.
fn scenes(subdivisions: u32, effort: Effort) -> Result<Vec<(&'static str, Scene)>> {
    let sets = [
        format!("design.subdivisions={subdivisions}"),
        "compression=0".to_owned(),
        "residual_gas=burst".to_owned(),
    ];
    let study = Study::from_text(STUDY, "studies/paper.json", "bench", &sets, MAX_POINTS)?;
    let points = next_jobs(&study, &[]).map(|first| first.points).unwrap_or_default();
    let scene_of = |strategy: &'static str| {
        let wanted = ("strategy".to_owned(), Value::from(strategy));
        let job = &points.iter().find(|point| point.job.parameters.contains(&wanted))?.job;
        let mut scene = Scene::clone(&job.scene);
        if effort == Effort::Quick {
            scene.solver.end_time = QUICK_END_TIME;
        }
        Some((strategy, scene))
    };
    Ok(STRATEGIES.into_iter().filter_map(scene_of).collect())
}
