//! Mesh errors of rows, several meshes, the choice of a mesh, convergence.

use std::fs;
use std::process::Output;

use serde_json::{Value, json};

use crate::support::{TestFolder, grid, json_of, stderr};

/// All that a command printed.
fn said(output: &Output) -> String {
    String::from_utf8_lossy(&output.stdout).into_owned() + &stderr(output)
}

/// The paper's capsule on coarse film for some milliseconds.
fn film(more: &Value) -> Value {
    let mut study = json!({
        "design": {
            "N": 6, "M": 3, "bottom_radius": "500 mm", "top_radius": "365 mm", "height": "1 m"
        },
        "gas": {"mass_flow_rate": "5 g/s"},
        "solver": {"model": "film", "end_time": "0.21 s"},
        "outputs": {"frames": 0},
        "seed": 1
    });
    for (key, value) in more.as_object().unwrap() {
        match (study.get_mut(key).and_then(Value::as_object_mut), value.as_object()) {
            (Some(section), Some(members)) => section.extend(members.clone()),
            _ => study[key] = value.clone(),
        }
    }
    study
}

/// A study on two meshes has one row, with values between which and the finest run the table of mesh errors stands.
#[test]
fn two_meshes_give_one_row_with_extrapolated_values_and_the_runs_are_kept() {
    let folder = TestFolder::new(&film(&json!({"solver": {"meshes": [4, 6]}})));
    folder.stdout(&["run", "grid.json", "-q"]);
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
    let error = |row: &Value| number(row, "t_50_z_rim_change_to_n24");
    assert!(error(of_mesh(4)) > error(of_mesh(6)), "a finer mesh has a smaller error");
    assert!(error(&points[0]) < error(of_mesh(6)), "so has an extrapolated value");
    // 0.21 s is too short for the state at the end.
    assert!(of_mesh(4)["no_error_reason"].as_str().unwrap().starts_with("not deployed"));
    let table = folder.stdout(&["table", "-q"]);
    assert!(table.contains(" ± "), "{table}");
    // The stored study plans the same jobs.
    let again = folder.run(&["run", "results/grid/study.json", "--results", "results/grid"]);
    assert!(said(&again).contains("all 2 jobs are finished"), "{}", said(&again));
}

#[test]
fn a_row_outside_the_table_says_why_it_has_no_error() {
    let mut study = film(&json!({"contact": {"friction": 0.2}, "design": {"subdivisions": 2}}));
    study["solver"]["end_time"] = json!("20 ms");
    let folder = TestFolder::new(&study);
    folder.stdout(&["run", "grid.json", "-q"]);
    let row = &folder.rows("results/grid")[0];
    assert_eq!(row["no_error_reason"], "contact.friction 0.2: the runs of the table have 0");
    assert_eq!(row["peak_vz_change_to_n24"], Value::Null);
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
        ["t_50_z_rim", "t_50_z_rim_change_to_n24"].map(|name| point[name].as_f64().unwrap());
    assert!(error > 0.01 * value && error < value, "{value} ± {error}");
    assert_eq!(point["t_50_z_rim_change_to_n24"], finest["t_50_z_rim_extrapolated_error"]);
    assert!(printed.contains("1 point, 3 runs; t_50_z_rim, "), "{printed}");
    assert!(printed.contains("are extrapolated from n 2, 3 and 4, all else is that of n 4"));
    assert!(answer.contains("extrapolated"), "{answer}");
    let (_, printed, point, _) = row(&[2, 4]);
    assert_eq!(point["t_50_z_rim_change_to_n24"], Value::Null);
    assert!(printed.contains("extrapolated from n 2 and 4"), "{printed}");
}

#[test]
fn meshes_that_cannot_be_extrapolated_are_refused() {
    let refused = |more: Value| {
        let output = TestFolder::new(&film(&more)).run(&["plan", "grid.json"]);
        assert_eq!(output.status.code(), Some(2));
        stderr(&output)
    };
    assert!(refused(json!({"solver": {"meshes": [8, 4]}})).contains("ascending"));
    assert!(refused(json!({"solver": {"meshes": [4]}})).contains("two or three meshes"));
    assert!(refused(json!({"solver": {"meshes": [4, 7]}})).contains("has a mesh that the table"));
    let both = json!({"solver": {"meshes": [4, 8]}, "grid": {"subdivisions": [4, 8]}});
    assert!(refused(both).contains("which another axis varies already"));
    let search = json!({
        "solver": {"meshes": [4, 8]}, "limits": {"verdict": "deployed"},
        "grid": {"residual_gas_mass": {"bisect": ["0.01 g", "0.1 g"], "on": "safe"}}
    });
    assert!(refused(search).contains("a search judges single runs"));
}

#[test]
fn an_accuracy_chooses_the_cheapest_meshes_that_keep_it() {
    let planned = |tolerance: Value| {
        let folder = TestFolder::new(&film(&json!({"accuracy": tolerance})));
        let rows = json_of(&folder, &["plan", "grid.json"]);
        let rows = rows.as_array().unwrap().clone();
        let mesh = |row: &Value| row["subdivisions"].as_i64();
        rows.iter().map(mesh).collect::<Vec<_>>()
    };
    let loose = planned(json!({"final_volume": "15 %"}));
    let strict = planned(json!({"final_volume": 0.03}));
    let cost = |meshes: &[Option<i64>]| meshes.iter().flatten().map(|n| n * n * n).sum::<i64>();
    // One mesh is no axis.
    assert!(loose.len() == 1, "{loose:?}");
    assert!(strict.len() == 2 && cost(&strict) > 0 || strict.len() == 1, "{strict:?}");
    let refused = |more: Value| {
        let output = TestFolder::new(&film(&more)).run(&["plan", "grid.json"]);
        assert_eq!(output.status.code(), Some(2));
        stderr(&output)
    };
    let message = refused(json!({"accuracy": {"final_volume": 1e-6}}));
    assert!(message.contains("is kept by no mesh") && message.contains("or more"), "{message}");
    assert!(refused(json!({"accuracy": {"t_90_z_rm": 0.02}})).contains("did you mean t_90_z_rim?"));
    let given = json!({"accuracy": {"t_90_z_rim": 0.1}, "design": {"subdivisions": 4}});
    assert!(refused(given).contains("is given beside accuracy"));
    let soft = json!({"accuracy": {"t_90_z_rim": 0.1}, "film": {"youngs_modulus": "1 GPa"}});
    assert!(refused(soft).contains("film.youngs_modulus"));
}

#[test]
fn the_choice_of_an_accuracy_stands_in_the_stored_study() {
    let mut study = film(&json!({"accuracy": {"peak_kinetic_energy": 0.3}}));
    study["solver"]["end_time"] = json!("10 ms");
    let folder = TestFolder::new(&study);
    folder.stdout(&["run", "grid.json", "-q"]);
    let text = fs::read_to_string(folder.results().join("study.json")).unwrap();
    let stored: Value = serde_json::from_str(&text).unwrap();
    let meshes = stored["accuracy"]["meshes"].as_array().unwrap();
    assert_eq!(meshes.len(), 1, "{meshes:?}");
    assert_eq!(stored["design"]["subdivisions"], meshes[0]);
    let again = folder.run(&["run", "grid.json"]);
    assert!(said(&again).contains("all 1 jobs are finished"), "{}", said(&again));
}

#[test]
fn advice_names_the_cheapest_method_or_refuses_with_a_reason() {
    let folder = TestFolder::new(&film(&json!({"design": {"subdivisions": 16}})));
    let rows = json_of(&folder, &["advise", "grid.json", "--tolerance", "0.05"]);
    let rows = rows.as_array().unwrap();
    let costs: Vec<f64> = rows.iter().map(|row| row["cost"].as_f64().unwrap()).collect();
    assert!(costs.is_sorted(), "{costs:?}");
    let keeps = rows.iter().find(|row| row["keeps_tolerance"] == true).unwrap();
    assert!(keeps["t_90_z_rim_relative_error"].as_f64().unwrap() <= 0.05);
    let output = folder.run(&["advise", "grid.json", "--tolerance", "5 %"]);
    let text = stderr(&output);
    assert!(text.contains("advice: ") && text.contains("cheaper than now"), "{text}");
    let none = stderr(&folder.run(&["advise", "grid.json", "--tolerance", "1e-6"]));
    assert!(none.contains("advice: none"), "{none}");
    let outside = TestFolder::new(&film(&json!({"film": {"compression": 0.03}})));
    let output = outside.run(&["advise", "grid.json", "--tolerance", "0.05"]);
    assert_eq!(output.status.code(), Some(2));
    assert!(stderr(&output).contains("film.compression 0.03"), "{}", stderr(&output));
    let output =
        folder.run(&["advise", "grid.json", "--tolerance", "0.05", "--measures", "peak_v"]);
    assert!(stderr(&output).contains("did you mean peak_vz?"), "{}", stderr(&output));
}

/// The advice for a study: the rows, and what stands below them.
fn advice(study: &Value, options: &[&str]) -> (Vec<Value>, String) {
    let folder = TestFolder::new(study);
    let arguments = [&["advise", "grid.json"], options].concat();
    let rows = json_of(&folder, &arguments);
    (rows.as_array().unwrap().clone(), stderr(&folder.run(&arguments)))
}

#[test]
fn advice_names_a_model_without_mesh_where_it_is_enough_and_film_where_it_is_not() {
    let study = film(&json!({}));
    let only_t_90 = ["--tolerance", "20 %", "--measures", "t_90_z_rim"];
    let (rows, text) = advice(&study, &only_t_90);
    let method = |row: &Value| row["method"].as_str().unwrap().to_owned();
    assert_eq!([method(&rows[0]), method(&rows[1])], ["piston", "storeys"]);
    // The piston is a third early (README), storeys some percent.
    assert_eq!(rows[0]["keeps_tolerance"], false);
    assert_eq!(rows[1]["keeps_tolerance"], true);
    assert!(
        text.contains("advice: storeys (") && text.contains("\"model\": \"storeys\""),
        "{text}"
    );
    assert!(text.contains("limits: storeys has no contact"), "{text}");
    assert!(text.contains("step: every error is that of the default step (solver.cfl 0.45)"));
    let (_, text) = advice(&study, &["--tolerance", "4 %"]);
    assert!(text.contains("advice: film, n "), "{text}");
    assert!(!text.contains("limits: "), "{text}");
    // Every scene that no model without mesh can stand for is outside the table.
    for (section, value) in [
        ("film", json!({"compression": 0.03})),
        ("contact", json!({"friction": 0.2})),
        ("gravity", json!(-9.81)),
        ("solver", json!({"cfl": 0.3})),
    ] {
        let mut outside = study.clone();
        match value.as_object() {
            Some(members) => outside[section] = json!(members),
            None => outside[section] = value.clone(),
        }
        if section == "solver" {
            outside[section]["end_time"] = json!("0.21 s");
        }
        let output = TestFolder::new(&outside).run(&["advise", "grid.json", "--tolerance", "0.5"]);
        assert_eq!(output.status.code(), Some(2), "{section}");
        let text = stderr(&output);
        assert!(text.contains("no advice: ") && text.contains(section), "{text}");
        assert!(text.contains("\"meshes\": [4, 6, 8]"), "{text}");
    }
}

#[test]
fn a_study_of_the_piston_gets_advice_too() {
    let mut study = film(&json!({}));
    study["solver"]["model"] = json!("piston");
    let (rows, text) = advice(&study, &["--tolerance", "60 %"]);
    assert_eq!((&rows[0]["method"], &rows[0]["keeps_tolerance"]), (&json!("piston"), &json!(true)));
    assert!(text.contains("advice: piston (1.0 times the cost of now); as it is"), "{text}");
    // Without a tolerance it is 5 %.
    let (_, text) = advice(&study, &[]);
    let expected = "; \"solver\": {\"model\": \"film\"";
    assert!(text.contains(expected) && text.contains("times the cost of now"), "{text}");
    study["solver"]["stepping"] = json!({"fixed": "1 ms"});
    let output = TestFolder::new(&study).run(&["advise", "grid.json"]);
    assert_eq!(output.status.code(), Some(2));
    let text = stderr(&output);
    assert!(
        text.contains("solver.stepping.fixed 0.001: the runs of the table have none"),
        "{text}"
    );
    assert!(text.contains("billow compare STUDY --by model --base film"), "{text}");
}

/// A mesh error of the piston would make every comparison of its rows a tie.
#[test]
fn rows_of_the_piston_have_no_mesh_error_and_say_where_theirs_is() {
    let mut study = film(&json!({"grid": {"mass_flow_rate": ["5 g/s", "10 g/s"]}}));
    study["solver"]["model"] = json!("piston");
    study["gas"] = json!({});
    let folder = TestFolder::new(&study);
    folder.stdout(&["run", "grid.json", "-q"]);
    for row in folder.rows("results/grid") {
        assert_eq!(row["t_90_z_rim_error"], Value::Null);
        let reason = row["no_error_reason"].as_str().unwrap();
        assert!(reason.ends_with("billow advise STUDY gives the errors of piston"), "{reason}");
    }
    let args = ["compare", "--by", "mass_flow_rate", "--base", "5 g/s", "--measures", "t_90_z_rim"];
    let pairs = json_of(&folder, &args);
    assert_eq!(pairs[0]["t_90_z_rim_better"], "other", "{pairs}");
}

#[test]
fn convergence_needs_four_meshes_and_names_what_tends_to_a_limit() {
    let mut study = film(&json!({"grid": {"subdivisions": [2, 3, 4, 5]}}));
    study["solver"]["end_time"] = json!("20 ms");
    let folder = TestFolder::new(&study);
    folder.stdout(&["run", "grid.json", "-q"]);
    let rows = json_of(&folder, &["converge", "results/grid"]);
    let rows = rows.as_array().unwrap();
    let energy = rows.iter().find(|row| row["measure"] == "peak_kinetic_energy").unwrap();
    assert_eq!(energy["meshes"], "2 to 5");
    let trend = energy["trend"].as_str().unwrap();
    assert!(["limit", "no limit known"].contains(&trend));
    for name in ["finest", "order"] {
        assert!(energy[name].is_f64(), "{energy}");
    }
    for name in ["limit", "change", "uncertainty"] {
        assert_eq!(energy[name].is_f64(), trend == "limit", "{energy}");
    }
    let output = folder.run(&["converge", "results/grid", "--check"]);
    assert_eq!(output.status.code(), Some(2));
    assert!(stderr(&output).contains("results with film on n 24"), "{}", stderr(&output));
    let output =
        folder.run(&["converge", "results/grid", "--table", "table.json", "--reference", "6"]);
    assert!(stderr(&output).contains("no scene has this mesh"), "{}", stderr(&output));
    assert!(!folder.path().join("table.json").exists());
    folder.stdout(&["converge", "results/grid", "--table", "table.json", "--reference", "5"]);
    let table: Value =
        serde_json::from_str(&fs::read_to_string(folder.path().join("table.json")).unwrap())
            .unwrap();
    assert_eq!((&table["format"], &table["reference"]), (&json!("billow-mesh-errors"), &json!(5)));
    let piston = TestFolder::new(&grid(&json!({
        "N": [6], "M": [3], "alpha1_over_phi": [1], "mass_flow_rate": ["2 g/s"]
    })));
    piston.stdout(&["run", "grid.json", "-q"]);
    let output = piston.run(&["converge", "results/grid"]);
    assert_eq!(output.status.code(), Some(2));
    assert!(stderr(&output).contains("at least four meshes"), "{}", stderr(&output));
}

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
