//! Static equilibrium by Newton's method: the tangent, supports, and comparison with damped motion.

use billow_solver::geometry::shapes::{grid, icosphere, nodes_where, pseudo_random};
use billow_solver::mechanics::forces::tangent::{self, Stiffness};
use billow_solver::mechanics::material::Regime;
use billow_solver::models::film::erected;
use billow_solver::scene::paper::free_film;
use billow_solver::statics::{
    Relaxation, StaticError, StaticFailureKind, Tolerances, equilibrium, solve,
};
use nalgebra::{SVector, Vector2};

use crate::film_rig::{film_forces, model, support};
use crate::prelude::*;
use crate::rig::paper_scene;

/// One element under an in-plane stretch, rotated in space.
fn stretched(film: &Film, a: f64, b: f64) -> (FilmModel, Field) {
    let flat = [Vector2::new(0.1, 0.2), Vector2::new(0.14, 0.21), Vector2::new(0.11, 0.25)];
    let model = FilmModel::new(film, 3, &[[0, 1, 2]], &[flat]).unwrap();
    let turn = nalgebra::Rotation3::from_euler_angles(0.4, -0.9, 1.3);
    let position =
        |x: Vector2<f64>| turn * Vector3::new(x.x * (1.0 + a) + 1e-3 * x.y, x.y * (1.0 + b), 0.3);
    (model, Field::of(&flat.map(position)))
}

/// Minus the central differences of all nine forces.
fn differences(model: &FilmModel, positions: &Field) -> Stiffness {
    let step = 1e-8;
    let mut stiffness = Stiffness::zeros();
    for column in 0..9 {
        let force_at = |by: f64| {
            let mut moved = positions.clone();
            let mut position = moved.get(column / 3);
            position[column % 3] += by;
            moved.set(column / 3, position);
            let force = film_forces(model, &moved).films();
            SVector::<f64, 9>::from_fn(|row, _| force.get(row / 3)[row % 3])
        };
        stiffness.set_column(column, &((force_at(-step) - force_at(step)) / (2.0 * step)));
    }
    stiffness
}

#[test]
fn the_tangent_is_the_slope_of_the_forces_in_every_regime() {
    let regimes = [
        (5e-3, 4e-3, Regime::Taut),
        (6e-3, -5e-3, Regime::Wrinkled),
        (2e-3, -0.2, Regime::Wrinkled),
        (-6e-3, -5e-3, Regime::Slack),
    ];
    for compression in [0.0, 0.01, 1.0] {
        for (a, b, regime) in regimes {
            let film = Film { compression, ..Film::PAPER_ELASTIC };
            let (model, positions) = stretched(&film, a, b);
            assert_eq!(
                model.material.regime(billow_solver::mechanics::forces::membrane::strain(
                    &model, &positions, 0
                )),
                regime
            );
            let tangent = tangent::elastic(&model, &positions, 0);
            let slope = differences(&model, &positions);
            let scale = film.youngs_modulus * film.thickness;
            assert!((tangent - tangent.transpose()).norm() < 1e-13 * scale);
            assert!((tangent - slope).norm() < 1e-6 * scale, "{regime:?} c {compression}");
            if compression == 0.0 {
                let least = tangent.symmetric_eigenvalues().min();
                assert!(least > -1e-13 * scale, "{regime:?}: {least}");
            }
        }
    }
}

#[test]
fn damped_motion_and_newton_find_the_same_equilibrium() {
    let mut scene = paper_scene();
    scene.design.folded_mut().unwrap().subdivisions = 3;
    let mut capsule = erected(InstructionSet::detect(), &scene).unwrap();
    let state = capsule.settle(100.0).unwrap();
    let nodes = capsule.model.nodes();
    let load = PressureLoad::Overpressure(100.0);
    let system = FilmSystem {
        supports: capsule.supports.clone(),
        numerical_damping: scene.film.numerical_damping,
        ..FilmSystem::free(capsule.model.clone(), load)
    };
    let settings = SimulationSettings { cfl: 0.9, ..SimulationSettings::default() };
    let film = FilmSimulation::new(
        system,
        settings,
        // Displaced by a tenth of a millimetre, so that there is motion to damp.
        Field::of(
            &state
                .positions
                .iter()
                .zip(pseudo_random(nodes, 5))
                .enumerate()
                .map(|(n, (x, d))| x + capsule.supports.projector(n) * d * 1e-4)
                .collect::<Vec<_>>(),
        ),
        Field::zeros(nodes),
        GasState::default(),
    );
    let relaxation = Relaxation { max_kinetic_fraction: 1e-16, ..Relaxation::default() };
    let film = relaxation.relax_at(film, 100.0).unwrap();
    let moved =
        (0..nodes).map(|n| (film.view().state.positions.get(n) - state.positions.get(n)).norm());
    let moved = moved.fold(0.0, f64::max);
    assert!(moved < 1e-6, "{moved}");
    assert!((film.view().state.volume / state.volume - 1.0).abs() < 1e-9);
}

fn scene(shell: Shell, pressure: f64, supports: Vec<FilmSupport>) -> FilmScene {
    let filling = Filling::Pressure(pressure);
    FilmScene { filling, supports, ..free_film(shell, Film::PAPER_ELASTIC) }
}

/// A strip of film along x, two cells wide, in z = 0.
fn strip(columns: u32, length: f64, width: f64) -> Shell {
    grid(columns, 2, length, width)
}

/// Nodes of a strip at this coordinate along it, m.
fn edge(strip: &Shell, x: f64) -> Vec<u32> {
    nodes_where(strip, |position| (position.x - x).abs() < 1e-12)
}

/// A strip pulled by a rigid plane that a force pushes: N = F/width, the travel from the stretch.
#[test]
fn a_rigid_plane_moves_until_its_force_is_balanced() {
    let (columns, length, width, force) = (6_u32, 0.3, 0.1, 20.0);
    let slant = Vector3::new(1.0, 0.0, 0.0);
    let shell = strip(columns, length, width);
    let (wall, plate) = (edge(&shell, 0.0), edge(&shell, length));
    let end_node = plate[0] as usize;
    let plane = PlaneBody { normal: slant, mass: 0.1, velocity: 0.0, force };
    let supports = vec![
        support("wall", wall, Hold::Components([true, false, false])),
        support("corner", vec![0], Hold::Components([true, true, false])),
        support("flat", nodes_where(&shell, |_| true), Hold::Components([false, false, true])),
        support("plate", plate, Hold::Body(plane)),
    ];
    let scene = scene(shell, 0.0, supports);
    let state = solve(&scene, None, &mut || true).unwrap();
    // λ (λ² − 1)/2 E t w = F.
    let stiffness = Film::PAPER_ELASTIC.youngs_modulus * Film::PAPER_ELASTIC.thickness * width;
    let mut stretch = 1.0;
    for _ in 0..50 {
        stretch = 1.0 + force / (stiffness * stretch * (stretch + 1.0) / 2.0);
    }
    let travel = state.positions.x[end_node] - length;
    assert!((travel / ((stretch - 1.0) * length) - 1.0).abs() < 1e-6);
    assert!((state.reactions[0].force.x / force - 1.0).abs() < 1e-6);
    assert!((state.reactions[3].force.x / -force - 1.0).abs() < 1e-6);
    assert!(state.potential_energy < 0.0 && state.strain_energy > 0.0);
}

/// A strip whose end is moved by 3 mm: the reactions at both ends are equal and opposite.
#[test]
fn reactions_at_a_moved_support_balance() {
    let shell = strip(6, 0.3, 0.1);
    let (wall, jaw) = (edge(&shell, 0.0), edge(&shell, 0.3));
    let jaw_node = jaw[0] as usize;
    let motion = Motion {
        from: 0.0,
        to: 1.0,
        profile: Profile::Smooth,
        translation: Vector3::new(3e-3, 0.0, 0.0),
        rotation: None,
    };
    let all = Hold::Components([true, true, true]);
    let mut moved = support("jaw", jaw, all);
    moved.motion = Some(motion);
    let supports = vec![support("wall", wall, all), moved];
    let state = solve(&scene(shell, 0.0, supports), None, &mut || true).unwrap();
    assert!((state.positions.x[jaw_node] - 0.303).abs() < 1e-15);
    let [wall, jaw] = [&state.reactions[0], &state.reactions[1]];
    assert!((wall.force + jaw.force).norm() < 1e-6 * wall.force.norm());
    let pull = Film::PAPER_ELASTIC.youngs_modulus * Film::PAPER_ELASTIC.thickness * 0.1 * 0.01;
    assert!(wall.force.x > pull && wall.force.x < 1.1 * pull, "{}", wall.force.x);
}

/// Film under gravity without a support has no static equilibrium.
#[test]
fn unsupported_film_under_gravity_has_no_equilibrium() {
    let mut falling = scene(strip(4, 0.3, 0.1), 0.0, Vec::new());
    falling.gravity = Vector3::new(0.0, 0.0, -9.81);
    let refused = solve(&falling, None, &mut || true);
    let Err(StaticError::NoState(failure)) = refused else { panic!("{refused:?}") };
    assert_ne!(failure.kind, StaticFailureKind::Stopped);
}

#[test]
fn an_observer_can_stop_the_solution() {
    let piece = icosphere(1, 0.5);
    let model = model(&piece, &Film::PAPER_ELASTIC);
    let film = FilmSystem::free(model, PressureLoad::Overpressure(100.0));
    let mut calls = 0;
    let stop = &mut || {
        calls += 1;
        calls < 3
    };
    let ended = equilibrium(&film, Field::of(&piece.positions), &Tolerances::default(), stop);
    assert_eq!(ended.unwrap_err().kind, StaticFailureKind::Stopped);
}

#[test]
fn a_static_state_has_the_same_bits_on_every_instruction_set() {
    let mut scene = paper_scene();
    scene.design.folded_mut().unwrap().subdivisions = 2;
    let capsule = erected(InstructionSet::detect(), &scene).unwrap();
    let states = InstructionSet::ALL.map(|instruction_set| {
        let load = PressureLoad::Overpressure(1000.0);
        let free = FilmSystem::free(capsule.model.clone(), load);
        let film = FilmSystem { instruction_set, ..free };
        let rest =
            equilibrium(&film, capsule.positions.clone(), &Tolerances::default(), &mut || true)
                .unwrap();
        rest.positions
    });
    assert!(states.iter().all(|state| *state == states[0]));
}
