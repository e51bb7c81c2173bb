//! Maps of failure: real runs, what is expected, faults of a map file.

use std::fs;
use std::path::Path;

use serde_json::{Value, json};

use crate::support::{Folder, stderr};

/// A map of a linear sheet on both sides of its stable step.
fn maps() -> Value {
    json!({"maps": [{
        "name": "step", "description": "what is asked", "scene": "sheet", "methods": ["explicit"],
        "axes": [["step", [0.5, 1.2, 1.5]]], "border": 1e-3, "theory": 0.01,
        "expect": [{"where": {"step": [1.4, 2]}, "status": ["unstable"], "why": "beyond the limit"}]
    }]})
}

fn folder(maps: &Value) -> Folder {
    let folder = Folder::new();
    fs::write(folder.path().join("maps.json"), maps.to_string()).unwrap();
    folder
}

/// A text file of the results.
fn text(folder: &Folder, name: &str) -> String {
    fs::read_to_string(folder.path().join("results/maps").join(name)).unwrap()
}

/// The borders that the command prints.
fn borders(folder: &Folder) -> Vec<Value> {
    serde_json::from_str(&folder.stdout(&["stability", "maps.json", "--json", "-q"])).unwrap()
}

#[test]
fn the_limit_of_a_linear_sheet_is_that_of_theory() {
    let folder = folder(&maps());
    let border = &borders(&folder)[0];
    // The element bound, a CFL number of 1, lies below it.
    assert!((border["border"].as_f64().unwrap() - 1.36).abs() < 0.01, "{border}");
    assert!((border["of_theory"].as_f64().unwrap() - 1.0).abs() < 0.01, "{border}");
    let cells = text(&folder, "cells.csv");
    let rows: Vec<&str> = cells.lines().collect();
    assert!(rows.len() == 4 && rows[1].starts_with("step,explicit,step 0.5,,done,done,yes,"));
    assert!(rows[3].starts_with("step,explicit,step 1.5,,unstable,unstable,yes,"), "{cells}");
    assert!(rows[3].contains("energy_source"), "{cells}");
    assert!(text(&folder, "borders.csv").starts_with("map,method,at,along,border,"));
    let picture = text(&folder, "step.svg");
    let texts = ["step (CFL number)", "beyond the limit", "what is asked", "3 of 3 cells"];
    assert!(texts.iter().all(|text| picture.contains(text)), "{picture}");
}

#[test]
fn a_wrong_expectation_and_a_wrong_limit_are_reported() {
    let mut maps = maps();
    maps["maps"][0]["expect"] = json!([{"where": {"step": [0.5, 0.5]}, "status": ["unstable"]}]);
    maps["maps"][0]["theory"] = json!(1e-9);
    let output = folder(&maps).run(&["stability", "maps.json", "-q"]);
    let message = stderr(&output);
    assert_eq!(output.status.code(), Some(1), "{message}");
    for part in [
        "3 outcomes not as expected",
        "step: explicit, step 0.5: done, expected unstable",
        "step: explicit, step 1.5: unstable",
        "of the limit of theory",
    ] {
        assert!(message.contains(part), "{part}: {message}");
    }
}

#[test]
fn film_of_two_materials_has_the_limit_of_the_stiff_one_and_statics_is_a_method() {
    let maps = json!({"maps": [
        {"name": "soft", "scene": "sheet", "methods": ["explicit"], "axes": [["step", [1, 1.5]], ["soft", [1e-4]]],
         "border": 1e-3, "theory": 0.01, "expect": [{"where": {"step": [1.5, 1.5]}, "status": ["fails"]}]},
        {"name": "contact", "scene": "films", "methods": ["explicit"], "axes": [["soft", [1e-4, 1]]]},
        {"name": "bag", "scene": "bag_statics", "axes": [["flatness", [0, 1]]],
         "expect": [{"where": {"flatness": [0, 0]}, "status": ["no_equilibrium", "done"]}]},
        {"name": "capsule", "scene": "capsule_statics", "axes": [["overpressure", [100]]]},
        {"name": "flow", "scene": "capsule", "methods": ["explicit", "piston", "storeys"],
         "axes": [["mass_flow_rate", [5e-3]]]}
    ]});
    let folder = folder(&maps);
    assert!(borders(&folder)[0]["of_theory"].is_f64());
    assert_eq!(text(&folder, "cells.csv").matches(",done,yes,").count(), 8);
}

#[test]
fn a_bad_file_gives_one_error_with_key_value_and_what_is_allowed() {
    for (key, value, parts) in [
        ("scene", json!("sheat"), ["maps[0].scene: unknown scene sheat", "sheet, bag"]),
        ("axes", json!([["stepp", [1]]]), ["no parameter of the scene sheet", "step, damping"]),
        ("axes", json!([["step", [2, 1]]]), ["cannot be axes", "larger than the one"]),
        ("methods", json!(["piston"]), ["piston is no method of the scene", "explicit"]),
        ("methods", json!(["explizit"]), ["maps[0].methods: unknown method", "film, explicit"]),
        ("expect", json!([{"status": ["unstabel"]}]), ["unknown status unstabel", "fails, any"]),
        ("bordr", json!(1), ["maps[0].bordr: unknown field `bordr`", "border"]),
    ] {
        let mut maps = maps();
        maps["maps"][0][key] = value;
        let folder = folder(&maps);
        let output = folder.run(&["stability", "maps.json"]);
        let message = stderr(&output);
        assert_eq!(output.status.code(), Some(2), "{message}");
        assert!(parts.iter().all(|part| message.contains(part)), "{message}");
        assert!(!folder.path().join("results").exists());
    }
}

#[test]
fn the_search_of_a_border_from_zero_ends() {
    let folder = folder(&json!({"maps": [{
        "name": "start", "scene": "bag", "methods": ["explicit"],
        "axes": [["flatness", [0, 1e-6]]], "values": {"mass_flow_rate": 0}, "border": 0.05,
        "expect": [{"where": {"flatness": [0, 0]}, "status": ["fails"], "why": "no volume for the gas"}]
    }]}));
    let border = &borders(&folder)[0];
    // It fails at 0 only: half of the width at which the search ends.
    assert_eq!((&border["border"], &border["status"]), (&json!(1.5625e-8), &json!("unstable")));
}

#[test]
fn the_shipped_maps_are_read() {
    let shipped = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../studies/stability.json");
    let shipped = shipped.to_string_lossy();
    let maps = ["stability", &shipped, "--maps", "piston_step,storeys_step", "--results", "out"];
    let printed = Folder::new().stdout(&maps);
    assert!(printed.contains("fixed_step") && printed.contains("energy_drift"), "{printed}");
}
