//! Studies at the edge of what is asked: next to no gas, air outside, very soft film.

use serde_json::{Value, json};

use crate::solve::{CUBE, cube, scene_folder, solve};
use crate::support::{TestFolder, paper_design, stderr};

/// The paper's capsule on a coarse film.
fn study(subdivisions: u32, end_time: &str, grid: &Value) -> Value {
    json!({
        "design": paper_design(subdivisions),
        "gas": {"mass_flow_rate": "5 g/s"},
        "solver": {"model": "film", "end_time": end_time},
        "outputs": {"frames": 0},
        "grid": grid,
    })
}

fn rows(study: &Value) -> Vec<Value> {
    let folder = TestFolder::new(study);
    let output = folder.run(&["run", "grid.json", "-q"]);
    assert!(output.status.success(), "{}", stderr(&output));
    folder.rows("results/grid")
}

#[test]
fn a_capsule_with_next_to_no_gas_stays_folded() {
    let grid = json!({"model": ["film", "piston"], "mass_flow_rate": [0, 1e-9, 1e-6]});
    let rows = rows(&study(3, "50 ms", &grid));
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
    let mut ground = study(2, "10 ms", &json!({"subdivisions": [2, 3]}));
    ground["gas"]["ambient_pressure"] = json!("101325 Pa");
    ground["gas"]["residual_gas"] = json!("ambient");
    ground["gravity"] = json!(-9.81);
    let folder = TestFolder::new(&ground);
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
    let mut soft = study(2, "40 ms", &json!({"seed": [0]}));
    soft["film"] = json!({"youngs_modulus": "1 MPa"});
    for row in rows(&soft) {
        assert_eq!(row["status"], "done", "{row}");
        assert!(row["ledger_residual"].as_f64().unwrap() < 1e-2, "{row}");
    }
}
