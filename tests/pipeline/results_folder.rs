//! Results folders with missing, damaged or foreign files.

use std::fs;

use billow_study::store::history_file;
use serde_json::json;

use crate::support::{TestFolder, grid, small_grid, stderr};

fn finished_study() -> TestFolder {
    let folder = TestFolder::finished(&small_grid());
    folder
}

#[test]
fn histories_agree_with_the_table() {
    let folder = finished_study();
    let mut seen = 0;
    for row in folder.rows("results/grid") {
        let Some(hash) = row["content_hash"].as_str() else { continue };
        let id = row["job"].as_str().unwrap();
        let path = folder.results().join(format!("jobs/{}/{id}.h5", &id[..2]));
        let stored = history_file::read(&path).unwrap();
        assert_eq!(stored.content_hash, hash);
        assert_eq!(history_file::hash_of(&stored.history, &[], None), hash);
        let last = |column: &str| stored.history.column(column).last().copied();
        assert_eq!(last("volume"), row["final_volume"].as_f64());
        assert_eq!(last("pressure"), row["final_pressure"].as_f64());
        assert_eq!(last("z_rim"), row["final_z_rim"].as_f64());
        let time = stored.history.column("time");
        assert!(time.windows(2).all(|pair| pair[0] < pair[1]), "time increases");
        assert_eq!((time[0], time[time.len() - 1]), (0.0, 0.6));
        seen += 1;
    }
    assert_eq!(seen, 16);
}

#[test]
fn a_lost_or_foreign_table_changes_no_answer_and_is_restored() {
    let folder = finished_study();
    let path = folder.results().join("summary.parquet");
    let table = fs::read(&path).unwrap();
    let rows = folder.run(&["table"]).stdout;
    fs::write(&path, b"a foreign file").unwrap();
    let output = folder.run(&["table"]);
    assert_eq!(output.status.code(), Some(0));
    assert_eq!(output.stdout, rows);
    assert!(folder.run(&["doctor"]).stdout.windows(18).any(|text| text == b"not a Parquet file"));
    for damage in [false, true] {
        if damage {
            fs::write(&path, &table[..table.len() / 2]).unwrap();
        } else {
            fs::remove_file(&path).unwrap();
        }
        folder.stdout(&["run", "grid.json", "-q"]);
        assert_eq!(fs::read(&path).unwrap(), table);
    }
}

#[test]
fn foreign_lines_of_a_journal_are_named_with_file_and_line() {
    let folder = finished_study();
    let path = folder.results().join("journal/000001.jsonl");
    let sound = fs::read_to_string(&path).unwrap();
    for (text, expected) in [
        (sound.replacen("billow-journal", "bellow-journal", 1), "line 1: it does not have"),
        (format!("{sound}not ours\n"), "line 19: it has no checksum"),
        (String::from("{}\n"), "line 1: it has no checksum"),
    ] {
        fs::write(&path, text).unwrap();
        let output = folder.run(&["status"]);
        assert_eq!(output.status.code(), Some(0));
        let output = folder.run(&["table"]);
        assert!(stderr(&output).contains(expected), "{}", stderr(&output));
        assert!(stderr(&output).contains("000001.jsonl"), "{}", stderr(&output));
        folder.stdout(&["run", "grid.json", "-q"]);
        assert_eq!(folder.run(&["doctor"]).status.code(), Some(0), "{expected}");
    }
    assert!(folder.stdout(&["run", "grid.json"]).contains("nothing to run"));
}

#[test]
fn a_results_path_that_is_a_file_is_an_error() {
    let folder = TestFolder::new(&small_grid());
    fs::write(folder.path().join("taken"), b"").unwrap();
    let output = folder.run(&["run", "grid.json", "-q", "--results", "taken"]);
    assert_eq!(output.status.code(), Some(2));
    assert!(stderr(&output).starts_with("billow: taken: "), "{}", stderr(&output));
    assert_eq!(fs::read(folder.path().join("taken")).unwrap(), b"");
}

#[test]
fn a_folder_of_another_study_is_refused_and_a_larger_grid_continues() {
    let folder = finished_study();
    let mut study = small_grid();
    study["name"] = serde_json::json!("other");
    fs::write(folder.path().join("other.json"), study.to_string()).unwrap();
    let output = folder.run(&["run", "other.json", "--results", "results/grid"]);
    assert_eq!(output.status.code(), Some(2));
    assert!(stderr(&output).contains("results of the study \"grid\", not of \"other\""));

    let mut study = small_grid();
    study["grid"]["mass_flow_rate"] = serde_json::json!(["2 g/s", "3 g/s"]);
    fs::write(folder.path().join("grid.json"), study.to_string()).unwrap();
    let said = folder.stdout(&["run", "grid.json", "-q"]);
    assert!(said.starts_with("grid: 16 jobs run, 48 points\n"), "{said}");
}

#[test]
fn a_run_with_another_set_says_what_changed_and_keeps_every_job() {
    let folder = finished_study();
    let said = folder.run(&["run", "grid.json", "--set", "solver.end_time=0.3"]);
    let note = "last run for another form of this study (solver.end_time 0.6 → 0.3)";
    assert!(stderr(&said).contains(note), "{}", stderr(&said));
    let table = stderr(&folder.run(&["table", "grid.json"]));
    assert!(table.contains("(solver.end_time 0.3 → 0.6)"), "{table}");
    let same = folder.run(&["table", "grid.json", "--set", "solver.end_time=0.3"]);
    assert!(!stderr(&same).contains("is not the study"), "{}", stderr(&same));
    // Back to the first form: nothing is computed again.
    assert!(folder.stdout(&["run", "grid.json", "-q"]).contains("nothing to run, all 16 jobs"));
}

#[test]
fn a_study_of_infeasible_points_says_so() {
    let study = grid(&json!({
        "N": [5, 6], "M": [2], "alpha1_over_phi": [0.1], "mass_flow_rate": ["2 g/s"]
    }));
    let folder = TestFolder::new(&study);
    let said = folder.stdout(&["run", "grid.json", "-q"]);
    assert!(said.contains("nothing to run, no fold pattern fits any of 2 points"), "{said}");
    assert!(
        said.contains("--columns job,reason,nearest") && !said.contains("all 0 jobs"),
        "{said}"
    );
}
