//! Verdicts and times: the static equilibria that runs are compared with.

use std::fs;

use serde_json::{Value, json};

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
