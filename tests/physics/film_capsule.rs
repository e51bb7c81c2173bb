//! The paper's capsule as film: conservation, its static states, and audits of film that sticks.

use billow_solver::models::film::{self, static_states};
use billow_solver::scene::paper;

use crate::prelude::*;

pub fn run(scene: &Scene, cfl: f64) -> Deployment {
    film::solve(InstructionSet::detect(), scene, cfl, None, &mut Unobserved).expect("a valid scene")
}

/// n 4 is coarser than any mesh that decides a verdict. The film sags between its folds, so volume
/// and rim height lie below those of the cone. Both rise with pressure.
#[test]
fn static_states_rise_with_pressure() {
    for subdivisions in [4, 5] {
        let scene = paper::capsule(subdivisions, 0.3);
        let states =
            static_states(InstructionSet::detect(), &scene, &[1000.0, 100.0, 10.0, 1.0]).unwrap();
        for pair in states.windows(2) {
            assert!(pair[1].volume < pair[0].volume, "{pair:?}");
        }
        assert!(states.iter().all(|s| s.volume > 0.5 && s.volume < 0.7 && s.height > 0.8));
    }
}

/// Everything that can do work or carry energy takes part, on the ground and with a late release.
#[test]
fn every_ledger_entry_takes_part_in_the_balance() {
    let mut scene = paper::capsule(2, 0.1);
    scene.gravity = -9.806_65;
    scene.gas.ambient_pressure = 20.0;
    scene.gas.initial_mass = 1e-5;
    scene.gas.leak_area = 2e-4;
    scene.gas.heat_transfer = HeatTransfer::Coefficient(3.0);
    scene.release_time = 0.02;
    scene.film.compression = 1e-3;
    let deployment = run(&scene, DEFAULT_CFL);
    assert_eq!(deployment.stop, Stop::Done);
    let history = &deployment.history;
    let moved = [
        "gas_work",
        "ambient_work",
        "gravity_work",
        "numerical_dissipation",
        "heat",
        "enthalpy_out",
    ];
    for name in moved {
        assert!(history.column(name).last().unwrap().abs() > 1e-2, "{name}");
    }
    assert!(deployment.audit.ledger_residual < 5e-3, "{:?}", deployment.audit);
    assert!(deployment.audit.gas_residual < 1e-12, "{:?}", deployment.audit);
    scene.gas.heat_transfer = HeatTransfer::Isothermal;
    let deployment = run(&scene, DEFAULT_CFL);
    assert!(deployment.audit.ledger_residual < 5e-3, "{:?}", deployment.audit);
    assert!(deployment.audit.gas_residual < 1e-12, "{:?}", deployment.audit);
}

/// Nodes come into the range of adhesion and leave it, where the force is small.
#[test]
fn film_that_sticks_passes_its_audits() {
    let mut scene = paper::empty_capsule(4, 0.03);
    scene.gas.initial_mass = 5e-5;
    let contact = Some(FilmContact { adhesion: 32e3, ..FilmContact::default() });
    let set = InstructionSet::detect();
    let deployment = film::solve(set, &scene, DEFAULT_CFL, contact, &mut Unobserved).unwrap();
    let pairs = deployment.tracks.iter().find(|track| track.name == "contact_pairs").unwrap();
    assert!(pairs.values[10..].iter().all(|pairs| *pairs > 0.0), "{pairs:?}");
    assert_eq!(deployment.stop, Stop::Done);
}

#[test]
fn a_cfl_number_out_of_range_is_refused() {
    for cfl in [0.0, 1.5, f64::NAN] {
        let refused = film::solve(
            InstructionSet::detect(),
            &paper::capsule(2, 0.1),
            cfl,
            None,
            &mut Unobserved,
        );
        assert!(matches!(refused, Err(SceneError::Invalid { key, .. }) if key == "cfl"));
    }
}
