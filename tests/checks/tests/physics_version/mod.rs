//! The guard of the physics version: the bits of some small runs change only with it.
//!
//! `tests/reference/physics.json` holds the physics version and the SHA-256 of the bits of each run's
//! history or end state. After a change of the physics, raise the version, record the hashes that this
//! test prints, and add a line to CHANGELOG.

mod whole_runs;

use billow_checks::cases::contact_capsule::stowed;
use billow_checks::cases::prelude::*;
use billow_checks::cases::rig::explicit;
use billow_solver::geometry::shapes::tube;
use billow_solver::models;
use billow_solver::models::run::Model;
use billow_solver::output::history::COLUMNS;
use billow_solver::platform::simd::InstructionSet;
use billow_solver::scene::inflow::Inflow;
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
    let columns = COLUMNS.iter().map(|column| deployment.history.column(column.name));
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
fn capsule() -> String {
    let contact = FilmContact::default();
    let mut scene = paper::capsule(2, 0.02);
    scene.film.numerical_damping = 0.1;
    let mut run = stowed(&Rig::default(), &scene, contact).expect("a capsule");
    let inflow = Inflow { mass_flow_rate: 5e-3, temperature_flow: 5e-3 * 293.0 };
    let phase = Phase { inflow, ..Phase::default() };
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
    let upper = FilmSupport {
        name: "upper".to_owned(),
        nodes: (around * along..around * (along + 1)).collect(),
        hold: Hold::Components([true; 3]),
        motion: Some(motion),
    };
    let scene = FilmScene {
        filling: Filling::Pressure(100.0),
        supports: vec![held((0..around).collect(), "xyz"), upper],
        ..free_film(tube(around, along, 0.1, 0.2), Film::PAPER_ELASTIC)
    };
    end_state_at(&scene, 3e-3, &Phase::default())
}

#[test]
fn the_physics_changes_only_with_its_version() {
    let recorded: Value =
        serde_json::from_str(include_str!("../../../reference/physics.json")).expect("JSON");
    let hashes = json!({
        "piston, rapid inflation with heat and leak": rapid(),
        "piston, preinflated and packed": preinflated(),
        "storeys, rapid inflation with heat and leak": storeys(),
        "film, capsule of two subdivisions with contact for 300 ms": capsule(),
        "film, sphere with gas, heat and leak in air": sphere(),
        "film, damped sheet under gravity, compression 0.3": falling_sheet(),
        "film, tube with a moving support": turned_tube(),
        "film, capsule under a lid": whole_runs::under_a_lid(),
        "film, capsule with friction, compression 1": whole_runs::with_friction(),
        "film, capsule with adhesion": whole_runs::with_adhesion(),
        "film, tube closed by faces, with gas": whole_runs::closed_by_faces(),
        "film, sheet between moving plates": whole_runs::between_moving_plates(),
        "film, column of gas under a free body": whole_runs::with_a_free_body(),
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
