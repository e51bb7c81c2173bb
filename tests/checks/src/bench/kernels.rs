//! Cost of a step without contact: membrane, gas and update, and a plain scalar reference in the same
//! run, from the same state.

use std::hint::black_box;
use std::time::Instant;

use billow_solver::integrators::FilmSimulation;
use billow_solver::integrators::explicit::update::KickParameters;
use billow_solver::platform::simd::InstructionSet;
use billow_solver::platform::stopwatch::Untimed;
use billow_solver::scene::timeline::Timeline;
use billow_solver::system::FilmSystem;
use billow_study::platform::error::Result;

use super::capsule::{Capsule, Progress};
use super::reference_step::{FilmMotion, reference_step, vector_step};
use super::stages::take_steps;
use super::{Effort, Plan, RISING, Row};
use crate::cases::rig::explicit;

/// Times the kernels on a mesh: the step (`step`) and the film's part of it at a fixed pressure (`film`) on every
/// available instruction set up to the one in use, and the scalar reference of the film's part (`reference`).
///
/// # Errors
/// A failure of the run.
pub(super) fn measure(subdivisions: u32, plan: &Plan<'_>) -> Result<Vec<Row>> {
    let capsule = Capsule::new(subdivisions, plan.instruction_set)?.without_contact();
    // At this time part of the film is taut, part wrinkled, part slack.
    let mut progress = Progress::of(&capsule)?;
    progress.run_to(RISING)?;
    let film = &progress.film.film;
    let (now, length) = (film.view(), explicit(film).motion.last_step);
    let model = &now.system.model;
    let (steps, repeats) = if plan.effort == Effort::Quick { (50, 2) } else { (200, 7) };
    let mut rows = Vec::new();
    let mut add =
        |kernel: &'static str, set: InstructionSet, once: &mut dyn FnMut() -> Result<f64>| {
            let mut least = f64::INFINITY;
            for _ in 0..repeats {
                least = least.min(once()?);
            }
            rows.push(vec![
                ("subdivisions", subdivisions.into()),
                ("kernel", kernel.into()),
                ("instruction_set", set.name().into()),
                (
                    "ns_per_element_step",
                    (1e9 * least / (steps as f64 * model.elements() as f64)).into(),
                ),
            ]);
            Result::Ok(())
        };
    let narrower = InstructionSet::ALL.into_iter().take_while(|set| *set != plan.instruction_set);
    let sets = narrower.chain([plan.instruction_set]).filter(|set| set.available());
    let sets: Vec<InstructionSet> = sets.collect();
    for set in sets.iter().copied() {
        add("step", set, &mut || step_seconds(film, set, &capsule.timeline, steps))?;
    }
    // Membrane and update as in the step, at a fixed pressure.
    let push = KickParameters {
        overpressure: now.overpressure(),
        gravity: now.system.gravity,
        weight_factor: 1.0,
        velocity_factor: 1.0,
        acceleration_factor: length,
        contact_active: false,
    };
    let free = &now.system.supports.free;
    let moving = |set| {
        let (positions, velocities) = (now.state.positions.clone(), now.state.velocities.clone());
        FilmMotion::new(set, model, positions, velocities)
    };
    for set in sets {
        add("film", set, &mut || {
            let mut motion = moving(set);
            Ok(timed(steps, &mut || {
                black_box(vector_step(set, model, &push, free, length, &mut motion));
            }))
        })?;
    }
    add("reference", InstructionSet::Scalar, &mut || {
        let mut motion = moving(InstructionSet::Scalar);
        Ok(timed(steps, &mut || {
            black_box(reference_step(model, &push, free, length, &mut motion));
        }))
    })?;
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
