//! The guard of the physics version: the bits of some small runs change only with it.
//!
//! `tests/reference/physics.json` holds the physics version and the SHA-256 of the bits of each run's
//! history or end state. After a change of the physics, raise the version, record the hashes that this
//! test prints, and add a line to CHANGELOG.

use billow_checks::cases::contact_capsule::stowed;
use billow_checks::cases::prelude::*;
use billow_checks::cases::rig::{explicit, inflow};
use billow_checks::cases::shapes::gas_column;
use billow_solver::geometry::shapes::tube;
use billow_solver::models;
use billow_solver::models::run::{self, Model};
use billow_solver::output::outcome::{Deployment, Stop};
use billow_solver::platform::simd::InstructionSet;
use billow_solver::scene::Creases;
use billow_solver::scene::film_scene::{FilmOutputs, FilmSolver};
use billow_solver::scene::plate::Plate;
use nalgebra::Matrix3;
use serde_json::{Value, json};
use sha2::{Digest, Sha256};

/// SHA-256 of the bits of these numbers, in hexadecimal digits.
fn hash(numbers: impl IntoIterator<Item = f64>) -> String {
    let mut sha = Sha256::new();
    numbers.into_iter().for_each(|number| sha.update(number.to_bits().to_le_bytes()));
    sha.finalize().iter().fold(String::new(), |text, byte| format!("{text}{byte:02x}"))
}

/// The hash of the whole history of a piston, or of storeys.
fn piston(scene: &Scene) -> String {
    let deployment = models::solve(InstructionSet::detect(), scene, &mut Unobserved)
        .expect("a scene that can be run");
    let columns = deployment.history.iter().map(|(_, values)| values);
    hash(columns.flatten().copied())
}

/// The hash of a film's end state: positions, velocities half a step ago, gas, work; work of contact if there
/// is any.
fn end_state(film: &FilmSimulation) -> String {
    let (now, explicit) = (film.view(), explicit(film));
    let (state, accounting) = (now.state, now.accounting());
    let fields =
        [&state.positions, &explicit.motion.velocities].map(|field| [&field.x, &field.y, &field.z]);
    let nodes = fields.into_iter().flatten().flat_map(|column| column.iter()).copied();
    let works = accounting.works;
    let scalars = [
        state.time,
        state.volume,
        state.pressure,
        state.gas.mass,
        state.gas.internal_energy,
        accounting.film_stress,
        works.gas,
        works.ambient,
        works.support,
        works.material_loss,
        works.numerical_dissipation,
        works.damping,
    ];
    let contact_work = now.system.contact.as_ref().map(|_| works.contact);
    hash(nodes.chain(scalars).chain(contact_work))
}

/// 5 g/s from the start, with heat exchange and a leak.
fn rapid() -> String {
    let mut scene = paper::capsule(5, 0.1);
    scene.gas.windows = vec![window(0.0, 1.5, 5e-3)];
    scene.gas.leak_area = 1e-5;
    piston(&scene)
}

/// [`rapid`] as storeys.
fn storeys() -> String {
    let mut scene = paper::capsule(5, 0.1);
    scene.gas.leak_area = 1e-5;
    scene.solver.model = ModelKind::Storeys;
    scene.solver.stepping = Stepping::Stable(0.45);
    piston(&scene)
}

/// Filled while packed, released at 20 ms, filled again from 50 ms.
fn preinflated() -> String {
    let mut scene = paper::capsule(5, 0.1);
    scene.gas.windows = vec![window(0.0, 0.01, 5e-3), window(0.05, 0.1, 1e-3)];
    scene.gas.initial_mass = 1.5e-4;
    scene.release_time = 0.02;
    piston(&scene)
}

/// Film on film from the first millisecond, quiescent at the end.
fn quiescent_capsule() -> String {
    let contact = FilmContact::default();
    let mut scene = paper::capsule(2, 0.02);
    scene.film.numerical_damping = 0.1;
    let mut run = stowed(&Rig::default(), &scene, contact).expect("a capsule");
    let phase = inflow(5e-3, 293.0);
    run.advance(0.02, &phase).expect("it runs");
    let first = explicit(&run.film);
    assert!(first.path_length > 0.1 && run.view().accounting().works.contact != 0.0);
    for target in 21..=300 {
        run.advance(1e-3 * f64::from(target), &phase).expect("it runs");
    }
    assert!(explicit(&run.film).motion.last_step > 1.5 * first.motion.last_step);
    end_state(&run.film)
}

fn end_state_at(scene: &FilmScene, time: f64, phase: &Phase) -> String {
    let mut film = Rig::default().start(scene).expect("a scene");
    film.advance(time, phase).expect("it runs");
    end_state(&film)
}

/// A sphere with gas that leaks into air and exchanges heat.
fn sphere() -> String {
    let supply = GasSupply {
        initial_mass: 2e-2,
        ambient_pressure: 500.0,
        heat_transfer: HeatTransfer::Coefficient(20.0),
        leak_area: 1e-3,
        ..nitrogen_supply()
    };
    let filling = Filling::Gas { supply, initial_temperature: 350.0 };
    let scene = FilmScene { filling, ..free_film(icosphere(1, 0.5), Film::PAPER_ELASTIC) };
    end_state_at(&scene, 3e-3, &Phase::default())
}

/// A damped sheet with some compressive stiffness and random velocities swings from two corners.
fn falling_sheet() -> String {
    let film = Film { numerical_damping: 0.1, compression: 0.3, ..Film::PAPER };
    let scene = FilmScene {
        velocities: pseudo_random(30, 1),
        supports: vec![held(vec![0, 5], "xyz")],
        gravity: Vector3::new(0.0, -3.0, -9.806_65),
        ..free_film(sheet(5, 4, 0.3, 0.2), film)
    };
    end_state_at(&scene, 5e-3, &Phase::default())
}

/// A sheet that slides on a slanted plane along one side.
fn on_a_slanted_plane() -> String {
    let shell = sheet(5, 4, 0.3, 0.2);
    let side = (0_u32..).zip(&shell.positions).filter(|(_, x)| x.y <= 0.0);
    let normal = Vector3::new(1.0, 2.0, 0.5).normalize();
    let nodes = side.map(|(node, _)| node).collect();
    let plane =
        FilmSupport { name: "plane".to_owned(), nodes, hold: Hold::Plane(normal), motion: None };
    let scene = FilmScene {
        supports: vec![plane],
        gravity: Vector3::new(0.0, -3.0, -9.806_65),
        ..free_film(shell, Film::PAPER)
    };
    end_state_at(&scene, 5e-3, &Phase::default())
}

/// A tube whose upper end is moved and rotated while the lower one is held.
fn turned_tube() -> String {
    let (around, along) = (8, 4);
    let turn = Rotation { axis: Vector3::z(), centre: Vector3::zeros(), angle: 0.02 };
    let motion = Motion {
        from: 0.0,
        to: 2e-3,
        profile: Profile::Smooth,
        translation: Vector3::new(0.0, 1e-3, 1e-3),
        rotation: Some(turn),
    };
    let upper = held(ring_nodes(along, around), "xyz");
    let upper = FilmSupport { motion: Some(motion), ..upper };
    let scene = FilmScene {
        filling: Filling::Pressure(100.0),
        supports: vec![held((0..around).collect(), "xyz"), upper],
        ..free_film(tube(around, along, 0.1, 0.2), Film::PAPER_ELASTIC)
    };
    end_state_at(&scene, 3e-3, &Phase::default())
}

/// The hash of a run: history, tracks, frames, number of steps.
fn whole(deployment: &Deployment) -> String {
    assert_eq!(deployment.stop, Stop::Done);
    let columns = deployment.history.iter().flat_map(|(_, values)| values);
    let tracks = deployment.tracks.iter().flat_map(|track| &track.values);
    let frames = deployment.frames.iter().flat_map(|frames| &frames.frames);
    let positions = frames.flat_map(|frame| frame.positions.iter().flatten());
    let positions = positions.map(|number| f64::from(*number));
    hash(columns.chain(tracks).copied().chain(positions).chain([deployment.steps as f64]))
}

/// The paper's capsule at n 3 under 5 g/s for some milliseconds, after some change.
fn short_capsule(end_time: f64, change: impl Fn(&mut Scene)) -> String {
    let mut scene = paper::capsule(3, end_time);
    scene.solver.model = ModelKind::Film;
    scene.solver.stepping = Stepping::Stable(0.45);
    scene.gas.windows = vec![window(0.0, 1.0, 5e-3)];
    scene.outputs.sample_interval = 1e-3;
    scene.outputs.frames = 4;
    change(&mut scene);
    whole(&models::solve(InstructionSet::detect(), &scene, &mut Unobserved).expect("a scene"))
}

/// Gas enters under the lid, which opens at 8 ms.
fn under_a_lid() -> String {
    short_capsule(0.02, |scene| {
        scene.gas.initial_mass = 2e-5;
        scene.release_time = 8e-3;
    })
}

/// Film that resists compression slides with friction.
fn with_friction() -> String {
    short_capsule(0.02, |scene| {
        scene.film.compression = 1.0;
        scene.contact.friction = 0.2;
    })
}

/// Film with bending and creases.
fn with_bending(yield_moment: Option<f64>) -> String {
    short_capsule(0.02, |scene| {
        let creases = Some(Creases { length_scale: 0.02, rest_angle: None });
        scene.film = Film { compression: 1.0, bending: true, creases, yield_moment, ..scene.film };
    })
}

/// Film sticks to film.
fn with_adhesion() -> String {
    short_capsule(0.03, |scene| {
        scene.contact.adhesion = 50.0;
        scene.contact.friction = 0.1;
    })
}

fn of_scene(scene: &FilmScene) -> String {
    let mut model = FilmRun::of(scene, None).expect("a scene");
    whole(&run::run(&mut model, &Timeline::of_film(scene), &mut Unobserved))
}

/// A scene that records every 0.5 ms.
fn recorded(shell: Shell, film: Film, end_time: f64) -> FilmScene {
    let scene = free_film(shell, film);
    let solver = FilmSolver { end_time, ..scene.solver };
    let outputs = FilmOutputs { sample_interval: 5e-4, frames: 3, ..scene.outputs.clone() };
    FilmScene { solver, outputs, ..scene }
}

/// A tube filled with gas, its lower rim held. Faces that are no film close both ends.
fn closed_by_faces() -> String {
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
        ..recorded(shell, Film::PAPER_ELASTIC, 6e-3)
    })
}

/// A sheet under gravity between a floor and a plate that comes down on it.
fn between_moving_plates() -> String {
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
        ..recorded(sheet(8, 6, 0.2, 0.15), film, 8e-3)
    })
}

/// A column of gas whose upper plate is a free body under a force.
fn with_a_free_body() -> String {
    let (lower, upper) = (0..4, 4..8);
    let body = PlaneBody { normal: Vector3::z(), mass: 0.05, velocity: 2.0, force: -5.0 };
    let piston = on_plane(upper.clone().collect(), body);
    of_scene(&FilmScene {
        filling: nitrogen_filling(1e-4, 300.0),
        supports: vec![held(lower.collect(), "xyz"), held(upper.collect(), "xy"), piston],
        ..recorded(gas_column(0.01, 0.1), Film::PAPER_ELASTIC, 5e-3)
    })
}

#[test]
fn the_physics_changes_only_with_its_version() {
    let recorded: Value =
        serde_json::from_str(include_str!("../../reference/physics.json")).expect("JSON");
    let hashes = json!({
        "piston, rapid inflation with heat and leak": rapid(),
        "piston, preinflated and packed": preinflated(),
        "storeys, rapid inflation with heat and leak": storeys(),
        "film, capsule of two subdivisions with contact for 300 ms": quiescent_capsule(),
        "film, sphere with gas, heat and leak in air": sphere(),
        "film, damped sheet under gravity, compression 0.3": falling_sheet(),
        "film, sheet on a slanted plane": on_a_slanted_plane(),
        "film, tube with a moving support": turned_tube(),
        "film, capsule under a lid": under_a_lid(),
        "film, capsule with friction, compression 1": with_friction(),
        "film, capsule with bending and creases": with_bending(None),
        "film, capsule with bending, creases and yield": with_bending(Some(1e-6)),
        "film, capsule with adhesion": with_adhesion(),
        "film, tube closed by faces, with gas": closed_by_faces(),
        "film, sheet between moving plates": between_moving_plates(),
        "film, column of gas under a free body": with_a_free_body(),
    });
    let now = json!({ "physics_version": billow_solver::PHYSICS_VERSION, "hashes": hashes });
    let same = recorded["physics_version"] == now["physics_version"]
        && recorded["hashes"] == now["hashes"];
    assert!(
        same,
        "the physics changed (or its version did): raise PHYSICS_VERSION in solver/src/lib.rs, \
         record these hashes in tests/reference/physics.json, and say in CHANGELOG what changed:\n\
         {now:#}"
    );
}
