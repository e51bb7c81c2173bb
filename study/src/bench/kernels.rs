//! What film alone takes: membrane, gas and update of a step without contact, beside a plain scalar
//! reference in the same run, on the same state.

use std::hint::black_box;
use std::time::Instant;

use billow_solver::integrators::explicit::Explicit;
use billow_solver::integrators::explicit::reference_step::{
    FilmMotion, reference_step, vector_step,
};
use billow_solver::integrators::explicit::update::KickParameters;
use billow_solver::platform::simd::InstructionSet;
use billow_solver::platform::stopwatch::Untimed;
use billow_solver::scene::timeline::Timeline;

use super::capsule::{Capsule, Mark, travel};
use super::stages::take;
use super::{Effort, Line, RISING, interrupted};
use crate::input::value::Value;
use crate::platform::error::Result;
use crate::platform::stop::Stop;

/// Name of the whole step's kernel.
pub const STEP: &str = "step";
/// Name of the film's part of a step: membrane and update at a fixed pressure.
pub const FILM: &str = "film";
/// Name of the scalar reference of the film's part.
pub const REFERENCE: &str = "reference";

/// What a kernel takes.
#[derive(Debug, Clone, PartialEq)]
pub struct KernelRow {
    /// n.
    pub subdivisions: u32,
    /// Its name: [`STEP`], [`FILM`], [`REFERENCE`].
    pub kernel: &'static str,
    /// Instruction set.
    pub path: InstructionSet,
    /// ns per element and step.
    pub cost: f64,
}

impl KernelRow {
    /// As a row.
    pub fn line(&self) -> Line {
        vec![
            ("subdivisions", Value::Integer(self.subdivisions.into())),
            ("kernel", Value::Text(self.kernel.to_owned())),
            ("path", Value::Text(self.path.name().to_owned())),
            ("ns_per_element_step", Value::Number(self.cost)),
        ]
    }
}

/// Times the kernels on a mesh: the step and the film's part of it on every instruction set up to
/// `path`, the reference.
///
/// # Errors
/// A run that stops short; a signal.
pub fn measure(
    subdivisions: u32,
    path: InstructionSet,
    effort: Effort,
    stop: &Stop,
) -> Result<Vec<KernelRow>> {
    let capsule = Capsule::new(subdivisions, path)?.without_contact();
    // Part of the film is taut by then, part wrinkled, part slack.
    let mark = Mark { time: RISING, state: Some("rising"), case: false };
    let (states, _) = travel(&capsule, &[mark], stop)?;
    let film = &states[0].run.film;
    let (elements, steps) = (film.model.elements(), effort.kernel_steps());
    let row = |kernel, path, seconds: f64| KernelRow {
        subdivisions,
        kernel,
        path,
        cost: 1e9 * seconds / (steps as f64 * elements as f64),
    };
    let mut rows = Vec::new();
    let widths = InstructionSet::ALL.into_iter().take_while(|narrow| *narrow != path).chain([path]);
    let widths: Vec<InstructionSet> = widths.filter(|width| width.available()).collect();
    for width in widths.iter().copied() {
        let seconds = least(effort, stop, &mut || stepped(film, width, &capsule.course, steps))?;
        rows.push(row(STEP, width, seconds));
    }
    // The same work as the step's, at a fixed pressure: nothing else is in either.
    let push = KickParameters {
        overpressure: film.overpressure(),
        gravity: film.parameters.gravity,
        weight_factor: 1.0,
        velocity_factor: 1.0,
        acceleration_factor: film.state.last_step,
        contact_active: false,
    };
    let (free, length) = (&film.parameters.supports.free, film.state.last_step);
    let moving = |path| {
        let (places, velocities) = (film.state.positions.clone(), film.state.velocities.clone());
        FilmMotion::new(path, &film.model, places, velocities)
    };
    for width in widths {
        let seconds = least(effort, stop, &mut || {
            let mut own = moving(width);
            Ok(timed(steps, &mut || {
                black_box(vector_step(width, &film.model, &push, free, length, &mut own));
            }))
        })?;
        rows.push(row(FILM, width, seconds));
    }
    let seconds = least(effort, stop, &mut || {
        let mut own = moving(InstructionSet::Scalar);
        Ok(timed(steps, &mut || {
            black_box(reference_step(&film.model, &push, free, length, &mut own));
        }))
    })?;
    rows.push(row(REFERENCE, InstructionSet::Scalar, seconds));
    Ok(rows)
}

/// Seconds of so many steps on a path.
fn stepped(film: &Explicit, path: InstructionSet, course: &Timeline, steps: u64) -> Result<f64> {
    let mut film = film.clone();
    film.parameters.instruction_set = path;
    let start = Instant::now();
    take(&mut film, course, steps, &mut Untimed)?;
    Ok(start.elapsed().as_secs_f64())
}

/// Seconds of so many calls.
fn timed(calls: u64, work: &mut dyn FnMut()) -> f64 {
    let start = Instant::now();
    (0..calls).for_each(|_| work());
    start.elapsed().as_secs_f64()
}

/// The least of some repeats, s.
fn least(effort: Effort, stop: &Stop, once: &mut dyn FnMut() -> Result<f64>) -> Result<f64> {
    let mut least = f64::INFINITY;
    for _ in 0..effort.kernel_repeats() {
        least = least.min(once()?);
        interrupted(stop)?;
    }
    Ok(least)
}
