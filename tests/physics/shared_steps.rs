//! The folded capsule with contact, one thread or two: the same bits, changed at any step.

use billow_solver::geometry::mesh::Shape;
use billow_solver::integrators::explicit::Explicit;
use billow_solver::models::film::capsule;
use billow_solver::platform::simd::InstructionSet;
use billow_solver::platform::workers::Workers;
use billow_solver::scene::film_scene::FilmContact;
use billow_solver::scene::inflow::Inflow;
use billow_solver::scene::timeline::Phase;

use crate::geometry::paper_design;
use crate::rig::paper_scene;

const INFLOW: Phase =
    Phase { packed: false, inflow: Inflow { mass: 5e-3, mass_temperature: 5e-3 * 293.0 } };
const END: f64 = 5e-3;

/// The paper's capsule, stowed, with enough elements for two.
fn stowed(path: InstructionSet) -> Explicit {
    let mut scene = paper_scene();
    scene.design.subdivisions = 11;
    scene.film.compression = 0.01;
    scene.gravity = -9.8;
    let stowed = Shape::Stowed(paper_design().stowed_height);
    let (mut film, _) = capsule::film_scene(&scene, stowed, 0.45).unwrap();
    film.contact = Some(FilmContact::default());
    film.solver.path = path;
    capsule::start(&film).unwrap()
}

fn text(film: &Explicit) -> String {
    serde_json::to_string(&film.state).unwrap()
}

#[test]
fn two_threads_give_the_bits_of_one() {
    let mut alone = stowed(InstructionSet::Scalar);
    alone.advance(END, &INFLOW).unwrap();
    assert!(alone.state.steps > 500 && !alone.state.meeting.contacts.is_empty());
    for path in InstructionSet::ALL.into_iter().filter(|path| path.available()) {
        let mut film = stowed(path);
        film.share_with(Workers::of(2));
        film.advance(END, &INFLOW).unwrap();
        assert!(text(&film) == text(&alone), "{}", path.name());
        assert!(film.forces == alone.forces, "{}", path.name());
        assert_eq!(film.ledger(), alone.ledger(), "{}", path.name());
    }
}

#[test]
fn threads_may_change_at_any_step() {
    let mut whole = stowed(InstructionSet::detect());
    whole.advance(END, &INFLOW).unwrap();
    for (pause, before, after) in [(1, 2, 2), (99, 1, 2), (250, 2, 1), (431, 2, 2)] {
        let mut film = stowed(InstructionSet::detect());
        film.share_with(Workers::of(before));
        assert!(!film.advance_at_most(END, &INFLOW, &mut pause.clone()).unwrap());
        // Put back on its state, and merely given other workers.
        let state = serde_json::from_str(&text(&film)).unwrap();
        let mut resumed = Explicit::resume(film.model.clone(), film.setting.clone(), state);
        for film in [&mut film, &mut resumed] {
            film.share_with(Workers::of(after));
            film.advance(END, &INFLOW).unwrap();
            assert!(text(film) == text(&whole), "paused after {pause} steps");
        }
    }
}
