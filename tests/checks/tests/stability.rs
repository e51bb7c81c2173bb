//! Maps of failure: real runs, what is expected, finished cells, faults of a map file.

use std::fs;
use std::path::Path;

use serde_json::{Value, json};

use crate::support::{Folder, stderr};

/// A map of a linear sheet on both sides of its stable step.
fn maps() -> Value {
    json!({"maps": [{
        "name": "step", "description": "what is asked", "scene": "sheet", "methods": ["explicit"],
        "axes": [["step", [0.5, 1.2, 1.5]]],
        "border": {"along": "step", "within": 1e-3},
        "theory": 0.01,
        "expect": [{"where": {"step": [1.4, 2]}, "status": "unstable", "why": "the step is beyond the limit"}]
    }]})
}

fn folder(maps: &Value) -> Folder {
    let folder = Folder::new();
    fs::write(folder.path().join("maps.json"), maps.to_string()).unwrap();
    folder
}

fn cells(folder: &Folder) -> Vec<u8> {
    fs::read(folder.path().join("out/cells.json")).unwrap()
}

const RUN: [&str; 4] = ["stability", "maps.json", "--results", "out"];

#[test]
fn the_limit_of_a_linear_sheet_is_that_of_theory_and_cells_are_kept() {
    let folder = folder(&maps());
    let printed = folder.stdout(&RUN);
    assert!(printed.contains("step: 3 cells\n  explicit: 2 done, 1 unstable\n"), "{printed}");
    let of_theory: f64 = printed
        .lines()
        .find_map(|line| line.strip_suffix(" of 2/omega_max")?.rsplit(' ').next()?.parse().ok())
        .unwrap();
    assert!((of_theory - 1.0).abs() < 0.01, "{of_theory}");
    // The element bound, a CFL number of 1, lies below it.
    assert!(printed.contains("border explicit: step 1.3"), "{printed}");
    for name in ["step.svg", "step.png"] {
        assert!(folder.path().join("out/charts").join(name).is_file(), "{name}");
    }
    // The picture says the unit of the axis, the border over theory, time and audit of the failure, and what is expected.
    let picture = fs::read_to_string(folder.path().join("out/charts/step.svg")).unwrap();
    for text in [
        "step (CFL number)",
        "of 2/ω",
        "energy_source",
        "µs",
        "a failure is expected",
        "the step is beyond the limit",
        "what is asked",
        "3 of 3 cells as expected",
    ] {
        assert!(picture.contains(text), "{text}");
    }
    let rows: Vec<Value> =
        serde_json::from_str(&folder.stdout(&[&RUN[..], &["--json", "-q"]].concat())).unwrap();
    let last = rows.last().unwrap();
    assert_eq!((&last["status"], &last["as_expected"]), (&json!("unstable"), &json!("yes")));
    assert_eq!((rows.len(), &last["audit"]), (3, &json!("energy_source")));
    let time = last["time"].as_f64().unwrap();
    assert!(time > 0.0 && last["ledger_residual"].as_f64().unwrap() > 0.01, "{last}");

    // The same command runs nothing again; a damaged file costs its cells and nothing else.
    let kept = cells(&folder);
    let again = folder.run(&RUN);
    assert!(stderr(&again).contains("0 cells run"), "{}", stderr(&again));
    assert_eq!(cells(&folder), kept);
    fs::write(folder.path().join("out/cells.json"), &kept[..kept.len() / 2]).unwrap();
    let repaired = folder.run(&RUN);
    assert!(stderr(&repaired).contains("damaged"), "{}", stderr(&repaired));
    assert_eq!(cells(&folder), kept, "the cells are the same after new runs");
}

#[test]
fn a_wrong_expectation_and_a_wrong_limit_are_reported() {
    let mut maps = maps();
    maps["maps"][0]["expect"] = json!([{"where": {"step": 0.5}, "status": "unstable"}]);
    maps["maps"][0]["theory"] = json!(1e-9);
    let folder = folder(&maps);
    let output = folder.run(&[&RUN[..], &["--no-pictures", "-q"]].concat());
    let message = stderr(&output);
    assert_eq!(output.status.code(), Some(1), "{message}");
    for part in [
        "3 outcomes not as expected",
        "step: explicit, step 0.5: done, expected unstable",
        "step: explicit, step 1.5: unstable",
        "not the limit of theory",
    ] {
        assert!(message.contains(part), "{part}: {message}");
    }
    assert!(!folder.path().join("out/charts").exists());
}

#[test]
fn film_of_two_materials_has_the_limit_of_the_stiff_one_and_statics_is_a_method() {
    let maps = json!({"maps": [
        {"name": "soft", "scene": "sheet", "methods": ["explicit"], "axes": [["step", [1, 1.5]], ["soft", [1e-4]]],
         "border": {"along": "step", "within": 1e-3}, "theory": 0.01,
         "expect": [{"where": {"step": 1.5}, "status": "fails"}]},
        {"name": "contact", "scene": "films", "methods": ["explicit"], "axes": [["soft", [1e-4, 1]]]},
        {"name": "bag", "scene": "bag_statics", "axes": [["flatness", [0, 1]]],
         "expect": [{"where": {"flatness": 0}, "status": ["no_equilibrium", "done"]}]},
        {"name": "capsule", "scene": "capsule_statics", "axes": [["overpressure", [100]]]},
        {"name": "flow", "scene": "capsule", "methods": ["explicit", "piston", "storeys"],
         "axes": [["mass_flow_rate", [5e-3]]]}
    ]});
    let folder = folder(&maps);
    let printed = folder.stdout(&RUN);
    let flow = "flow: 3 cells\n  explicit: 1 done\n  piston: 1 done\n  storeys: 1 done";
    for text in ["contact: 2 cells\n  explicit: 2 done", "capsule: 1 cell\n  statics: 1 done", flow]
    {
        assert!(printed.contains(text), "{printed}");
    }
    assert!(printed.contains("of 2/omega_max"), "{printed}");
}

#[test]
fn a_bad_file_gives_one_error_with_key_value_and_what_is_allowed() {
    for (key, value, parts) in [
        ("scene", json!("sheat"), ["maps[0].scene: unknown scene sheat", "sheet, bag"]),
        ("axes", json!([["step", [0.5, 7]]]), ["maps[0] (step): step is 7", "from 0.01 to 4"]),
        ("axes", json!([["stepp", [1]]]), ["no parameter of the scene sheet", "step, damping"]),
        ("axes", json!([["step", [2, 1]]]), ["step cannot be an axis", "larger than the one"]),
        ("methods", json!(["piston"]), ["piston is no method of the scene", "explicit"]),
        ("methods", json!(["explizit"]), ["maps[0].methods: unknown method", "film, explicit"]),
        ("border", json!({"along": "slack"}), ["along no such axis", "real numbers"]),
        ("expect", json!([{"status": "unstabel"}]), ["unstabel is no status", "fails, any, done"]),
        ("bordr", json!(1), ["maps[0].bordr: unknown field `bordr`", "border"]),
    ] {
        let mut maps = maps();
        maps["maps"][0][key] = value;
        let folder = folder(&maps);
        let output = folder.run(&RUN);
        let message = stderr(&output);
        assert_eq!(output.status.code(), Some(2), "{message}");
        for part in parts {
            assert!(message.contains(part), "{part}: {message}");
        }
        assert!(!folder.path().join("out").exists());
    }
}

#[test]
fn the_search_of_a_border_from_zero_ends() {
    let why = "no volume for the gas";
    let folder = folder(&json!({"maps": [{
        "name": "start", "scene": "bag", "methods": ["explicit"],
        "axes": [["flatness", [0, 1e-6]]], "values": {"mass_flow_rate": 0},
        "border": {"along": "flatness", "within": 0.05},
        "expect": [{"where": {"flatness": 0}, "status": "fails", "why": why},
            {"where": {"flatness": 1e-6}, "status": "done", "why": "a reason of no failure"}]
    }]}));
    let printed = folder.stdout(&RUN);
    // It fails at 0 only: half of the width at which the search ends.
    assert!(printed.contains("border explicit: flatness 1.562e-8 (unstable)"), "{printed}");
    let stored: Value = serde_json::from_slice(&cells(&folder)).unwrap();
    assert_eq!(stored["cells"].as_object().unwrap().len(), 7);
    let picture = fs::read_to_string(folder.path().join("out/charts/start.svg")).unwrap();
    assert!(picture.contains(why) && !picture.contains("a reason of no failure"));
}

#[test]
fn the_shipped_maps_are_read() {
    let shipped = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../studies/stability.json");
    let folder = folder(&maps());
    let shipped = shipped.to_string_lossy();
    let arguments = [
        "stability",
        &shipped,
        "--results",
        "out",
        "--maps",
        "piston_step,storeys_step",
        "--no-pictures",
    ];
    let printed = folder.stdout(&arguments);
    assert!(printed.contains("invalid"), "{printed}");
    assert!(printed.contains("border piston, mass_flow_rate 0.005: fixed_step"), "{printed}");
}
