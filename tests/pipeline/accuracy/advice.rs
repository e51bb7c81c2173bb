//! `billow advise`.

use serde_json::{Value, json};

use super::film;
use crate::support::{TestFolder, json_of, stderr};

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
