//! The same bits on every instruction set, and after a resume from any step.

use billow_solver::geometry::mesh::Shape;
use billow_solver::integrators::explicit::{Explicit, State};
use billow_solver::mechanics::forces::membrane::viscous_forces;
use billow_solver::models::film::capsule;
use billow_solver::platform::simd::InstructionSet;
use billow_solver::scene::inflow::Inflow;
use billow_solver::scene::timeline::Phase;

use crate::geometry::paper_design;
use crate::rig::paper_scene;

fn film(instruction_set: InstructionSet) -> Explicit {
    let mut scene = paper_scene();
    scene.design.subdivisions = 3;
    scene.film.compression = 0.01;
    scene.gravity = -9.8;
    let stowed = Shape::Stowed(paper_design().stowed_height);
    let (film, _) = capsule::film_scene(instruction_set, &scene, stowed, 0.45).unwrap();
    capsule::start(&film).unwrap()
}

const INFLOW: Phase = Phase {
    packed: false,
    inflow: Inflow { mass_flow_rate: 5e-3, temperature_flow: 5e-3 * 293.0 },
};

fn bits(state: &State) -> String {
    serde_json::to_string(state).unwrap()
}

#[test]
fn every_instruction_set_gives_the_same_bits() {
    let end = |instruction_set: InstructionSet| {
        let mut film = film(instruction_set);
        film.advance(8e-3, &INFLOW).unwrap();
        (bits(&film.state), film.ledger())
    };
    let scalar = end(InstructionSet::Scalar);
    for set in InstructionSet::ALL.into_iter().filter(|set| set.available()) {
        assert!(end(set) == scalar, "{}", set.name());
    }
}

#[test]
fn a_resumed_run_has_the_same_bits() {
    let whole = {
        let mut film = film(InstructionSet::detect());
        film.advance(2e-3, &INFLOW).unwrap();
        film.advance(3e-3, &INFLOW).unwrap();
        bits(&film.state)
    };
    for pause in [0, 1, 7, 40, 100] {
        let mut film = film(InstructionSet::detect());
        let mut steps = pause;
        for target in [2e-3, 3e-3] {
            while !film.advance_at_most(target, &INFLOW, &mut steps).unwrap() {
                // As text and back, as in a checkpoint.
                let state = serde_json::from_str(&bits(&film.state)).unwrap();
                film = Explicit::resume(film.model, film.parameters, state);
                steps = u64::MAX;
            }
        }
        assert!(bits(&film.state) == whole, "paused after {pause} steps");
    }
}

/// Targets that differ by rounding: in so short a step the rounding of a strain is not a strain rate.
#[test]
fn a_tiny_step_leaves_the_viscous_stress_unchanged() {
    let mut film = film(InstructionSet::detect());
    film.advance(2e-3, &INFLOW).unwrap();
    let drags = |film: &Explicit| {
        viscous_forces(&film.model, &film.state.positions, &film.state.viscous_history)
    };
    let (before, steps) = (drags(&film), film.state.steps);
    film.advance(2e-3_f64.next_up(), &INFLOW).unwrap();
    assert_eq!(film.state.steps, steps + 1);
    let size = before.iter().map(|force| force.norm()).fold(0.0, f64::max);
    assert!(size > 0.0);
    for (now, before) in drags(&film).iter().zip(before.iter()) {
        assert!((now - before).norm() < 1e-9 * size, "{now} {before}");
    }
}
