//! Small films for the tests of the explicit solver.

use billow_solver::geometry::shapes::{joined, moved, sheet};
use billow_solver::mechanics::forces::membrane::{
    ElementHistory, NodeForces, assemble_conservative,
};
use billow_solver::models::film::capsule;
use billow_solver::output::ledger::residuals;
use billow_solver::scene::paper::{self, free_film, nitrogen_supply};

use crate::prelude::*;

/// The paper's inflow, 5 g/s at 293 K, into a released capsule.
pub const INFLOW: Phase = Phase {
    packed: false,
    inflow: Inflow {
        mass_flow_rate: 5e-3,
        temperature_flow: 5e-3 * 293.0,
        vibration_flow: 0.0,
        vent_open: false,
    },
    end: 0.0,
};

/// The film of a capsule's scene in its stowed shape.
pub fn stowed(instruction_set: InstructionSet, scene: &Scene, cfl: f64) -> FilmScene {
    let shape = Shape::Stowed(scene.design.folded().unwrap().stowed_height);
    capsule::film_scene(instruction_set, scene, shape, cfl).expect("a foldable design").0
}

/// The paper's capsule at n 3, stowed with this contact, after a change of its scene.
pub fn capsule_film(
    set: InstructionSet,
    contact: Option<FilmContact>,
    change: impl FnOnce(&mut Scene),
) -> FilmSimulation {
    let mut scene = paper::empty_capsule(3, 0.5);
    change(&mut scene);
    let mut film = stowed(set, &scene, DEFAULT_CFL);
    film.contact = contact;
    capsule::start(&film, &[]).unwrap()
}

/// The model of a shell.
pub fn model(shell: &Shell, film: &Film) -> FilmModel {
    FilmModel::of_shell(film, shell).expect("a valid film")
}

/// Film forces on nodes at these positions, without motion.
pub fn film_forces(model: &FilmModel, positions: &Field) -> NodeForces {
    let mut nodes = NodeForces::new(model);
    let histories = &mut ElementHistory::zero(model);
    let set = InstructionSet::detect();
    let _ = assemble_conservative(set, model, positions, &[], histories, &mut nodes);
    nodes
}

/// The nodes of a shell under a map.
pub fn mapped(shell: &Shell, mut map: impl FnMut(Vector3<f64>) -> Vector3<f64>) -> Field {
    Field::of(&shell.positions.iter().map(|node| map(*node)).collect::<Vec<_>>())
}

/// Neither gas nor pressure.
pub fn unloaded() -> (PressureLoad, GasState) {
    (PressureLoad::Overpressure(0.0), GasState::default())
}

/// Film without velocity at the shell's positions, after a change of system and settings.
pub fn still(
    shell: &Shell,
    film: &Film,
    load: (PressureLoad, GasState),
    change: impl FnOnce(&mut FilmSystem, &mut SimulationSettings),
) -> FilmSimulation {
    moving(shell, film, load, Field::zeros(shell.positions.len()), change)
}

/// A support that does not move.
pub fn support(name: &str, nodes: Vec<u32>, hold: Hold) -> FilmSupport {
    FilmSupport { name: name.to_owned(), nodes, hold, motion: None }
}

/// Film with these velocities (m/s) at the shell's positions, after a change of system and settings.
pub fn moving(
    shell: &Shell,
    film: &Film,
    (pressure, gas): (PressureLoad, GasState),
    velocities: Field,
    change: impl FnOnce(&mut FilmSystem, &mut SimulationSettings),
) -> FilmSimulation {
    let mut system = FilmSystem {
        numerical_damping: film.numerical_damping,
        ..FilmSystem::free(model(shell, film), pressure)
    };
    let mut settings = SimulationSettings::default();
    change(&mut system, &mut settings);
    FilmSimulation::new(system, settings, Field::of(&shell.positions), velocities, gas)
}

/// Two sheets that cross over a floor, pressed together by their weight, after 10 ms.
pub fn pressed_sheets(monitor: MonitorSettings, mass_damping: f64) -> FilmSimulation {
    let lower = moved(sheet(6, 5, 0.3, 0.25), |x| x + Vector3::new(0.0, 0.0, 0.9e-3));
    let turned = |x: Vector3<f64>| Vector3::new(0.24 - x.y, 0.013 + 0.8 * x.x, 1.5e-3 + 2e-3 * x.x);
    let shell = joined(&[lower, moved(sheet(6, 5, 0.3, 0.25), turned)]);
    let plate = Plate {
        name: "floor".to_owned(),
        point: Vector3::zeros(),
        normal: Vector3::z(),
        motion: None,
        removal_time: f64::INFINITY,
    };
    let contact = FilmContact {
        distance: Some(1e-3),
        plates: vec![plate],
        monitor,
        ..FilmContact::default()
    };
    let mut scene = FilmScene {
        gravity: Vector3::new(0.0, 0.0, -100.0),
        contact: Some(contact),
        ..free_film(shell, Film { numerical_damping: 0.1, compression: 0.2, ..Film::PAPER_ELASTIC })
    };
    scene.solver.mass_damping = mass_damping;
    let mut film = capsule::start(&scene, &[]).unwrap();
    film.advance(0.01, &free()).unwrap();
    film
}

/// The same film after a change of what is stored of it.
pub fn edited(film: FilmSimulation, edit: impl FnOnce(&mut StoredFilm)) -> FilmSimulation {
    let mut stored = film.stored().expect("a film that can be stored");
    edit(&mut stored);
    let (system, _, settings) = film.into_parts();
    FilmSimulation::resume(system, settings, stored).expect("the same film")
}

/// The same film, resumed from text.
pub fn resumed(film: FilmSimulation) -> FilmSimulation {
    let text = text(&film);
    edited(film, |stored| *stored = serde_json::from_str(&text).expect("what was stored"))
}

/// Everything that a run resumes from, as text.
pub fn text(film: &FilmSimulation) -> String {
    serde_json::to_string(&film.stored()).expect("finite numbers")
}

/// What central differences keep beside the state.
pub fn explicit(film: &FilmSimulation) -> StoredExplicit {
    let StoredIntegrator::Explicit(explicit) = film.stored().expect("a film").integrator else {
        panic!("not central differences")
    };
    *explicit
}

pub fn free() -> Phase {
    Phase::default()
}

pub fn nitrogen_gas() -> Gas {
    Gas::new(&nitrogen_supply(), 293.0, 1.0)
}

/// Orders of convergence of errors on meshes or steps halved each time.
pub fn orders(errors: &[f64]) -> Vec<f64> {
    errors.windows(2).map(|pair| (pair[0] / pair[1]).abs().log2()).collect()
}

/// The ledgers of film at time 0 and at `samples` equal distances up to `end` (s).
pub fn ledgers(film: &mut FilmSimulation, end: f64, samples: u32, phase: &Phase) -> Vec<Ledger> {
    let mut series = vec![film.view().ledger()];
    for sample in 1..=samples {
        film.advance(end * f64::from(sample) / f64::from(samples), phase).unwrap();
        series.push(film.view().ledger());
    }
    series
}

/// The largest residual of a series of ledgers.
pub fn largest_residual(series: &[Ledger]) -> f64 {
    residuals(series).into_iter().fold(0.0, f64::max)
}
