//! Cost of a step without contact and of its membrane kernel, on each instruction set, from the same state.

use std::hint::black_box;
use std::time::Instant;

use billow_solver::geometry::field::Field;
use billow_solver::integrators::explicit::update::drift_nodes;
use billow_solver::mechanics::forces::membrane::{CreepStep, NodeForces, assemble_membrane};
use billow_solver::platform::simd::InstructionSet;
use billow_solver::platform::stopwatch::Untimed;
use billow_solver::system::FilmSystem;
use billow_study::platform::error::Result;

use super::capsule::{Capsule, Progress};
use super::stages::take_steps;
use super::{RISING, Row, cost, sets};
use crate::cases::rig::explicit;

/// Steps that are timed, and repeats of which the fastest counts.
const STEPS: u64 = 200;
const REPEATS: u32 = 7;

/// Times the kernels on a mesh: the whole step without contact (`step`); and positions and forces of the film alone
/// (`membrane`), while it moves at constant speed.
pub(super) fn measure(capsule: &Capsule, selected: InstructionSet) -> Result<Vec<Row>> {
    let capsule = capsule.without_contact();
    // At this time part of the film is taut, part wrinkled, part slack.
    let mut progress = Progress::of(&capsule)?;
    progress.run_to(RISING)?;
    let film = &progress.film.film;
    let (state, stored) = (film.view().state, explicit(film));
    let (model, length) = (&film.view().system.model, stored.motion.last_step);
    let step = |instruction_set| {
        let mut film = film
            .clone()
            .with(|system, settings| (FilmSystem { instruction_set, ..system }, settings));
        let start = Instant::now();
        take_steps(&mut film, &capsule.timeline, STEPS, &mut Untimed)?;
        Ok(start.elapsed().as_secs_f64())
    };
    let membrane = |set| {
        let (mut positions, mut histories): (Field, _) =
            (state.positions.clone(), stored.histories.clone());
        let (mut forces, mut creep) = (NodeForces::new(model), state.creep.clone());
        let mut next = creep.clone();
        let start = Instant::now();
        for _ in 0..STEPS {
            drift_nodes(set, &state.velocities, length, &mut positions);
            let step = &mut CreepStep { last: &creep, next: &mut next };
            let (histories, forces) = (&mut histories, &mut forces);
            black_box(assemble_membrane(set, model, &positions, length, step, histories, forces));
            std::mem::swap(&mut creep, &mut next);
        }
        Ok(start.elapsed().as_secs_f64())
    };
    let kernels: [(&str, &dyn Fn(InstructionSet) -> Result<f64>); 2] =
        [("step", &step), ("membrane", &membrane)];
    let mut rows = Vec::new();
    for (kernel, once) in kernels {
        for set in sets(selected) {
            let seconds: Result<Vec<f64>> = (0..REPEATS).map(|_| once(set)).collect();
            let least = seconds?.into_iter().fold(f64::INFINITY, f64::min);
            rows.push(vec![
                ("subdivisions", capsule.subdivisions.into()),
                ("kernel", kernel.into()),
                ("instruction_set", set.name().into()),
                ("ns_per_element_step", cost(least, STEPS, model.elements()).into()),
            ]);
        }
    }
    Ok(rows)
}
