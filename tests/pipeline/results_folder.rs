//! Results folders with missing, damaged or foreign files.

use std::collections::BTreeSet;
use std::fs;

use billow_study::store::history_file;
use serde_json::json;

use crate::support::{TestFolder, grid, histories, json_of, ran, small_grid, stderr};

#[test]
fn histories_agree_with_the_table() {
    let folder = ran();
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
fn a_job_has_the_same_history_in_every_study() {
    let mut study = small_grid();
    study["grid"]["N"] = json!([6]);
    study["grid"]["M"] = json!([3, 2]);
    let (all, some) = (histories(&ran().results()), TestFolder::finished(&study));
    let some = histories(&some.results());
    assert_eq!((all.len(), some.len()), (16, 8));
    assert_eq!(all.values().collect::<BTreeSet<_>>().len(), 16, "different jobs, different files");
    for (name, bytes) in some {
        assert_eq!(all.get(&name), Some(&bytes), "{}", name.display());
    }
}

#[test]
fn a_run_with_another_set_says_what_changed_and_keeps_every_job() {
    let folder = ran();
    let said = folder.run(&["run", "grid.json", "--set", "solver.end_time=0.3"]);
    let note = "last run for another form of this study (solver.end_time 0.6 s → 0.3 s)";
    assert!(stderr(&said).contains(note), "{}", stderr(&said));
    let table = stderr(&folder.run(&["table", "grid.json"]));
    assert!(table.contains("(solver.end_time 0.3 s → 0.6 s)"), "{table}");
    let same = folder.run(&["table", "grid.json", "--set", "solver.end_time=0.3"]);
    assert!(!stderr(&same).contains("is not the study"), "{}", stderr(&same));
    // Back to the first form: nothing is computed again.
    assert!(folder.stdout(&["run", "grid.json", "-q"]).contains("nothing to run, all 16 jobs"));
}

#[test]
fn a_study_or_a_folder_with_another_name_is_found_beside() {
    let folder = ran();
    let rename = |from: &str, to: &str| {
        fs::rename(folder.path().join(from), folder.path().join(to)).unwrap();
    };
    rename("grid.json", "new.json");
    let key = "note: results/grid holds jobs of this study, results/new holds none: to use them, give \"name\": \
               \"grid\" in the study file\n";
    let said = stderr(&folder.run(&["plan", "new.json"]));
    assert!(said.contains(key), "{said}");
    // A command that only reads says it once, as its error.
    for command in ["table", "status"] {
        let refused = "results/new: no results here; results/grid holds jobs of this study\n  next: give \"name\": \
                       \"grid\" in the study file";
        folder.refuses(&[command, "new.json"], refused);
    }
    let refused = "if it is this study under an earlier name, give \"name\": \"grid\"";
    folder.refuses(&["run", "new.json", "--results", "results/grid"], refused);
    let said = stderr(&folder.run(&["plan", "new.json", "--set", "name=grid"]));
    assert!(said.contains("16 of 16 jobs finished") && !said.contains("holds none"), "{said}");
    rename("new.json", "grid.json");
    rename("results/grid", "results/old");
    let option = "holds none: to use them, give --results results/old\n";
    let ran_again = folder.run(&["run", "grid.json", "--points", "1/16"]);
    assert!(stderr(&ran_again).contains(option), "{}", stderr(&ran_again));
    let said = stderr(&folder.run(&["plan", "grid.json"]));
    assert!(!said.contains("holds none"), "it holds jobs now: {said}");
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

#[test]
fn a_cube_holds_every_done_job() {
    let folder = ran();
    let rows = json_of(&folder, &["export", "results/grid", "--out", "grid.nc"]);
    let row = &rows.as_array().unwrap()[0];
    let all = folder.rows("results/grid");
    let done = all.iter().filter(|row| row["status"] == "done").count();
    assert_eq!((row["file"].as_str(), &row["points"]), (Some("grid.nc"), &json!(all.len())));
    assert_eq!((&row["times"], &row["histories"]), (&json!(601), &json!(done)));
    let file = fs::read(folder.path().join("grid.nc")).unwrap();
    assert_eq!(&file[..8], b"\x89HDF\r\n\x1a\n");
    // The same results and program give the same bytes.
    folder.stdout(&["export", "results/grid", "--out", "again.h5"]);
    assert_eq!(fs::read(folder.path().join("again.h5")).unwrap(), file);
    let few = json_of(&folder, &["export", "--out", "few.nc", "--columns", "z_rim,volume"]);
    assert!(few[0]["variables"].as_u64() < row["variables"].as_u64());
}
