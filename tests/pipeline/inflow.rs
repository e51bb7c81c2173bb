//! The gas of engineers: inflow from a table, from a tank, as a volume at a standard state; gas that leaves.

use std::fs;

use serde_json::{Value, json};

use crate::support::{TestFolder, grid, stderr};

/// A piston study of 0.4 s whose strategies are these; 1 g/s.
fn study(strategies: &Value) -> Value {
    let mut study =
        grid(&json!({"strategy": strategies.as_object().unwrap().keys().collect::<Vec<_>>()}));
    study["strategies"] = strategies.clone();
    study["strategy"] = study["grid"]["strategy"][0].clone();
    study["gas"]["mass_flow_rate"] = json!("1 g/s");
    study["design"]["N"] = json!(6);
    study["design"]["M"] = json!(3);
    study["design"]["alpha1_over_phi"] = json!(0.8);
    study["solver"]["end_time"] = json!(0.4);
    study
}

/// The gas inside at the end of each run, kg, by strategy.
fn inside(folder: &TestFolder) -> Vec<(String, f64)> {
    let rows = folder.rows("grid.json");
    let mass = |row: &Value| {
        let job = row["job"].as_str().unwrap();
        let text = folder.stdout(&[
            "job",
            job,
            "grid.json",
            "--history",
            "--columns",
            "gas_mass",
            "--json",
        ]);
        let samples: Value = serde_json::from_str(&text).unwrap();
        samples.as_array().unwrap().last().unwrap()["gas_mass"].as_f64().unwrap()
    };
    rows.iter().map(|row| (row["strategy"].as_str().unwrap().to_owned(), mass(row))).collect()
}

#[test]
fn a_strategy_lets_gas_in_by_a_table_from_a_tank_and_as_standard_litres() {
    let folder = TestFolder::new(&study(&json!({
        "points": {"inflow": [{"from": "0.1 s", "table": [[0, 0], ["0.1 s", "10 g/s"], ["0.2 s", 0]]}]},
        "file": {"inflow": [{"from": "0.1 s", "table": "flow.csv"}]},
        "tank": {"inflow": [{"from": 0, "mass": "1 g", "tank_pressure": "50 bar", "orifice_area": "2 mm2"}]},
        "closed": {"inflow": [
            {"from": 0, "to": "10 ms", "mass": "1 g", "tank_pressure": "50 bar", "orifice_area": "2 mm2"}
        ]},
        "litres": {"inflow": [{"from": 0, "to": "0.2 s", "mass_flow_rate": "240 SLPM"}]},
        "ramp": {"inflow": [{"from": "0.1 s", "to": "0.3 s", "mass_flow_rate": "1 g/s", "end_mass_flow_rate": "9 g/s"}]},
        "ramp_of_mass": {"inflow": [{"mass": "1.2 g", "mass_flow_rate": "2 g/s", "end_mass_flow_rate": "10 g/s"}]},
        "steps": {"release_time": "0.1 s", "inflow": [
            {"mass": "0.3 g", "mass_flow_rate": "3 g/s"}, {"mass": "0.9 g", "mass_flow_rate": "9 g/s"}, {"to": "0.4 s"}
        ]}
    })));
    fs::write(folder.path().join("flow.csv"), "time (ms);flow (g/s)\n0;0\n100;10\n200;0\n")
        .unwrap();
    let plan = folder.run(&["plan", "grid.json"]);
    assert!(
        stderr(&plan).contains("1 SLPM (1000 sccm) of nitrogen is 0.02083 g/s"),
        "{}",
        stderr(&plan)
    );
    folder.stdout(&["run", "grid.json", "-q"]);
    let inside = inside(&folder);
    let of = |name: &str| inside.iter().find(|(strategy, _)| strategy == name).unwrap().1;
    let near = |name: &str, grams: f64| {
        assert!((1e3 * of(name) / grams - 1.0).abs() < 2e-3, "{name}: {} kg", of(name));
    };
    near("points", 1.0);
    assert_eq!(of("file").to_bits(), of("points").to_bits());
    // Choked: m = m0 (1 + (γ−1)/2 w t)^(−2/(γ−1)), with γ = 1.4 and w = A p0 f/(√(R T0) m0).
    let w = 2e-6 * 5e6 * 0.6847 / (296.8_f64 * 293.0).sqrt() / 1e-3;
    let blown = |t: f64| 1.0 - (1.0 + 0.2 * w * t).powi(-5);
    near("tank", blown(0.4));
    // It closes within a window of constant rate.
    assert!((1e3 * of("closed") / blown(0.01) - 1.0).abs() < 5e-3, "{}", of("closed"));
    near("litres", 0.2 * 4.0 * 1.2498);
    near("ramp", 1.0);
    near("ramp_of_mass", 1.2);
    // Each step begins where the one before ends: at 0.1, 0.2 and 0.3 s, the last with 1 g/s.
    near("steps", 0.3 + 0.9 + 0.1);
    // The results folder has the points of the file.
    let jobs = folder.stdout(&["plan", "grid.json"]);
    fs::remove_file(folder.path().join("flow.csv")).unwrap();
    assert_eq!(folder.stdout(&["plan", "results/grid/study.json"]), jobs);
    folder.refuses(&["plan", "grid.json"], "flow.csv");
}

#[test]
fn gas_that_leaves_through_leak_and_vent_is_a_column() {
    let mut study = study(&json!({"one": {"inflow": [{"from": 0, "mass": "0.2 g"}]}}));
    study["grid"]["leak_area"] = json!([0, "10 cm2"]);
    let folder = TestFolder::new(&study);
    folder.stdout(&["run", "grid.json", "-q"]);
    let inside = inside(&folder);
    let rows = folder.rows("grid.json");
    let vented = |row: usize| rows[row]["vented_mass"].as_f64().unwrap();
    assert!(vented(0).abs() < 1e-15, "{}", vented(0));
    assert!(vented(1) > 1e-5);
    for (row, (_, mass)) in inside.iter().enumerate() {
        assert!((vented(row) + mass - 2e-4).abs() < 1e-9, "{row}: {} {mass}", vented(row));
    }
}

#[test]
fn a_table_and_a_tank_that_say_too_much_or_too_little_are_refused() {
    let refused = |window: Value, text: &str| {
        let folder = TestFolder::new(&study(&json!({"one": {"inflow": [window]}})));
        folder.refuses(&["plan", "grid.json"], text);
    };
    let table = json!([[0, 0], [1, 1e-3]]);
    refused(
        json!({"from": 0, "table": table, "end_mass_flow_rate": "1 g/s"}),
        "is given beside end_mass_flow_rate",
    );
    refused(
        json!({"from": 0, "mass": "1 g", "tank_pressure": "50 bar", "orifice_area": "2 mm2", "end_mass_flow_rate": 1e-3}),
        "is given beside a tank",
    );
    refused(json!({"from": 0, "table": table, "mass": "1 g"}), "is given beside mass");
    refused(json!({"from": 0, "table": [[0, 0]]}), "inflow[0].table");
    refused(json!({"from": 0, "table": "no.csv"}), "no.csv");
    refused(json!({"tank_pressure": "50 bar", "orifice_area": "1 mm2"}), "inflow[0].mass");
    refused(json!({"mass": "1 g", "orifice_area": "1 mm2"}), "inflow[0].tank_pressure");
    let tank = json!({
        "mass": "1 g", "tank_pressure": "50 bar", "orifice_area": "1 mm2", "mass_flow_rate": "1 g/s"
    });
    refused(tank, "beside a tank");
}
