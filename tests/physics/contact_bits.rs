//! The folded capsule with contact, put back on its state: the same bits from any step on.

use billow_solver::geometry::mesh::Shape;
use billow_solver::integrators::explicit::Explicit;
use billow_solver::models::film::capsule;
use billow_solver::scene::film_scene::FilmContact;
use billow_solver::scene::inflow::Inflow;
use billow_solver::scene::timeline::Phase;

use crate::geometry::paper_design;
use crate::rig::paper_scene;

const INFLOW: Phase = Phase {
    packed: false,
    inflow: Inflow { mass_flow_rate: 5e-3, temperature_flow: 5e-3 * 293.0 },
};

/// The paper's capsule of film that bears compression, stowed.
fn stowed() -> Explicit {
    let mut scene = paper_scene();
    scene.design.subdivisions = 3;
    scene.film.compression = 1.0;
    let stowed = Shape::Stowed(paper_design().stowed_height);
    let (mut film, _) = capsule::film_scene(&scene, stowed, 0.45).unwrap();
    film.contact = Some(FilmContact::default());
    capsule::start(&film).unwrap()
}

#[test]
fn contact_goes_on_bit_for_bit_from_any_step() {
    let text = |film: &Explicit| serde_json::to_string(&film.state).unwrap();
    let mut whole = stowed();
    whole.advance(0.02, &INFLOW).unwrap();
    assert!(whole.state.meeting.path_length > 0.1 && whole.state.works.contact != 0.0);
    for pause in [1, 100, 777, 1500] {
        let mut film = stowed();
        let mut steps = pause;
        assert!(!film.advance_at_most(0.02, &INFLOW, &mut steps).unwrap());
        let state = serde_json::from_str(&text(&film)).unwrap();
        let mut film = Explicit::resume(film.model, film.setting, state);
        film.advance(0.02, &INFLOW).unwrap();
        assert!(text(&film) == text(&whole), "paused after {pause} steps");
    }
}
