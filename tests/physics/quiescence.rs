//! Quiescent film takes longer steps without a larger error, until activity is detected.

use crate::film_rig::{INFLOW, capsule_film, edited, explicit, resumed, text};
use crate::prelude::*;

/// The paper's capsule at n 3 with contact, stowed.
fn capsule_in_contact() -> FilmSimulation {
    // A film that loses enough to come to rest within 0.4 s.
    let contact = Some(FilmContact::default());
    capsule_film(InstructionSet::detect(), contact, |scene| scene.film.numerical_damping = 0.1)
}

/// The film after this time (ms). With `never_quiescent`, activity is reported every millisecond.
fn after(milliseconds: u32, never_quiescent: bool) -> FilmSimulation {
    let mut film = capsule_in_contact();
    for target in 1..=milliseconds {
        if never_quiescent {
            film = edited(film, |stored| {
                let StoredIntegrator::Explicit(explicit) = &mut stored.integrator else { panic!() };
                explicit.motion.quiescence.last_active = stored.state.time;
            });
        }
        film.advance(1e-3 * f64::from(target), &INFLOW).unwrap();
    }
    film
}

#[test]
fn quiescent_film_takes_longer_steps_without_a_larger_energy_error() {
    let early = after(20, false);
    let (film, control) = (after(400, false), after(400, true));
    assert_eq!(after(20, true).view().state.positions, early.view().state.positions);
    let (steps, all) = (film.view().steps(), control.view().steps());
    assert!(f64::from(u32::try_from(steps).unwrap()) < 0.8 * all as f64, "{steps} of {all}");
    let ratio = explicit(&film).motion.last_step / explicit(&early).motion.last_step;
    assert!(ratio > 1.7 && ratio < 1.8, "{ratio}");

    let (ledger, control_ledger) = (film.view().ledger(), control.view().ledger());
    assert!((film.view().state.volume / control.view().state.volume - 1.0).abs() < 1e-4);
    // Both ledgers have the same defect to 1e-5 of the work of the gas, 40 J.
    let start = capsule_in_contact().view().ledger();
    let (defect, control_defect) = (ledger.defect(&start), control_ledger.defect(&start));
    assert!((defect - control_defect).abs() < 1e-5 * ledger.gas_work, "{defect} {control_defect}");
    assert!(
        (ledger.numerical_dissipation / control_ledger.numerical_dissipation - 1.0).abs() < 1e-3
    );
}

/// Quiescent film in an interval of 60 ms gets a downward velocity. The steps become short again, in
/// a run step by step with resumed states as in one call.
#[test]
fn activity_shortens_the_steps_of_quiescent_film() {
    let struck = {
        let mut film = after(400, false);
        let mut steps = 5;
        assert!(!film.advance_at_most(0.46, &INFLOW, &mut steps).unwrap());
        let interval = explicit(&film).motion.step_interval;
        assert!(interval.is_some_and(|interval| interval.quiescent));
        let events = film.take_events();
        assert_eq!(events.last().map(|event| event.kind), Some(EventKind::Quiescent));
        edited(film, |stored| {
            let StoredIntegrator::Explicit(explicit) = &mut stored.integrator else { panic!() };
            for node in 0..stored.state.positions.len() {
                let position = stored.state.positions.get(node);
                let down = Vector3::new(0.0, 0.0, -60.0 * position.z.max(0.0));
                explicit.motion.velocities.set(node, down);
            }
        })
    };
    let short_step = struck.view().next_step() * (1.0 + 1e-9);
    let last_active = |film: &FilmSimulation| explicit(film).motion.quiescence.last_active;

    let (mut film, mut active, mut taken) = (resumed(struck.clone()), false, 0_u32);
    let mut events = Vec::new();
    let mut steps = 1;
    while !film.advance_at_most(0.46, &INFLOW, &mut steps).unwrap() {
        assert!(!active || explicit(&film).motion.last_step <= short_step, "after {taken} steps");
        let moves = last_active(&film) > last_active(&struck);
        active |= !film.view().state.contact.contacts.is_empty() || moves;
        events.extend(film.take_events());
        (steps, taken) = (1, taken + 1);
        if taken % 97 == 0 {
            film = resumed(film);
        }
    }
    assert!(active && taken > 1000);
    assert_eq!(events.first().map(|event| event.kind), Some(EventKind::Active));

    let mut whole = resumed(struck);
    whole.advance(0.46, &INFLOW).unwrap();
    assert!(text(&whole) == text(&film), "step by step and resumed");
    events.extend(film.take_events());
    assert_eq!(whole.take_events(), events);
}
