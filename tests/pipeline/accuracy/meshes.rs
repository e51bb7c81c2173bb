//! Several meshes of one point.

use std::fs;

use serde_json::{Value, json};

use super::{film, said};
use crate::support::{TestFolder, stderr};

/// A study on two meshes has one row, with values between which and the finest run the table of mesh errors stands.
#[test]
fn two_meshes_give_one_row_with_extrapolated_values_and_the_runs_are_kept() {
    let folder = TestFolder::finished(&film(&json!({"solver": {"meshes": [4, 6]}})));
    let (points, runs) = (folder.points("results/grid"), folder.rows("results/grid"));
    assert_eq!((points.len(), runs.len()), (1, 2));
    let of_mesh = |n: i64| runs.iter().find(|run| run["subdivisions"] == n).unwrap();
    let number =
        |row: &Value, name: &str| row[name].as_f64().unwrap_or_else(|| panic!("{name}: {row}"));
    for name in ["t_50_z_rim", "peak_kinetic_energy"] {
        let [coarse, fine] = [4, 6].map(|n| number(of_mesh(n), name));
        let value = number(&points[0], name);
        let stored = number(of_mesh(6), &format!("{name}_extrapolated"));
        assert_eq!(value.to_bits(), stored.to_bits());
        let beyond = (value - fine) * (fine - coarse) >= 0.0;
        assert!(beyond && (value - fine).abs() <= 3.0 * (fine - coarse).abs(), "{name}: {value}");
    }
    let error =
        |row: &Value| number(row, "t_50_z_rim_error_below") + number(row, "t_50_z_rim_error_above");
    assert!(error(of_mesh(4)) > error(of_mesh(6)), "a finer mesh has a smaller error");
    assert!(error(&points[0]) < 0.5 * number(&points[0], "t_50_z_rim"));
    // 0.21 s is too short for the state at the end.
    assert!(of_mesh(4)["no_error_reason"].as_str().unwrap().starts_with("not deployed"));
    let table = folder.stdout(&["table", "-q"]);
    assert!(table.contains(" −") && table.contains(" +"), "{table}");
    // The stored study plans the same jobs.
    let again = folder.run(&["run", "results/grid/study.json", "--results", "results/grid"]);
    assert!(said(&again).contains("all 2 jobs are finished"), "{}", said(&again));
}

/// Outside the table of mesh errors three meshes have an error, three times the observed difference at least, and two
/// have none. What is printed says which values are extrapolated.
#[test]
fn outside_the_table_three_meshes_tell_their_error_and_two_do_not() {
    let row = |meshes: &[u32]| {
        let mut study = film(&json!({"contact": {"friction": 0.2}}));
        study["solver"] = json!({"model": "film", "end_time": "60 ms", "meshes": meshes});
        let folder = TestFolder::new(&study);
        let answer = folder.stdout(&["run", "grid.json"]);
        let printed = stderr(&folder.run(&["table"]));
        let points = folder.points("results/grid").remove(0);
        let finest = folder.rows("results/grid").pop().unwrap();
        (answer, printed, points, finest)
    };
    let (answer, printed, point, finest) = row(&[2, 3, 4]);
    let [value, error] =
        ["t_50_z_rim", "t_50_z_rim_error_above"].map(|name| point[name].as_f64().unwrap());
    assert!(error > 0.01 * value && error < value, "{value} ± {error}");
    for side in ["below", "above"] {
        let [of_point, of_run] =
            ["error", "extrapolated_error"].map(|name| format!("t_50_z_rim_{name}_{side}"));
        assert_eq!(point[of_point], finest[of_run]);
    }
    assert!(printed.contains("1 point, 3 runs; the measures with a mesh error "), "{printed}");
    assert!(printed.contains("are extrapolated from n 3 and 4 (that of n 4 where n 3 has none)"));
    assert!(answer.contains("extrapolated"), "{answer}");
    assert!(printed.contains("− and + are 3 times the change"), "{printed}");
    let (_, printed, point, _) = row(&[2, 4]);
    assert!(printed.contains("have no error"), "{printed}");
    assert_eq!(point["t_50_z_rim_error_above"], Value::Null);
    assert!(printed.contains("extrapolated from n 2 and 4"), "{printed}");
}

/// Outside the table of mesh errors the points nearest to a limit run on two more meshes, and every point has an error.
#[test]
fn pilots_give_an_error_outside_the_table_and_can_be_left_out() {
    let mut study = film(&json!({
        "contact": {"friction": 0.2}, "limits": {"peak_speed": "< 20 m/s"},
        "grid": {"mass_flow_rate": ["1 g/s", "2 g/s", "4 g/s", "8 g/s", "16 g/s", "32 g/s"]}
    }));
    study["design"]["subdivisions"] = json!(2);
    study["solver"] = json!({"model": "film", "end_time": "60 ms"});
    let folder = TestFolder::new(&study);
    let plan = stderr(&folder.run(&["plan", "grid.json"]));
    assert!(plan.contains("pilots: up to 8 jobs, on n 3 and 4 of the points nearest"), "{plan}");
    let answer = folder.stdout(&["run", "grid.json"]);
    assert!(answer.contains("6 points, and 8 runs of pilots"), "{answer}");
    let words = answer.split_whitespace().collect::<Vec<_>>().join(" ");
    assert!(words.contains("the largest error of the pilots (n 2, 3, 4)"), "{answer}");
    let (points, runs) = (folder.points("results/grid"), folder.rows("results/grid"));
    assert_eq!((points.len(), runs.len()), (6, 14));
    let error = |row: &Value| {
        let side = |side: &str| row[format!("peak_speed_error_{side}")].as_f64().unwrap();
        (side("below") + side("above")) / row["peak_speed"].as_f64().unwrap()
    };
    let pilots: Vec<&Value> = points
        .iter()
        .filter(|point| {
            runs.iter().any(|run| {
                run["subdivisions"] == 4 && run["mass_flow_rate"] == point["mass_flow_rate"]
            })
        })
        .collect();
    assert_eq!(pilots.len(), 4);
    let others: Vec<f64> =
        points.iter().filter(|point| !pilots.contains(point)).map(error).collect();
    assert_eq!(others.len(), 2);
    assert!(others[0] > 0.05 && (others[0] / others[1] - 1.0).abs() < 1e-9, "{others:?}");
    // The intervals of the others, laid about the value of a pilot on the mesh of the study, hold its extrapolated value.
    let number =
        |row: &Value, name: &str| row[name].as_f64().unwrap_or_else(|| panic!("{name}: {row}"));
    let other = points.iter().find(|point| !pilots.contains(point)).unwrap();
    let [below, above] = ["below", "above"].map(|side| {
        number(other, &format!("peak_speed_error_{side}")) / number(other, "peak_speed")
    });
    for pilot in &pilots {
        let of_study = |run: &&Value| {
            run["subdivisions"] == 2 && run["mass_flow_rate"] == pilot["mass_flow_rate"]
        };
        let coarse = number(runs.iter().find(of_study).unwrap(), "peak_speed");
        let ratio = number(pilot, "peak_speed") / coarse;
        assert!((1.0 - below..=1.0 + above).contains(&ratio), "{ratio} {below} {above}");
    }
    assert!(points.iter().any(|point| point["safety"] == "unsafe"), "{points:?}");
    let again = folder.run(&["run", "grid.json"]);
    assert!(said(&again).contains("all 14 jobs are finished"), "{}", said(&again));
    // On one mesh alone no error is known.
    let one = ["run", "grid.json", "--set", "solver.meshes=[2]", "--results", "one"];
    let answer = folder.stdout(&one);
    assert!(answer.contains("mesh error of 6 jobs not known"), "{answer}");
    assert_eq!(folder.rows("one").len(), 6);
    // Pilots that fail take nothing from the points, and give no error.
    let limited = ["run", "grid.json", "--set", "job_limits.steps=4000", "--results", "limited"];
    let output = folder.run(&limited);
    assert_eq!(output.status.code(), Some(1), "{}", said(&output));
    let known = folder.points("results/grid");
    for (point, known) in folder.points("limited").iter().zip(&known) {
        assert_eq!(point["mass_flow_rate"], known["mass_flow_rate"]);
        assert!(
            point["peak_speed"].is_f64() && point["peak_speed_error_above"].is_null(),
            "{point}"
        );
        assert_ne!(point["safety"], "safe", "{point}");
    }
}

/// A search has pilots at the ends of its border, and an interval that the error widens.
#[test]
fn the_ends_of_a_border_have_pilots_outside_the_table() {
    let mut study = film(&json!({
        "contact": {"friction": 0.2}, "limits": {"peak_speed": "< 20 m/s"},
        "grid": {"mass_flow_rate": {"bisect": ["0.5 g/s", "64 g/s"], "on": "safe", "tolerance": "20 %", "spacing": "log"}}
    }));
    study["design"]["subdivisions"] = json!(2);
    study["solver"] = json!({"model": "film", "end_time": "60 ms"});
    let folder = TestFolder::new(&study);
    let border = |folder: &TestFolder, results: &str| {
        let json =
            folder.stdout(&["run", "grid.json", "--results", results, "--format", "json", "-q"]);
        let answer: Value = serde_json::from_str(&json).unwrap();
        let border = answer["borders"]["searches"][0].clone();
        ["low", "high"].map(|end| border[end].as_f64().unwrap_or_else(|| panic!("{answer}")))
    };
    let [low, high] = border(&folder, "results/grid");
    let runs = folder.rows("results/grid");
    let on_finest: Vec<f64> = runs
        .iter()
        .filter(|run| run["subdivisions"] == 4)
        .map(|run| run["mass_flow_rate"].as_f64().unwrap())
        .collect();
    assert_eq!(on_finest.len(), 4, "two on each side");
    assert!(high / low > 1.2, "{low} to {high}: wider than the tolerance alone");
}

/// A chart of several meshes shows what the table has: extrapolated values, and outcomes and histories of the finest mesh.
#[test]
fn charts_and_comparisons_of_several_meshes_name_what_they_show() {
    let study = film(&json!({
        "solver": {"meshes": [2, 3], "end_time": "60 ms"},
        "design": {"subdivisions": 5},
        "grid": {"N": [6, 8], "mass_flow_rate": ["3 g/s", "5 g/s"]}
    }));
    let folder = TestFolder::new(&study);
    let plan = stderr(&folder.run(&["plan", "grid.json"]));
    assert!(plan.contains("solver.meshes replaces design.subdivisions 5"), "{plan}");
    folder.stdout(&["run", "grid.json", "-q"]);
    let table = folder.stdout(&["table", "--columns", "runs,runs_done", "--format", "csv", "-q"]);
    assert!(table.lines().skip(1).all(|line| line.ends_with("2,2")), "{table}");
    let chart = |options: &[&str]| {
        folder.stdout(&[&["chart", "--out", "chart.svg", "-q"], options].concat());
        fs::read_to_string(folder.path().join("chart.svg")).unwrap()
    };
    let values = chart(&["--measure", "t_50_z_rim", "--over", "mass_flow_rate"]);
    assert!(values.contains("4 points on n 2 and 3"), "{values}");
    assert!(values.contains("Values are extrapolated from n 2 and 3"));
    assert!(!values.contains("median"), "one run on each mesh has no median");
    let stress = chart(&["--measure", "overshoot", "--over", "mass_flow_rate"]);
    assert!(stress.contains("Only the runs on the finest mesh, n 3, are shown"));
    let history = chart(&["--history", "z_rim"]);
    assert!(history.contains("Only the runs on the finest mesh, n 3, are shown"));
    let compare = ["compare", "--by", "N", "--base", "6", "--measures", "t_50_z_rim"];
    let pairs = folder.stdout(&compare);
    assert!(pairs.contains(" −") && pairs.contains(" +"), "{pairs}");
}
