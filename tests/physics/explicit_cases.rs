//! Film in motion: moving supports, order in the step, failures. Free flight, drums, momentum and damping are reference
//! cases of `billow-checks validate`.

use billow_solver::geometry::shapes::{icosphere, nodes_where, sheet};

use crate::film_rig::{free, mapped, model, moving, nitrogen_gas, orders, still, unloaded};
use crate::prelude::*;

#[test]
fn the_work_of_a_moving_support_balances() {
    let piece = sheet(6, 3, 0.3, 0.15);
    let edge = |x: f64| nodes_where(&piece, |position| (position.x - x).abs() < 1e-12);
    let (left, right) = (edge(0.0), edge(0.3));
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
    let positions = Field::of(&piece.positions);
    let mut film = still(&piece, &Film::PAPER, unloaded(), |system, _| {
        system.supports = Supports::new(&[left, right], &positions);
    });
    let start = film.view().ledger();
    film.advance(1e-3, &free()).unwrap();
    film.advance(2e-3, &free()).unwrap();
    let end: Ledger = film.view().ledger();
    for node in edge(0.0) {
        let state = film.view().state;
        assert_eq!(state.positions.get(node as usize), piece.positions[node as usize]);
        assert_eq!(state.velocities.get(node as usize), Vector3::zeros());
    }
    let moved = film.view().state.positions.get(right_node) - piece.positions[right_node];
    assert!((moved - Vector3::new(2e-3, 0.5e-3, 1e-3)).norm() < 1e-14);
    assert!(end.support_work > 0.09 && end.strain > 0.09 && end.numerical_dissipation > 0.0);
    assert!(end.defect(&start).abs() < 5e-3 * end.support_work, "{}", end.defect(&start));
}

#[test]
fn failures_have_their_kind() {
    let piece = icosphere(1, 0.5);
    let gas = nitrogen_gas();
    let filled = (PressureLoad::Gas(gas), gas.at_temperature(1e-3, 293.0));
    let mut film = still(&piece, &Film::PAPER, filled, |_, settings| {
        settings.step_limit = 7;
    });
    let failure = film.advance(1.0, &free()).unwrap_err();
    assert_eq!((failure.kind, film.view().steps()), (FailureKind::StepLimit, 7));

    let mut film = still(&piece, &Film::PAPER, filled, |_, settings| {
        settings.cfl = 3.0;
    });
    let failure = film.advance(1.0, &free()).unwrap_err();
    assert_eq!(failure.kind, FailureKind::Unstable, "{failure:?}");
    assert!(failure.place.starts_with("node ") && failure.time < 0.1, "{failure:?}");

    // Soft film under a pressure far beyond its modulus stretches without end; its energy balances.
    let soft = Film { youngs_modulus: 1e4, ..Film::PAPER_ELASTIC };
    let pressed = (PressureLoad::Overpressure(50.0), GasState::default());
    let mut film = still(&piece, &soft, pressed, |_, settings| settings.cfl = 0.01);
    let failure = film.advance(10.0, &free()).unwrap_err();
    assert_eq!(failure.kind, FailureKind::Overstretched, "{failure:?}");
    assert!(failure.place.contains("times its length"), "{failure:?}");

    // A node faster than the waves of its film is no failure.
    let wave_speed = model(&piece, &soft).wave_speed();
    let fast = mapped(&piece, |_| Vector3::x() * (3.0 * wave_speed));
    let mut film = moving(&piece, &soft, unloaded(), fast, |_, _| ());
    film.advance(0.02, &free()).unwrap();

    // Thrown inward through itself, the sphere turns inside out.
    let (empty, inward) =
        ((PressureLoad::Gas(gas), GasState::default()), mapped(&piece, |x| x * -400.0));
    let mut film = moving(&piece, &Film::PAPER, empty, inward, |_, _| ());
    let failure = film.advance(1.0, &free()).unwrap_err();
    assert_eq!(failure.kind, FailureKind::InvertedVolume, "{failure:?}");
}

/// A sphere of film under gas, released without stress.
#[test]
fn film_with_gas_is_of_second_order_in_the_step() {
    let shell = icosphere(1, 0.5);
    let gas = nitrogen_gas();
    let mass = 1000.0 * 0.5 / (296.8 * 293.0);
    let volume = |cfl: f64| {
        let load = (PressureLoad::Gas(gas), gas.at_temperature(mass, 293.0));
        let mut film = still(&shell, &Film::PAPER_ELASTIC, load, |_, settings| {
            settings.cfl = cfl;
        });
        film.advance(0.9e-3, &free()).unwrap();
        film.view().state.volume
    };
    let exact = volume(0.005);
    let errors: Vec<f64> = [0.4, 0.2, 0.1].map(|cfl| volume(cfl) - exact).to_vec();
    assert!(orders(&errors).iter().all(|order| *order > 1.9 && *order < 2.1), "{errors:?}");
}
