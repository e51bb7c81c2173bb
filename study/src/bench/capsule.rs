//! The capsule the bench times: the paper's, as `scenes/capsule.json` has it, on a way of 1.5 s.
//!
//! A journey is one run from the stowed shape on, as `billow solve` runs it. At its marks it leaves
//! the state, from which stages are timed, and what it has cost so far.

use std::path::Path;
use std::time::Instant;

use billow_solver::models::film::FilmRun;
use billow_solver::models::run::{Model, Observer, Progress, Run};
use billow_solver::output::outcome::Stop as End;
use billow_solver::platform::simd;
use billow_solver::scene::timeline::Timeline;

use super::{Line, interrupted, machine};
use crate::input::value::Value;
use crate::platform::error::{Error, Result};
use crate::platform::stop::Stop;
use crate::scene::file::SceneFile;

/// The scene, as it ships.
const SCENE: &str = include_str!("../../../scenes/capsule.json");
/// What errors call it.
const NAME: &str = "scenes/capsule.json";
/// End of its inflow, s: beyond all that is timed, so that the end of the 1.5 s case goes on as it is.
const END: &str = "solver.end_time=\"1.6 s\"";

/// The capsule of one mesh.
#[derive(Debug, Clone)]
pub struct Capsule {
    /// n.
    pub subdivisions: u32,
    /// What is run.
    pub scene: SceneFile,
    /// What happens when.
    pub course: Timeline,
}

impl Capsule {
    /// On this mesh and this instruction set.
    ///
    /// # Errors
    /// Where the scene is none on this mesh.
    pub fn new(subdivisions: u32, path: simd::InstructionSet) -> Result<Self> {
        let sets = [END.to_owned(), format!("design.subdivisions={subdivisions}")];
        let scene = SceneFile::from_text(SCENE, Path::new(NAME), &sets, path)?;
        let course = Timeline::of_film(&scene.film);
        Ok(Self { subdivisions, scene, course })
    }

    /// The same film passing through itself: contact and what watches it left out.
    #[must_use]
    pub fn without_contact(mut self) -> Self {
        self.scene.film.contact = None;
        self
    }

    /// Stowed, at time 0.
    ///
    /// # Errors
    /// Where the film is none.
    pub fn stowed(&self) -> Result<FilmRun> {
        let failed = |error| Error::JobsFailed(format!("n {}: {error}", self.subdivisions));
        FilmRun::of(&self.scene.film, self.scene.rings.clone()).map_err(failed)
    }
}

/// A moment of a journey.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Mark {
    /// Simulated time, s: that of a sample.
    pub time: f64,
    /// The state's name, where stages are timed from it.
    pub state: Option<&'static str>,
    /// Whether it is told what the way so far has cost.
    pub case: bool,
}

/// A state on the way.
#[derive(Debug, Clone)]
pub struct State {
    /// Its name.
    pub name: &'static str,
    /// Simulated time, s.
    pub time: f64,
    /// The film.
    pub run: FilmRun,
}

/// What a way from the start has cost.
#[derive(Debug, Clone, PartialEq)]
pub struct Case {
    /// n.
    pub subdivisions: u32,
    /// Simulated time, s.
    pub end_time: f64,
    /// Elements.
    pub elements: usize,
    /// Steps.
    pub steps: u64,
    /// Wall time, samples included, s.
    pub wall_seconds: f64,
    /// Time on a core, s: without whoever else uses it. `None` where the system does not say.
    pub core_seconds: Option<f64>,
    /// Residual of the energy ledger: what the speed is worth.
    pub ledger_residual: f64,
    /// Film through film.
    pub passages: Option<u64>,
    /// Most memory the process has held so far, bytes.
    pub peak_memory: Option<u64>,
}

impl Case {
    /// Wall time of an element's step, ns.
    pub fn nanoseconds(&self) -> f64 {
        1e9 * self.wall_seconds / (self.steps as f64 * self.elements as f64)
    }

    /// Share of the wall time it was on a core; `None` where nothing says, or the way was too short.
    pub fn core_share(&self) -> Option<f64> {
        machine::core_share(self.core_seconds, self.wall_seconds)
    }

    /// As a row.
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

/// Ends a way at a sample.
struct Until<'a> {
    time: f64,
    stop: &'a Stop,
}

impl Observer for Until<'_> {
    fn sample(&mut self, progress: Progress) -> bool {
        progress.time < self.time && self.stop.requested().is_none()
    }
}

/// Runs a capsule to its last mark; marks rise.
///
/// # Errors
/// A run that stops short; a signal.
pub fn travel(capsule: &Capsule, marks: &[Mark], stop: &Stop) -> Result<(Vec<State>, Vec<Case>)> {
    let (mut model, mut run) = (capsule.stowed()?, Run::default());
    let (mut states, mut cases) = (Vec::new(), Vec::new());
    let (mut wall_seconds, mut core_seconds) = (0.0, Some(0.0));
    for mark in marks {
        if mark.time > 0.0 {
            // Samples are whole multiples of the interval; half of one takes rounding out.
            let time = mark.time - 0.5 * capsule.course.sample_interval;
            let (start, core) = (Instant::now(), machine::core_seconds());
            let end = run.advance(&mut model, &capsule.course, u64::MAX, &mut Until { time, stop });
            wall_seconds += start.elapsed().as_secs_f64();
            let on_core = machine::core_seconds().zip(core).map(|(now, then)| now - then);
            core_seconds = core_seconds.zip(on_core).map(|(so_far, more)| so_far + more);
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
            let audit = run.clone().finish(&model, &capsule.course, End::Cancelled).audit;
            cases.push(Case {
                subdivisions: capsule.subdivisions,
                end_time: mark.time,
                elements: model.elements(),
                steps: model.steps(),
                wall_seconds,
                core_seconds,
                ledger_residual: audit.ledger_residual,
                passages: audit.passages,
                peak_memory: machine::peak_memory(),
            });
        }
    }
    Ok((states, cases))
}
