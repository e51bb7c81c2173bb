//! The table of mesh errors, from runs on several meshes.
//!
//! ```text
//! v = F ln(m/m_ref)      one run; m_ref: median of the runs of its scene on its finest mesh n_ref, 16 or 24
//! F = (1/n − 1/n_f)/(1/n − 1/n_ref)    to the finest mesh n_f, 24: errors go as 1/n;  1 for models without mesh:
//!                        their errors are against n_ref
//! bias of a scene = median of v;  bias(x): [`super::regression`] over all scenes
//! width = the distance from bias(x) that 19 of 20 runs keep, each predicted from all other scenes
//! of an assumed value: v = ln(m'/m), m' the run with that value, m the median of the scene on the same mesh
//! ```
//! A value extrapolated from two meshes is m₂ + w (m₂ − m₁), with the weight w for which it is nearest to the value on
//! the finest mesh.

use std::collections::{BTreeMap, BTreeSet};

use billow_solver::scene::ModelKind;

use super::lots::FINEST;
use super::regression::{Point, nineteen_of_twenty, regression};
use super::runs::{MeshRun, SceneRuns};
use billow_study::accuracy::features::FEATURES;
use billow_study::accuracy::table::{FORMAT, VERSION};
use billow_study::accuracy::{Coordinates, Coverage, Entry, MeshErrors, PROMISED};
use billow_study::analysis::statistics::Spread;
use billow_study::job::row::ColumnId;
use billow_study::platform::provenance::PHYSICS_VERSION;

/// Largest value of a feature that can be 0, over its value at half of its effect. Chosen: whether there
/// is gas at all changes the start more than its mass; of 4 to 50 it predicts the shipped scenes best, by a little.
const LARGEST_OVER_HALF: f64 = 20.0;
/// Scenes of an entry, at least, where the results have as many.
const MIN_SCENES: usize = 5;
/// Weights of an extrapolated value are at most this. Chosen: first order of meshes that differ by half gives 1, by
/// a quarter 3.
const MAX_WEIGHT: f64 = 3.0;
/// An assumed value that differs (empty: none does), a model, and subdivisions.
type Kind = (String, u8, u32);

/// One scene for one measure: v by kind and seed.
pub(super) struct Ratios {
    pub(super) features: [f64; FEATURES],
    values: BTreeMap<Kind, BTreeMap<u64, f64>>,
}

/// An assumed value, a model and its mesh or meshes.
pub(super) type Method = (String, ModelKind, Vec<u32>);

/// The table from these scenes, with the errors against their runs on the finest mesh, or where these are missing on
/// that of `reference` subdivisions; `None` if no scene has a run on the latter.
pub(super) fn calibrate(
    scenes: &[SceneRuns],
    studies: Vec<String>,
    reference: u32,
) -> Option<MeshErrors> {
    let has_reference =
        |run: &MeshRun| run.mesh() == (ModelKind::Film, reference) && run.assumed().is_empty();
    scenes.iter().flat_map(|scene| &scene.runs).find(|run| has_reference(run))?;
    let scenes = longest(scenes);
    let all = || scenes.iter().flat_map(|scene| &scene.runs);
    let unchanged = all().filter(|run| run.assumed().is_empty());
    let coverage = Coverage::of(unchanged.map(|run| (&run.scene, run.features)))?;
    let coordinates = coordinates(&scenes);
    let (mut errors, mut assumed) = (BTreeMap::new(), BTreeMap::new());
    for promised in &PROMISED {
        let measure = promised.measure;
        let of_reference = |scene: &SceneRuns| {
            let on = |n: u32| Some((n, scene.median(measure, (ModelKind::Film, n))?));
            [FINEST, reference].into_iter().find_map(on)
        };
        let of = |scene: &&SceneRuns| Ratios::of(scene, measure, of_reference(scene)?);
        let of_measure: Vec<Ratios> = scenes.iter().filter_map(of).collect();
        let (of_meshes, changes) = entries(&of_measure, &coordinates);
        errors.insert(measure.name().to_owned(), of_meshes);
        assumed.insert(measure.name().to_owned(), changes);
    }
    Some(MeshErrors {
        format: FORMAT.to_owned(),
        version: VERSION,
        physics_version: PHYSICS_VERSION,
        studies,
        reference,
        finest: FINEST.max(reference),
        coverage,
        coordinates,
        errors,
        assumed,
    })
}

/// The coordinates about the geometric mean of each feature, or about 0 of one that can be 0.
fn coordinates(scenes: &[&SceneRuns]) -> Coordinates {
    let all: Vec<[f64; FEATURES]> =
        scenes.iter().filter_map(|scene| Some(scene.runs.first()?.features.values)).collect();
    let of = |index: usize| all.iter().map(move |values| values[index]);
    let base = core::array::from_fn(|index| {
        let can_be_0 = of(index).any(|value| value <= 0.0);
        let mean = of(index).map(libm::log).sum::<f64>() / all.len() as f64;
        if can_be_0 { 0.0 } else { libm::exp(mean) }
    });
    let half = core::array::from_fn(|index| {
        if base[index] > 0.0 { 0.0 } else { of(index).fold(0.0, f64::max) / LARGEST_OVER_HALF }
    });
    Coordinates { base, half }
}

/// Of scenes that differ in their end alone the longest one.
fn longest(scenes: &[SceneRuns]) -> Vec<&SceneRuns> {
    let mut longest: BTreeMap<String, &SceneRuns> = BTreeMap::new();
    let end = |scene: &SceneRuns| scene.runs.first().map_or(0.0, |run| run.scene.solver.end_time);
    for scene in scenes {
        let key = format!("{:?}", scene.runs[0].features);
        let known = longest.entry(key).or_insert(scene);
        if end(scene) > end(known) {
            *known = scene;
        }
    }
    longest.into_values().collect()
}

impl Ratios {
    /// The values of a scene over that on its reference mesh, to the finest one; none of that mesh itself.
    pub(super) fn of(
        scene: &SceneRuns,
        measure: ColumnId,
        (reference, value): (u32, f64),
    ) -> Option<Self> {
        let mut values: BTreeMap<Kind, BTreeMap<u64, f64>> = BTreeMap::new();
        for run in &scene.runs {
            let (assumed, mesh) = (run.assumed(), run.mesh());
            if mesh.1 >= reference {
                continue;
            }
            let of = if assumed.is_empty() { Some(value) } else { scene.median(measure, mesh) };
            let order = if assumed.is_empty() { first_order(mesh, reference) } else { 1.0 };
            let ratio = run.measure(measure).zip(of).map(|(measured, of)| measured / of);
            if let Some(value) = ratio.and_then(logarithm) {
                let of_kind = values.entry((assumed, mesh.0 as u8, mesh.1)).or_default();
                of_kind.insert(run.scene.seed, order * value);
            }
        }
        Some(Self { features: scene.runs.first()?.features.values, values })
    }

    /// The values of a method, one per run; of two meshes by equal seed.
    pub(super) fn of_method(&self, (assumed, model, meshes): &Method, weight: f64) -> Vec<f64> {
        let on = |n: u32| self.values.get(&(assumed.clone(), *model as u8, n));
        match meshes.as_slice() {
            [coarse, fine] => {
                let (Some(coarse), Some(fine)) = (on(*coarse), on(*fine)) else {
                    return Vec::new();
                };
                let pairs = coarse.iter().filter_map(|(seed, a)| Some((a, fine.get(seed)?)));
                pairs.filter_map(|(a, b)| extrapolated([*a, *b], weight)).collect()
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

/// ln of a ratio of two values; `None` unless it is above 0.
fn logarithm(ratio: f64) -> Option<f64> {
    (ratio > 0.0 && ratio < f64::INFINITY).then(|| libm::log(ratio))
}

/// v of the value extrapolated from two meshes, from those of its meshes.
fn extrapolated(of_meshes: [f64; 2], weight: f64) -> Option<f64> {
    let [coarse, fine] = of_meshes.map(libm::exp);
    logarithm(fine + weight * (fine - coarse))
}

/// F of a mesh; 1 for a model without mesh.
fn first_order((model, n): (ModelKind, u32), reference: u32) -> f64 {
    if model != ModelKind::Film {
        return 1.0;
    }
    let [size, reference, finest] =
        [n, reference, FINEST.max(reference)].map(|n| 1.0 / f64::from(n));
    (size - finest) / (size - reference)
}

/// The entries of a measure: of models without a mesh, each mesh, each pair of meshes; and of each assumed value.
fn entries(scenes: &[Ratios], coordinates: &Coordinates) -> (Vec<Entry>, BTreeMap<String, Entry>) {
    let kinds: BTreeSet<&Kind> = scenes.iter().flat_map(|scene| scene.values.keys()).collect();
    let film = |kind: &&&Kind| kind.1 == ModelKind::Film as u8;
    let (unchanged, changed): (Vec<&Kind>, Vec<&Kind>) =
        kinds.iter().copied().filter(|kind| film(&kind)).partition(|kind| kind.0.is_empty());
    let meshes: Vec<u32> = unchanged.iter().map(|kind| kind.2).collect();
    let of_film = |meshes: Vec<u32>| (String::new(), ModelKind::Film, meshes);
    let mut methods: Vec<Method> = [ModelKind::Piston, ModelKind::Storeys]
        .map(|model| (String::new(), model, Vec::new()))
        .to_vec();
    methods.extend(meshes.iter().map(|n| of_film(vec![*n])));
    for (index, coarse) in meshes.iter().enumerate() {
        methods.extend(meshes[index + 1..].iter().map(|fine| of_film(vec![*coarse, *fine])));
    }
    let entry = |method: &Method| {
        let weight = weight(scenes, method);
        let of_scene = |scene: &Ratios| {
            let values = scene.of_method(method, weight);
            let bias = Spread::of(values.iter().copied())?.median;
            Some(((coordinates.of(&scene.features), bias), values))
        };
        let (points, values): (Vec<Point>, Vec<Vec<f64>>) =
            scenes.iter().filter_map(of_scene).unzip();
        // A mesh of few scenes shows no deviation between designs, and would look better than finer ones.
        if points.len() < MIN_SCENES.min(scenes.len()) {
            return None;
        }
        let fitted = regression(&points)?;
        let distances = values.iter().zip(&fitted.left_out);
        let distances =
            distances.flat_map(|(values, at)| values.iter().map(move |value| (value - at).abs()));
        Some(Entry {
            model: method.1,
            meshes: method.2.clone(),
            weight: rounded(weight),
            bias: rounded(fitted.intercept),
            slopes: fitted.slopes.map(rounded),
            width: rounded(nineteen_of_twenty(distances.collect(), points.len())),
            runs: values.iter().map(Vec::len).sum(),
            scenes: points.len(),
        })
    };
    let change = |kind: &Kind| {
        Some((kind.0.clone(), entry(&(kind.0.clone(), ModelKind::Film, vec![kind.2]))?))
    };
    let changes = changed.into_iter().filter_map(change).collect();
    (methods.iter().filter_map(entry).collect(), changes)
}

/// A number to four digits: what more would say is noise.
pub(super) fn rounded(number: f64) -> f64 {
    format!("{number:.3e}").parse().unwrap_or(number)
}

/// The weight w for which m₂ + w (m₂ − m₁) is nearest to the value on the finest mesh, over all scenes; 0 for one
/// mesh.
fn weight(scenes: &[Ratios], (assumed, model, meshes): &Method) -> f64 {
    let [coarse, fine] = meshes[..] else { return 0.0 };
    let mut product = 0.0;
    let mut square = 0.0;
    for scene in scenes {
        let bias = |n: u32| {
            let bias = scene.bias(&(assumed.clone(), *model, vec![n]), 0.0)?;
            Some(libm::exp(bias) - 1.0)
        };
        if let (Some(a), Some(b)) = (bias(coarse), bias(fine)) {
            product -= b * (b - a);
            square += (b - a) * (b - a);
        }
    }
    if square > 0.0 { (product / square).clamp(0.0, MAX_WEIGHT) } else { 0.0 }
}
