//! Static states by Newton's method: its tangent, its supports, and states against damped motion.

use std::time::Instant;

use billow_solver::geometry::field::Field;
use billow_solver::geometry::shell::Shell;
use billow_solver::integrators::explicit::{Explicit, Parameters, PressureLoad};
use billow_solver::mechanics::film_model::FilmModel;
use billow_solver::mechanics::gas::GasState;
use billow_solver::mechanics::material::Regime;
use billow_solver::mechanics::supports::Supports;
use billow_solver::models::film::erected;
use billow_solver::platform::simd::InstructionSet;
use billow_solver::scene::Film;
use billow_solver::scene::film_scene::{Filling, FilmOutputs, FilmScene, FilmSolver};
use billow_solver::scene::film_support::{FilmSupport, Hold, PlaneBody};
use billow_solver::scene::motion::{Motion, Profile};
use billow_solver::statics::tangent::{self, Stiffness};
use billow_solver::statics::{
    Loaded, Relaxation, StaticError, StaticFailureKind, Tolerances, equilibrium, solve_unobserved,
};
use nalgebra::{SVector, Vector2, Vector3};

use crate::film_rig::{ELASTIC, film_forces, icosphere, pattern};
use crate::rig::paper_scene;

/// One element and its nodes under an in-plane stretch, turned in space.
fn stretched(film: &Film, a: f64, b: f64) -> (FilmModel, Field) {
    let flat = [Vector2::new(0.1, 0.2), Vector2::new(0.14, 0.21), Vector2::new(0.11, 0.25)];
    let model = FilmModel::new(film, 3, &[[0, 1, 2]], &[flat]).unwrap();
    let turn = nalgebra::Rotation3::from_euler_angles(0.4, -0.9, 1.3);
    let place =
        |x: Vector2<f64>| turn * Vector3::new(x.x * (1.0 + a) + 1e-3 * x.y, x.y * (1.0 + b), 0.3);
    (model, Field::of(&flat.map(place)))
}

/// Minus the central differences of all nine forces.
fn differences(places: &Field, step: f64, force: impl Fn(&Field) -> Field) -> Stiffness {
    let mut stiffness = Stiffness::zeros();
    for column in 0..9 {
        let at = |by: f64| {
            let mut moved = places.clone();
            let mut place = moved.get(column / 3);
            place[column % 3] += by;
            moved.set(column / 3, place);
            let force = force(&moved);
            SVector::<f64, 9>::from_fn(|row, _| force.get(row / 3)[row % 3])
        };
        stiffness.set_column(column, &((at(-step) - at(step)) / (2.0 * step)));
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
            let film = Film { compression, ..ELASTIC };
            let (model, places) = stretched(&film, a, b);
            assert_eq!(
                model
                    .material
                    .regime(billow_solver::mechanics::forces::membrane::strain(&model, &places, 0)),
                regime
            );
            let own = tangent::elastic(&model, &places, 0);
            let slope = differences(&places, 1e-8, |at| film_forces(&model, at).films());
            let scale = film.youngs_modulus * film.thickness;
            assert!((own - own.transpose()).norm() < 1e-13 * scale);
            assert!((own - slope).norm() < 1e-6 * scale, "{regime:?} c {compression}");
            if compression == 0.0 {
                let least = own.symmetric_eigenvalues().min();
                assert!(least > -1e-13 * scale, "{regime:?}: {least}");
            }
        }
    }
}

#[test]
fn the_pressure_tangent_is_the_symmetric_slope_of_the_pressure() {
    let (model, places) = stretched(&ELASTIC, 5e-3, 4e-3);
    let own = tangent::pressure([0, 1, 2], &places, 1000.0);
    let force = |at: &Field| {
        let area = film_forces(&model, at).areas();
        Field::of(&area.iter().map(|share| share * 1000.0).collect::<Vec<_>>())
    };
    let slope = differences(&places, 1e-6, force);
    let symmetric = (slope + slope.transpose()) * 0.5;
    assert!((own - own.transpose()).norm() < 1e-15 * own.norm());
    assert!((own - symmetric).norm() < 1e-8 * own.norm());
}

/// The tangent of a whole closed film is the slope of its forces, pressure and all.
#[test]
fn over_a_closed_film_nothing_of_the_pressure_is_left_out() {
    let piece = icosphere(1, 0.5);
    let model = piece.model(&ELASTIC);
    let bump = |(k, x): (usize, &Vector3<f64>)| x * (1.01 + 1e-3 * f64::from(k as u32 % 5));
    let places = Field::of(&piece.nodes.iter().enumerate().map(bump).collect::<Vec<_>>());
    let way: Vec<Vector3<f64>> = pattern(places.len(), 7);
    let pressure = 5e4;
    let force = |share: f64| {
        let moved: Vec<Vector3<f64>> =
            places.iter().zip(&way).map(|(place, way)| place + way * share).collect();
        let moved = Field::of(&moved);
        let own = film_forces(&model, &moved);
        own.films()
            .iter()
            .zip(own.areas().iter())
            .map(|(f, a)| f + a * pressure)
            .collect::<Vec<_>>()
    };
    let (ahead, behind) = (force(1e-7), force(-1e-7));
    let mut push = vec![Vector3::zeros(); places.len()];
    for (element, face) in model.triangles.iter().enumerate() {
        let stiffness = tangent::elastic(&model, &places, element)
            + tangent::pressure(*face, &places, pressure);
        let moves = SVector::<f64, 9>::from_fn(|row, _| way[face[row / 3] as usize][row % 3]);
        let forces = stiffness * moves;
        for (corner, node) in face.iter().enumerate() {
            push[*node as usize] -= forces.fixed_rows::<3>(3 * corner);
        }
    }
    let size = push.iter().map(nalgebra::Vector3::norm).fold(0.0, f64::max);
    for node in 0..places.len() {
        let slope = (ahead[node] - behind[node]) / 2e-7;
        assert!((push[node] - slope).norm() < 1e-5 * size, "{node}");
    }
}

#[test]
fn where_damped_motion_rests_newton_rests() {
    let mut scene = paper_scene();
    scene.design.subdivisions = 3;
    let mut capsule = erected(InstructionSet::detect(), &scene).unwrap();
    let state = capsule.settle(100.0).unwrap();
    let nodes = capsule.model.nodes();
    let setting = Parameters {
        supports: capsule.supports.clone(),
        cfl: 0.9,
        viscosity: scene.film.viscosity,
        ..Parameters::free(PressureLoad::Overpressure(100.0), nodes)
    };
    let mut film = Explicit::new(
        capsule.model.clone(),
        setting,
        // Pushed off by a tenth of a millimetre, so that there is something to settle.
        Field::of(
            &state
                .positions
                .iter()
                .zip(pattern(nodes, 5))
                .enumerate()
                .map(|(n, (place, way))| place + capsule.supports.projector(n) * way * 1e-4)
                .collect::<Vec<_>>(),
        ),
        Field::zeros(nodes),
        GasState::default(),
    );
    Relaxation { max_kinetic_fraction: 1e-16, ..Relaxation::default() }
        .relax_at(&mut film, 100.0)
        .unwrap();
    let moved = (0..nodes).map(|n| (film.state.positions.get(n) - state.positions.get(n)).norm());
    let moved = moved.fold(0.0, f64::max);
    println!("{} Newton steps; damped motion moves {moved:e} m on", state.iterations);
    assert!(moved < 1e-6, "{moved}");
    assert!((film.state.volume / state.volume - 1.0).abs() < 1e-9);
}

fn scene(shell: Shell, pressure: f64, supports: Vec<FilmSupport>) -> FilmScene {
    FilmScene {
        shell,
        velocities: Vec::new(),
        film: ELASTIC,
        filling: Filling::Pressure(pressure),
        supports,
        gravity: Vector3::zeros(),
        release_time: 0.0,
        solver: FilmSolver {
            cfl: 0.5,
            end_time: 0.0,
            statics: true,
            mass_damping: 0.0,
            step_limit: 0,
            instruction_set: InstructionSet::detect(),
        },
        outputs: FilmOutputs {
            sample_interval: 1.0,
            nodes: Vec::new(),
            elements: Vec::new(),
            frames: 0,
        },
        contact: None,
    }
}

/// A strip of film along x, `width` m wide, in z = 0.
fn strip(columns: u32, length: f64, width: f64) -> Shell {
    let at = |i: u32, j: u32| i * 3 + j;
    let mut nodes = Vec::new();
    let mut triangles = Vec::new();
    for i in 0..=columns {
        for j in 0..3 {
            let (x, y) = (f64::from(i) / f64::from(columns), f64::from(j) / 2.0);
            nodes.push(Vector3::new(x * length, y * width, 0.0));
            if i < columns && j < 2 {
                let [a, b, c, d] = [at(i, j), at(i + 1, j), at(i + 1, j + 1), at(i, j + 1)];
                triangles.extend([[a, b, c], [a, c, d]]);
            }
        }
    }
    Shell::relaxed(nodes, triangles)
}

fn on(name: &str, nodes: Vec<u32>, hold: Hold) -> FilmSupport {
    FilmSupport { name: name.to_owned(), nodes, hold, motion: None }
}

/// A strip pulled by a rigid plane that a force pushes: N = F/width, the travel from the stretch.
#[test]
fn a_rigid_plane_goes_where_its_force_is_borne() {
    let (columns, length, width, force) = (6_u32, 0.3, 0.1, 20.0);
    let slant = Vector3::new(1.0, 0.0, 0.0);
    let ends = |i: u32| (0..3).map(|j| i * 3 + j).collect::<Vec<u32>>();
    let plane = PlaneBody { normal: slant, mass: 0.1, velocity: 0.0, force };
    let supports = vec![
        on("wall", ends(0), Hold::Components([true, false, false])),
        on("corner", vec![0], Hold::Components([true, true, false])),
        on("flat", (0..(columns + 1) * 3).collect(), Hold::Components([false, false, true])),
        on("plate", ends(columns), Hold::Body(plane)),
    ];
    let scene = scene(strip(columns, length, width), 0.0, supports);
    let state = solve_unobserved(&scene).unwrap();
    // λ (λ² − 1)/2 E t w = F.
    let stiffness = ELASTIC.youngs_modulus * ELASTIC.thickness * width;
    let mut stretch = 1.0;
    for _ in 0..50 {
        stretch = 1.0 + force / (stiffness * stretch * (stretch + 1.0) / 2.0);
    }
    let travel = state.positions.x[(columns * 3) as usize] - length;
    println!("travel {travel}, expected {}", (stretch - 1.0) * length);
    assert!((travel / ((stretch - 1.0) * length) - 1.0).abs() < 1e-6);
    assert!((state.reactions[0].force.x / force - 1.0).abs() < 1e-6);
    assert!((state.reactions[3].force.x / -force - 1.0).abs() < 1e-6);
    assert!(state.potential_energy < 0.0 && state.strain_energy > 0.0);
}

/// A strip whose end is moved 3 mm: the mover bears what the wall bears.
#[test]
fn what_is_moved_is_moved_and_bears() {
    let ends = |i: u32| (0..3).map(|j| i * 3 + j).collect::<Vec<u32>>();
    let motion = Motion {
        from: 0.0,
        to: 1.0,
        profile: Profile::Smooth,
        translation: Vector3::new(3e-3, 0.0, 0.0),
        rotation: None,
    };
    let all = Hold::Components([true, true, true]);
    let mut moved = on("jaw", ends(6), all);
    moved.motion = Some(motion);
    let supports = vec![on("wall", ends(0), all), moved];
    let state = solve_unobserved(&scene(strip(6, 0.3, 0.1), 0.0, supports)).unwrap();
    assert!((state.positions.x[18] - 0.303).abs() < 1e-15);
    let [wall, jaw] = [&state.reactions[0], &state.reactions[1]];
    assert!((wall.force + jaw.force).norm() < 1e-6 * wall.force.norm());
    let pull = ELASTIC.youngs_modulus * ELASTIC.thickness * 0.1 * 0.01;
    assert!(wall.force.x > pull && wall.force.x < 1.1 * pull, "{}", wall.force.x);
}

/// A film that nothing holds, with a weight and no support, has no state of rest.
#[test]
fn film_that_falls_is_refused() {
    let mut falling = scene(strip(4, 0.3, 0.1), 0.0, Vec::new());
    falling.gravity = Vector3::new(0.0, 0.0, -9.81);
    let refused = solve_unobserved(&falling);
    let Err(StaticError::NoState(failure)) = refused else { panic!("{refused:?}") };
    assert_ne!(failure.kind, StaticFailureKind::Stopped);
    println!("{failure}");
}

#[test]
fn the_watcher_can_end_a_search() {
    let piece = icosphere(1, 0.5);
    let model = piece.model(&ELASTIC);
    let supports = Supports::none(piece.nodes.len());
    let loaded = Loaded {
        model: &model,
        supports: &supports,
        overpressure: 100.0,
        gravity: Vector3::zeros(),
        instruction_set: InstructionSet::detect(),
    };
    let mut looks = 0;
    let stop = &mut |_: &_| {
        looks += 1;
        if looks == 3 {
            std::ops::ControlFlow::Break(())
        } else {
            std::ops::ControlFlow::Continue(())
        }
    };
    let ended = equilibrium(&loaded, Field::of(&piece.nodes), &Tolerances::default(), stop);
    assert_eq!(ended.unwrap_err().kind, StaticFailureKind::Stopped);
}

#[test]
fn an_equilibrium_has_the_same_bits_on_every_instruction_set() {
    let mut scene = paper_scene();
    scene.design.subdivisions = 2;
    let capsule = erected(InstructionSet::detect(), &scene).unwrap();
    let states = InstructionSet::ALL.map(|instruction_set| {
        let loaded = Loaded {
            model: &capsule.model,
            supports: &Supports::none(capsule.model.nodes()),
            overpressure: 1000.0,
            gravity: Vector3::zeros(),
            instruction_set,
        };
        let start = Instant::now();
        let go = &mut |_: &_| std::ops::ControlFlow::Continue(());
        let rest =
            equilibrium(&loaded, capsule.positions.clone(), &Tolerances::default(), go).unwrap();
        println!("{}: {:.3} s", instruction_set.name(), start.elapsed().as_secs_f64());
        rest.positions
    });
    assert!(states.iter().all(|state| *state == states[0]));
}
