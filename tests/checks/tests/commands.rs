//! `bench`, `converge` and `pareto`: rows, files, messages. No test asserts a speed.

use std::fs;

use billow_solver::platform::stopwatch::Stage;
use serde_json::{Value, json};

use crate::support::{Folder, stderr};

#[test]
fn bench_has_every_stage_and_run() {
    let flags = ["bench", "--subdivisions", "1,2", "--end-time", "0.05", "--json", "-q"];
    let text = Folder::new().stdout(&flags);
    let parts: Vec<Vec<Value>> =
        serde_json::Deserializer::from_str(&text).into_iter().collect::<Result<_, _>>().unwrap();
    let [stages, multiples, runs] = parts.as_slice() else { panic!("{text}") };
    let states: Vec<&str> = stages.iter().filter_map(|row| row["state"].as_str()).collect();
    assert_eq!(states, ["stowed", "rising", "end"].repeat(2));
    for row in stages {
        // Broad phase and monitor may have no work in a short run; their columns are still present.
        assert!(Stage::ALL.iter().all(|stage| row[stage.name()].as_f64() >= Some(0.0)), "{row}");
        let positive = ["membrane", "update", "whole"];
        assert!(positive.iter().all(|name| row[*name].as_f64() > Some(0.0)), "{row}");
    }
    for (row, multiple) in stages.iter().zip(multiples) {
        let of = |row: &Value, name: &str| row[name].as_f64().unwrap_or(0.0);
        let floor = of(multiple, "arithmetic").max(of(multiple, "streaming"));
        assert!(
            floor > 0.0 && (of(multiple, "whole") * floor / of(row, "whole") - 1.0).abs() < 1e-9
        );
    }
    assert_eq!(runs.len(), 2);
    for row in runs {
        let steps = row["steps"].as_f64().unwrap() * row["elements"].as_f64().unwrap();
        let cost = 1e9 * row["wall_seconds"].as_f64().unwrap() / steps;
        assert!((cost / row["time_per_zone_cycle"].as_f64().unwrap() - 1.0).abs() < 1e-9);
        assert!(row["passages"] == 0 && row["ledger_residual"].as_f64() < Some(1e-2), "{row:?}");
    }
}

#[test]
fn bench_sets_keys_and_refuses_invalid_flags() {
    let folder = Folder::new();
    let short = ["bench", "--subdivisions", "1", "--end-time", "0.01"];
    let output = folder.run(&[&short[..], &["--set", "solver.integrator=hybrid"]].concat());
    let text = String::from_utf8_lossy(&output.stdout).into_owned();
    assert!(text.contains("time_per_zone_cycle") && !text.contains("rising"), "{text}");
    assert!(stderr(&output).contains("n 1, 0.01 s"), "{}", stderr(&output));
    for (flags, words) in [
        (["--subdivisions", "0"], "--subdivisions"),
        (["--set", "solver.integratr=hybrid"], "solver.integratr"),
    ] {
        let output = folder.run(&[&short[..1], &flags].concat());
        assert_eq!(output.status.code(), Some(2), "{flags:?}: {}", stderr(&output));
        assert!(output.stdout.is_empty() && stderr(&output).contains(words), "{}", stderr(&output));
    }
}

/// The paper's capsule on coarse film for some milliseconds.
fn study() -> Value {
    json!({
        "design": {
            "N": 6, "M": 3, "bottom_radius": "500 mm", "top_radius": "365 mm", "height": "1 m"
        },
        "gas": {"mass_flow_rate": "5 g/s"},
        "solver": {"model": "film", "end_time": "20 ms"},
        "outputs": {"frames": 0},
        "seed": 1,
        "grid": {"subdivisions": [2, 3, 4, 5]}
    })
}

#[test]
fn convergence_needs_four_meshes_and_names_what_tends_to_a_limit() {
    let folder = Folder::new();
    folder.study("meshes", &study());
    let printed = folder.stdout(&["converge", "meshes", "--json"]);
    let rows: Vec<Value> = serde_json::from_str(&printed).unwrap();
    let energy = rows.iter().find(|row| row["measure"] == "peak_kinetic_energy").unwrap();
    assert_eq!(energy["meshes"], "2 to 5");
    assert!(energy["finest"].is_f64() && energy["order"].is_f64(), "{energy}");
    // Null where no limit is known.
    let limits = ["limit", "change", "uncertainty"].map(|name| energy[name].is_f64());
    assert!(limits == [true; 3] || limits == [false; 3], "{energy}");
    let output = folder.run(&["converge", "meshes", "--table", "table.json", "--reference", "6"]);
    assert!(stderr(&output).contains("no scene has this mesh"), "{}", stderr(&output));
    assert!(!folder.path().join("table.json").exists());
    folder.stdout(&["converge", "meshes", "--table", "table.json", "--reference", "5"]);
    let table: Value =
        serde_json::from_str(&fs::read_to_string(folder.path().join("table.json")).unwrap())
            .unwrap();
    assert_eq!((&table["format"], &table["reference"]), (&json!("billow-mesh-errors"), &json!(5)));
    let mut study = study();
    study["solver"]["model"] = json!("piston");
    folder.study("piston", &study);
    let output = folder.run(&["converge", "piston"]);
    assert_eq!(output.status.code(), Some(2));
    assert!(stderr(&output).contains("at least four meshes"), "{}", stderr(&output));
}

#[test]
fn pareto_runs_a_scene_and_draws_it() {
    let folder = Folder::new();
    let printed = folder.stdout(&["pareto", "--scenes", "injected_piston", "--json", "-q"]);
    let rows: Vec<Value> = serde_json::from_str(&printed).unwrap();
    // The explicit step is of second order, the exact value known.
    let orders: Vec<f64> = rows
        .iter()
        .filter(|row| row["configuration"].as_str().unwrap().starts_with("film, explicit"))
        .filter_map(|row| row["order"].as_f64())
        .collect();
    let second = |order: &f64| (1.8..2.2).contains(order);
    assert!(orders.len() > 4 && orders.iter().all(second), "{orders:?}");
    for name in ["pareto_exact", "pareto_injected_piston", "pareto_injected_piston_seconds"] {
        for ending in ["svg", "png"] {
            let path = folder.path().join(format!("results/exact/charts/{name}.{ending}"));
            assert!(fs::metadata(&path).unwrap().len() > 1000, "{}", path.display());
        }
    }
}
