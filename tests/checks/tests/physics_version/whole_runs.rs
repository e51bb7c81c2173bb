//! Whole runs with a lid, friction, adhesion, closing faces, moving plates and free bodies: the bits of
//! their histories.

use billow_checks::cases::prelude::*;
use billow_checks::cases::shapes::gas_column;
use billow_solver::geometry::shapes::tube;
use billow_solver::models;
use billow_solver::models::run::run;
use billow_solver::output::history::COLUMNS;
use billow_solver::output::outcome::{Deployment, Stop};
use billow_solver::platform::simd::InstructionSet;
use billow_solver::scene::film_scene::{FilmOutputs, FilmSolver};
use billow_solver::scene::plate::Plate;
use nalgebra::Matrix3;

use super::hash;

/// The hash of a run: history, tracks, frames, number of steps.
fn of(deployment: &Deployment) -> String {
    assert_eq!(deployment.stop, Stop::Done);
    let columns = COLUMNS.iter().flat_map(|column| deployment.history.column(column.name));
    let tracks = deployment.tracks.iter().flat_map(|track| &track.values);
    let frames = deployment.frames.iter().flat_map(|frames| &frames.frames);
    let positions = frames.flat_map(|frame| frame.positions.iter().flatten());
    let positions = positions.map(|number| f64::from(*number));
    hash(columns.chain(tracks).copied().chain(positions).chain([deployment.steps as f64]))
}

/// The paper's capsule at n 3 under 5 g/s for some milliseconds, after some change.
fn capsule(end_time: f64, change: impl Fn(&mut Scene)) -> String {
    let mut scene = paper::capsule(3, end_time);
    scene.solver.model = ModelKind::Film;
    scene.solver.stepping = Stepping::Stable(0.45);
    scene.gas.windows = vec![window(0.0, 1.0, 5e-3)];
    scene.outputs.sample_interval = 1e-3;
    scene.outputs.frames = 4;
    change(&mut scene);
    of(&models::solve(InstructionSet::detect(), &scene, &mut Unobserved).expect("a scene"))
}

/// Gas enters under the lid, which opens at 8 ms.
pub fn under_a_lid() -> String {
    capsule(0.02, |scene| {
        scene.gas.initial_mass = 2e-5;
        scene.release_time = 8e-3;
    })
}

/// Film that resists compression slides with friction.
pub fn with_friction() -> String {
    capsule(0.02, |scene| {
        scene.film.compression = 1.0;
        scene.contact.friction = 0.2;
    })
}

/// Film sticks to film.
pub fn with_adhesion() -> String {
    capsule(0.03, |scene| {
        scene.contact.adhesion = 50.0;
        scene.contact.friction = 0.1;
    })
}

fn of_scene(scene: &FilmScene) -> String {
    let mut model = FilmRun::of(scene, None).expect("a scene");
    of(&run(&mut model, &Timeline::of_film(scene), &mut Unobserved))
}

/// A scene that records every 0.5 ms.
fn scene(shell: Shell, film: Film, end_time: f64) -> FilmScene {
    let scene = free_film(shell, film);
    let solver = FilmSolver { end_time, ..scene.solver };
    let outputs = FilmOutputs { sample_interval: 5e-4, frames: 3, ..scene.outputs.clone() };
    FilmScene { solver, outputs, ..scene }
}

/// A tube filled with gas, its lower rim held. Faces that are no film close both ends.
pub fn closed_by_faces() -> String {
    let (around, along) = (10, 4);
    let mut shell = tube(around, along, 0.1, 0.2);
    let held_nodes = ring_nodes(0, around);
    shell.close(
        |node| {
            if held_nodes.contains(&node) { Matrix3::zeros() } else { Matrix3::identity() }
        },
    );
    let windows = vec![window(0.0, 0.01, 2e-4)];
    let supply = GasSupply { initial_mass: 7e-6, windows, ..nitrogen_supply() };
    of_scene(&FilmScene {
        filling: Filling::Gas { supply, initial_temperature: 300.0 },
        supports: vec![held(held_nodes, "xyz")],
        ..scene(shell, Film::PAPER_ELASTIC, 6e-3)
    })
}

/// A sheet under gravity between a floor and a plate that comes down on it.
pub fn between_moving_plates() -> String {
    let down = Motion {
        from: 1e-3,
        to: 6e-3,
        profile: Profile::Smooth,
        translation: Vector3::new(0.0, 0.0, -8e-3),
        rotation: None,
    };
    let press = plate(Vector3::z() * 6e-3, -Vector3::z(), None);
    let floor = plate(Vector3::z() * -5e-3, Vector3::z(), None);
    let plates = vec![floor, Plate { motion: Some(down), ..press }];
    let contact =
        FilmContact { distance: Some(1e-3), friction: 0.1, plates, ..FilmContact::default() };
    let film = Film { numerical_damping: 0.05, ..Film::PAPER };
    of_scene(&FilmScene {
        contact: Some(contact),
        gravity: Vector3::new(0.0, 0.0, -9.806_65),
        ..scene(sheet(8, 6, 0.2, 0.15), film, 8e-3)
    })
}

/// A column of gas whose upper plate is a free body under a force.
pub fn with_a_free_body() -> String {
    let (lower, upper) = (0..4, 4..8);
    let body = PlaneBody { normal: Vector3::z(), mass: 0.05, velocity: 2.0, force: -5.0 };
    let piston = on_plane(upper.clone().collect(), body);
    of_scene(&FilmScene {
        filling: nitrogen_filling(1e-4, 300.0),
        supports: vec![held(lower.collect(), "xyz"), held(upper.collect(), "xy"), piston],
        ..scene(gas_column(0.01, 0.1), Film::PAPER_ELASTIC, 5e-3)
    })
}
