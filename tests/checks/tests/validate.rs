//! `billow-checks validate`: rows, names, tiers, exit codes.

use std::collections::BTreeSet;

use billow_checks::cases::{CASES, Rig, command};
use billow_solver::platform::fault_injection::{Fault, Term};
use billow_study::platform::exit_code::Exit;
use billow_study::print::Format;
use serde_json::Value;

use crate::support::{Folder, stderr};

/// `make test` runs the whole quick tier, `make test-all` every case.
#[test]
fn rows_are_in_table_order_and_quick_skips_long_cases() {
    let names = ["free_flight_damping", "released_sphere", "tank_filling", "injected_piston"];
    let flags: Vec<&str> = names.iter().flat_map(|name| ["--case", name]).collect();
    let flags = [&["validate"], &flags[..], &["--quick", "--json", "--threads", "2"]].concat();
    let output = Folder::new().run(&flags);
    let error = stderr(&output);
    assert_eq!(output.status.code(), Some(0), "{error}");
    let rows: Vec<Value> = serde_json::from_slice(&output.stdout).unwrap();
    for row in &rows {
        assert!(row["pass"] == true && row["value"].is_number() && row["seconds"].is_number());
        assert!(row["error"].as_f64() <= row["tolerance"].as_f64(), "{row}");
    }
    let mut cases: Vec<&str> = rows.iter().filter_map(|row| row["case"].as_str()).collect();
    cases.dedup();
    assert_eq!(cases, ["tank_filling", "injected_piston", "free_flight_damping"]);
    let piston = rows.iter().find(|row| row["case"] == "injected_piston").unwrap();
    assert_eq!((&piston["tolerance"], &piston["reference"]), (&1e-6.into(), &1.139_523_301.into()));
    assert!(piston["order"].as_f64() >= Some(1.9), "{piston}");
    assert!(error.contains("skipped by --quick: released_sphere"), "{error}");
    assert!(error.contains("tank_filling: in tolerance"), "{error}");
    assert!(CASES.iter().any(|case| case.name == "released_sphere" && case.long));
}

#[test]
fn an_unknown_case_is_bad_input() {
    let output = Folder::new().run(&["validate", "--case", "shear_pannel"]);
    assert!(output.status.code() == Some(2) && output.stdout.is_empty());
    let error = stderr(&output);
    assert!(error.contains("--case = shear_pannel: unknown name"), "{error}");
    assert!(error.contains("did you mean shear_panel?"), "{error}");
    let names: BTreeSet<&str> = CASES.iter().map(|case| case.name).collect();
    assert!(names.len() == CASES.len() && names.iter().all(|name| error.contains(name)), "{error}");
}

#[test]
fn a_case_out_of_tolerance_gives_exit_code_1() {
    let case = CASES.iter().find(|case| case.name == "shear_panel").expect("the case");
    let fault = Fault { term: Term::WrinkledModulus, factor: 1.01 };
    let judged =
        [case.run(&Rig { fault: Some(fault), ..Rig::default() }), case.run(&Rig::default())];
    let printed = |format: Format| {
        let mut out = Vec::new();
        command::print(&judged, format, &mut out).expect("a Vec accepts all bytes");
        String::from_utf8(out).expect("text")
    };
    let table = printed(Format::Table);
    assert!(table.starts_with("case ") && table.contains("false"), "{table}");
    let rows: Vec<Value> = serde_json::from_str(&printed(Format::Json)).expect("JSON");
    assert_eq!((&rows[0]["pass"], &rows[1]["pass"]), (&Value::Bool(false), &Value::Bool(true)));
    assert!(rows[0]["error"].as_f64() > Some(5e-3) && rows[1]["order"].is_null());
    let error = command::verdict(&judged).expect_err("one is out of tolerance");
    assert_eq!(error.to_string(), "1 of 2 cases out of tolerance: shear_panel");
    assert_eq!(error.exit(), Exit::Failure);
    assert!(command::verdict(&judged[1..]).is_ok());
}
