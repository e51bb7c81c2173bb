//! What film alone takes: membrane, gas and update of a step without contact, beside a plain scalar
//! reference in the same run, on the same state.

use std::time::Instant;

use billow_solver::course::Course;
use billow_solver::forces::membrane::{ElementForces, NodeForces, element_pass, node_pass};
use billow_solver::integrate::explicit::Explicit;
use billow_solver::simd::Path;
use billow_solver::stages::Untimed;

use super::capsule::{Capsule, Mark, travel};
use super::stages::take;
use super::{Effort, Line, RISING, interrupted};
use crate::error::Result;
use crate::stop::Stop;
use crate::value::Value;

/// Name of the whole step's kernel.
pub const STEP: &str = "step";
/// Name of the scalar reference.
pub const REFERENCE: &str = "reference";

/// What a kernel takes.
#[derive(Debug, Clone, PartialEq)]
pub struct KernelRow {
    /// n.
    pub subdivisions: u32,
    /// Its name: [`STEP`], `element_pass`, `node_pass`, [`REFERENCE`].
    pub kernel: &'static str,
    /// Instruction set.
    pub path: Path,
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

/// Times the kernels on a mesh: the step and its element pass on every instruction set up to `path`,
/// the node pass, the reference.
///
/// # Errors
/// A run that stops short; a signal.
pub fn measure(
    subdivisions: u32,
    path: Path,
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
    let widths = Path::ALL.into_iter().take_while(|narrow| *narrow != path).chain([path]);
    let widths: Vec<Path> = widths.filter(|width| width.available()).collect();
    for width in widths.iter().copied() {
        let seconds = least(effort, stop, &mut || stepped(film, width, &capsule.course, steps))?;
        rows.push(row(STEP, width, seconds));
    }
    let mut own = ElementForces::new(&film.model);
    let (places, velocities) = (&film.state.places, &film.state.velocities);
    for width in widths {
        let seconds = least(effort, stop, &mut || {
            Ok(timed(steps, &mut || {
                let sums = element_pass(width, &film.model, places, velocities, &mut own);
                std::hint::black_box(sums);
            }))
        })?;
        rows.push(row("element_pass", width, seconds));
    }
    let mut nodes = NodeForces::new(&film.model);
    let seconds = least(effort, stop, &mut || {
        Ok(timed(steps, &mut || node_pass(&film.model, &own, std::hint::black_box(&mut nodes))))
    })?;
    rows.push(row("node_pass", path, seconds));
    let seconds = least(effort, stop, &mut || reference(film, &capsule.course, steps))?;
    rows.push(row(REFERENCE, Path::Scalar, seconds));
    Ok(rows)
}

/// Seconds of so many steps of the plain scalar reference.
///
/// TO BE SWAPPED BEFORE RELEASE: the step itself on the scalar path stands in for the plain kernel,
/// which is not in the tree yet.
fn reference(film: &Explicit, course: &Course, steps: u64) -> Result<f64> {
    stepped(film, Path::Scalar, course, steps)
}

/// Seconds of so many steps on a path.
fn stepped(film: &Explicit, path: Path, course: &Course, steps: u64) -> Result<f64> {
    let mut film = film.clone();
    film.setting.path = path;
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
