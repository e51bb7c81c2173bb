//! The same bits on every instruction set, and in a run resumed from any step.

use billow_solver::integrators::FilmSimulation;
use billow_solver::mechanics::forces::membrane::numerical_forces;
use billow_solver::models::film::capsule;
use billow_solver::platform::simd::InstructionSet;

use crate::film_rig::{INFLOW, explicit, resumed, stowed, text};
use crate::rig::paper_scene;

fn film(instruction_set: InstructionSet) -> FilmSimulation {
    let mut scene = paper_scene();
    scene.design.subdivisions = 3;
    scene.film.compression = 0.01;
    scene.gravity = -9.8;
    let film = stowed(instruction_set, &scene, 0.45);
    capsule::start(&film, &[]).unwrap()
}

#[test]
fn every_instruction_set_gives_the_same_bits() {
    let end = |instruction_set: InstructionSet| {
        let mut film = film(instruction_set);
        film.advance(8e-3, &INFLOW).unwrap();
        (text(&film), film.view().ledger())
    };
    let scalar = end(InstructionSet::Scalar);
    for instruction_set in InstructionSet::ALL.into_iter().filter(|set| set.available()) {
        assert!(end(instruction_set) == scalar, "{}", instruction_set.name());
    }
}

#[test]
fn a_resumed_run_has_the_same_bits_from_any_step() {
    let whole = {
        let mut film = film(InstructionSet::detect());
        film.advance(2e-3, &INFLOW).unwrap();
        film.advance(3e-3, &INFLOW).unwrap();
        text(&film)
    };
    for pause in [0, 1, 7, 40, 100] {
        let mut film = film(InstructionSet::detect());
        let mut steps = pause;
        for target in [2e-3, 3e-3] {
            while !film.advance_at_most(target, &INFLOW, &mut steps).unwrap() {
                // To text and back, as a checkpoint does.
                film = resumed(film);
                steps = u64::MAX;
            }
        }
        assert!(text(&film) == whole, "paused after {pause} steps");
    }
}

/// Two targets differ by rounding. Over such a short step, the rounding error of a stress must not
/// count as a stress rate.
#[test]
fn a_step_of_rounding_length_does_not_change_numerical_forces() {
    let mut film = film(InstructionSet::detect());
    film.advance(2e-3, &INFLOW).unwrap();
    let damping = |film: &FilmSimulation| {
        let (now, histories) = (film.view(), explicit(film).histories);
        numerical_forces(&now.system.model, &now.state.positions, &histories)
    };
    let (before, steps) = (damping(&film), film.view().steps());
    film.advance(2e-3_f64.next_up(), &INFLOW).unwrap();
    assert_eq!(film.view().steps(), steps + 1);
    let size = before.iter().map(|force| force.norm()).fold(0.0, f64::max);
    assert!(size > 0.0);
    for (now, before) in damping(&film).iter().zip(before.iter()) {
        assert!((now - before).norm() < 1e-9 * size, "{now} {before}");
    }
}
