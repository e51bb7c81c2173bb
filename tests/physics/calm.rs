//! Calm film takes longer steps: as exact as before, until something stirs it.

use billow_solver::geometry::mesh::Shape;
use billow_solver::integrators::explicit::{DEFAULT_CFL, Explicit, State};
use billow_solver::models::film::capsule;
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
    let (mut film, _) = capsule::film_scene(&scene, stowed, DEFAULT_CFL).unwrap();
    film.contact = Some(FilmContact::default());
    capsule::start(&film).unwrap()
}

/// Advances by milliseconds; `never_calm` film has just been seen to move, always.
fn after(milliseconds: u32, never_calm: bool) -> Explicit {
    let mut film = stowed();
    for target in 1..=milliseconds {
        if never_calm {
            film.state.calm.lively = film.state.time;
        }
        film.advance(1e-3 * f64::from(target), &INFLOW).unwrap();
    }
    film
}

#[test]
fn calm_film_takes_longer_steps_and_no_larger_error() {
    let at_first = after(20, false);
    let (film, control) = (after(400, false), after(400, true));
    assert_eq!(after(20, true).state.places, at_first.state.places);
    let (steps, all) = (film.state.steps, control.state.steps);
    assert!(f64::from(u32::try_from(steps).unwrap()) < 0.8 * all as f64, "{steps} of {all}");
    assert!(film.state.last_step > 1.7 * at_first.state.last_step);
    assert!(film.state.last_step < 1.8 * at_first.state.last_step);

    let (own, its) = (film.ledger(), control.ledger());
    assert!((film.state.volume / control.state.volume - 1.0).abs() < 1e-4);
    // Of what the film was given, 40 J: what is missing is the same to a hundredth of a thousandth.
    let start = stowed().ledger();
    let (missing, its_missing) = (own.defect(&start), its.defect(&start));
    assert!((missing - its_missing).abs() < 1e-5 * own.gas_work, "{missing} {its_missing}");
    assert!((own.viscous_work / its.viscous_work - 1.0).abs() < 1e-3);
}

/// Film standing calm on a way of 60 ms is struck down; told by every step, and by a state put back on.
#[test]
fn what_stirs_calm_film_shortens_its_steps() {
    let struck = {
        let mut film = after(400, false);
        let mut steps = 5;
        assert!(!film.advance_at_most(0.46, &INFLOW, &mut steps).unwrap());
        assert!(film.state.stretch.as_ref().is_some_and(|stretch| stretch.calm));
        for node in 0..film.model.nodes() {
            let place = film.state.places.get(node);
            let down = Vector3::new(0.0, 0.0, -60.0 * place.z.max(0.0));
            film.state.velocities.set(node, down);
        }
        film
    };
    let careful = struck.stable_step() * (1.0 + 1e-9);
    let text = |film: &Explicit| serde_json::to_string(&film.state).unwrap();
    let again = |film: Explicit| {
        let state: State = serde_json::from_str(&text(&film)).unwrap();
        Explicit::resume(film.model, film.setting, state)
    };

    let (mut film, mut stirred, mut taken) = (again(struck.clone()), false, 0_u32);
    let mut steps = 1;
    while !film.advance_at_most(0.46, &INFLOW, &mut steps).unwrap() {
        assert!(!stirred || film.state.last_step <= careful, "after {taken} steps");
        let moves = film.state.calm.lively > struck.state.calm.lively;
        stirred |= !film.state.meeting.contacts.is_empty() || moves;
        (steps, taken) = (1, taken + 1);
        if taken % 97 == 0 {
            film = again(film);
        }
    }
    assert!(stirred && taken > 1000);

    let mut whole = again(struck);
    whole.advance(0.46, &INFLOW).unwrap();
    assert!(text(&whole) == text(&film), "told step by step and put back on");
}
