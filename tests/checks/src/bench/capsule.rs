//! The capsule of the bench: the paper's capsule from `scenes/capsule.json`, for up to 1.5 s.
//!
//! It runs from the stowed shape as in `billow solve`. At each mark the bench keeps the state, from
//! which stages are timed, or the cost so far.

use std::path::Path;
use std::time::Instant;

use billow_solver::models::film::FilmRun;
use billow_solver::models::run::{Model, Observer, Progress, Run};
use billow_solver::output::outcome::Stop as End;
use billow_solver::platform::simd;
use billow_solver::scene::timeline::Timeline;

use super::{Line, interrupted, machine};
use billow_study::input::value::Value;
use billow_study::platform::error::{Error, Result};
use billow_study::platform::memory;
use billow_study::platform::stop::Stop;
use billow_study::scene::file::SceneFile;

/// The shipped scene.
const SCENE: &str = include_str!("../../../../scenes/capsule.json");
/// Its name in error messages.
const NAME: &str = "scenes/capsule.json";
/// End time of the scene: later than every timed run, so that inflow lasts through the 1.5 s case.
const END_TIME: &str = "solver.end_time=\"1.6 s\"";

/// The capsule of one mesh.
#[derive(Debug, Clone)]
pub struct Capsule {
    /// Elements along each edge of the pattern, n.
    pub subdivisions: u32,
    /// The scene.
    pub scene: SceneFile,
    /// Its timeline.
    pub timeline: Timeline,
}

impl Capsule {
    /// The capsule on this mesh with this instruction set.
    ///
    /// # Errors
    /// If the scene is invalid on this mesh.
    pub fn new(subdivisions: u32, instruction_set: simd::InstructionSet) -> Result<Self> {
        let sets = [END_TIME.to_owned(), format!("design.subdivisions={subdivisions}")];
        let scene = SceneFile::from_text(SCENE, Path::new(NAME), &sets, instruction_set)?;
        let timeline = Timeline::of_film(&scene.film);
        Ok(Self { subdivisions, scene, timeline })
    }

    /// The same without contact and without the tunnelling monitor: film passes through film.
    #[must_use]
    pub fn without_contact(mut self) -> Self {
        self.scene.film.contact = None;
        self
    }

    /// The stowed capsule at time 0.
    ///
    /// # Errors
    /// If the film is invalid.
    pub fn stowed(&self) -> Result<FilmRun> {
        let failed = |error| Error::JobsFailed(format!("n {}: {error}", self.subdivisions));
        FilmRun::of(&self.scene.film, self.scene.rings.clone()).map_err(failed)
    }
}

/// A time at which a run is interrupted.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Mark {
    /// Simulated time of a sample, s.
    pub time: f64,
    /// Name of the state, if stages are timed from it.
    pub state: Option<&'static str>,
    /// Whether the cost so far becomes a case.
    pub case: bool,
}

/// A state of a run, from which stages are timed.
#[derive(Debug, Clone)]
pub struct State {
    /// Its name.
    pub name: &'static str,
    /// Simulated time, s.
    pub time: f64,
    /// The film.
    pub run: FilmRun,
}

/// Cost of a run from the start to a time.
#[derive(Debug, Clone, PartialEq)]
pub struct Case {
    /// Elements along each edge of the pattern, n.
    pub subdivisions: u32,
    /// Simulated time, s.
    pub end_time: f64,
    /// Number of elements.
    pub elements: usize,
    /// Number of steps.
    pub steps: u64,
    /// Wall time with samples, s.
    pub wall_seconds: f64,
    /// Time on a processor core, s, without other processes. `None` if the system does not report it.
    pub core_seconds: Option<f64>,
    /// Residual of the energy ledger: a fast run must also be a sound one.
    pub ledger_residual: f64,
    /// Passages of film through film.
    pub passages: Option<u64>,
    /// Peak memory of the process so far, bytes.
    pub peak_memory: Option<u64>,
}

impl Case {
    /// Wall time per element and step, ns.
    pub fn nanoseconds(&self) -> f64 {
        1e9 * self.wall_seconds / (self.steps as f64 * self.elements as f64)
    }

    /// Fraction of the wall time on a core; `None` if unknown, or if the run is too short.
    pub fn core_share(&self) -> Option<f64> {
        machine::core_share(self.core_seconds, self.wall_seconds)
    }

    /// As a row of the report.
    pub fn line(&self) -> Line {
        let count = |number: u64| Value::Integer(i64::try_from(number).unwrap_or(i64::MAX));
        let maybe = |number: Option<u64>| number.map_or(Value::Null, count);
        vec![
            ("subdivisions", Value::Integer(self.subdivisions.into())),
            ("end_time", Value::Number(self.end_time)),
            ("elements", count(self.elements as u64)),
            ("steps", count(self.steps)),
            ("wall_seconds", Value::Number(self.wall_seconds)),
            ("core_seconds", self.core_seconds.map_or(Value::Null, Value::Number)),
            ("wall_per_second", Value::Number(self.wall_seconds / self.end_time)),
            ("ns_per_element_step", Value::Number(self.nanoseconds())),
            ("ledger_residual", Value::Number(self.ledger_residual)),
            ("passages", maybe(self.passages)),
            ("peak_memory", maybe(self.peak_memory)),
        ]
    }
}

/// Ends a run at a sample, or on a signal.
struct Until<'a> {
    time: f64,
    stop: &'a Stop,
}

impl Observer for Until<'_> {
    fn sample(&mut self, progress: Progress) -> bool {
        progress.time < self.time && self.stop.requested().is_none()
    }
}

/// Runs a capsule to its last mark; marks are in ascending order.
///
/// # Errors
/// A failure of the run; a signal.
pub fn run_to_marks(
    capsule: &Capsule,
    marks: &[Mark],
    stop: &Stop,
) -> Result<(Vec<State>, Vec<Case>)> {
    let (mut model, mut run) = (capsule.stowed()?, Run::default());
    let (mut states, mut cases) = (Vec::new(), Vec::new());
    let (mut wall_seconds, mut core_seconds) = (0.0, Some(0.0));
    for mark in marks {
        if mark.time > 0.0 {
            // Samples are multiples of the interval; half an interval less avoids rounding errors.
            let time = mark.time - 0.5 * capsule.timeline.sample_interval;
            let (start, core) = (Instant::now(), machine::core_seconds());
            let end =
                run.advance(&mut model, &capsule.timeline, u64::MAX, &mut Until { time, stop });
            wall_seconds += start.elapsed().as_secs_f64();
            let on_core = machine::core_seconds().zip(core).map(|(now, then)| now - then);
            core_seconds = core_seconds.zip(on_core).map(|(before, more)| before + more);
            interrupted(stop)?;
            if let Some(End::Failed(failure)) = end {
                return Err(Error::JobsFailed(format!(
                    "n {}: {} at {} s: {}",
                    capsule.subdivisions,
                    failure.kind.name(),
                    failure.time,
                    failure.place
                )));
            }
        }
        if let Some(name) = mark.state {
            states.push(State { name, time: mark.time, run: model.clone() });
        }
        if mark.case {
            let audit = run.clone().finish(&model, &capsule.timeline, End::Cancelled).audit;
            cases.push(Case {
                subdivisions: capsule.subdivisions,
                end_time: mark.time,
                elements: model.elements(),
                steps: model.steps(),
                wall_seconds,
                core_seconds,
                ledger_residual: audit.ledger_residual,
                passages: audit.passages,
                peak_memory: memory::peak_resident(),
            });
        }
    }
    Ok((states, cases))
}
