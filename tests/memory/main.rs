//! The estimate of a job's memory against its measured peak, `tests/reference/memory.json`.
//!
//! `BILLOW_UPDATE_REFERENCE=1 cargo test --release -p billow-study --test memory` measures all again: one
//! to two minutes.

#![expect(clippy::disallowed_methods, reason = "tests read and write files directly")]

#[expect(dead_code, reason = "the number of allocations is for the tests of the solver")]
mod counting;

use std::fs;
use std::path::Path;

use billow_solver::models;
use billow_solver::models::run::Unobserved;
use billow_solver::platform::simd::InstructionSet;
use billow_solver::scene::Scene;
use billow_study::job::memory::estimate;
use billow_study::job::references::References;
use billow_study::study::Study;
use billow_study::study::plan::next_jobs;
use counting::peak;
use serde_json::{Value, json};

/// Bytes by which the estimate of a small job may be above the factor. Chosen: every machine has them.
const SMALL: f64 = 15e6;
/// Upper bound of an estimate over its peak: of a low stack, and of one of many layers, where contact decides.
const MAX_RATIO: [f64; 2] = [1.75, 2.0];
/// Storeys from which a stack has many layers.
const MANY_STOREYS: u64 = 10;
/// Relative difference of a peak from its reference, at most. Chosen: other versions of the standard library
/// may let lists grow otherwise.
const TOLERANCE: f64 = 0.1;

fn file() -> std::path::PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("../tests/reference/memory.json")
}

/// The scene of a case.
fn scene(case: &Value) -> Scene {
    let mut study = json!({
        "design": {
            "fit": "cone", "N": case["N"], "M": case["M"], "bottom_radius": "500 mm",
            "top_radius": "365 mm", "height": "1 m", "stowed_height": case["stowed_height"],
            "subdivisions": case["n"]
        },
        "solver": { "model": "film", "end_time": case["end_time"] },
        "gas": { "mass_flow_rate": "1 g/s" }
    });
    if let Some(integrator) = case.get("bending_with") {
        study["film"] = json!({ "compression": 1, "bending": true });
        study["creases"] = json!({ "length_scale": "20 mm" });
        study["solver"]["integrator"] = integrator.clone();
    }
    let folder = tempfile::tempdir().unwrap();
    let file = folder.path().join("study.json");
    fs::write(&file, study.to_string()).unwrap();
    let study = Study::load(&file, &[]).unwrap();
    Scene::clone(&next_jobs(&study, &[]).unwrap().points[0].job.scene)
}

/// Peaks of the run and of its static equilibria, bytes.
fn peaks(scene: &Scene) -> [usize; 2] {
    let set = InstructionSet::detect();
    let (_, run) = peak(|| models::solve(set, scene, &mut Unobserved).unwrap());
    let references = References::default();
    let (_, statics) = peak(|| references.of(set, scene, Some(100.0), &mut || true));
    [run, statics]
}

#[test]
fn estimates_are_not_below_the_peaks_and_not_far_above() {
    let mut cases: Vec<Value> = serde_json::from_slice(&fs::read(file()).unwrap()).unwrap();
    let update = std::env::var_os("BILLOW_UPDATE_REFERENCE").is_some();
    for case in &mut cases {
        let scene = scene(case);
        if update || case["measured_by_test"] == true {
            let [run, statics] = peaks(&scene);
            for (name, peak) in [("run", run), ("statics", statics)] {
                if update {
                    case[name] = json!(peak);
                }
                let reference = case[name].as_f64().unwrap();
                let difference = (peak as f64 - reference).abs() / reference;
                assert!(update || difference < TOLERANCE, "{name} {peak}, {case}");
            }
        }
    }
    if update {
        let lines: Vec<String> = cases.iter().map(Value::to_string).collect();
        fs::write(file(), format!("[\n{}\n]\n", lines.join(",\n"))).unwrap();
    }
    for case in &cases {
        let peak = case["run"].as_f64().unwrap().max(case["statics"].as_f64().unwrap());
        let estimate = estimate(&scene(case));
        let many = case["M"].as_u64().unwrap() >= MANY_STOREYS;
        let above = MAX_RATIO[usize::from(many)] * peak + SMALL;
        let total = estimate.total as f64;
        assert!(peak <= total && total <= above, "{total} for {case}");
        assert!(case["statics"].as_f64().unwrap() <= 1.02 * estimate.statics as f64, "{case}");
    }
}
