//! Quiescent film takes longer steps without a larger error, until it is active again.

use billow_solver::geometry::mesh::Shape;
use billow_solver::integrators::explicit::{DEFAULT_CFL, Explicit, State};
use billow_solver::models::film::capsule;
use billow_solver::platform::simd::InstructionSet;
use billow_solver::scene::film_scene::FilmContact;
use billow_solver::scene::inflow::Inflow;
use billow_solver::scene::timeline::Phase;
use nalgebra::Vector3;

use crate::geometry::paper_design;
use crate::rig::paper_scene;

const INFLOW: Phase = Phase {
    packed: false,
    inflow: Inflow { mass_flow_rate: 5e-3, temperature_flow: 5e-3 * 293.0 },
};

/// The paper's capsule at n 3, stowed.
fn stowed() -> Explicit {
    let mut scene = paper_scene();
    scene.design.subdivisions = 3;
    let stowed = Shape::Stowed(paper_design().stowed_height);
    let (mut film, _) =
        capsule::film_scene(InstructionSet::detect(), &scene, stowed, DEFAULT_CFL).unwrap();
    film.contact = Some(FilmContact::default());
    capsule::start(&film).unwrap()
}

/// The film after so many milliseconds; with `always_active` it is never quiescent.
fn after(milliseconds: u32, always_active: bool) -> Explicit {
    let mut film = stowed();
    for target in 1..=milliseconds {
        if always_active {
            film.state.quiescence.last_active = film.state.time;
        }
        film.advance(1e-3 * f64::from(target), &INFLOW).unwrap();
    }
    film
}

#[test]
fn quiescent_film_takes_longer_steps_without_a_larger_error() {
    let at_first = after(20, false);
    let (film, control) = (after(400, false), after(400, true));
    assert_eq!(after(20, true).state.positions, at_first.state.positions);
    let (steps, all) = (film.state.steps, control.state.steps);
    assert!(f64::from(u32::try_from(steps).unwrap()) < 0.8 * all as f64, "{steps} of {all}");
    assert!(film.state.last_step > 1.7 * at_first.state.last_step);
    assert!(film.state.last_step < 1.8 * at_first.state.last_step);

    let (ledger, expected) = (film.ledger(), control.ledger());
    assert!((film.state.volume / control.state.volume - 1.0).abs() < 1e-4);
    // The energy errors agree to 1e-5 of the work of the gas, 40 J.
    let start = stowed().ledger();
    let (error, expected_error) = (ledger.defect(&start), expected.defect(&start));
    assert!((error - expected_error).abs() < 1e-5 * ledger.gas_work, "{error} {expected_error}");
    assert!((ledger.viscous_work / expected.viscous_work - 1.0).abs() < 1e-3);
}

/// Quiescent film within an interval of 60 ms gets a downward velocity. Stepped one by one with resumes,
/// and in one call.
#[test]
fn activity_shortens_the_steps_of_quiescent_film() {
    let struck = {
        let mut film = after(400, false);
        let mut steps = 5;
        assert!(!film.advance_at_most(0.46, &INFLOW, &mut steps).unwrap());
        assert!(film.state.step_interval.as_ref().is_some_and(|interval| interval.quiescent));
        for node in 0..film.model.nodes() {
            let place = film.state.positions.get(node);
            let down = Vector3::new(0.0, 0.0, -60.0 * place.z.max(0.0));
            film.state.velocities.set(node, down);
        }
        film
    };
    let max_step = struck.stable_step() * (1.0 + 1e-9);
    let text = |film: &Explicit| serde_json::to_string(&film.state).unwrap();
    let again = |film: Explicit| {
        let state: State = serde_json::from_str(&text(&film)).unwrap();
        Explicit::resume(film.model, film.parameters, state)
    };

    let (mut film, mut active, mut taken) = (again(struck.clone()), false, 0_u32);
    let mut steps = 1;
    while !film.advance_at_most(0.46, &INFLOW, &mut steps).unwrap() {
        assert!(!active || film.state.last_step <= max_step, "after {taken} steps");
        let moves = film.state.quiescence.last_active > struck.state.quiescence.last_active;
        active |= !film.state.contact_state.contacts.is_empty() || moves;
        (steps, taken) = (1, taken + 1);
        if taken % 97 == 0 {
            film = again(film);
        }
    }
    assert!(active && taken > 1000);

    let mut whole = again(struck);
    whole.advance(0.46, &INFLOW).unwrap();
    assert!(text(&whole) == text(&film), "single steps with resumes differ");
}
