//! Results of an older version are read: old names of columns and statuses, a journal of version 2.
//!
//! `tests/reference/old-results` was written by version 0.1.0 before the names changed: three jobs of
//! the piston and three of film with two subdivisions, one of them with the status `drifted` and run
//! again, so that the journal has a line of the kind `withdrawn`.

use std::fs;
use std::path::{Path, PathBuf};

use serde_json::{Value, json};

use crate::support::{TestFolder, histories, json_of, stderr};

/// Job ids of the study then, in the order of its points. Ids contain the physics version, which has
/// risen since: [`folder`] gives the jobs their ids of today, so that they count as finished.
const OLD_IDS: [&str; 6] = [
    "005f13b621fc4c66fe4e4c9a7e75a6a9",
    "06c4fe26149f26005c5557b1d8b38782",
    "8ce4d4104bf87e5e252cd7e408ca016a",
    "6ca78bc2d3b6f2334a3c2828cca739cd",
    "9ffb7487615abd613c2096271a82d882",
    "09072094f6804cf948474ed9421dd6d6",
];
/// The point of the job that the old version called `drifted`.
const ENERGY_DRIFT: usize = 4;
/// The point of a job of film that is done.
const DONE: usize = 3;

fn copy(from: &Path, to: &Path) {
    fs::create_dir_all(to).unwrap();
    for entry in fs::read_dir(from).unwrap() {
        let path = entry.unwrap().path();
        let target = to.join(path.file_name().unwrap());
        if path.is_dir() {
            copy(&path, &target);
        } else {
            fs::copy(&path, &target).unwrap();
        }
    }
}

/// A folder with a copy of the old results in `old`, and the ids of their jobs.
fn folder() -> (TestFolder, Vec<String>) {
    let folder = TestFolder::new(&json!({}));
    let stored = PathBuf::from(env!("CARGO_MANIFEST_DIR")).join("../tests/reference/old-results");
    let results = folder.path().join("old");
    copy(&stored, &results);
    let plan = json_of(&folder, &["plan", "old/study.json"]);
    let ids: Vec<String> = plan
        .as_array()
        .unwrap()
        .iter()
        .map(|point| point["job"].as_str().unwrap().to_owned())
        .collect();
    assert_eq!(ids.len(), OLD_IDS.len());
    for entry in fs::read_dir(results.join("journal")).unwrap() {
        let path = entry.unwrap().path();
        let mut text = fs::read_to_string(&path).unwrap();
        for (old, id) in OLD_IDS.iter().zip(&ids) {
            text = text.replace(old, id);
        }
        fs::write(&path, text).unwrap();
    }
    let file = |id: &str| results.join("jobs").join(&id[..2]).join(format!("{id}.h5"));
    for (old, id) in OLD_IDS.iter().zip(&ids) {
        fs::create_dir_all(file(id).parent().unwrap()).unwrap();
        fs::rename(file(old), file(id)).unwrap();
    }
    // Static references of another physics version are computed again, and the table holds the old ids.
    fs::remove_dir_all(results.join("references")).unwrap();
    fs::remove_file(results.join("summary.parquet")).unwrap();
    (folder, ids)
}

#[test]
fn a_run_finds_every_old_job_finished() {
    let (folder, _) = folder();
    let before = histories(&folder.path().join("old"));
    fs::copy(folder.path().join("old/study.json"), folder.path().join("study.json")).unwrap();
    let ended = folder.run(&["run", "study.json", "--results", "old", "--json"]);
    let summary: Value = serde_json::from_slice(&ended.stdout).unwrap();
    assert_eq!(summary["ran"], 0, "{summary}");
    assert_eq!(summary["status"], json!({"done": 5, "energy_drift": 1}));
    assert_eq!(summary["near_threshold"], 1);
    assert_eq!(before, histories(&folder.path().join("old")));
    // The run wrote the table again, with the current names.
    let rows = folder.rows("old");
    assert_eq!(rows.len(), 6);
    assert_eq!(rows[1]["near_threshold"], true);
}

/// Without ids of today the old jobs do not count as jobs of the study, and none of their files is lost.
#[test]
fn jobs_of_another_physics_version_are_kept() {
    let folder = TestFolder::new(&json!({}));
    let stored = PathBuf::from(env!("CARGO_MANIFEST_DIR")).join("../tests/reference/old-results");
    copy(&stored, &folder.path().join("old"));
    let before = histories(&folder.path().join("old"));
    let status = json_of(&folder, &["status", "old"]);
    assert_eq!((&status["jobs"], &status["done"]), (&json!(6), &json!(0)), "{status}");
    let findings = status["findings"].to_string();
    assert!(findings.contains("6 finished jobs are not in the study as it is now"), "{findings}");
    assert_eq!(before, histories(&folder.path().join("old")));
}

#[test]
fn old_rows_have_the_current_names() {
    let (folder, ids) = folder();
    let status = json_of(&folder, &["status", "old"]);
    assert_eq!((&status["done"], &status["failed"]), (&json!(5), &json!(1)), "{status}");
    assert_eq!(status["broken"], 0, "{status}");
    for row in folder.rows("old") {
        let row = row.as_object().unwrap();
        for (old, current) in [
            ("close", "near_threshold"),
            ("close_margin", "near_threshold_margin"),
            ("stop_place", "stop_location"),
        ] {
            assert!(!row.contains_key(old) && row.contains_key(current), "{old}");
        }
    }
    let why = json_of(&folder, &["job", &ids[ENERGY_DRIFT], "old"]);
    assert_eq!(why["status"], "energy_drift");
    assert!(why["stop_location"].as_str().unwrap().starts_with("energy ledger"), "{why}");
    let shown = folder.stdout(&["job", &ids[ENERGY_DRIFT], "old", "--all"]);
    assert!(shown.contains("energy_drift") && shown.contains("near_threshold_margin"), "{shown}");
}

#[test]
fn old_histories_have_the_current_names() {
    let (folder, ids) = folder();
    let all = json_of(&folder, &["job", &ids[DONE], "old", "--history"]);
    let sample = all[0].as_object().unwrap();
    assert!(sample.contains_key("broad_phase_rebuilds"), "{sample:?}");
    assert!(!sample.contains_key("contact_searches"), "{sample:?}");
    let columns = ["job", &ids[DONE], "old", "--history", "--columns", "time,contact_searches"];
    let output = folder.run(&columns);
    assert!(output.status.success(), "{}", stderr(&output));
    assert!(stderr(&output).contains("is now called \"broad_phase_rebuilds\""));
}

#[test]
fn old_names_in_options_work_with_a_note() {
    let (folder, _) = folder();
    for (arguments, note) in [
        (&["table", "old", "--columns", "job,close"] as &[&str], "\"near_threshold\""),
        (&["table", "old", "--sort", "close_margin"], "\"near_threshold_margin\""),
        (&["table", "old", "--where", "close"], "\"near_threshold\""),
        (&["table", "old", "--where", "status == 'drifted'"], "\"energy_drift\""),
        (
            &["compare", "old", "--by", "model", "--base", "piston", "--measures", "close_margin"],
            "\"near_threshold_margin\"",
        ),
        (
            &["chart", "old", "--measure", "close_margin", "--over", "mass_flow_rate"],
            "\"near_threshold_margin\"",
        ),
        (
            &["chart", "old", "--history", "contact_searches", "--where", "model == 'film'"],
            "\"broad_phase_rebuilds\"",
        ),
    ] {
        let output = folder.run(arguments);
        assert!(output.status.success(), "{arguments:?}: {}", stderr(&output));
        let notes = stderr(&output);
        assert!(notes.contains("is now called") && notes.contains(note), "{arguments:?}: {notes}");
    }
    for (condition, number) in [("close", 1), ("status == 'drifted'", 1), ("not close", 4)] {
        let rows = json_of(&folder, &["table", "old", "--where", condition]);
        assert_eq!(rows.as_array().unwrap().len(), number, "{condition}");
    }
}

#[test]
fn comparisons_and_charts_of_old_results_work() {
    let (folder, _) = folder();
    let compared = folder.stdout(&["compare", "old", "--by", "model", "--base", "piston"]);
    assert!(compared.contains("peak_kinetic_energy"), "{compared}");
    let drawn = folder.stdout(&["chart", "old"]);
    assert!(drawn.contains(".svg"), "{drawn}");
}
