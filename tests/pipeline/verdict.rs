//! Verdicts and times: the static equilibria that runs are compared with; next to no gas, air outside, soft film.

use std::fs;

use serde_json::{Value, json};

use crate::solve::{CUBE, cube, scene_folder, solve};
use crate::support::{TestFolder, json_of, paper_design, stderr};

/// The paper's capsule on the coarsest film.
fn study(solver: &Value, changes: &Value) -> Value {
    let mut study = json!({
        "design": paper_design(2),
        "solver": solver,
        "outputs": {"frames": 0},
        "grid": {"seed": [0]}
    });
    for (name, value) in changes.as_object().unwrap() {
        study[name] = value.clone();
    }
    study
}

fn number(row: &Value, name: &str) -> f64 {
    row[name].as_f64().unwrap_or_else(|| panic!("{name} in {row}"))
}

/// Film that stretches by a third.
#[test]
fn compliant_film_is_compared_with_its_own_static_equilibrium() {
    let soft = json!({
        "film": {"youngs_modulus": "20 MPa", "thickness": "50 um", "density": "1200 kg/m3"},
        "gas": {"mass_flow_rate": "10 g/s"}
    });
    let folder =
        TestFolder::finished(&study(&json!({"model": "film", "end_time": "0.5 s"}), &soft));
    let row = &folder.rows("results/grid")[0];
    assert!(row["verdict"].is_string(), "{row}");
    let pressure = number(row, "reference_overpressure");
    assert!(pressure > 200.0 && row["final_overpressure"] == row["reference_overpressure"]);
    // A separate search at that pressure.
    let mut scene = study(&json!({"static": true}), &soft);
    scene.as_object_mut().unwrap().remove("grid");
    scene["gas"] = json!({"pressure": pressure});
    scene["outputs"] = json!({});
    fs::write(folder.path().join("static.json"), scene.to_string()).unwrap();
    let exact = json_of(&folder, &["solve", "static.json"]);
    let volume = number(&exact, "volume");
    assert!((number(row, "reference_volume") / volume - 1.0).abs() < 2e-3, "{row} {volume}");
    assert!((number(row, "volume_ratio") - 0.98).abs() < 0.04, "{row}");
}

/// Gas that comes after the motion changes no time; times count from the release too.
#[test]
fn equal_motion_has_equal_times() {
    let strategies = json!({
        "strategies": {
            "residual": {"inflow": []},
            "delayed": {"inflow": [{"from": "0.25 s", "to": "0.3 s"}]},
            "held": {"release_time": "20 ms", "inflow": []}
        },
        "gas": {"mass_flow_rate": "5 g/s", "residual_gas_mass": "0.1 g"},
        "grid": {"strategy": ["residual", "delayed", "held"]}
    });
    let solver = json!({"model": "film", "end_time": "0.3 s"});
    let folder = TestFolder::new(&study(&solver, &strategies));
    let run = folder.run(&["run", "grid.json", "-q"]);
    assert!(run.status.success(), "{}", stderr(&run));
    let rows = folder.rows("results/grid");
    assert_ne!(rows[0]["final_pressure"], rows[1]["final_pressure"]);
    for name in ["t_50_z_rim", "t_50_volume", "t_50_z_rim_since_release"] {
        assert!(number(&rows[0], name) > 0.0);
        assert_eq!(rows[0][name], rows[1][name], "{name}");
    }
    assert_eq!(rows[0]["t_50_z_rim"], rows[0]["t_50_z_rim_since_release"]);
    let held = &rows[2];
    let since = number(held, "t_50_z_rim") - number(held, "t_50_z_rim_since_release");
    assert!((since - 0.02).abs() < 1e-12, "{held}");
}

#[test]
fn a_capsule_with_next_to_no_gas_stays_folded() {
    let grid = json!({"model": ["film", "piston"], "mass_flow_rate": [0, 1e-9, 1e-6]});
    let changes = json!({"design": paper_design(3), "grid": grid});
    let study = study(&json!({"end_time": "50 ms"}), &changes);
    let rows = TestFolder::finished(&study).rows("results/grid");
    assert_eq!(rows.len(), 6);
    for row in rows {
        assert_eq!((&row["status"], &row["verdict"]), (&json!("done"), &json!("stalled")), "{row}");
        assert!(row["volume_ratio"].as_f64().unwrap() < 0.2, "{row}");
    }
}

#[test]
fn a_scene_whose_gas_is_below_ambient_pressure_says_so() {
    for (pressure, said) in [("0.1 Pa", true), ("0.99 Pa", false)] {
        let gas = json!({"initial_pressure": pressure, "ambient_pressure": "1 Pa"});
        let scene = cube(&json!({"positions": "cube.obj"}), &gas);
        let folder = scene_folder(&scene, &[("cube.obj", CUBE)]);
        let output = solve(folder.path(), &["scene.json"], "");
        let message = stderr(&output);
        assert_eq!(message.contains("below gas.ambient_pressure (1 Pa)"), said, "{message}");
    }
}

#[test]
fn stored_air_carries_the_ambient_pressure() {
    let changes = json!({
        "gas": {"mass_flow_rate": "5 g/s", "ambient_pressure": "101325 Pa", "residual_gas": "ambient"},
        "gravity": -9.81, "grid": {"subdivisions": [2, 3]}
    });
    let study = study(&json!({"model": "film", "end_time": "10 ms"}), &changes);
    let folder = TestFolder::new(&study);
    let planned = stderr(&folder.run(&["plan", "grid.json"]));
    assert!(!planned.contains("below gas.ambient_pressure"), "{planned}");
    // A given mass of stored gas is wanted: a note says what it does.
    let less = ["--set", "gas.residual_gas=stored", "--set", "gas.residual_gas_mass=0.05 g"];
    let planned = stderr(&folder.run(&[&["plan", "grid.json"], &less[..]].concat()));
    assert!(planned.contains("below gas.ambient_pressure"), "{planned}");
    let output = folder.run(&["run", "grid.json", "-q"]);
    assert!(output.status.success(), "{}", stderr(&output));
    for row in folder.rows("results/grid") {
        assert_eq!((&row["status"], &row["verdict"]), (&json!("done"), &json!("stalled")), "{row}");
        let pressure = row["final_pressure"].as_f64().unwrap();
        assert!((pressure / 101_325.0 - 1.0).abs() < 0.01, "{row}");
    }
}

#[test]
fn very_soft_film_is_no_instability() {
    let changes = json!({
        "film": {"youngs_modulus": "1 MPa"}, "gas": {"mass_flow_rate": "5 g/s"}
    });
    let study = study(&json!({"model": "film", "end_time": "40 ms"}), &changes);
    let row = &TestFolder::finished(&study).rows("results/grid")[0];
    assert!(number(row, "ledger_residual") < 1e-2, "{row}");
}
