//! Small scenes in which every integrator reaches the end. `refinement` 0 is the mesh of the quick tests.

use billow_solver::geometry::shapes::{icosphere, joined, moved, sheet};
use billow_solver::scene::InflowWindow;
use billow_solver::scene::paper::{self, TEMPERATURE, free_film, nitrogen_supply, window};

use crate::prelude::*;

/// A scene of an integrator at a refinement of its mesh.
pub type SceneOf = fn(IntegratorKind, u32) -> (FilmRun, Timeline);

/// Contact distance of the sheets, m.
pub const DISTANCE: f64 = 2e-3;

fn prepared(mut scene: FilmScene, kind: IntegratorKind, interval: f64) -> (FilmRun, Timeline) {
    scene.outputs.sample_interval = interval;
    scene.solver.integrator = kind;
    let run = FilmRun::of(&scene, None).expect("a valid scene");
    (run, Timeline::of_film(&scene))
}

fn contact(distance: f64) -> FilmContact {
    let monitor = MonitorSettings::EVERY_STEP;
    FilmContact { distance: Some(distance), monitor, ..FilmContact::default() }
}

/// A flattened sphere of film with loss, with this numerical damping, mass of gas (kg) and inflow.
fn sphere(refinement: u32, damping: f64, mass: f64, inflow: InflowWindow) -> FilmScene {
    let flat = |x: Vector3<f64>| Vector3::new(x.x, x.y, x.z * 0.3);
    let shell = moved(icosphere(1 + refinement, 0.2), flat);
    let supply = GasSupply { initial_mass: mass, windows: vec![inflow], ..nitrogen_supply() };
    let filling = Filling::Gas { supply, initial_temperature: TEMPERATURE };
    let film = Film { numerical_damping: damping, ..Film::PAPER };
    FilmScene { filling, ..free_film(shell, film) }
}

/// `bag`: gas fills a bag in 20 ms.
pub fn bag(kind: IntegratorKind, refinement: u32) -> (FilmRun, Timeline) {
    let mut scene = sphere(refinement, 0.01, 1e-6, window(0.0, 0.02, 5e-3));
    scene.solver.end_time = 0.03;
    prepared(scene, kind, 1e-3)
}

/// `filling`: gas flows slowly into a bag whose motion is damped. From 0.15 s on the hybrid is implicit.
pub fn filling(kind: IntegratorKind, refinement: u32) -> (FilmRun, Timeline) {
    let mut scene = sphere(refinement, 0.1, 1e-4, window(0.0, 1.0, 2e-4));
    scene.solver.end_time = 0.5;
    scene.solver.mass_damping = 40.0;
    prepared(scene, kind, 5e-3)
}

/// `sheets`: a corner of a tilted sheet hits another sheet.
pub fn sheets(kind: IntegratorKind, refinement: u32) -> (FilmRun, Timeline) {
    let cells = 1 + refinement;
    let flat = || sheet(4 * cells, 3 * cells, 0.2, 0.15);
    let (low, nodes) = (flat(), flat().positions.len());
    let high = moved(flat(), |x| {
        let height = 2.0 * DISTANCE + 0.3 * x.x + 0.2 * x.y;
        Vector3::new(x.x + 0.085, x.y + 0.055, height)
    });
    let high = Shell::relaxed(high.positions, high.triangles);
    let shell = joined(&[low, high]);
    let velocity = |node: usize| Vector3::z() * if node < nodes { 1.0 } else { -1.0 };
    let mut scene = FilmScene {
        velocities: (0..shell.positions.len()).map(velocity).collect(),
        contact: Some(contact(DISTANCE)),
        ..free_film(shell, Film::PAPER)
    };
    scene.solver.end_time = 8e-3;
    prepared(scene, kind, 1e-4)
}

/// `strip`: a stretched sheet of film with loss 0.05 that springs back.
pub fn strip(kind: IntegratorKind, refinement: u32) -> (FilmRun, Timeline) {
    let cells = 1 + refinement;
    let film = Film { compression: 1.0, loss_factor: 0.05, ..Film::PAPER };
    let shell = moved(sheet(4 * cells, 3 * cells, 2.0, 1.5), |x| x * 1.001);
    let mut scene = free_film(shell, film);
    scene.solver.end_time = 2e-3;
    prepared(scene, kind, 2e-5)
}

/// `capsule`: the paper's capsule, stowed, with a tenth of its inflow.
pub fn capsule(kind: IntegratorKind, refinement: u32) -> (FilmRun, Timeline) {
    let mut scene = paper::empty_capsule(2 + refinement, 0.03);
    scene.gas.windows.push(window(0.0, 0.03, 5e-4));
    scene.solver.integrator = kind;
    let set = InstructionSet::detect();
    let run = FilmRun::from_scene(set, &scene, DEFAULT_CFL, Some(contact(1e-3)));
    (run.expect("a capsule"), Timeline::new(&scene))
}
