//! `billow-checks validate`: rows, names, tiers, exit codes.

use std::collections::BTreeSet;
use std::process::Output;

use billow_checks::cases::{CASES, Rig, Tier, command};
use billow_solver::platform::fault_injection::{Fault, Term};
use billow_study::cli::Format;
use billow_study::platform::exit_code::Exit;
use serde_json::Value;

use crate::support::{checks, stderr as stderr_of};

const KEYS: [&str; 10] = [
    "case",
    "quantity",
    "value",
    "reference",
    "error",
    "order",
    "tolerance",
    "pass",
    "seconds",
    "note",
];

fn validate(flags: &[&str]) -> Output {
    checks(&[&["validate"], flags].concat()).output().expect("the binary runs")
}

fn rows(output: &Output) -> Vec<Value> {
    serde_json::from_slice(&output.stdout).expect("a JSON array of rows")
}

/// `make test` runs the whole quick tier, `make test-all` every case.
#[test]
fn rows_are_in_table_order_and_quick_skips_long_cases() {
    let names = ["free_flight_damping", "released_sphere", "tank_filling", "injected_piston"];
    let flags: Vec<&str> = names.iter().flat_map(|name| ["--case", name]).collect();
    let output = validate(&[&flags[..], &["--quick", "--json", "--threads", "2"]].concat());
    let text = String::from_utf8_lossy(&output.stdout).into_owned();
    assert_eq!(output.status.code(), Some(0), "{text}\n{}", stderr_of(&output));
    let rows = rows(&output);
    for row in &rows {
        let keys: Vec<&String> = row.as_object().expect("an object").keys().collect();
        assert_eq!(keys.len(), KEYS.len(), "{row}");
        assert!(KEYS.iter().all(|key| row.get(key).is_some()), "{row}");
        assert!(row["pass"] == true && row["value"].is_number() && row["seconds"].is_number());
        assert!(row["error"].as_f64() <= row["tolerance"].as_f64(), "{row}");
    }
    let mut cases: Vec<&str> = rows.iter().filter_map(|row| row["case"].as_str()).collect();
    cases.dedup();
    assert_eq!(cases, ["tank_filling", "injected_piston", "free_flight_damping"]);
    let piston = rows.iter().find(|row| row["case"] == "injected_piston").expect("its row");
    assert_eq!((&piston["tolerance"], &piston["reference"]), (&1e-6.into(), &1.139_523_301.into()));
    assert!(piston["order"].as_f64() >= Some(1.9), "{piston}");
    let error = stderr_of(&output);
    assert!(error.contains("skipped by --quick: released_sphere"), "{error}");
    assert!(CASES.iter().any(|case| case.name == "released_sphere" && case.tier == Tier::Long));
}

#[test]
fn cases_are_selected_by_name_and_printed_in_every_format() {
    // In table order, and once, in whatever order they are named.
    let names = ["--case", "shear_panel", "--case", "momentum", "--case", "momentum"];
    let table = validate(&names);
    let text = String::from_utf8_lossy(&table.stdout).into_owned();
    assert!(text.starts_with("case ") && text.contains("billow") && text.contains("yes"), "{text}");
    assert!(text.find("momentum") < text.find("shear_panel"), "{text}");
    assert!(stderr_of(&table).contains("2/2 "), "{}", stderr_of(&table));
    let output = validate(&["--case", "shear_panel", "--json", "-q"]);
    assert!(output.status.success() && output.stderr.is_empty());
    let panel = &rows(&output)[0];
    assert_eq!((&panel["reference"], &panel["tolerance"]), (&863_794.613.into(), &1e-3.into()));
    assert!(panel["order"].is_null());
    let csv = validate(&["--case", "shear_panel", "--format", "csv", "-q"]);
    assert!(String::from_utf8_lossy(&csv.stdout).starts_with(&KEYS.join(",")));
}

#[test]
fn an_unknown_case_is_bad_input() {
    let output = validate(&["--case", "shear_pannel"]);
    assert_eq!(output.status.code(), Some(2));
    assert!(output.stdout.is_empty());
    let error = stderr_of(&output);
    assert!(error.contains("--case = shear_pannel: unknown name"), "{error}");
    assert!(error.contains("did you mean shear_panel?"), "{error}");
    assert!(CASES.iter().all(|case| error.contains(case.name)), "{error}");
    let names: BTreeSet<&str> = CASES.iter().map(|case| case.name).collect();
    assert_eq!(names.len(), CASES.len());
    assert_eq!(validate(&["--threads", "0"]).status.code(), Some(2));
}

#[test]
fn a_case_out_of_tolerance_gives_exit_code_1() {
    let case = CASES.iter().find(|case| case.name == "shear_panel").expect("the case");
    let fault = Fault { term: Term::WrinkledModulus, factor: 1.01 };
    let judged =
        [case.run(&Rig { fault: Some(fault), ..Rig::default() }), case.run(&Rig::default())];
    let mut out = Vec::new();
    command::print(&judged, Format::Json, &mut out).expect("a Vec accepts all bytes");
    let rows: Vec<Value> = serde_json::from_slice(&out).expect("JSON");
    assert_eq!((&rows[0]["pass"], &rows[1]["pass"]), (&Value::Bool(false), &Value::Bool(true)));
    assert!(rows[0]["error"].as_f64() > Some(5e-3));
    let error = command::verdict(&judged).expect_err("one is out of tolerance");
    assert_eq!(error.to_string(), "1 of 2 cases out of tolerance: shear_panel");
    assert_eq!(error.exit(), Exit::Failure);
    assert!(command::verdict(&judged[1..]).is_ok());
}
