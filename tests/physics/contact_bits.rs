//! A resumed run of the folded capsule with contact has the same bits from any step on.

use billow_solver::integrators::explicit::Explicit;
use billow_solver::models::film::capsule;
use billow_solver::scene::film_scene::FilmContact;

use crate::film_rig::{INFLOW, stowed};
use crate::rig::paper_scene;

/// The paper's capsule with the full membrane stiffness in compression, stowed.
fn capsule_in_contact() -> Explicit {
    let mut scene = paper_scene();
    scene.design.subdivisions = 3;
    scene.film.compression = 1.0;
    let mut film = stowed(&scene, 0.45);
    film.contact = Some(FilmContact::default());
    capsule::start(&film).unwrap()
}

#[test]
fn resumed_contact_has_the_same_bits_from_any_step() {
    let text = |film: &Explicit| serde_json::to_string(&film.state).unwrap();
    let mut whole = capsule_in_contact();
    whole.advance(0.02, &INFLOW).unwrap();
    assert!(whole.state.meeting.path > 0.1 && whole.state.works.contact != 0.0);
    for pause in [1, 100, 777, 1500] {
        let mut film = capsule_in_contact();
        let mut steps = pause;
        assert!(!film.advance_at_most(0.02, &INFLOW, &mut steps).unwrap());
        let state = serde_json::from_str(&text(&film)).unwrap();
        let mut film = Explicit::resume(film.model, film.setting, state);
        film.advance(0.02, &INFLOW).unwrap();
        assert!(text(&film) == text(&whole), "paused after {pause} steps");
    }
}
