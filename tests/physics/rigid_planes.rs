//! Rigid planes and oblique supports: invariance under rotation, energy, momentum.

use billow_solver::geometry::shapes::{nodes_where, sheet};
use billow_solver::integrators::FilmView;
use nalgebra::Rotation3;

use crate::film_rig::{still, support, unloaded};
use crate::prelude::*;

/// Film whose vibrations decay, so that rounding does not grow.
const DAMPED: Film = Film { numerical_damping: 0.1, ..Film::PAPER };

/// A sheet held at one edge, with a heavy plane at the other, everything rotated by `turn`; and the
/// relative defect of its energy.
fn hanging(turn: Rotation3<f64>, cfl: f64) -> (FilmSimulation, f64) {
    let mut piece = sheet(6, 3, 0.3, 0.15);
    let edge = |x: f64| nodes_where(&piece, |position| (position.x - x).abs() < 1e-12);
    let (left, right) = (edge(0.0), edge(0.3));
    piece.positions = piece.positions.iter().map(|x| turn * x).collect();
    let plane = PlaneBody { normal: turn * Vector3::x(), mass: 0.02, velocity: -0.5, force: 3.0 };
    let supports = [
        support("plane", left.clone(), Hold::Plane(turn * Vector3::x())),
        support("plane", left, Hold::Plane(turn * Vector3::z())),
        support("plane", right, Hold::Body(plane)),
    ];
    let positions = Field::of(&piece.positions);
    let mut film = still(&piece, &DAMPED, unloaded(), |system, settings| {
        system.supports = Supports::new(&supports, &positions);
        system.mass_damping = 5.0;
        settings.cfl = cfl;
    });
    let start = film.view().ledger();
    film.advance(0.02, &Phase::default()).unwrap();
    let end = film.view().ledger();
    let defect = end.defect(&start).abs() / (start.kinetic + end.external());
    (film, defect)
}

#[test]
fn a_rotated_scene_moves_alike() {
    let (straight, first) = hanging(Rotation3::identity(), 0.45);
    let turn = Rotation3::from_euler_angles(0.3, -1.1, 2.0);
    let (turned, second) = hanging(turn, 0.45);
    assert!((straight.view().state.planes[0] / turned.view().state.planes[0] - 1.0).abs() < 1e-7);
    for (a, b) in straight.view().state.positions.iter().zip(turned.view().state.positions.iter()) {
        assert!((turn * a - b).norm() < 1e-8, "{a} {b}");
    }
    assert!(
        straight.view().system.supports.oblique.is_empty()
            && !turned.view().system.supports.oblique.is_empty()
    );
    assert!(first < 1e-3 && second < 1e-3);
}

#[test]
fn the_energy_defect_of_a_plane_falls_with_the_square_of_the_step() {
    let defects: Vec<f64> =
        [0.4, 0.2, 0.1].map(|cfl| hanging(Rotation3::identity(), cfl).1).to_vec();
    assert!(defects[2] < 1e-4 && defects[2] < 0.2 * defects[0], "{defects:?}");
}

/// Two rigid planes joined by film without stress. The film transfers momentum between them and
/// conserves the sum.
#[test]
fn momentum_of_planes_and_film_is_conserved() {
    let piece = sheet(6, 3, 0.3, 0.15);
    let edge = |x: f64| nodes_where(&piece, |position| (position.x - x).abs() < 1e-12);
    let plane = |mass: f64, velocity: f64| {
        Hold::Body(PlaneBody { normal: Vector3::x(), mass, velocity, force: 0.0 })
    };
    let supports = [
        support("plane", edge(0.0), plane(0.01, -1.0)),
        support("plane", edge(0.3), plane(0.03, 2.0)),
    ];
    let positions = Field::of(&piece.positions);
    let mut film = still(&piece, &DAMPED, unloaded(), |system, _| {
        system.supports = Supports::new(&supports, &positions);
        system.numerical_damping = 0.0;
    });
    let momentum = |film: &FilmView<'_>| -> f64 {
        let nodes = film.system.model.mass.iter().zip(film.state.velocities.iter());
        let bodies = film.system.supports.bodies.iter().zip(&film.state.planes);
        nodes.map(|(m, v)| m * v.x).sum::<f64>()
            + bodies.map(|(b, v)| b.plane.mass * v).sum::<f64>()
    };
    let before = momentum(&film.view());
    assert!(before > 0.05);
    for _ in 0..10 {
        let target = film.view().state.time + 1e-3;
        film.advance(target, &Phase::default()).unwrap();
        assert!(
            (momentum(&film.view()) / before - 1.0).abs() < 1e-12,
            "{}",
            momentum(&film.view())
        );
    }
    let apart = film.view().state.planes[1] - film.view().state.planes[0];
    assert!(apart < 0.5, "the film has not pulled: {apart}");
}
