//! Kinds of scenes, coverage, interpolation between meshes, and the table that the program contains.

use std::collections::BTreeMap;

use billow_solver::scene::paper::{capsule, window};
use billow_solver::scene::{ModelKind, Scene, Stepping};

use super::entry::RelativeError;
use super::features::FEATURES;
use super::promised::promise;
use super::*;

/// The capsule of the paper at 5 g/s.
fn scene() -> Scene {
    let mut scene = capsule(8, 0.3);
    scene.solver.model = ModelKind::Film;
    scene.solver.stepping = Stepping::Stable(0.45);
    scene.seed = 1;
    scene
}

fn features(scene: &Scene) -> Features {
    Features::of(scene, 0.365, 1.0).unwrap()
}

fn value(features: &Features, name: &str) -> f64 {
    let index = features::FEATURE_NAMES.iter().position(|known| *known == name).unwrap();
    features.values[index]
}

/// The same capsule with everything else as in the runs of the shipped table.
pub(super) fn covered() -> Scene {
    let mut covered = MeshErrors::shipped().coverage.scene.clone();
    let scene = scene();
    (covered.design, covered.film) = (scene.design, scene.film);
    covered.film.loss_factor = MeshErrors::shipped().coverage.scene.film.loss_factor;
    covered.gas.windows = vec![window(0.0, 0.3, 5e-3)];
    (covered.gas.initial_mass, covered.release_time) = (0.0, 0.0);
    covered.solver.end_time = 0.3;
    covered
}

#[test]
fn the_features_of_a_scene_say_how_gas_reaches_the_released_capsule() {
    let mut scene = scene();
    scene.gas.windows = vec![window(0.0, 0.3, 5e-3)];
    let near = |features: Features, name: &str, expected: f64| {
        let value = value(&features, name);
        assert!(
            (value - expected).abs() <= 1e-9 * expected.abs(),
            "{name}: {value}, not {expected}"
        );
    };
    let slant = libm::hypot(1.0, 0.135);
    let area = std::f64::consts::PI * (0.865 * slant + 0.25 + 0.365 * 0.365);
    let mass = 1400.0 * 25.4e-6 * area;
    // A constant inflow: ṁ R T t³ = m H².
    let square = mass / (scene.gas.species.gas_constant * 293.0);
    let gas_time = libm::cbrt(square / 5e-3);
    let direct = features(&scene);
    near(direct, "mass of film over gas", mass / (5e-3 * gas_time));
    let wave_time = 0.5 * (1400.0_f64 / 3.45e9).sqrt();
    near(direct, "gas time over wave time", gas_time / wave_time);
    near(direct, "burst over gas", 0.0);
    near(direct, "duration of inflow over gas time", 3.0);
    near(direct, "stowed_height over bottom_radius", 0.08);
    // Gas that is inside at the release: m₀ R T t² = m H², and what flows in later has no part in it.
    scene.release_time = 0.005;
    scene.gas.initial_mass = 1e-4;
    scene.gas.windows = vec![window(0.305, 0.4, 5e-3)];
    let stored = (square / 1e-4).sqrt();
    let delayed = features(&scene);
    near(delayed, "gas at the release over gas", 1.0);
    near(delayed, "time to inflow over gas time", 0.3 / stored);
    near(delayed, "mass of film over gas", mass / 1e-4);
    // An empty capsule waits for its gas.
    scene.gas.initial_mass = 0.0;
    near(features(&scene), "time to inflow over gas time", 0.0);
    scene.gas.windows = vec![window(0.0, 0.01, 5e-3), window(0.0, 0.3, 5e-3)];
    scene.release_time = 0.0;
    let burst = features(&scene);
    near(burst, "burst over gas", 5e-5 * value(&burst, "mass of film over gas") / mass);
}

/// A capsule of twice the size, with film and gas of other numbers but equal ratios.
#[test]
fn equal_physics_of_another_size_has_equal_features() {
    let mut small = scene();
    small.gas.windows = vec![window(0.0, 0.3, 5e-3)];
    let mut large = small.clone();
    large.design.folded_mut().unwrap().bottom_radius *= 2.0;
    large.design.folded_mut().unwrap().stowed_height *= 2.0;
    // Twice the length at equal speeds takes twice the time; the film is four times as heavy.
    large.gas.windows = vec![window(0.0, 0.6, 1e-2)];
    large.solver.end_time = 0.6;
    let [small, large] =
        [features(&small), Features::of(&large, 0.73, 2.0).unwrap()].map(|of| of.values);
    for (name, (small, large)) in features::FEATURE_NAMES.iter().zip(small.iter().zip(large)) {
        assert!((small - large).abs() <= 1e-9 * small.abs(), "{name}: {small} {large}");
    }
}

#[test]
fn a_scene_unlike_the_runs_is_not_covered_and_the_reason_names_its_key() {
    let base = scene();
    let coverage = Coverage::of([(&base, features(&base))]).unwrap();
    let gap = |scene: &Scene| coverage.gap(scene, &features(scene));
    assert_eq!(gap(&base), None);
    let mut other = base.clone();
    other.design.folded_mut().unwrap().subdivisions = 16;
    other.seed = 7;
    other.outputs.frames = 5;
    assert_eq!(gap(&other), None, "mesh, seed and outputs are no part of it");
    let reason = |change: fn(&mut Scene)| {
        let mut scene = scene();
        change(&mut scene);
        gap(&scene).unwrap()
    };
    assert!(
        reason(|scene| scene.film.thickness = 50e-6).starts_with("mass of film over gas "),
        "thicker film is heavier"
    );
    assert!(
        reason(|scene| scene.film.numerical_damping = 0.01).starts_with("film.numerical_damping ")
    );
    assert_eq!(
        reason(|scene| scene.solver.stepping = Stepping::Stable(0.3)),
        "solver.cfl 0.3: the runs of the table have 0.45"
    );
    assert!(reason(|scene| scene.contact.friction = 0.3).starts_with("contact.friction 0.3"));
    assert_eq!(
        reason(|scene| scene.gas.species.cp = 846.0),
        "gas.species: the runs of the table have nitrogen"
    );
    assert!(reason(|scene| scene.gravity = -9.8).starts_with("gravity -9.8"));
    assert!(reason(|scene| scene.design.folded_mut().unwrap().panels = 9).starts_with("N 9: "));
}

#[test]
fn a_model_without_mesh_is_covered_at_its_default_step() {
    let base = scene();
    let coverage = Coverage::of([(&base, features(&base))]).unwrap();
    let gap = |model: ModelKind, stepping: Stepping| {
        let mut scene = scene();
        scene.solver.model = model;
        scene.solver.stepping = stepping;
        coverage.gap(&scene, &features(&scene))
    };
    assert_eq!(gap(ModelKind::Piston, Stepping::Adaptive(1e-9)), None);
    assert_eq!(gap(ModelKind::Piston, Stepping::Adaptive(1e-11)), None);
    assert_eq!(gap(ModelKind::Storeys, Stepping::Stable(0.45)), None);
    let step = gap(ModelKind::Storeys, Stepping::Stable(0.9)).unwrap();
    assert_eq!(step, "solver.cfl 0.9: the runs of the table have 0.45");
    let step = gap(ModelKind::Piston, Stepping::Fixed(0.001)).unwrap();
    assert_eq!(step, "solver.stepping.fixed 0.001: the runs of the table have none");
    assert!(gap(ModelKind::Piston, Stepping::Adaptive(1e-3)).is_some());
}

/// A table of one measure with two meshes.
fn table() -> MeshErrors {
    let base = scene();
    let mut slopes = [0.0; FEATURES];
    slopes[1] = 0.04 / libm::log(1.5);
    let entry = |n: u32, error: f64| Entry {
        model: ModelKind::Film,
        meshes: vec![n],
        weight: 0.0,
        bias: libm::log(1.0 - error),
        slopes,
        width: 0.0,
        runs: 1,
        scenes: 1,
    };
    MeshErrors {
        format: table::FORMAT.to_owned(),
        version: table::VERSION,
        physics_version: 0,
        studies: Vec::new(),
        reference: 24,
        finest: 24,
        coverage: Coverage::of([(&base, features(&base))]).unwrap(),
        coordinates: Coordinates { base: features(&base).values, half: [0.0; FEATURES] },
        errors: [("t_90_z_rim".to_owned(), vec![entry(16, 0.02), entry(4, 0.08)])].into(),
        assumed: BTreeMap::new(),
    }
}

#[test]
fn between_two_meshes_the_error_is_linear_in_the_logarithm_of_n() {
    let table = table();
    let promised = promise("t_90_z_rim_since_release").unwrap();
    let error = |n: u32| {
        let method = Method { model: ModelKind::Film, meshes: vec![n] };
        table.error(&method, &features(&scene()), promised)
    };
    assert!((error(4).unwrap().of_reference - 0.08).abs() < 1e-15);
    assert!((error(8).unwrap().of_reference - 0.05).abs() < 1e-15);
    assert!((error(32).unwrap().of_reference - 0.02).abs() < 1e-15, "that of the finest");
    assert_eq!(error(3).unwrap_err(), "design.subdivisions 3: the table has 4 and finer meshes");
    let method = Method { model: ModelKind::Piston, meshes: Vec::new() };
    let error = table.error(&method, &features(&scene()), promised).unwrap_err();
    assert_eq!(error, "piston: the table has no such runs");
}

#[test]
fn a_feature_changes_the_bias_and_deviations_make_the_error_wider() {
    let mut table = table();
    let promised = promise("t_90_z_rim").unwrap();
    let method = Method { model: ModelKind::Film, meshes: vec![4] };
    let mut two_storeys = scene();
    two_storeys.design.folded_mut().unwrap().storeys = 2;
    let of = |table: &MeshErrors, scene: &Scene| {
        table.error(&method, &features(scene), promised).unwrap()
    };
    let near = |found: [f64; 3], expected: [f64; 3]| {
        let close = |k: usize| (found[k] - expected[k]).abs() < 1e-12;
        assert!((0..3).all(close), "{found:?} {expected:?}");
    };
    let all = |error: RelativeError| [error.of_reference, error.of_itself[0], error.of_itself[1]];
    // The value is 0.92 e^−0.04 of that on the finest mesh, which is above it.
    let value = 0.92 * libm::exp(-0.04);
    near(all(of(&table, &two_storeys)), [1.0 - value, 0.0, 1.0 / value - 1.0]);
    let wide = libm::exp(0.05);
    for entry in table.errors.values_mut().flatten() {
        entry.width = 0.05;
    }
    near(all(of(&table, &two_storeys)), [1.0 - value / wide, 0.0, wide / value - 1.0]);
    for entry in table.errors.values_mut().flatten() {
        entry.bias = 0.01;
    }
    let (most, least) = (libm::exp(0.06), libm::exp(0.04));
    near(all(of(&table, &scene())), [most - 1.0, 1.0 - 1.0 / most, least - 1.0]);
}

#[test]
fn the_worst_end_of_each_assumed_value_counts() {
    let mut table = table();
    let promised = promise("t_90_z_rim").unwrap();
    assert_eq!(table.assumed(&features(&scene()), promised, &AssumedRanges::default()), None);
    let changes = [
        ("film.loss_factor 0.003", 0.01),
        ("film.loss_factor 0.03", -0.03),
        ("gas.heat_transfer 1", 0.04),
    ];
    let of_mesh = table.of_measure("t_90_z_rim")[1].clone();
    let changed = changes.map(|(assumed, bias)| {
        let bias = libm::log(1.0 + bias);
        (assumed.to_owned(), Entry { bias, slopes: [0.0; FEATURES], ..of_mesh.clone() })
    });
    table.assumed.insert("t_90_z_rim".to_owned(), changed.into());
    let near = |ranges: &AssumedRanges, [below, above]: [f64; 2]| {
        let sides = table.assumed(&features(&scene()), promised, ranges).unwrap();
        let off = [sides[0] - below, sides[1] - above].map(f64::abs);
        assert!(off.iter().all(|off| *off < 1e-12), "{sides:?}");
    };
    near(&AssumedRanges::default(), [0.03, libm::hypot(0.01, 0.04)]);
    // Half of the way from 0.3 to 1 in the logarithm, and no doubt about the loss.
    let ranges = AssumedRanges([[0.015, 0.015], [0.3, libm::sqrt(0.3)]]);
    near(&ranges, [0.0, 0.02]);
}

#[test]
fn the_shipped_table_is_that_of_this_physics_and_agrees_with_the_names_of_the_columns() {
    let table = MeshErrors::shipped();
    assert_eq!(table.format, table::FORMAT);
    assert_eq!(table.physics_version, billow_solver::PHYSICS_VERSION, "calibrate again");
    let paper = covered();
    assert_eq!(table.gap(&paper, &features(&paper)), None);
    for promised in &PROMISED {
        let name = promised.measure.name();
        let names = ["below", "above"].map(|side| format!("{name}_error_{side}"));
        assert_eq!(promised.error_columns, names);
        for n in [4, 5, 8, 10, 24] {
            let method = Method { model: ModelKind::Film, meshes: vec![n] };
            let error = table.error(&method, &features(&paper), promised).unwrap();
            let [below, above] = error.of_itself;
            for part in [error.of_reference, below + above] {
                assert!((1e-4..2.5).contains(&part), "{name} n {n}: {part}");
            }
        }
        let names = ["below", "above"].map(|side| format!("{name}_assumed_{side}"));
        assert_eq!(promised.assumed_columns, names);
        let sides = table.assumed(&features(&paper), promised, &AssumedRanges::default()).unwrap();
        let within = |side: &f64| (0.0..1.0).contains(side);
        assert!(sides.iter().all(within) && sides[0] + sides[1] > 1e-5, "{name}: {sides:?}");
    }
}

/// The shipped table has all three models for each measure, and the piston is the least exact in how soon.
#[test]
fn the_models_without_mesh_stand_beside_the_meshes_the_cheapest_first() {
    let table = MeshErrors::shipped();
    let film = covered();
    let mut piston = film.clone();
    piston.solver.model = ModelKind::Piston;
    piston.solver.stepping = Stepping::Adaptive(1e-9);
    for scene in [film, piston] {
        let choices = choices(table, &[(&scene, features(&scene))]).unwrap();
        let models: Vec<ModelKind> = choices.iter().map(|choice| choice.method.model).collect();
        assert_eq!(models[..3], [ModelKind::Piston, ModelKind::Storeys, ModelKind::Film]);
        assert!(choices.iter().all(|choice| choice.refusal.is_none()));
        assert!(choices[..2].iter().all(|choice| choice.asked().all(f64::is_finite)));
        let t_90 = |index: usize| choices[index].errors[1];
        assert!((1..choices.len()).all(|index| t_90(0) > t_90(index)), "{choices:?}");
    }
}

#[test]
fn a_model_that_cannot_compute_a_scene_keeps_nothing() {
    // A table of scenes whose top is held, which no model but film moves.
    let mut held = scene();
    held.supports.push(held.supports[0].clone());
    held.supports[1].on = billow_solver::scene::SupportLocation::TopRing;
    let mut table = table();
    table.coverage = Coverage::of([(&held, features(&held))]).unwrap();
    let film = table.of_measure("t_90_z_rim").to_vec();
    let meshless = |model| Entry { model, meshes: Vec::new(), ..film[0].clone() };
    let entries =
        [film.clone(), [ModelKind::Piston, ModelKind::Storeys].map(meshless).to_vec()].concat();
    table.errors = PROMISED.map(|of| (of.measure.name().to_owned(), entries.clone())).into();
    let choices = choices(&table, &[(&held, features(&held))]).unwrap();
    let keeps = |model: ModelKind| {
        let choice = choices.iter().find(|choice| choice.method.model == model).unwrap();
        (choice.keeps(0.5), choice.refusal.clone().unwrap_or_default())
    };
    assert_eq!(keeps(ModelKind::Film), (true, String::new()));
    for model in [ModelKind::Piston, ModelKind::Storeys] {
        let (kept, reason) = keeps(model);
        assert!(!kept && reason.contains("supports[1]"), "{reason}");
    }
}
