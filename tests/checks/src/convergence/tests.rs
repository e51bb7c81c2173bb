//! The table of mesh errors of synthetic runs whose errors are known.

use billow_solver::scene::paper::capsule;
use billow_solver::scene::{ModelKind, Stepping};

use super::calibrate::calibrate;
use super::fit::levels;
use super::runs::{MeshRun, SceneRuns};
use billow_study::accuracy::{Entry, Features, Method};
use billow_study::job::Status;
use billow_study::job::row::{Cells, ColumnId};

const MESHES: [u32; 6] = [4, 6, 8, 12, 16, 24];

/// Runs of N panels and M storeys whose `t_90_z_rim` is `limit (1 + error(n, seed))`.
fn scene([panels, storeys]: [u32; 2], limit: f64, error: &dyn Fn(u32, u64) -> f64) -> SceneRuns {
    let run = |n: u32, seed: u64| {
        let mut scene = capsule(n, 0.3);
        scene.design.folded_mut().unwrap().panels = panels;
        scene.design.folded_mut().unwrap().storeys = storeys;
        scene.solver.model = ModelKind::Film;
        scene.solver.stepping = Stepping::Stable(0.45);
        scene.seed = seed;
        let mut cells = Cells::new(Status::Done);
        cells.set(ColumnId::T90ZRim, limit * (1.0 + error(n, seed)));
        cells.set(ColumnId::Verdict, "deployed");
        MeshRun { features: Features::of(&scene, 0.365, 1.0).unwrap(), scene, cells }
    };
    let seeds = |n: u32| if n <= 12 { 1..=5 } else { 1..=1 };
    let runs = MESHES.iter().flat_map(|n| seeds(*n).map(|seed| run(*n, seed))).collect();
    SceneRuns { runs, label: format!("N={panels} M={storeys}") }
}

/// The slope of the error in 1/n: changes with N and M add up.
fn slope([panels, storeys]: [u32; 2]) -> f64 {
    0.2 + 0.01 * (f64::from(panels) - 6.0) - 0.03 * (f64::from(storeys) - 3.0)
}

/// First-order errors, with a little scatter by seed.
fn one(design: [u32; 2]) -> SceneRuns {
    let slope = slope(design);
    scene(design, 0.1 * f64::from(design[0]), &move |n, seed| {
        slope / f64::from(n) + 1e-4 * (seed as f64 - 3.0) * f64::from(n % 3)
    })
}

/// One feature at a time about N 6, M 3.
fn scenes() -> Vec<SceneRuns> {
    [[6, 3], [5, 3], [8, 3], [10, 3], [6, 2], [6, 4], [6, 5]].map(one).to_vec()
}

fn film(meshes: &[u32]) -> Method {
    Method { model: ModelKind::Film, meshes: meshes.to_vec() }
}

#[test]
fn bias_and_changes_are_those_of_the_runs() {
    let table = calibrate(&scenes(), vec!["synthetic".to_owned()], 24).unwrap();
    let all = scenes();
    let bias = |entry: &Entry, scene: usize| {
        entry.bias(&table.coordinates.of(&all[scene].runs[0].features.values))
    };
    let entry = |meshes: &[u32]| table.entry(&film(meshes), "t_90_z_rim").unwrap();
    let four = entry(&[4]);
    assert!((four.scenes, four.runs) == (7, 35) && four.width < 8e-3, "{four:?}");
    let against_finest = |slope: f64, n: f64| libm::log((1.0 + slope / n) / (1.0 + slope / 24.0));
    // N 6 with three storeys, and with two.
    for (scene, slope) in [(0, 0.2), (4, 0.23)] {
        let bias = bias(four, scene);
        assert!((bias - against_finest(slope, 4.0)).abs() < 4e-3, "{bias}");
    }
    let ranges = [0, 1].map(|index| &table.coverage.ranges[index]);
    let ends = ranges.map(|range| [range.least, range.largest]);
    assert_eq!(ends, [[5.0, 10.0], [2.0, 5.0]]);
    let pair = entry(&[4, 8]);
    assert!((pair.weight - 2.0 / 3.0).abs() < 0.05, "first order: {}", pair.weight);
    assert!(bias(pair, 0).abs() < 2e-3, "{}", pair.bias);
    assert!(calibrate(&scenes(), Vec::new(), 32).is_none(), "no run on this mesh");
    // Against n 16 the errors are taken to n 24, by their first order.
    let table = calibrate(&scenes(), Vec::new(), 16).unwrap();
    let eight = table.entry(&film(&[8]), "t_90_z_rim").unwrap();
    let bias = eight.bias(&table.coordinates.of(&all[0].runs[0].features.values));
    assert!((bias - against_finest(0.2, 8.0)).abs() < 1e-3, "{bias}");
    assert_eq!((table.reference, table.finest), (16, 24));
}

/// A loss that slows every capsule by 3 %, on the coarsest mesh.
#[test]
fn the_change_by_an_assumed_value_is_an_entry_of_its_own() {
    let mut scenes = scenes();
    for scene in &mut scenes {
        let coarse =
            scene.runs.iter().filter(|run| run.scene.design.folded().unwrap().subdivisions == 4);
        let mut changed: Vec<MeshRun> = coarse.cloned().collect();
        for run in &mut changed {
            run.scene.film.loss_factor = 0.03;
            let value = run.cells.number(ColumnId::T90ZRim).unwrap();
            run.cells.set(ColumnId::T90ZRim, 1.03 * value);
        }
        scene.runs.extend(changed);
    }
    let table = calibrate(&scenes, Vec::new(), 24).unwrap();
    let assumed = &table.assumed["t_90_z_rim"];
    assert_eq!(assumed.keys().collect::<Vec<_>>(), ["film.loss_factor 0.03"]);
    let bias = assumed["film.loss_factor 0.03"].bias;
    assert!((bias - libm::log(1.03)).abs() < 1e-4, "{bias}");
    let unchanged = calibrate(&self::scenes(), Vec::new(), 24).unwrap();
    assert_eq!(table.entry(&film(&[4]), "t_90_z_rim"), unchanged.entry(&film(&[4]), "t_90_z_rim"));
}

#[test]
fn the_state_at_the_end_counts_only_where_the_capsule_is_deployed() {
    let mut scene = scene([6, 3], 1.0, &|_, _| 0.0);
    for run in &mut scene.runs {
        run.cells.set(ColumnId::FinalVolume, 0.6);
    }
    assert_eq!(levels(&scene, ColumnId::FinalVolume).len(), 6);
    for run in &mut scene.runs {
        run.cells.set(ColumnId::Verdict, "stalled");
    }
    assert!(levels(&scene, ColumnId::FinalVolume).is_empty());
    assert_eq!(levels(&scene, ColumnId::T90ZRim).len(), 6);
}
