//! Film in motion: moving supports, weight, typed stops. Momentum, the stable step and damping are
//! reference cases of `billow validate`.

use billow_solver::integrators::explicit::PressureLoad;
use billow_solver::mechanics::gas::GasState;
use billow_solver::mechanics::supports::Supports;
use billow_solver::output::ledger::Ledger;
use billow_solver::output::outcome::FailureKind;
use billow_solver::scene::film_support::{FilmSupport, Hold};
use billow_solver::scene::motion::{Motion, Profile};
use nalgebra::Vector3;

use crate::film_rig::{at_rest, free, icosphere, mapped, nitrogen_gas, sheet};
use crate::rig::PAPER_FILM;

#[test]
fn a_moving_support_does_the_work_it_should() {
    let piece = sheet(6, 3, 0.3, 0.15);
    let mut film =
        at_rest(&piece, &PAPER_FILM, PressureLoad::Overpressure(0.0), GasState::default());
    let edge = |x: f64| -> Vec<u32> {
        let on = |node: &u32| (piece.nodes[*node as usize].x - x).abs() < 1e-12;
        (0..piece.nodes.len() as u32).filter(on).collect()
    };
    let (left, right) = (edge(0.0), edge(0.3));
    let start = film.ledger();
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
    film.parameters.supports = Supports::new(&[left, right], &film.state.positions);
    film.advance(1e-3, &free()).unwrap();
    film.advance(2e-3, &free()).unwrap();
    let end: Ledger = film.ledger();
    println!("moving support: {end:?}, defect {}", end.defect(&start));
    let moved = film.state.positions.get(right_node) - piece.nodes[right_node];
    assert!((moved - Vector3::new(2e-3, 0.5e-3, 1e-3)).norm() < 1e-14);
    assert!(end.support_work > 0.09 && end.strain > 0.09 && end.viscous_work > 0.0);
    assert!(end.defect(&start).abs() < 5e-3 * end.support_work, "{}", end.defect(&start));
}

#[test]
fn weight_falls_as_it_should() {
    let piece = icosphere(0, 0.5);
    let mut film =
        at_rest(&piece, &PAPER_FILM, PressureLoad::Overpressure(0.0), GasState::default());
    film.parameters.gravity = Vector3::new(0.0, 0.0, -9.806_65);
    film.advance(0.1, &free()).unwrap();
    let drop = film.state.positions.z[0] - piece.nodes[0].z;
    assert!((drop / (-0.5 * 9.806_65 * 0.01) - 1.0).abs() < 1e-12, "{drop}");
    let ledger = film.ledger();
    assert!((ledger.kinetic / ledger.gravity_work - 1.0).abs() < 1e-3, "{ledger:?}");
}

#[test]
fn typed_stops() {
    let piece = icosphere(1, 0.5);
    let gas = nitrogen_gas();
    let mut film =
        at_rest(&piece, &PAPER_FILM, PressureLoad::Gas(gas), gas.at_temperature(1e-3, 293.0));
    film.parameters.step_limit = 7;
    let failure = film.advance(1.0, &free()).unwrap_err();
    assert_eq!((failure.kind, film.state.steps), (FailureKind::StepLimit, 7));

    film.parameters.step_limit = u64::MAX;
    film.parameters.cfl = 3.0;
    let failure = film.advance(1.0, &free()).unwrap_err();
    assert_eq!(failure.kind, FailureKind::Unstable, "{failure:?}");
    assert!(failure.place.starts_with("node ") && failure.time < 0.1, "{failure:?}");

    // Thrown through itself, turned inside out.
    let mut film = at_rest(&piece, &PAPER_FILM, PressureLoad::Gas(gas), GasState::default());
    film.state.velocities = mapped(&piece, |x| x * -400.0);
    let failure = film.advance(1.0, &free()).unwrap_err();
    assert_eq!(failure.kind, FailureKind::InvertedVolume, "{failure:?}");
}
