//! The table of mesh errors, from runs on several meshes.
//!
//! ```text
//! v = m/m_ref − 1        one run; m_ref: median of the runs of its scene on the finest mesh
//! bias of a scene = median of v;  s² = Σ (v − bias)²/(runs − scenes) + the same of the finest mesh with several runs
//! bias(x) and its deviation: [`super::regression`] over all scenes
//! ```
//! The base scene is the one from which most others differ in one feature. A value extrapolated from two meshes is
//! m₂ + w (m₂ − m₁), with the weight w for which it is nearest to the value on the finest mesh.

use std::collections::{BTreeMap, BTreeSet};

use billow_solver::scene::ModelKind;

use super::fit::limit;
use super::regression::{Point, regression};
use super::runs::{MeshRun, SceneRuns};
use billow_study::accuracy::features::{FEATURE_NAMES, FEATURES, are_equal};
use billow_study::accuracy::table::{FORMAT, VERSION};
use billow_study::accuracy::{Coordinates, Coverage, Entry, MeshErrors, PROMISED};
use billow_study::analysis::statistics::Spread;
use billow_study::job::row::ColumnId;
use billow_study::platform::provenance::PHYSICS_VERSION;

/// Largest value of a feature with the base value 0, over its value at half of its effect. Chosen: whether there
/// is gas at all changes the start more than its mass; of 4 to 50 it predicts the shipped scenes best, by a little.
const LARGEST_OVER_HALF: f64 = 20.0;
/// Scenes of an entry, at least, where the results have as many.
const MIN_SCENES: usize = 5;
/// Weights of an extrapolated value are at most this. Chosen: first order of meshes that differ by half gives 1, by
/// a quarter 3.
const MAX_WEIGHT: f64 = 3.0;
/// One scene for one measure: v by model, subdivisions and seed.
struct Scene {
    features: [f64; FEATURES],
    values: BTreeMap<(u8, u32), BTreeMap<u64, f64>>,
}

/// A model and its mesh or meshes.
type Method = (ModelKind, Vec<u32>);

/// The table from these scenes, with the errors against the mesh of `reference` subdivisions; `None` if no scene
/// has a run on it.
pub(super) fn calibrate(
    scenes: &[SceneRuns],
    studies: Vec<String>,
    reference: u32,
) -> Option<MeshErrors> {
    let scenes = longest(scenes, reference);
    let all = || scenes.iter().flat_map(|scene| &scene.runs);
    let coverage = Coverage::of(all().map(|run| (&run.scene, run.features)))?;
    let coordinates = coordinates(&scenes)?;
    let mut errors = Vec::new();
    let mut limits = BTreeMap::new();
    for promised in &PROMISED {
        let measure = promised.measure;
        let of_measure: Vec<Scene> =
            scenes.iter().filter_map(|scene| Scene::of(scene, measure, reference)).collect();
        limits.insert(measure.name().to_owned(), limit(&scenes, measure, reference));
        errors.extend(entries(&of_measure, &coordinates, measure, reference));
    }
    Some(MeshErrors {
        format: FORMAT.to_owned(),
        version: VERSION,
        physics_version: PHYSICS_VERSION,
        studies,
        reference,
        coverage,
        coordinates,
        limits,
        errors,
    })
}

/// The coordinates about the scene from which most others differ in one feature.
fn coordinates(scenes: &[&SceneRuns]) -> Option<Coordinates> {
    let all: Vec<[f64; FEATURES]> =
        scenes.iter().filter_map(|scene| Some(scene.runs.first()?.features.values)).collect();
    let neighbours =
        |one: &[f64; FEATURES]| all.iter().filter(|other| different(one, other).len() == 1).count();
    let base = all.iter().copied().rev().max_by_key(neighbours)?;
    let largest = |index: usize| all.iter().map(|values| values[index]).fold(0.0, f64::max);
    let half = core::array::from_fn(|index| {
        if base[index] > 0.0 { 0.0 } else { largest(index) / LARGEST_OVER_HALF }
    });
    Some(Coordinates { base, half })
}

/// Positions of the features in which two scenes differ.
fn different(a: &[f64; FEATURES], b: &[f64; FEATURES]) -> Vec<usize> {
    (0..FEATURES).filter(|index| !are_equal(a[*index], b[*index])).collect()
}

/// The scenes with a run on the finest mesh; of scenes that differ in their end alone the longest one.
fn longest(scenes: &[SceneRuns], reference: u32) -> Vec<&SceneRuns> {
    let mut longest: BTreeMap<String, &SceneRuns> = BTreeMap::new();
    let end = |scene: &SceneRuns| scene.runs.first().map_or(0.0, |run| run.scene.solver.end_time);
    let has_reference = |scene: &&SceneRuns| {
        scene.runs.iter().any(|run| run.mesh() == (ModelKind::Film, reference))
    };
    for scene in scenes.iter().filter(has_reference) {
        let key = format!("{:?}", scene.runs[0].features);
        let known = longest.entry(key).or_insert(scene);
        if end(scene) > end(known) {
            *known = scene;
        }
    }
    longest.into_values().collect()
}

impl Scene {
    fn of(scene: &SceneRuns, measure: ColumnId, reference: u32) -> Option<Self> {
        let on = |run: &&MeshRun| run.mesh() == (ModelKind::Film, reference);
        let finest = scene.runs.iter().filter(on).filter_map(|run| run.measure(measure));
        let finest = Spread::of(finest)?.median;
        let mut values: BTreeMap<(u8, u32), BTreeMap<u64, f64>> = BTreeMap::new();
        for run in &scene.runs {
            if let Some(value) = run.measure(measure)
                && finest != 0.0
            {
                let (model, n) = run.mesh();
                let of_mesh = values.entry((model as u8, n)).or_default();
                of_mesh.insert(run.scene.seed, value / finest - 1.0);
            }
        }
        Some(Self { features: scene.runs.first()?.features.values, values })
    }

    /// The values of a method, one per run; of two meshes by equal seed.
    fn of_method(&self, (model, meshes): &Method, weight: f64) -> Vec<f64> {
        let on = |n: u32| self.values.get(&(*model as u8, n));
        match meshes.as_slice() {
            [coarse, fine] => {
                let (Some(coarse), Some(fine)) = (on(*coarse), on(*fine)) else {
                    return Vec::new();
                };
                let pairs = coarse.iter().filter_map(|(seed, a)| Some((a, fine.get(seed)?)));
                pairs.map(|(a, b)| b + weight * (b - a)).collect()
            }
            meshes => {
                let values = on(meshes.first().copied().unwrap_or(0));
                values.map(|values| values.values().copied().collect()).unwrap_or_default()
            }
        }
    }

    fn bias(&self, method: &Method, weight: f64) -> Option<f64> {
        Some(Spread::of(self.of_method(method, weight))?.median)
    }
}

/// The entries of a measure: models without a mesh, each mesh, each pair of meshes.
fn entries(
    scenes: &[Scene],
    coordinates: &Coordinates,
    measure: ColumnId,
    reference: u32,
) -> Vec<Entry> {
    let film = scenes.iter().flat_map(|scene| scene.values.keys());
    let film = film.filter(|(model, n)| *model == ModelKind::Film as u8 && *n < reference);
    let meshes: BTreeSet<u32> = film.map(|(_, n)| *n).collect();
    let meshes: Vec<u32> = meshes.into_iter().collect();
    // Single runs of the finest mesh scatter as those of the finest mesh with several.
    let of_mesh = |n: &u32| scatter(scenes, &(ModelKind::Film, vec![*n]), 0.0);
    let finest = meshes.iter().rev().find_map(of_mesh).unwrap_or(0.0);
    let mut methods: Vec<Method> =
        vec![(ModelKind::Piston, Vec::new()), (ModelKind::Storeys, Vec::new())];
    methods.extend(meshes.iter().map(|n| (ModelKind::Film, vec![*n])));
    for (index, coarse) in meshes.iter().enumerate() {
        let pairs = meshes[index + 1..].iter().map(|fine| (ModelKind::Film, vec![*coarse, *fine]));
        methods.extend(pairs);
    }
    let entry = |method: &Method| {
        let weight = weight(scenes, method);
        let biases: Vec<(&Scene, f64)> =
            scenes.iter().filter_map(|scene| Some((scene, scene.bias(method, weight)?))).collect();
        // A mesh of few scenes shows no deviation between designs, and would look better than finer ones.
        if biases.len() < MIN_SCENES.min(scenes.len()) {
            return None;
        }
        let points: Vec<Point> =
            biases.iter().map(|(scene, bias)| (coordinates.of(&scene.features), *bias)).collect();
        let fitted = regression(&points)?;
        let ranges = ranges(&biases, &coordinates.base);
        let slopes = FEATURE_NAMES.iter().zip(fitted.slopes);
        let slopes = slopes.filter(|((name, _), _)| ranges.contains_key(*name));
        // Pairs with one run each scatter as their finer mesh.
        let of_method = scatter(scenes, method, weight)
            .or_else(|| {
                method
                    .1
                    .last()
                    .and_then(|n| meshes.iter().filter(|m| *m <= n).rev().find_map(of_mesh))
            })
            .unwrap_or(0.0);
        Some(Entry {
            measure: measure.name().to_owned(),
            model: method.0,
            meshes: method.1.clone(),
            weight,
            bias: fitted.intercept,
            slopes: slopes.map(|((name, _), slope)| ((*name).to_owned(), slope)).collect(),
            ranges,
            scatter: (of_method * of_method + finest * finest).sqrt(),
            deviation: fitted.deviation,
            runs: scenes.iter().map(|scene| scene.of_method(method, weight).len()).sum(),
            scenes: biases.len(),
        })
    };
    methods.iter().filter_map(entry).collect()
}

/// The ranges of the features in which a scene differs from the base scene.
fn ranges(biases: &[(&Scene, f64)], base: &[f64; FEATURES]) -> BTreeMap<String, [f64; 2]> {
    let of_feature = |(index, (name, _)): (usize, &(&str, &str))| {
        let levels = || biases.iter().map(|(scene, _)| scene.features[index]);
        let varies = levels().any(|level| !are_equal(level, base[index]));
        let range =
            [levels().fold(f64::INFINITY, f64::min), levels().fold(f64::NEG_INFINITY, f64::max)];
        varies.then(|| ((*name).to_owned(), range))
    };
    FEATURE_NAMES.iter().enumerate().filter_map(of_feature).collect()
}

/// Standard deviation of the runs of a method about the medians of their scenes; `None` where no scene has several.
fn scatter(scenes: &[Scene], method: &Method, weight: f64) -> Option<f64> {
    let mut squares = 0.0;
    let mut free = 0;
    for scene in scenes {
        let values = scene.of_method(method, weight);
        if let (Some(spread), 2..) = (Spread::of(values.iter().copied()), values.len()) {
            squares +=
                values.iter().map(|v| (v - spread.median) * (v - spread.median)).sum::<f64>();
            free += values.len() - 1;
        }
    }
    (free > 0).then(|| (squares / free as f64).sqrt())
}

/// The weight w for which m₂ + w (m₂ − m₁) is nearest to the value on the finest mesh, over all scenes; 0 for one
/// mesh.
fn weight(scenes: &[Scene], (model, meshes): &Method) -> f64 {
    let [coarse, fine] = meshes[..] else { return 0.0 };
    let mut product = 0.0;
    let mut square = 0.0;
    for scene in scenes {
        let bias = |n: u32| scene.bias(&(*model, vec![n]), 0.0);
        if let (Some(a), Some(b)) = (bias(coarse), bias(fine)) {
            product -= b * (b - a);
            square += (b - a) * (b - a);
        }
    }
    if square > 0.0 { (product / square).clamp(0.0, MAX_WEIGHT) } else { 0.0 }
}
