//! Results folders that are not as they should be.

use std::fs;

use billow_study::store::history_file;

use crate::support::{Desk, small_grid, stderr};

fn ran() -> Desk {
    let desk = Desk::new(&small_grid());
    desk.stdout(&["run", "grid.json", "-q"]);
    desk
}

#[test]
fn histories_hold_what_the_table_says() {
    let desk = ran();
    let mut seen = 0;
    for row in desk.rows("results/grid") {
        let Some(hash) = row["content_hash"].as_str() else { continue };
        let id = row["job"].as_str().unwrap();
        let path = desk.results().join(format!("jobs/{}/{id}.h5", &id[..2]));
        let stored = history_file::read(&path).unwrap();
        assert_eq!(stored.content_hash, hash);
        assert_eq!(history_file::hash_of(&stored.history, &[], None), hash);
        let last = |column: &str| stored.history.column(column).last().copied();
        assert_eq!(last("volume"), row["final_volume"].as_f64());
        assert_eq!(last("pressure"), row["final_pressure"].as_f64());
        assert_eq!(last("z_rim"), row["final_z_rim"].as_f64());
        let time = stored.history.column("time");
        assert!(time.windows(2).all(|pair| pair[0] < pair[1]), "time grows");
        assert_eq!((time[0], time[time.len() - 1]), (0.0, 0.6));
        seen += 1;
    }
    assert_eq!(seen, 16);
}

#[test]
fn a_lost_table_is_written_again_and_a_foreign_one_refused() {
    let desk = ran();
    let path = desk.results().join("summary.parquet");
    let table = fs::read(&path).unwrap();
    fs::write(&path, b"somebody else's").unwrap();
    let output = desk.run(&["table"]);
    assert_eq!(output.status.code(), Some(2));
    assert!(stderr(&output).contains("not a Parquet file"), "{}", stderr(&output));
    for damage in [false, true] {
        if damage {
            fs::write(&path, &table[..table.len() / 2]).unwrap();
        } else {
            fs::remove_file(&path).unwrap();
        }
        desk.stdout(&["run", "grid.json", "-q"]);
        assert_eq!(fs::read(&path).unwrap(), table);
    }
}

#[test]
fn newer_and_foreign_journals_are_refused_by_file_and_line() {
    let desk = ran();
    let path = desk.results().join("journal/000001.jsonl");
    let sound = fs::read_to_string(&path).unwrap();
    for (text, expected) in [
        (sound.replacen("\"version\":3", "\"version\":7", 1), "journal of version 7"),
        (format!("{sound}not ours\n"), "line 18: not a journal record"),
        (String::from("{}\n"), "line 1: not the header"),
    ] {
        fs::write(&path, text).unwrap();
        let output = desk.run(&["run", "grid.json", "-q"]);
        assert_eq!(output.status.code(), Some(2));
        assert!(stderr(&output).contains(expected), "{}", stderr(&output));
        assert!(stderr(&output).contains("000001.jsonl"), "{}", stderr(&output));
    }
    fs::write(&path, sound).unwrap();
    assert!(desk.stdout(&["run", "grid.json"]).contains("nothing to run"));
}

#[test]
fn a_results_path_that_is_a_file_is_one_clear_error() {
    let desk = Desk::new(&small_grid());
    fs::write(desk.path().join("taken"), b"").unwrap();
    let output = desk.run(&["run", "grid.json", "-q", "--results", "taken"]);
    assert_eq!(output.status.code(), Some(2));
    assert!(stderr(&output).starts_with("billow: taken: "), "{}", stderr(&output));
    assert_eq!(fs::read(desk.path().join("taken")).unwrap(), b"");
}

#[test]
fn a_folder_of_another_study_is_refused_and_a_grown_one_goes_on() {
    let desk = ran();
    let mut study = small_grid();
    study["name"] = serde_json::json!("other");
    fs::write(desk.path().join("other.json"), study.to_string()).unwrap();
    let output = desk.run(&["run", "other.json", "--results", "results/grid"]);
    assert_eq!(output.status.code(), Some(2));
    assert!(stderr(&output).contains("results of the study \"grid\", not of \"other\""));

    let mut study = small_grid();
    study["grid"]["mass_flow_rate"] = serde_json::json!(["2 g/s", "3 g/s"]);
    fs::write(desk.path().join("grid.json"), study.to_string()).unwrap();
    let said = desk.stdout(&["run", "grid.json", "-q"]);
    assert!(said.starts_with("grid: 16 jobs run, 48 points\n"), "{said}");
}
