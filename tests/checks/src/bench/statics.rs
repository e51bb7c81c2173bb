//! Static equilibria: the references of the paper's capsule that one job needs.
//!
//! ```text
//! ms per factorisation = time of the whole search / factorisations
//! ```

use std::time::Instant;

use billow_solver::models::{self, film};
use billow_solver::platform::simd::InstructionSet;
use billow_solver::scene::{DEFAULT_CFL, ModelKind, Stepping, paper};

use super::{Effort, LARGEST_RUN, Line, MAX_REPEATED_WALL_TIME, Plan, interrupted};
use billow_study::input::value::Value;
use billow_study::platform::error::{Error, Result};
use billow_study::platform::stop::Stop;

/// Overpressure at the end of the job, Pa. Chosen: about that of the paper's capsule after 0.3 s at 5 g/s.
const END_OVERPRESSURE: f64 = 217.0;
/// End time of the scene, s. No static equilibrium depends on it.
const END_TIME: f64 = 1.0;
/// Default meshes, n.
const MESHES: [u32; 3] = [4, 8, 16];
/// Default meshes with `--quick`, n.
const QUICK_MESHES: [u32; 1] = [4];

/// Cost of the references of one mesh.
#[derive(Debug, Clone, PartialEq)]
pub struct StaticsRow {
    /// Elements along each edge of the pattern, n.
    pub subdivisions: u32,
    /// Number of elements.
    pub elements: u64,
    /// Number of equilibria.
    pub states: usize,
    /// Newton steps of all searches.
    pub newton_steps: u32,
    /// Factorisations of all searches.
    pub factorisations: u32,
    /// Wall time, s.
    pub wall_seconds: f64,
}

impl StaticsRow {
    /// As a row of the report.
    pub fn line(&self) -> Line {
        let count = |number: u64| Value::Integer(i64::try_from(number).unwrap_or(i64::MAX));
        let each = 1e3 * self.wall_seconds / f64::from(self.factorisations);
        vec![
            ("subdivisions", Value::Integer(self.subdivisions.into())),
            ("elements", count(self.elements)),
            ("states", count(self.states as u64)),
            ("newton_steps", Value::Integer(self.newton_steps.into())),
            ("factorisations", Value::Integer(self.factorisations.into())),
            ("wall_seconds", Value::Number(self.wall_seconds)),
            ("ms_per_factorisation", Value::Number(each)),
        ]
    }
}

/// The meshes of this part, n.
pub fn meshes(plan: &Plan) -> Vec<u32> {
    match (plan.subdivisions.as_slice(), plan.effort) {
        ([], Effort::Quick) => QUICK_MESHES.to_vec(),
        ([], _) => MESHES.to_vec(),
        _ => plan.meshes().into_iter().filter(|n| *n <= LARGEST_RUN).collect(),
    }
}

/// Computes the references on a mesh; a short search is repeated and the fastest kept.
///
/// # Errors
/// If there is no equilibrium; a signal.
pub fn measure(
    subdivisions: u32,
    instruction_set: InstructionSet,
    effort: Effort,
    stop: &Stop,
) -> Result<StaticsRow> {
    let mut row = search(subdivisions, instruction_set, stop)?;
    for _ in 1..effort.repeats() {
        if row.wall_seconds > MAX_REPEATED_WALL_TIME {
            break;
        }
        let repeat = search(subdivisions, instruction_set, stop)?;
        row.wall_seconds = row.wall_seconds.min(repeat.wall_seconds);
    }
    Ok(row)
}

fn search(subdivisions: u32, instruction_set: InstructionSet, stop: &Stop) -> Result<StaticsRow> {
    let mut scene = paper::capsule(subdivisions, END_TIME);
    scene.solver.model = ModelKind::Film;
    scene.solver.stepping = Stepping::Stable(DEFAULT_CFL);
    let failed = |why: String| Error::JobsFailed(format!("statics, n {subdivisions}: {why}"));
    let cost = models::cost(&scene).map_err(|error| failed(error.to_string()))?;
    let start = Instant::now();
    let reference = film::reference_scene(&scene);
    let mut ladder = models::ladder(instruction_set, &reference, &[])
        .map_err(|error| failed(error.to_string()))?;
    let mut continues = || stop.requested().is_none();
    let design = ladder.design(&mut continues);
    let end = ladder.at(END_OVERPRESSURE, &mut continues);
    let wall_seconds = start.elapsed().as_secs_f64();
    interrupted(stop)?;
    design.and(end).map_err(|error| failed(error.to_string()))?;
    let work = ladder.work();
    Ok(StaticsRow {
        subdivisions,
        elements: cost.elements,
        states: ladder.states().len(),
        newton_steps: work.iterations,
        factorisations: work.factorisations,
        wall_seconds,
    })
}
