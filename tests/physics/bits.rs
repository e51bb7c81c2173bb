//! The paper's capsule without and with contact: the same bits on every instruction set.

use billow_solver::mechanics::forces::membrane::numerical_forces;

use crate::film_rig::{INFLOW, capsule_film, explicit, text};
use crate::prelude::*;

/// The paper's capsule, stowed; in contact with friction, full stiffness, bending and yield, and with a monitor that checks
/// every step of about half of the blocks.
fn film(set: InstructionSet, in_contact: bool) -> FilmSimulation {
    let monitor = MonitorSettings { block: 50, dense_block_period: 2, seed: 1 };
    let contact = FilmContact { friction: 0.2, monitor, ..FilmContact::default() };
    capsule_film(set, in_contact.then_some(contact), |scene| {
        scene.film.compression = if in_contact { 1.0 } else { 0.01 };
        scene.film.bending = in_contact;
        scene.film.yield_moment = in_contact.then_some(1e-6);
        scene.gravity = if in_contact { 0.0 } else { -9.8 };
    })
}

#[test]
fn every_instruction_set_gives_the_same_bits() {
    for (in_contact, time) in [(false, 8e-3), (true, 0.02)] {
        let end = |set: InstructionSet| {
            let mut film = film(set, in_contact);
            film.advance(time, &INFLOW).unwrap();
            film
        };
        let scalar = end(InstructionSet::Scalar);
        let touches = scalar.view().accounting().works.contact != 0.0
            && scalar.view().ledger().contact_dissipation != 0.0;
        assert_eq!(touches, in_contact);
        for set in InstructionSet::ALL.into_iter().filter(|set| set.available()) {
            let film = end(set);
            let (a, b, name) = (film.view(), scalar.view(), set.name());
            assert!(text(&film) == text(&scalar), "{name}");
            assert!(a.forces() == b.forces(), "{name}");
            assert_eq!(a.ledger(), b.ledger(), "{name}");
            assert_eq!(a.smallest_gap().to_bits(), b.smallest_gap().to_bits(), "{name}");
            let audited = [a, b].map(|view| (view.passages(), view.intersections()));
            assert_eq!(audited[0], audited[1], "{name}");
        }
    }
}

/// Two targets differ by rounding. Over such a short step, the rounding error of a stress must not
/// count as a stress rate.
#[test]
fn a_step_of_rounding_length_does_not_change_numerical_forces() {
    let mut film = film(InstructionSet::detect(), false);
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
