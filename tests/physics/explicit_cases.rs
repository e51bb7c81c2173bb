//! Film in motion: moving supports, free fall, a vibrating sheet, order in the step, failures. Momentum and damping are
//! reference cases of `billow-checks validate`.

use billow_solver::geometry::field::Field;
use billow_solver::geometry::shapes::{crossed_grid, icosphere, nodes_where, sheet};
use billow_solver::integrators::FilmSimulation;
use billow_solver::mechanics::gas::GasState;
use billow_solver::mechanics::supports::Supports;
use billow_solver::output::ledger::Ledger;
use billow_solver::output::outcome::FailureKind;
use billow_solver::scene::Film;
use billow_solver::scene::film_support::{FilmSupport, Hold};
use billow_solver::scene::motion::{Motion, Profile};
use billow_solver::system::PressureLoad;
use nalgebra::Vector3;

use crate::film_rig::{
    at_rest, free, largest_residual, ledgers, mapped, moving, nitrogen_gas, orders,
};

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
    let unloaded = (PressureLoad::Overpressure(0.0), GasState::default());
    let (still, positions) = (Field::zeros(piece.positions.len()), Field::of(&piece.positions));
    let mut film = moving(&piece, &Film::PAPER, unloaded, still, |system, _| {
        system.supports = Supports::new(&[left, right], &positions);
    });
    let start = film.view().ledger();
    film.advance(1e-3, &free()).unwrap();
    film.advance(2e-3, &free()).unwrap();
    let end: Ledger = film.view().ledger();
    let moved = film.view().state.positions.get(right_node) - piece.positions[right_node];
    assert!((moved - Vector3::new(2e-3, 0.5e-3, 1e-3)).norm() < 1e-14);
    assert!(end.support_work > 0.09 && end.strain > 0.09 && end.numerical_dissipation > 0.0);
    assert!(end.defect(&start).abs() < 5e-3 * end.support_work, "{}", end.defect(&start));
}

#[test]
fn free_fall_follows_gravity() {
    let piece = icosphere(0, 0.5);
    let unloaded = (PressureLoad::Overpressure(0.0), GasState::default());
    let still = Field::zeros(piece.positions.len());
    let mut film = moving(&piece, &Film::PAPER, unloaded, still, |system, _| {
        system.gravity = Vector3::new(0.0, 0.0, -9.806_65);
    });
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
    let filled = (PressureLoad::Gas(gas), gas.at_temperature(1e-3, 293.0));
    let still = || Field::zeros(piece.positions.len());
    let mut film = moving(&piece, &Film::PAPER, filled, still(), |_, settings| {
        settings.step_limit = 7;
    });
    let failure = film.advance(1.0, &free()).unwrap_err();
    assert_eq!((failure.kind, film.view().steps()), (FailureKind::StepLimit, 7));

    let mut film = moving(&piece, &Film::PAPER, filled, still(), |_, settings| {
        settings.cfl = 3.0;
    });
    let failure = film.advance(1.0, &free()).unwrap_err();
    assert_eq!(failure.kind, FailureKind::Unstable, "{failure:?}");
    assert!(failure.place.starts_with("node ") && failure.time < 0.1, "{failure:?}");

    // Soft film under a pressure far beyond its modulus stretches without end; its energy balances.
    let soft = Film { youngs_modulus: 1e4, ..Film::PAPER_ELASTIC };
    let pressed = (PressureLoad::Overpressure(50.0), GasState::default());
    let mut film = moving(&piece, &soft, pressed, still(), |_, settings| settings.cfl = 0.01);
    let failure = film.advance(10.0, &free()).unwrap_err();
    assert_eq!(failure.kind, FailureKind::Overstretched, "{failure:?}");
    assert!(failure.place.contains("times its length"), "{failure:?}");

    // A node faster than the waves of its film is no failure.
    let unloaded = (PressureLoad::Overpressure(0.0), GasState::default());
    let wave_speed =
        at_rest(&piece, &soft, unloaded.0, unloaded.1).view().system.model.wave_speed();
    let fast = mapped(&piece, |_| Vector3::x() * (3.0 * wave_speed));
    let mut film = moving(&piece, &soft, unloaded, fast, |_, _| ());
    film.advance(0.02, &free()).unwrap();

    // Thrown inward through itself, the sphere turns inside out.
    let (empty, inward) =
        ((PressureLoad::Gas(gas), GasState::default()), mapped(&piece, |x| x * -400.0));
    let mut film = moving(&piece, &Film::PAPER, empty, inward, |_, _| ());
    let failure = film.advance(1.0, &free()).unwrap_err();
    assert_eq!(failure.kind, FailureKind::InvertedVolume, "{failure:?}");
}

const SIDE: f64 = 0.3;

fn first_mode(x: &Vector3<f64>) -> f64 {
    let pi = std::f64::consts::PI;
    libm::sin(pi * x.x / SIDE) * libm::sin(pi * x.y / SIDE)
}

/// Amplitude of the first mode of a sheet, m.
fn amplitude(film: &FilmSimulation) -> f64 {
    let (system, state) = (film.view().system, film.view().state);
    let (mut sum, mut norm) = (0.0, 0.0);
    for (mass, x) in system.model.mass.iter().zip(state.positions.iter()) {
        let shape = first_mode(&x);
        sum += mass * shape * x.z;
        norm += mass * shape * shape;
    }
    sum / norm
}

/// A square sheet under tension, held at its edge, that a pressure and gravity push out of its plane.
#[test]
fn a_held_sheet_swings_about_its_sag_with_the_period_of_a_membrane() {
    let (strain, overpressure, gravity) = (1e-3, 1.0, 9.8);
    let flat = crossed_grid(16, 16, SIDE, SIDE);
    let edge = nodes_where(&flat, |x| [x.x, x.y].iter().any(|x| *x < 1e-9 || *x > SIDE - 1e-9));
    let reference: Vec<_> = flat.positions.iter().map(|x| x / (1.0 + strain)).collect();
    let shell = flat.with_reference(&reference);
    let material = Film::PAPER_ELASTIC;
    let still = Field::zeros(shell.positions.len());
    let load = (PressureLoad::Overpressure(overpressure), GasState::default());
    let mut film = moving(&shell, &material, load, still, |system, settings| {
        system.supports.hold(&edge, "xyz");
        system.gravity = Vector3::new(0.0, 0.0, -gravity);
        settings.cfl = 0.3;
    });
    let pi = std::f64::consts::PI;
    let stress = material.youngs_modulus * strain / (1.0 - material.poisson_ratio);
    let frequency = (stress / material.density * 2.0 * pi * pi / (SIDE * SIDE)).sqrt();
    let acceleration = overpressure / material.area_density() - gravity;
    let sag = 16.0 / (pi * pi) * acceleration / (frequency * frequency);
    let period = 2.0 * pi / frequency;
    let mut series = ledgers(&mut film, 0.5 * period, 20, &free());
    let lowest = amplitude(&film);
    assert!((lowest / (2.0 * sag) - 1.0).abs() < 3e-3, "{lowest} {sag}");
    assert!(series[20].gas_work > 0.0 && series[20].gravity_work < 0.0, "{:?}", series[20]);
    for sample in 1..=20 {
        film.advance(period * (0.5 + f64::from(sample) / 40.0), &free()).unwrap();
        series.push(film.view().ledger());
    }
    let back = amplitude(&film);
    assert!(back.abs() < 1e-3 * sag.abs(), "{back} {sag}");
    assert!(largest_residual(&series) < 1e-6, "{}", largest_residual(&series));
    let state = film.view().state;
    for node in edge {
        assert_eq!(state.positions.get(node as usize), shell.positions[node as usize]);
        assert_eq!(state.velocities.get(node as usize), Vector3::zeros());
    }
}

/// A sphere of film under gas, released without stress.
#[test]
fn film_with_gas_is_of_second_order_in_the_step() {
    let shell = icosphere(1, 0.5);
    let gas = nitrogen_gas();
    let mass = 1000.0 * 0.5 / (296.8 * 293.0);
    let volume = |cfl: f64| {
        let load = (PressureLoad::Gas(gas), gas.at_temperature(mass, 293.0));
        let still = Field::zeros(shell.positions.len());
        let mut film = moving(&shell, &Film::PAPER_ELASTIC, load, still, |_, settings| {
            settings.cfl = cfl;
        });
        film.advance(0.9e-3, &free()).unwrap();
        film.view().state.volume
    };
    let exact = volume(0.005);
    let errors: Vec<f64> = [0.4, 0.2, 0.1].map(|cfl| volume(cfl) - exact).to_vec();
    assert!(orders(&errors).iter().all(|order| *order > 1.9 && *order < 2.1), "{errors:?}");
}
