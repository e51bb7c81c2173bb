//! The folded capsule with contact and tunnelling monitor: the same bits on every instruction set, and
//! after a resume from any step.

use billow_solver::integrators::FilmSimulation;
use billow_solver::models::film::capsule;
use billow_solver::platform::simd::InstructionSet;
use billow_solver::scene::film_scene::FilmContact;
use billow_solver::scene::monitor_settings::MonitorSettings;

use crate::film_rig::{INFLOW, explicit, resumed, stowed, text};
use crate::rig::paper_scene;

/// The paper's capsule, stowed, of film that resists compression, with friction. The monitor checks every
/// step of about half of the blocks.
fn capsule_in_contact(instruction_set: InstructionSet) -> FilmSimulation {
    let mut scene = paper_scene();
    scene.design.subdivisions = 3;
    scene.film.compression = 1.0;
    let mut film = stowed(instruction_set, &scene, 0.45);
    let monitor = MonitorSettings { block: 50, dense_block_period: 2, seed: 1 };
    film.contact = Some(FilmContact { friction: 0.2, monitor, ..FilmContact::default() });
    capsule::start(&film, &[]).unwrap()
}

#[test]
fn contact_and_monitor_bits_are_equal_on_every_instruction_set() {
    let end = |instruction_set: InstructionSet| {
        let mut film = capsule_in_contact(instruction_set);
        film.advance(0.02, &INFLOW).unwrap();
        film
    };
    let scalar = end(InstructionSet::Scalar);
    assert!(
        scalar.view().accounting().works.contact != 0.0
            && scalar.view().ledger().contact_dissipation != 0.0
    );
    for set in InstructionSet::ALL.into_iter().filter(|set| set.available()) {
        let film = end(set);
        assert!(text(&film) == text(&scalar), "{}", set.name());
        assert!(film.view().forces() == scalar.view().forces(), "{}", set.name());
        assert_eq!(film.view().ledger(), scalar.view().ledger(), "{}", set.name());
        assert_eq!(film.view().smallest_gap().to_bits(), scalar.view().smallest_gap().to_bits());
        assert_eq!(film.view().passages(), scalar.view().passages(), "{}", set.name());
        assert_eq!(film.view().intersections(), scalar.view().intersections(), "{}", set.name());
    }
}

#[test]
fn a_resumed_run_with_contact_has_the_same_bits() {
    let mut whole = capsule_in_contact(InstructionSet::detect());
    whole.advance(0.02, &INFLOW).unwrap();
    assert!(explicit(&whole).path_length > 0.1);
    assert!(whole.view().accounting().works.contact != 0.0);
    for pause in [1, 100, 777, 1300] {
        let mut film = capsule_in_contact(InstructionSet::detect());
        let mut steps = pause;
        assert!(!film.advance_at_most(0.02, &INFLOW, &mut steps).unwrap());
        let mut film = resumed(film);
        film.advance(0.02, &INFLOW).unwrap();
        assert!(text(&film) == text(&whole), "paused after {pause} steps");
    }
}
