//! Quiet filling: the delayed and the preinflated case of `studies/paper.json` in tension field, once with
//! `explicit` and once with `hybrid`.
//!
//! ```text
//! speedup = wall time of explicit / wall time of hybrid      same scene, one run after the other
//! ```

use std::time::Instant;

use billow_solver::integrators;
use billow_solver::models::film::solve_scene;
use billow_solver::models::run::{Observer, Progress};
use billow_solver::output::outcome::Stop as End;
use billow_solver::platform::simd::InstructionSet;
use billow_solver::scene::{IntegratorKind, Scene};

use super::{Effort, LARGEST_RUN, Line, Plan, interrupted, machine};
use billow_study::input::value::Value;
use billow_study::platform::error::{Error, Result};
use billow_study::platform::stop::Stop;
use billow_study::study::plan::next_jobs;
use billow_study::study::{PlanSize, Study};

/// The shipped study.
const STUDY: &str = include_str!("../../../../studies/paper.json");
/// Its name in error messages.
const NAME: &str = "studies/paper.json";
/// The strategies whose film hardly moves for most of the run.
pub const STRATEGIES: [&str; 2] = ["delayed", "preinflate"];
/// The integrators, in the order of their runs.
const INTEGRATORS: [IntegratorKind; 2] = [IntegratorKind::Explicit, IntegratorKind::Hybrid];
/// End time with `--quick`, s. Chosen: the burst is over, and the run takes seconds.
const QUICK_END_TIME: f64 = 0.5;

/// Cost of one run.
#[derive(Debug, Clone, PartialEq)]
pub struct QuietRow {
    /// Elements along each edge of the pattern, n.
    pub subdivisions: u32,
    /// Strategy.
    pub strategy: &'static str,
    /// Name of the integrator.
    pub integrator: &'static str,
    /// Simulated time, s.
    pub end_time: f64,
    /// Number of elements.
    pub elements: usize,
    /// Number of steps.
    pub steps: u64,
    /// Wall time, s.
    pub wall_seconds: f64,
    /// Time on a processor core, s, without other processes. `None` if the system does not report it.
    pub core_seconds: Option<f64>,
    /// Wall time of `explicit` over that of this run; `None` for `explicit`.
    pub speedup: Option<f64>,
    /// Largest residual of the energy ledger.
    pub ledger_residual: f64,
    /// Passages of film through film.
    pub passages: Option<u64>,
    /// Enclosed volume at the end, m³: both integrators must agree.
    pub volume: f64,
}

impl QuietRow {
    /// Fraction of the wall time on a core; `None` if unknown.
    pub fn core_share(&self) -> Option<f64> {
        machine::core_share(self.core_seconds, self.wall_seconds)
    }

    /// As a row of the report.
    pub fn line(&self) -> Line {
        let count = |number: u64| Value::Integer(i64::try_from(number).unwrap_or(i64::MAX));
        vec![
            ("subdivisions", Value::Integer(self.subdivisions.into())),
            ("strategy", Value::Text(self.strategy.to_owned())),
            ("integrator", Value::Text(self.integrator.to_owned())),
            ("end_time", Value::Number(self.end_time)),
            ("elements", count(self.elements as u64)),
            ("steps", count(self.steps)),
            ("wall_seconds", Value::Number(self.wall_seconds)),
            ("wall_per_second", Value::Number(self.wall_seconds / self.end_time)),
            ("speedup", self.speedup.map_or(Value::Null, Value::Number)),
            ("ledger_residual", Value::Number(self.ledger_residual)),
            ("passages", self.passages.map_or(Value::Null, count)),
            ("volume", Value::Number(self.volume)),
        ]
    }
}

/// The meshes of this part, n. A run takes minutes at n 8 and an hour at n 16, so the larger ones need `--full`,
/// and n above 8 also its name in `--subdivisions`.
pub fn meshes(plan: &Plan) -> Vec<u32> {
    let named = !plan.subdivisions.is_empty();
    let largest = match plan.effort {
        Effort::Full if named => LARGEST_RUN,
        Effort::Full => 8,
        Effort::Usual if named => 8,
        Effort::Usual => 5,
        Effort::Quick => LARGEST_RUN,
    };
    plan.meshes().into_iter().filter(|n| *n <= largest).collect()
}

/// Runs a mesh with every strategy and integrator; `progress` receives the name of each run.
///
/// # Errors
/// A failure of a run; a signal.
pub fn measure(
    subdivisions: u32,
    instruction_set: InstructionSet,
    effort: Effort,
    stop: &Stop,
    progress: &mut dyn FnMut(&str),
) -> Result<Vec<QuietRow>> {
    let mut rows = Vec::new();
    for (strategy, scene) in scenes(subdivisions, effort)? {
        let mut explicit = None;
        for kind in INTEGRATORS {
            let end_time = scene.solver.end_time;
            let name = integrators::entry(kind).name;
            progress(&format!("{strategy}, {name}, n {subdivisions}, {end_time} s"));
            let row = run(strategy, kind, &scene, instruction_set, stop)?;
            let speedup = explicit.map(|seconds: f64| seconds / row.wall_seconds);
            explicit = explicit.or(Some(row.wall_seconds));
            rows.push(QuietRow { speedup, ..row });
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
    let study = Study::from_text(STUDY, NAME, "bench", &sets, PlanSize::default())?;
    let points = next_jobs(&study, &[]).map(|first| first.points).unwrap_or_default();
    let scene_of = |strategy: &'static str| {
        let is_it = |(name, value): &(String, Value)| {
            name == "strategy" && *value == Value::Text(strategy.to_owned())
        };
        let job = &points.iter().find(|point| point.job.parameters.iter().any(is_it))?.job;
        let mut scene = job.scene.clone();
        if effort == Effort::Quick {
            scene.solver.end_time = QUICK_END_TIME;
        }
        Some((strategy, scene))
    };
    Ok(STRATEGIES.into_iter().filter_map(scene_of).collect())
}

/// Ends a run on a signal.
struct UntilStopped<'a>(&'a Stop);

impl Observer for UntilStopped<'_> {
    fn sample(&mut self, _: Progress) -> bool {
        self.0.requested().is_none()
    }
}

/// One run, without its speedup.
fn run(
    strategy: &'static str,
    kind: IntegratorKind,
    scene: &Scene,
    instruction_set: InstructionSet,
    stop: &Stop,
) -> Result<QuietRow> {
    let mut scene = scene.clone();
    scene.solver.integrator = kind;
    let name = integrators::entry(kind).name;
    let subdivisions = scene.design.subdivisions;
    let failed =
        |why: String| Error::JobsFailed(format!("n {subdivisions}, {strategy}, {name}: {why}"));
    let (start, core) = (Instant::now(), machine::core_seconds());
    let ended = solve_scene(instruction_set, &scene, &mut UntilStopped(stop));
    let wall_seconds = start.elapsed().as_secs_f64();
    let core_seconds = machine::core_seconds().zip(core).map(|(now, then)| now - then);
    interrupted(stop)?;
    let deployment = ended.map_err(|error| failed(error.to_string()))?;
    if let End::Failed(failure) = &deployment.stop {
        let why = format!("{} at {} s: {}", failure.kind.name(), failure.time, failure.place);
        return Err(failed(why));
    }
    let volume = deployment.history.column("volume").last().copied();
    Ok(QuietRow {
        subdivisions,
        strategy,
        integrator: name,
        end_time: scene.solver.end_time,
        elements: deployment.elements,
        steps: deployment.steps,
        wall_seconds,
        core_seconds,
        speedup: None,
        ledger_residual: deployment.audit.ledger_residual,
        passages: deployment.audit.passages,
        volume: volume.unwrap_or(f64::NAN),
    })
}
