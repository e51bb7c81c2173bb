//! Film in motion: moving supports, free fall, failures. Momentum, the stable step and damping are
//! reference cases of `billow validate`.

use billow_solver::geometry::shapes::{icosphere, nodes_where, sheet};
use billow_solver::mechanics::gas::GasState;
use billow_solver::mechanics::supports::Supports;
use billow_solver::output::ledger::Ledger;
use billow_solver::output::outcome::FailureKind;
use billow_solver::scene::Film;
use billow_solver::scene::film_support::{FilmSupport, Hold};
use billow_solver::scene::motion::{Motion, Profile};
use billow_solver::system::PressureLoad;
use nalgebra::Vector3;

use crate::film_rig::{at_rest, free, mapped, nitrogen_gas};

#[test]
fn the_work_of_a_moving_support_balances() {
    let piece = sheet(6, 3, 0.3, 0.15);
    let mut film =
        at_rest(&piece, &Film::PAPER, PressureLoad::Overpressure(0.0), GasState::default());
    let edge = |x: f64| nodes_where(&piece, |position| (position.x - x).abs() < 1e-12);
    let (left, right) = (edge(0.0), edge(0.3));
    let start = film.view().ledger();
    let motion = Motion {
        from: 0.0,
        to: 1e-3,
        profile: Profile::Linear,
        translation: Vector3::new(2e-3, 0.5e-3, 1e-3),
        rotation: None,
    };
    let hold = Hold::Components([true; 3]);
    let [left, right] = [(left, None), (right, Some(motion))].map(|(nodes, motion)| FilmSupport {
        name: "edge".to_owned(),
        nodes,
        hold,
        motion,
    });
    let right_node = right.nodes[0] as usize;
    film.view().system.supports = Supports::new(&[left, right], &film.view().state.positions);
    film.advance(1e-3, &free()).unwrap();
    film.advance(2e-3, &free()).unwrap();
    let end: Ledger = film.view().ledger();
    println!("moving support: {end:?}, defect {}", end.defect(&start));
    let moved = film.view().state.positions.get(right_node) - piece.positions[right_node];
    assert!((moved - Vector3::new(2e-3, 0.5e-3, 1e-3)).norm() < 1e-14);
    assert!(end.support_work > 0.09 && end.strain > 0.09 && end.numerical_dissipation > 0.0);
    assert!(end.defect(&start).abs() < 5e-3 * end.support_work, "{}", end.defect(&start));
}

#[test]
fn free_fall_follows_gravity() {
    let piece = icosphere(0, 0.5);
    let mut film =
        at_rest(&piece, &Film::PAPER, PressureLoad::Overpressure(0.0), GasState::default());
    film.view().system.gravity = Vector3::new(0.0, 0.0, -9.806_65);
    film.advance(0.1, &free()).unwrap();
    let drop = film.view().state.positions.z[0] - piece.positions[0].z;
    assert!((drop / (-0.5 * 9.806_65 * 0.01) - 1.0).abs() < 1e-12, "{drop}");
    let ledger = film.view().ledger();
    assert!((ledger.kinetic / ledger.gravity_work - 1.0).abs() < 1e-3, "{ledger:?}");
}

#[test]
fn failures_have_their_kind() {
    let piece = icosphere(1, 0.5);
    let gas = nitrogen_gas();
    let mut film =
        at_rest(&piece, &Film::PAPER, PressureLoad::Gas(gas), gas.at_temperature(1e-3, 293.0));
    film.view().system.step_limit = 7;
    let failure = film.advance(1.0, &free()).unwrap_err();
    assert_eq!((failure.kind, film.view().steps()), (FailureKind::StepLimit, 7));

    film.view().system.step_limit = u64::MAX;
    film.view().system.cfl = 3.0;
    let failure = film.advance(1.0, &free()).unwrap_err();
    assert_eq!(failure.kind, FailureKind::Unstable, "{failure:?}");
    assert!(failure.place.starts_with("node ") && failure.time < 0.1, "{failure:?}");

    // Soft film under a pressure far beyond its modulus stretches without end; its energy balances.
    let soft = Film { youngs_modulus: 1e4, ..Film::PAPER_ELASTIC };
    let mut film = at_rest(&piece, &soft, PressureLoad::Overpressure(50.0), GasState::default());
    film.view().system.cfl = 0.01;
    let failure = film.advance(10.0, &free()).unwrap_err();
    assert_eq!(failure.kind, FailureKind::Overstretched, "{failure:?}");
    assert!(failure.place.contains("times its length"), "{failure:?}");

    // A node faster than the waves of its film is no failure.
    let mut film = at_rest(&piece, &soft, PressureLoad::Overpressure(0.0), GasState::default());
    let speed = 3.0 * film.view().system.model.wave_speed();
    film.view().state.velocities = mapped(&piece, |_| Vector3::x() * speed);
    film.view().state.start_energy = film.view().ledger().kinetic;
    film.advance(0.02, &free()).unwrap();

    // Thrown inward through itself, the sphere turns inside out.
    let mut film = at_rest(&piece, &Film::PAPER, PressureLoad::Gas(gas), GasState::default());
    film.view().state.velocities = mapped(&piece, |x| x * -400.0);
    film.view().state.start_energy = film.view().ledger().kinetic;
    let failure = film.advance(1.0, &free()).unwrap_err();
    assert_eq!(failure.kind, FailureKind::InvertedVolume, "{failure:?}");
}
