//! Cost of a step without contact: membrane, gas and update, and a plain scalar reference in the same
//! run, from the same state.

use std::hint::black_box;
use std::time::Instant;

use billow_solver::integrators::FilmSimulation;
use billow_solver::integrators::explicit::reference_step::{
    FilmMotion, reference_step, vector_step,
};
use billow_solver::integrators::explicit::update::KickParameters;
use billow_solver::platform::simd::InstructionSet;
use billow_solver::platform::stopwatch::Untimed;
use billow_solver::scene::timeline::Timeline;
use billow_solver::system::FilmSystem;

use super::capsule::{Capsule, Mark, run_to_marks};
use super::stages::take_steps;
use super::{Effort, Line, RISING, interrupted};
use crate::cases::rig::explicit;
use billow_study::input::value::Value;
use billow_study::platform::error::Result;
use billow_study::platform::stop::Stop;

/// Name of the whole step's kernel.
pub const STEP: &str = "step";
/// Name of the film's part of a step: membrane and update at a fixed pressure.
pub const FILM: &str = "film";
/// Name of the scalar reference of the film's part.
pub const REFERENCE: &str = "reference";

/// Cost of a kernel.
#[derive(Debug, Clone, PartialEq)]
pub struct KernelRow {
    /// Elements along each edge of the pattern, n.
    pub subdivisions: u32,
    /// Its name: [`STEP`], [`FILM`], [`REFERENCE`].
    pub kernel: &'static str,
    /// Instruction set.
    pub instruction_set: InstructionSet,
    /// Wall time per element and step, ns.
    pub cost: f64,
}

impl KernelRow {
    /// As a row of the report.
    pub fn line(&self) -> Line {
        vec![
            ("subdivisions", Value::Integer(self.subdivisions.into())),
            ("kernel", Value::Text(self.kernel.to_owned())),
            ("instruction_set", Value::Text(self.instruction_set.name().to_owned())),
            ("ns_per_element_step", Value::Number(self.cost)),
        ]
    }
}

/// Times the kernels on a mesh: the step and the film's part of it on every available instruction set
/// up to the given one, and the scalar reference.
///
/// # Errors
/// A failure of the run; a signal.
pub fn measure(
    subdivisions: u32,
    instruction_set: InstructionSet,
    effort: Effort,
    stop: &Stop,
) -> Result<Vec<KernelRow>> {
    let capsule = Capsule::new(subdivisions, instruction_set)?.without_contact();
    // At this time part of the film is taut, part wrinkled, part slack.
    let mark = Mark { time: RISING, state: Some("rising"), case: false };
    let (states, _) = run_to_marks(&capsule, &[mark], stop)?;
    let film = &states[0].run.film;
    let (now, last_step) = (film.view(), explicit(film).motion.last_step);
    let model = &now.system.model;
    let (elements, steps) = (model.elements(), effort.kernel_steps());
    let row = |kernel, instruction_set, seconds: f64| KernelRow {
        subdivisions,
        kernel,
        instruction_set,
        cost: 1e9 * seconds / (steps as f64 * elements as f64),
    };
    let mut rows = Vec::new();
    let narrower = InstructionSet::ALL.into_iter().take_while(|set| *set != instruction_set);
    let sets = narrower.chain([instruction_set]);
    let sets: Vec<InstructionSet> = sets.filter(|set| set.available()).collect();
    for set in sets.iter().copied() {
        let seconds =
            least(effort, stop, &mut || step_seconds(film, set, &capsule.timeline, steps))?;
        rows.push(row(STEP, set, seconds));
    }
    // Membrane and update as in the step, at a fixed pressure.
    let push = KickParameters {
        overpressure: now.overpressure(),
        gravity: now.system.gravity,
        weight_factor: 1.0,
        velocity_factor: 1.0,
        acceleration_factor: last_step,
        contact_active: false,
    };
    let (free, length) = (&now.system.supports.free, last_step);
    let moving = |set| {
        let (positions, velocities) = (now.state.positions.clone(), now.state.velocities.clone());
        FilmMotion::new(set, model, positions, velocities)
    };
    for set in sets {
        let seconds = least(effort, stop, &mut || {
            let mut motion = moving(set);
            Ok(timed(steps, &mut || {
                black_box(vector_step(set, model, &push, free, length, &mut motion));
            }))
        })?;
        rows.push(row(FILM, set, seconds));
    }
    let seconds = least(effort, stop, &mut || {
        let mut motion = moving(InstructionSet::Scalar);
        Ok(timed(steps, &mut || {
            black_box(reference_step(model, &push, free, length, &mut motion));
        }))
    })?;
    rows.push(row(REFERENCE, InstructionSet::Scalar, seconds));
    Ok(rows)
}

/// Seconds of a number of steps with an instruction set.
fn step_seconds(
    film: &FilmSimulation,
    instruction_set: InstructionSet,
    timeline: &Timeline,
    steps: u64,
) -> Result<f64> {
    let mut film =
        film.clone().with(|system, settings| (FilmSystem { instruction_set, ..system }, settings));
    let start = Instant::now();
    take_steps(&mut film, timeline, steps, &mut Untimed)?;
    Ok(start.elapsed().as_secs_f64())
}

/// Seconds of a number of calls.
fn timed(calls: u64, work: &mut dyn FnMut()) -> f64 {
    let start = Instant::now();
    (0..calls).for_each(|_| work());
    start.elapsed().as_secs_f64()
}

/// The shortest of several repeats, s.
fn least(effort: Effort, stop: &Stop, once: &mut dyn FnMut() -> Result<f64>) -> Result<f64> {
    let mut least = f64::INFINITY;
    for _ in 0..effort.kernel_repeats() {
        least = least.min(once()?);
        interrupted(stop)?;
    }
    Ok(least)
}
