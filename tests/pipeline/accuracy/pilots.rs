//! `"model": "auto"`: pilots, chosen mesh, checks.

use std::fs;

use serde_json::{Value, json};

use super::{film, said};
use crate::support::{TestFolder, json_of, stderr};

/// A grid of 60 short jobs on n 6, of which most run on n 3.
fn pilots(accuracy: &Value) -> Value {
    let mut study = film(&json!({
        "solver": {"model": "auto", "end_time": "12 ms"},
        "accuracy": accuracy,
        "grid": {"N": [5, 6, 7, 8], "M": [2, 3, 4],
                 "mass_flow_rate": ["4 g/s", "4.5 g/s", "5 g/s", "5.5 g/s", "6 g/s"]}
    }));
    study["design"]["subdivisions"] = json!(6);
    study
}

/// Most points run on the coarse mesh, corrected by the pilots; the answer says so, a resumed run changes nothing.
#[test]
fn a_study_with_pilots_has_one_row_per_point_and_says_what_it_promises() {
    let folder = TestFolder::new(&pilots(&json!({"peak_kinetic_energy": 0.6})));
    let answer = json_of(&folder, &["run", "grid.json", "-q"]);
    let auto = &answer["auto"];
    assert_eq!((auto["reference"].as_i64(), auto["chosen"].as_i64()), (Some(6), Some(3)), "{auto}");
    let pilots = auto["pilots"].as_i64().unwrap();
    assert_eq!(auto["points"].as_i64().unwrap() + pilots, 60);
    assert!(auto["cost"].as_f64().unwrap() < 0.3, "{auto}");
    let (points, runs) = (folder.points("results/grid"), folder.rows("results/grid"));
    assert_eq!(points.len(), 60);
    let on = |n: i64| runs.iter().filter(|run| run["subdivisions"] == n).count();
    let checks = auto["checks"].as_i64().unwrap();
    let on = [6, 4, 3].map(|n| i64::try_from(on(n)).unwrap());
    assert_eq!(on, [pilots, checks, 60], "checks run one mesh finer than n 3");
    let error = auto["promises"][0]["error"].as_f64().unwrap();
    assert!(error > 0.0 && error <= 0.6);
    let factor = |point: &Value| {
        let run = runs.iter().find(|run| run["job"] == point["job"]).unwrap();
        let energy = |row: &Value| row["peak_kinetic_energy"].as_f64().unwrap();
        (point["run_subdivisions"].as_i64().unwrap(), energy(point) / energy(run))
    };
    let factors: Vec<(i64, f64)> = points.iter().map(factor).collect();
    assert!(
        factors.iter().all(|(n, factor)| *n == 3 || factor.to_bits() == 1_f64.to_bits()),
        "{factors:?}"
    );
    assert!(factors.iter().any(|(n, factor)| *n == 3 && (factor - 1.0).abs() > 1e-3));
    assert_eq!(json_of(&folder, &["status", "grid.json"])["points"], 60);
    let said = folder.stdout(&["run", "grid.json"]);
    assert!(said.contains("nothing to run") && said.contains("n 3 instead of n 6"), "{said}");
    let table = fs::read(folder.path().join("results/grid/summary.parquet")).unwrap();
    fs::remove_file(folder.path().join("results/grid/summary.parquet")).unwrap();
    folder.stdout(&["run", "results/grid", "-q"]);
    assert!(fs::read(folder.path().join("results/grid/summary.parquet")).unwrap() == table);
    assert!(folder.stdout(&["doctor", "results/grid"]).contains("no faults"));
}

/// What a study with pilots cannot have is refused, with what to do.
#[test]
fn pilots_that_cannot_be_paid_or_judged_are_refused() {
    let refused = |change: &dyn Fn(&mut Value)| {
        let mut study = pilots(&json!("3 %"));
        change(&mut study);
        let folder = TestFolder::new(&study);
        let output = folder.run(&["plan", "grid.json"]);
        assert_eq!(output.status.code(), Some(2), "{}", said(&output));
        stderr(&output)
    };
    let members = |study: &mut Value| study.as_object_mut().unwrap().remove("accuracy");
    assert!(refused(&|study| drop(members(study))).contains("has no accuracy to keep"));
    assert!(refused(&|study| study["grid"]["N"] = json!([6])).contains("has too few points"));
    let varied = refused(&|study| study["grid"]["subdivisions"] = json!([4, 6]));
    assert!(varied.contains("which the grid varies"), "{varied}");
    let coarse = refused(&|study| study["design"]["subdivisions"] = json!(4));
    assert!(coarse.contains("no mesh from n 3 to half of design.subdivisions, 4"), "{coarse}");
    let search = refused(&|study| {
        study["grid"]["mass_flow_rate"] = json!({"bisect": ["1 g/s", "5 g/s"], "on": "verdict"});
    });
    assert!(search.contains("cannot run a search"), "{search}");
    let meshes = refused(&|study| {
        study["design"].as_object_mut().unwrap().remove("subdivisions");
        study["solver"]["meshes"] = json!([4, 8]);
    });
    assert!(meshes.contains("solver.meshes"), "{meshes}");
}
