//! The index of the results changes the time of a command, and nothing that it prints.

use std::fs;
use std::process::Output;

use serde_json::{Value, json};

use crate::support::{TestFolder, failed, grid, ids, ran, small_grid};

/// Checks that these results have an index, and that no output of a command that it serves depends on it.
fn check(folder: &TestFolder, job: &str, by: &[&str]) {
    let compare = [&["compare", "results/grid", "--summary"], by].concat();
    let commands: [&[&str]; 18] = [
        &["status"],
        &["status", "grid.json", "--json"],
        &["job", job],
        &["job", job, "--json"],
        &["job", job, "--all"],
        &["job", job, "grid.json", "--all", "--json"],
        &compare,
        &[&compare[..], &["--json"]].concat(),
        &[&compare[..], &["--where", "N == 6 or N == 5", "--measures", "peak_vz"]].concat(),
        &["table"],
        &["table", "grid.json", "--runs", "--limit", "2"],
        &["table", "--format", "csv", "--si"],
        &["table", "--columns", "design.N,film.thickness,first_minimum_z_rim,close"],
        &["table", "--sort", "peak_vz:desc", "--where", "volume_ratio > 0.1 and M == 2"],
        &["table", "--columns", "peak_v"],
        &["table", "--where", "N = 6"],
        &["run", "grid.json"],
        &["run", "results/grid", "--json"],
    ];
    let index = folder.results().join("index.json");
    for command in commands {
        assert!(index.is_file(), "{command:?}");
        let with = texts(&folder.run(command));
        let kept = fs::read(&index).unwrap();
        fs::remove_file(&index).unwrap();
        let without = texts(&folder.run(command));
        assert_eq!(with, without, "{command:?}");
        // A run has written it again.
        fs::write(&index, kept).unwrap();
    }
}

/// Stdout, stderr and exit code of a command.
fn texts(output: &Output) -> (String, String, Option<i32>) {
    let text = |bytes: &[u8]| String::from_utf8_lossy(bytes).into_owned();
    (text(&output.stdout), text(&output.stderr), output.status.code())
}

#[test]
fn no_output_depends_on_the_index() {
    let folder = ran();
    check(&folder, &ids(&folder, "done")[0].clone(), &["--by", "N", "--base", "6"]);
    check_infeasible(&folder);

    let mut study = grid(&json!({
        "N": [5, 6], "M": [2, 3], "alpha1_over_phi": [0.8], "mass_flow_rate": ["2 g/s"]
    }));
    study["replicates"] = json!({"seed": 3});
    study["limits"] = json!({"peak_vz": "< 20 m/s"});
    let replicates = TestFolder::new(&study);
    replicates.stdout(&["run", "grid.json", "-q"]);
    let job = job_of(&replicates);
    check(&replicates, &job, &["--by", "N", "--base", "6"]);
}

#[test]
fn no_output_of_failed_jobs_depends_on_the_index() {
    let folder = failed();
    let job = job_of(&folder);
    check(&folder, &job, &["--by", "N", "--base", "6"]);
}

fn check_infeasible(folder: &TestFolder) {
    folder.stdout(&["run", "grid.json", "-q"]);
    let job = ids(folder, "infeasible")[0].clone();
    check(folder, &job, &["--by", "M", "--base", "3"]);
}

/// The first job of a folder.
fn job_of(folder: &TestFolder) -> String {
    folder.rows("results/grid")[0]["job"].as_str().unwrap().to_owned()
}

#[test]
fn a_limit_prints_the_first_rows_and_says_what_it_leaves_out() {
    let folder = TestFolder::new(&small_grid());
    folder.stdout(&["run", "grid.json", "-q"]);
    let output = folder.run(&["table", "--limit", "3", "--json"]);
    let rows: Vec<Value> = serde_json::from_slice(&output.stdout).unwrap();
    assert_eq!(rows, folder.rows("results/grid")[..3]);
    let said = String::from_utf8(output.stderr).unwrap();
    assert_eq!(said, "3 of 24 rows: --limit leaves out 21\n");
    assert_eq!(folder.run(&["table", "--limit", "24", "--json"]).stderr, b"");
}
