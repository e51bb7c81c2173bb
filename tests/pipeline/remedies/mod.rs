//! Remedies of failed jobs, by real runs: what the table applies is cured, the row says what was changed, and nothing
//! is lost.

use std::fs;

use billow_study::platform::files::Disk;
use billow_study::store::results::Results;
use serde_json::{Value, json};

use crate::support::{TestFolder, file_of, histories, ids, json_of, stderr};

/// The paper's capsule of soft film with much residual gas, on its coarsest mesh.
fn capsule_study(solver: &Value, axes: &Value) -> Value {
    let mut study = json!({
        "design": {
            "fit": "cone", "N": 6, "M": 3, "bottom_radius": "500 mm", "top_radius": "365 mm",
            "height": "1 m", "stowed_height": "40 mm", "subdivisions": 2,
        },
        "film": {"youngs_modulus": "10 MPa"},
        "gas": {
            "residual_gas": "stored", "residual_gas_mass": "1 g", "mass_flow_rate": "5 g/s",
        },
        "solver": {"model": "film", "end_time": "20 ms"},
        "outputs": {"sample_interval": "0.5 ms", "frames": 0},
        "grid": axes,
    });
    for (key, value) in solver.as_object().unwrap() {
        study["solver"][key] = value.clone();
    }
    study
}

fn capsule(solver: &Value, axes: &Value) -> TestFolder {
    TestFolder::new(&capsule_study(solver, axes))
}

/// The row with this value of a parameter.
fn row(folder: &TestFolder, parameter: &str, value: &Value) -> Value {
    let rows = folder.rows("results/grid");
    rows.into_iter().find(|row| row[parameter] == *value).unwrap()
}

fn text(value: &Value) -> String {
    value.as_str().unwrap_or_default().to_owned()
}

#[test]
fn a_drifting_job_gets_the_result_of_a_smaller_step() {
    // E 10 MPa drifts at a CFL number of 0.9 and not at 0.45; E 1 GPa does neither.
    let axes = json!({"youngs_modulus": ["10 MPa", "1 GPa"]});
    let folder = capsule(&json!({"cfl": 0.9}), &axes);
    let ended = folder.run(&["run", "grid.json"]);
    assert_eq!(ended.status.code(), Some(1));
    let next = "solver.cfl 0.9 -> 0.45 (1 job):\n        billow rerun results/grid --remedy";
    assert!(stderr(&ended).contains(next), "{}", stderr(&ended));
    let planned = ids(&folder, "energy_drift").remove(0);
    let before = histories(&folder.results());
    assert_eq!(row(&folder, "youngs_modulus", &json!(1e7))["stop_audit"], "energy_ledger");

    // Every reader names the remedy and the command.
    let said = folder.stdout(&["job", &planned]);
    for words in [
        "audit     energy_ledger",
        "remedy    solver.cfl 0.9 -> 0.45: a step of half the length",
        "proposed  more loss",
        &format!("next      billow rerun {} results/grid --remedy", &planned[..8]),
    ] {
        assert!(said.contains(words), "{words}: {said}");
    }
    assert_eq!(json_of(&folder, &["job", &planned])["next_remedy"], "solver.cfl 0.9 -> 0.45");
    let said = folder.stdout(&["status"]);
    assert!(said.contains("remedy    solver.cfl 0.9 -> 0.45 (1 job): billow rerun"), "{said}");
    assert_eq!(json_of(&folder, &["status"])["can_run_with_remedy"], 1);
    let shown = json_of(&folder, &["job", &planned, "--all"]);
    let of_group = |row: &&Value| row["group"] == "remedies";
    let about: Vec<&Value> = shown.as_array().unwrap().iter().filter(of_group).collect();
    assert!(text(&about[0]["value"]).starts_with("solver.cfl 0.9 -> 0.45"), "{about:?}");

    // A dry run changes nothing.
    let listed = json_of(&folder, &["rerun", "--remedy", "--dry-run", "-q"]);
    let listed = listed.as_array().unwrap();
    assert_eq!((listed.len(), &listed[0]["job"]), (1, &json!(planned)));
    assert_eq!(listed[0]["remedy"], "solver.cfl 0.9 -> 0.45");
    assert_eq!(histories(&folder.results()), before);

    let summary = json_of(&folder, &["rerun", &planned[..8], "results/grid", "--remedy", "-q"]);
    assert_eq!((&summary["ran"], &summary["failed"]), (&json!(1), &json!(0)), "{summary}");
    assert_eq!(summary["with_remedy"], 1);
    let cured = row(&folder, "youngs_modulus", &json!(1e7));
    assert_eq!(
        (&cured["status"], &cured["remedy"]),
        (&json!("done"), &json!("solver.cfl 0.9 -> 0.45"))
    );
    let other = row(&folder, "youngs_modulus", &json!(1e9));
    assert_eq!((&other["status"], &other["remedy"]), (&json!("done"), &Value::Null));

    // It is the job, with the bits, of a study that plans the smaller step.
    let plain = capsule(&json!({"cfl": 0.45}), &json!({"youngs_modulus": ["10 MPa"]}));
    plain.stdout(&["run", "grid.json", "-q"]);
    let planned_so = plain.rows("results/grid").remove(0);
    for column in ["job", "content_hash", "peak_kinetic_energy", "volume_ratio", "stop_audit"] {
        assert_eq!(cured[column], planned_so[column], "{column}");
    }

    // The failed job keeps its record and its history, and the readers lead from one to the other.
    let id = text(&cured["job"]);
    let after = histories(&folder.results());
    assert_eq!(after.len(), 3);
    assert!(before.iter().all(|(name, bytes)| after[name] == *bytes));
    let said = folder.stdout(&["job", &planned]);
    assert!(said.contains(": energy_drift"), "{said}");
    assert!(said.contains(&format!("gives the result of the point: job {}", &id[..8])), "{said}");
    let said = folder.stdout(&["job", &id]);
    let from = format!("after the planned job {} ended as energy_drift", &planned[..8]);
    assert!(said.contains(&from), "{said}");
    let refused = folder.run(&["rerun", &planned, "-q"]);
    assert!(stderr(&refused).contains(&id[..8]), "{}", stderr(&refused));
    assert!(folder.stdout(&["table"]).contains("solver.cfl 0.9 -> 0.45"));
    let csv = folder.stdout(&["table", "--columns", "remedy", "--format", "csv"]);
    assert_eq!(csv, "remedy\nsolver.cfl 0.9 -> 0.45\n\n");
    let parquet = Results::new(&Disk, &folder.results()).read_table().unwrap();
    let cells = &parquet.column("remedy").unwrap().cells;
    assert_eq!(cells[0].to_string(), "solver.cfl 0.9 -> 0.45");
    let said = folder.stdout(&["status"]);
    assert!(said.contains("2 done (1 with a remedy), 0 failed, 0 pending\n"), "{said}");

    // Resume, rerun, doctor, compare and chart take it as the result of the point.
    assert!(folder.stdout(&["run", "grid.json"]).contains("nothing to run, all 2 jobs"));
    let said = folder.stdout(&["doctor"]);
    assert!(said.contains("3 jobs recorded, 3 histories checked, 0 findings"), "{said}");
    let again = json_of(&folder, &["rerun", &id, "-q"]);
    assert_eq!((&again["same_bits"], &again["other_bits"]), (&json!(1), &json!([])));
    let compared = folder.run(&[
        "compare",
        "--by",
        "youngs_modulus",
        "--base",
        "10 MPa",
        "--measures",
        "peak_vz",
    ]);
    assert!(compared.status.success(), "{}", stderr(&compared));
    assert!(stderr(&compared).contains("1 row with other numerical settings than planned"));
    let charts = folder.stdout(&["chart", "--history", "z_rim", "-q"]);
    assert!(charts.contains(".svg"), "{charts}");

    // A lost history runs again, with the same bits; a lost table is written again.
    fs::remove_file(file_of(&folder, &id)).unwrap();
    fs::remove_file(folder.results().join("summary.parquet")).unwrap();
    let again = json_of(&folder, &["run", "grid.json", "-q"]);
    assert_eq!((&again["ran"], &again["same_bits"]), (&json!(1), &json!(1)), "{again}");
    assert_eq!(histories(&folder.results()), after);
    assert_eq!(row(&folder, "youngs_modulus", &json!(1e7))["remedy"], cured["remedy"]);
}

#[test]
fn implicit_and_xpbd_jobs_get_the_result_of_an_integrator_that_bears_contact() {
    // The paper's film and no residual gas.
    let study = |axes: Value| {
        let mut study = capsule_study(&json!({"cfl": 0.9, "end_time": "50 ms"}), &axes);
        study["film"] = json!({});
        study["gas"]["residual_gas_mass"] = json!(0);
        study["outputs"]["sample_interval"] = json!("1.25 ms");
        study
    };
    let folder = TestFolder::new(&study(json!({"integrator": ["implicit", "xpbd"]})));
    folder.run(&["run", "grid.json", "-q"]);
    let of = |name: &str| row(&folder, "integrator", &json!(name));
    assert_eq!(of("implicit")["status"], "step_limit");
    assert_eq!(of("xpbd")["status"], "unstable");
    folder.stdout(&["rerun", "results/grid", "--remedy", "-q"]);
    assert_eq!(of("implicit")["status"], "done");
    assert_eq!(of("implicit")["remedy"], "solver.integrator implicit -> hybrid");
    assert_eq!(of("xpbd")["status"], "done");
    assert_eq!(of("xpbd")["remedy"], "solver.integrator xpbd -> explicit");

    // A job that another point of the study has is not computed twice, and --status chooses.
    let folder = TestFolder::new(&study(json!({"integrator": ["implicit", "hybrid"]})));
    folder.run(&["run", "grid.json", "-q"]);
    let arguments = ["rerun", "results/grid", "--status", "step_limit", "--remedy", "-q"];
    let summary = json_of(&folder, &arguments);
    assert_eq!((&summary["ran"], &summary["with_remedy"]), (&json!(0), &json!(1)), "{summary}");
    let rows = folder.rows("results/grid");
    assert_eq!(rows[0]["job"], rows[1]["job"]);
    assert_eq!((&rows[0]["status"], &rows[1]["remedy"]), (&json!("done"), &Value::Null));
}

#[test]
fn a_piston_with_a_fixed_step_gets_error_controlled_steps() {
    let solver = json!({"model": "piston", "stepping": {"fixed": "2 ms"}, "end_time": "50 ms"});
    let mut study = capsule_study(&solver, &json!({"residual_gas_mass": ["1 g", "10 g"]}));
    study["outputs"]["sample_interval"] = json!("1.25 ms");
    let folder = TestFolder::new(&study);
    folder.run(&["run", "grid.json", "-q"]);
    assert_eq!(ids(&folder, "energy_drift").len(), 2);
    folder.stdout(&["rerun", "--remedy", "-q"]);
    assert_eq!(ids(&folder, "done").len(), 2);
    for row in folder.rows("results/grid") {
        let expected = "solver.stepping.fixed 0.002 s -> solver.stepping.adaptive 1e-9";
        assert_eq!(row["remedy"], expected);
    }
}

#[test]
fn a_job_that_no_remedy_helps_keeps_its_status_and_names_what_was_tried() {
    let axes = json!({"residual_gas_mass": ["10 g"]});
    let folder = capsule(&json!({"cfl": 0.9}), &axes);
    folder.run(&["run", "grid.json", "-q"]);
    let planned = ids(&folder, "unstable").remove(0);
    let ended = folder.run(&["rerun", "--remedy"]);
    assert_eq!(ended.status.code(), Some(1));
    let row = folder.rows("results/grid").remove(0);
    assert_eq!((&row["job"], &row["status"]), (&json!(planned), &json!("unstable")));
    assert_eq!(row["failed_remedies"], "solver.cfl 0.9 -> 0.45: overstretched");
    assert_eq!(row["remedy"], Value::Null);
    let said = folder.stdout(&["job", &planned]);
    assert!(said.contains("tried     solver.cfl 0.9 -> 0.45: overstretched, job "), "{said}");
    assert!(said.contains("proposed  less stretch"), "{said}");
    let listed = json_of(&folder, &["rerun", "--remedy", "--dry-run", "-q"]);
    assert_eq!(listed[0]["remedy"], Value::Null);
    assert!(text(&listed[0]["reason"]).contains("tried: solver.cfl 0.9 -> 0.45"), "{listed}");
    let refused = folder.run(&["rerun", "--remedy"]);
    assert_eq!(refused.status.code(), Some(1));
    assert!(stderr(&refused).contains("no remedy can be applied to 1 failed job"));
    let again = folder.run(&["run", "grid.json"]);
    assert!(String::from_utf8_lossy(&again.stdout).contains("nothing to run"), "{again:?}");
    assert_eq!(histories(&folder.results()).len(), 2);
    assert!(folder.stdout(&["doctor"]).contains("0 findings"));
}

#[test]
fn a_search_takes_the_results_of_remedies() {
    let axes = json!({
        "residual_gas_mass": {"bisect": ["0.1 g", "4 g"], "on": "verdict", "tolerance": "0.5 g"},
    });
    let folder = capsule(&json!({"cfl": 0.9}), &axes);
    let pending = |folder: &TestFolder| json_of(folder, &["status"])["pending"].clone();
    folder.run(&["run", "grid.json", "-q"]);
    let scanned = ids(&folder, "energy_drift").len();
    assert_eq!((scanned, pending(&folder)), (4, json!(0)), "four of five values of the scan");
    // With their results the search goes on: its next values run, fail, and are cured.
    for round in 0.. {
        let cured = folder.run(&["rerun", "--remedy", "-q"]);
        assert!(cured.status.success(), "{}", stderr(&cured));
        if pending(&folder) == 0 {
            assert!(round > 0, "the search needs values between those of the scan");
            break;
        }
        assert!(round < 4, "the tolerance is an eighth of the interval");
        folder.run(&["run", "grid.json", "-q"]);
    }
    let rows = folder.rows("results/grid");
    assert!(rows.len() > 5 && rows.iter().all(|row| row["status"] == "done"), "{rows:?}");
    let said = folder.stdout(&["run", "grid.json"]);
    assert!(said.contains("nothing to run"), "{said}");
    assert!(said.contains("deployed above, not below"), "{said}");
    assert!(folder.stdout(&["doctor"]).contains("no faults"));
}

#[test]
fn storeys_have_a_proposal_and_nothing_to_apply() {
    let solver = json!({"model": "storeys", "end_time": "50 ms"});
    let folder = capsule(&solver, &json!({"residual_gas_mass": ["100 g"]}));
    let ended = folder.run(&["run", "grid.json", "-q"]);
    assert!(!stderr(&ended).contains("--remedy"), "{}", stderr(&ended));
    let failed = ids(&folder, "unstable").remove(0);
    let said = folder.stdout(&["job", &failed]);
    assert!(said.contains("proposed  solver.model film"), "{said}");
    let refused = folder.run(&["rerun", &failed, "--remedy"]);
    assert_eq!(refused.status.code(), Some(1), "{}", stderr(&refused));
    let none = capsule(&json!({"end_time": "1 ms"}), &json!({"seed": [0]}));
    none.stdout(&["run", "grid.json", "-q"]);
    let said = none.run(&["rerun", "--remedy"]);
    assert!(said.status.success() && stderr(&said).contains("no job has failed"));
}
