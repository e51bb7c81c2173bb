//! What every model of the paper's capsule does.

use billow_solver::models;
use billow_solver::models::piston::MovingMass;
use billow_solver::scene::paper;

use crate::film_capsule;
use crate::prelude::*;
use crate::rig::run;

/// The capsule at n 2 by a model, sampled every millisecond.
fn scene(model: ModelKind, end_time: f64) -> Scene {
    let mut scene = paper::capsule(2, end_time);
    scene.solver.model = model;
    if model != ModelKind::Piston {
        scene.solver.stepping = Stepping::Stable(DEFAULT_CFL);
    }
    scene.outputs.sample_interval = 1e-3;
    scene
}

#[test]
fn a_packed_capsule_stays_and_presses_on_its_lid() {
    let all = ModelKind::ALL.map(|model| (model, true));
    // Film without contact too.
    for (model, contact) in all.into_iter().chain([(ModelKind::Film, false)]) {
        let mut scene = scene(model, 0.03);
        scene.release_time = 0.01;
        let deployment = if contact { run(&scene) } else { film_capsule::run(&scene, DEFAULT_CFL) };
        assert_eq!(deployment.stop, Stop::Done, "{model:?}");
        let column = |name: &str| deployment.history.column(name);
        let (lid, pressure, z) = (column("lid_force"), column("pressure"), column("z_rim"));
        if model == ModelKind::Film && contact {
            // Layers in contact move a little under the lid.
            let near = |height: &f64| (height / z[0] - 1.0).abs() < 0.03;
            assert!(z[..=10].iter().all(near), "{z:?}");
            assert!(lid[..10].iter().any(|force| *force > 1.0), "{lid:?}");
        } else {
            assert!(z[..=10].iter().all(|height| *height == z[0]), "{model:?}: {z:?}");
            assert!(column("kinetic_energy")[..=10].iter().all(|energy| *energy == 0.0));
            // p dV/dz for a uniform stretch; V is nearly linear in the height.
            let expected =
                pressure[10] * column("volume")[0] / scene.design.folded().unwrap().stowed_height;
            assert!((lid[10] / expected - 1.0).abs() < 0.1, "{model:?}: {} {expected}", lid[10]);
        }
        assert!(lid[11..].iter().all(|force| *force == 0.0), "{model:?}: {lid:?}");
        let largest = lid.iter().copied().fold(0.0, f64::max);
        assert_eq!(deployment.measures.peak_lid_force, Some(largest), "{model:?}");
        assert!(z[30] > 0.09, "{model:?}: {}", z[30]);
        assert!(deployment.audit.ledger_residual < 5e-3, "{model:?}");
    }
}

/// Pressure on closed film has no resultant: while nothing moves, what holds the film carries its weight alone, and then
/// also what lifts it.
#[test]
fn what_holds_the_film_carries_its_weight_and_what_lifts_it() {
    for model in ModelKind::ALL {
        let mut scene = scene(model, 0.03);
        scene.release_time = 0.01;
        scene.gravity = -9.806_65;
        let pattern = scene.design.pattern().unwrap();
        let mass = MovingMass::new(&pattern, scene.film.area_density()).total;
        // Layers in contact move under the lid.
        let film = model == ModelKind::Film;
        let deployment = if film { film_capsule::run(&scene, DEFAULT_CFL) } else { run(&scene) };
        assert_eq!(deployment.stop, Stop::Done, "{model:?}");
        let impulse = deployment.history.column("support_impulse");
        let weight = mass * 9.806_65;
        assert!((impulse[10] / (0.01 * weight) - 1.0).abs() < 0.02, "{model:?}: {impulse:?}");
        let vz = deployment.history.column("vz")[30];
        let momentum = impulse[30] - 0.03 * weight;
        assert!(momentum > 0.3 * mass * vz && momentum < mass * vz, "{model:?}: {momentum} {vz}");
        let largest = deployment.measures.peak_base_force.unwrap();
        assert!(largest > (impulse[30] - impulse[25]) / 5e-3 - 1e-9, "{model:?}: {largest}");
        // Some node is as fast as the ring.
        let fastest = deployment.followed("film_speed").iter().copied().reduce(f64::max);
        let ring = deployment.measures.peak_speed.unwrap();
        match fastest {
            Some(fastest) => assert!(fastest > ring - 1e-9, "{model:?}: {fastest} {ring}"),
            None => assert_eq!(model, ModelKind::Piston, "without nodes"),
        }
    }
}

/// Without gas, gravity pulls the top through the stowed stack.
#[test]
fn gravity_presses_an_empty_capsule_shut() {
    for model in [ModelKind::Piston, ModelKind::Storeys] {
        let mut scene = scene(model, 1.0);
        scene.gas.windows = Vec::new();
        scene.gravity = -9.806_65;
        match run(&scene).stop {
            Stop::Failed(failure) => assert_eq!(failure.kind, FailureKind::InvertedVolume),
            stop => panic!("{model:?}: {stop:?}"),
        }
    }
}

/// Film and pistons have tests of their own.
#[test]
fn storeys_have_the_same_bits_on_every_instruction_set_and_others_with_another_seed() {
    let mut scene = scene(ModelKind::Storeys, 0.08);
    scene.film.loss_factor = paper::LOSS_FACTOR;
    let mut bits = |set: InstructionSet, seed: u64| {
        scene.seed = seed;
        let deployment = models::solve(set, &scene, &mut Unobserved).unwrap();
        assert_eq!(deployment.stop, Stop::Done);
        format!("{deployment:?}")
    };
    let scalar = bits(InstructionSet::Scalar, 3);
    for set in InstructionSet::ALL.into_iter().filter(|set| set.available()) {
        assert!(bits(set, 3) == scalar, "{}", set.name());
    }
    assert!(bits(InstructionSet::Scalar, 4) != scalar);
}

/// A change of a scene.
type Change = fn(&mut Scene);

#[test]
fn invalid_scenes_name_their_key() {
    let changes: [(Change, &str); 24] = [
        (|s| s.supports.clear(), "supports"),
        (
            |s| s.supports.push(Support { on: SupportLocation::TopRing, fix: "z".to_owned() }),
            "supports[1].fix",
        ),
        (|s| s.supports[0].fix = "zx".to_owned(), "supports[0].fix"),
        (|s| s.film.thickness = 0.0, "film.thickness"),
        (|s| s.film.youngs_modulus = f64::NAN, "film.youngs_modulus"),
        (|s| s.film.poisson_ratio = 0.6, "film.poisson_ratio"),
        (|s| s.film.compression = 1.5, "film.compression"),
        (|s| s.film.numerical_damping = -0.1, "film.numerical_damping"),
        (|s| s.gas.species.cp = 200.0, "gas.species.cp"),
        (|s| s.gas.species.vibrations[1] = f64::NAN, "gas.species.vibrations"),
        (|s| s.gas.initial_mass = -1.0, "gas.initial_mass"),
        (|s| s.gas.windows[0].to = -1.0, "gas.windows[0].to"),
        (|s| s.gas.windows[0].mass_flow_rate = -1.0, "gas.windows[0].rate"),
        (|s| s.gas.windows[0].temperature = 0.0, "gas.windows[0].temperature"),
        (
            |s| s.gas.heat_transfer = HeatTransfer::Coefficient(-1.0),
            "gas.heat_transfer.coefficient",
        ),
        (|s| s.gas.discharge_coefficient = 0.0, "gas.discharge_coefficient"),
        (|s| s.gravity = f64::INFINITY, "gravity"),
        (|s| s.release_time = -1.0, "release_time"),
        (|s| s.solver.end_time = 0.0, "solver.end_time"),
        (|s| s.solver.step_limit = 0, "solver.step_limit"),
        (|s| s.solver.stepping = Stepping::Adaptive(1.0), "solver.stepping.adaptive"),
        (|s| s.solver.stepping = Stepping::Fixed(0.0), "solver.stepping.fixed"),
        (|s| s.outputs.sample_interval = 1e-12, "outputs.sample_interval"),
        (|s| s.outputs.thresholds.deployed_volume = 0.0, "outputs.thresholds.deployed_volume"),
    ];
    let of_storeys: [(Change, &str); 4] = [
        (|s| s.supports.clear(), "supports"),
        (|s| s.supports[0].fix = "z".to_owned(), "supports[0]"),
        (|s| s.supports[0].on = SupportLocation::TopRing, "supports[0]"),
        (|s| s.solver.stepping = Stepping::Fixed(1e-5), "solver.stepping"),
    ];
    let of_piston = changes.into_iter().map(|change| (ModelKind::Piston, change));
    let of_storeys = of_storeys.into_iter().map(|change| (ModelKind::Storeys, change));
    for (model, (change, expected)) in of_piston.chain(of_storeys) {
        let mut scene = scene(model, 0.1);
        change(&mut scene);
        match models::solve(InstructionSet::detect(), &scene, &mut Unobserved) {
            Err(SceneError::Invalid { key, problem }) => {
                assert!(key.starts_with(expected), "{key}: {problem}, not {expected}");
                let of_storeys = problem.contains("storeys") && problem.contains("allowed");
                assert!(!problem.is_empty() && (model == ModelKind::Piston || of_storeys));
                let invalid = SceneError::Invalid { key, problem };
                assert_eq!(models::check(&scene).unwrap_err(), invalid);
            }
            other => panic!("{expected}: {other:?}"),
        }
    }
}
