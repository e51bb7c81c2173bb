//! `billow validate`: rows, names, tiers, exit codes; the quick tier itself.

use std::io::{BufRead, BufReader, Read};
use std::process::{Command, Output, Stdio};

use billow_solver::platform::fault_injection::{Fault, Term};
use billow_study::cases::{self, CASES, Rig, Tier};
use billow_study::cli::{Format, validate};
use serde_json::Value;

use crate::resume::signal;

const KEYS: [&str; 10] =
    ["case", "quantity", "value", "reference", "error", "order", "band", "pass", "seconds", "note"];

fn billow(flags: &[&str]) -> Output {
    let mut command = Command::new(env!("CARGO_BIN_EXE_billow"));
    command.arg("validate").args(flags).output().expect("the binary runs")
}

fn rows(output: &Output) -> Vec<Value> {
    serde_json::from_slice(&output.stdout).expect("a JSON array of rows")
}

fn said(output: &Output) -> String {
    String::from_utf8_lossy(&output.stderr).into_owned()
}

/// The whole quick tier is run by `make test`, all of it by `make test-all`.
#[test]
fn rows_stand_in_the_tables_order_and_long_cases_are_skipped() {
    let names = ["free_flight_damping", "released_sphere", "tank_filling", "injected_piston"];
    let flags: Vec<&str> = names.iter().flat_map(|name| ["--case", name]).collect();
    let output = billow(&[&flags[..], &["--quick", "--json", "--threads", "2"]].concat());
    let text = String::from_utf8_lossy(&output.stdout).into_owned();
    assert_eq!(output.status.code(), Some(0), "{text}\n{}", said(&output));
    let rows = rows(&output);
    for row in &rows {
        let keys: Vec<&String> = row.as_object().expect("an object").keys().collect();
        assert_eq!(keys.len(), KEYS.len(), "{row}");
        assert!(KEYS.iter().all(|key| row.get(key).is_some()), "{row}");
        assert!(row["pass"] == true && row["value"].is_number() && row["seconds"].is_number());
        assert!(row["error"].as_f64() <= row["band"].as_f64(), "{row}");
    }
    let mut told: Vec<&str> = rows.iter().filter_map(|row| row["case"].as_str()).collect();
    told.dedup();
    assert_eq!(told, ["tank_filling", "injected_piston", "free_flight_damping"]);
    let piston = rows.iter().find(|row| row["case"] == "injected_piston").expect("its row");
    assert_eq!((&piston["band"], &piston["reference"]), (&1e-6.into(), &1.139_523_301.into()));
    assert!(piston["order"].as_f64() >= Some(1.9), "{piston}");
    let error = said(&output);
    assert!(error.contains("skipped by --quick: released_sphere"), "{error}");
    assert!(CASES.iter().any(|case| case.name == "released_sphere" && case.tier == Tier::Long));
}

#[test]
fn cases_are_asked_for_by_name() {
    // In the table's order, and once, however they are asked for.
    let flags = ["--case", "shear_panel", "--case", "patch", "--case", "patch", "--json", "-q"];
    let output = billow(&flags);
    assert!(output.status.success(), "{}", said(&output));
    assert!(output.stderr.is_empty());
    let rows = rows(&output);
    let names: Vec<&str> = rows.iter().filter_map(|row| row["case"].as_str()).collect();
    assert_eq!(names, ["patch", "patch", "shear_panel"]);
    let panel = &rows[2];
    assert_eq!(panel["reference"], 863_794.613);
    assert_eq!(panel["band"], 1e-3);
    assert!(panel["order"].is_null());

    let table = billow(&["--case", "patch"]);
    let text = String::from_utf8_lossy(&table.stdout).into_owned();
    assert!(text.starts_with("case ") && text.contains("billow") && text.contains("yes"), "{text}");
    assert!(said(&table).contains("1/1 patch: in band"));
    let csv = billow(&["--case", "patch", "--format", "csv", "-q"]);
    assert!(String::from_utf8_lossy(&csv.stdout).starts_with(&KEYS.join(",")));
}

#[test]
fn an_unknown_case_is_bad_input() {
    let output = billow(&["--case", "shear_pannel"]);
    assert_eq!(output.status.code(), Some(2));
    assert!(output.stdout.is_empty());
    let error = said(&output);
    assert!(error.contains("--case = shear_pannel: there is no such case"), "{error}");
    assert!(error.contains("did you mean shear_panel?"), "{error}");
    assert!(CASES.iter().all(|case| error.contains(case.name)), "{error}");
    assert_eq!(billow(&["--threads", "0"]).status.code(), Some(2));
}

#[test]
fn the_list_runs_nothing() {
    let output = billow(&["--list", "--json"]);
    let rows = rows(&output);
    assert_eq!(rows.len(), CASES.len());
    for (row, case) in rows.iter().zip(CASES) {
        assert_eq!(row["case"], case.name);
        assert!(row["tier"] == "quick" || row["tier"] == "long");
        assert!(!row["compares"].as_str().expect("a text").is_empty());
    }
}

#[test]
fn a_case_out_of_band_is_told_and_ends_in_exit_code_1() {
    let case = CASES.iter().find(|case| case.name == "shear_panel").expect("the case");
    let fault = Fault { term: Term::WrinkledModulus, factor: 1.01 };
    let judged = [case.run(&Rig { fault: Some(fault) }), case.run(&Rig::default())];
    let mut out = Vec::new();
    validate::print(&judged, Format::Json, &mut out).expect("a Vec takes all");
    let rows: Vec<Value> = serde_json::from_slice(&out).expect("JSON");
    assert_eq!((&rows[0]["pass"], &rows[1]["pass"]), (&Value::Bool(false), &Value::Bool(true)));
    assert!(rows[0]["error"].as_f64() > Some(5e-3));
    let error = validate::verdict(&judged).expect_err("one is out of band");
    assert_eq!(error.to_string(), "1 of 2 cases out of band: shear_panel");
    assert_eq!(
        format!("{:?}", error.exit_code()),
        format!("{:?}", std::process::ExitCode::from(1))
    );
    assert!(validate::verdict(&judged[1..]).is_ok());
}

#[test]
fn rows_are_the_same_with_one_thread_and_two() {
    let few: Vec<&cases::Case> = CASES.iter().filter(|case| case.name.contains("piston")).collect();
    let told = |threads: usize| {
        let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().expect("threads");
        let judged = cases::run_all(&pool, &few, &Rig::default(), &|_| ());
        judged.into_iter().map(|case| (case.name, case.rows)).collect::<Vec<_>>()
    };
    assert_eq!(told(1), told(2));
}

#[test]
fn a_signal_leaves_what_is_judged() {
    // The second takes many times as long as the first.
    let flags =
        ["validate", "--case", "patch", "--case", "deployed_equals_inflated_fine", "--json"];
    let mut command = Command::new(env!("CARGO_BIN_EXE_billow"));
    let child = command.args(flags).args(["--threads", "1"]);
    let child = child.stdout(Stdio::piped()).stderr(Stdio::piped()).spawn();
    let mut child = child.expect("the binary runs");
    let mut stderr = BufReader::new(child.stderr.take().expect("piped"));
    let mut told = String::new();
    stderr.read_line(&mut told).expect("a line");
    assert!(told.starts_with("billow: 1/2 patch: in band"), "{told}");
    signal(&child, "-INT");
    stderr.read_to_string(&mut told).expect("its last words");
    let output = child.wait_with_output().expect("a child");
    assert_eq!(output.status.code(), Some(130), "{told}");
    assert!(told.contains("stopped by signal 2; 1 of 2 cases were judged"), "{told}");
    assert!(rows(&output).iter().all(|row| row["case"] == "patch"));
}
