//! `status` and `job` read what is stored.

use std::fs;

use billow_solver::platform::seal;
use billow_study::input::value::brief_number;
use billow_study::platform::files::{Disk, Files};
use billow_study::store::history_file;
use serde_json::{Value, json};

use crate::support::{TestFolder, failed, file_of, grid, ids, json_of, paper_design, ran};

#[test]
fn status_counts_agree_with_the_table() {
    let folder = ran();
    let status = json_of(&folder, &["status"]);
    for (key, expected) in [
        ("points", 24),
        ("jobs", 16),
        ("done", 16),
        ("failed", 0),
        ("pending", 0),
        ("infeasible", 8),
        ("broken", 0),
    ] {
        assert_eq!(status[key], expected, "{key}: {status}");
    }
    assert_eq!(status["running"], false);
    let rows = folder.rows("results/grid");
    let wall: f64 = rows.iter().filter_map(|row| row["wall_seconds"].as_f64()).sum();
    assert!((status["job_seconds"].as_f64().unwrap() - wall).abs() < 1e-9);
    assert!(folder.stdout(&["status", "grid.json"]).starts_with("grid: finished\n"));

    // An invalidated job is pending again; the remaining time is the mean time of the jobs that ran.
    let journal = folder.results().join("journal/000001.jsonl");
    let text = fs::read_to_string(&journal).unwrap();
    let id = &ids(&folder, "done")[0];
    let line = seal::seal(&format!("{{\"kind\":\"invalidated\",\"job\":\"{id}\"}}"));
    fs::write(&journal, format!("{text}{line}\n")).unwrap();
    let status = json_of(&folder, &["status", "--threads", "1"]);
    assert_eq!(
        (&status["done"], &status["pending"], &status["invalidated"]),
        (&json!(15), &json!(1), &json!(1))
    );
    assert_eq!(status["remaining_seconds"], status["mean_job_seconds"]);
    let said = folder.stdout(&["status"]);
    assert!(said.contains("15 done, 0 failed, 1 pending (1 invalidated)"), "{said}");
    assert!(said.contains("remaining about "), "{said}");
    assert!(said.contains("job time") && said.contains("the sum over"), "{said}");
}

#[test]
fn status_works_under_the_lock_of_another_process() {
    let folder = ran();
    let lock = Disk.try_lock(&folder.results().join("lock")).unwrap().unwrap();
    assert_eq!(json_of(&folder, &["status"])["running"], true);
    assert!(folder.stdout(&["status"]).starts_with("grid: running, by another process"));
    let again = ["run", "grid.json", "--again", &ids(&folder, "done")[0], "-q"];
    folder.refuses(&again, "another billow command is running");
    drop(lock);
    // A running `status` does not prevent a run.
    let mut observer = folder.billow(&["status"]).spawn().unwrap();
    folder.stdout(&["run", "grid.json", "-q"]);
    assert!(observer.wait().unwrap().success());
}

#[test]
fn status_reports_damage_in_one_line_and_counts_the_rest() {
    let folder = ran();
    let journal = folder.results().join("journal/000001.jsonl");
    let text = fs::read_to_string(&journal).unwrap();
    fs::write(&journal, format!("{text}hello\nhello\n")).unwrap();
    let status = json_of(&folder, &["status"]);
    assert_eq!((&status["done"], &status["broken"]), (&json!(16), &json!(2)));
    let said = folder.stdout(&["status"]);
    assert!(said.contains("line 19: it has no checksum"), "{said}");
    assert!(said.contains("and 1 more; next: billow doctor results/grid"), "{said}");
}

#[test]
fn job_explains_a_verdict_with_its_numbers() {
    let folder = ran();
    for row in folder.rows("results/grid").iter().filter(|row| row["status"] == "done") {
        let id = row["job"].as_str().unwrap();
        let explained = json_of(&folder, &["job", &id[..7]]);
        for column in [
            "job",
            "status",
            "verdict",
            "near_threshold",
            "volume_ratio",
            "deployed_volume_threshold",
            "ledger_residual",
            "passages",
        ] {
            assert_eq!(explained[column], row[column], "{column}");
        }
        let said = folder.stdout(&["job", id]);
        assert!(said.contains("done, deployed") && said.contains("height_ratio"), "{said}");
        assert!(said.contains("≤ 0.01") && said.contains("counted by this model"), "{said}");
        assert!(said.contains(&format!("next      billow job {}", &id[..8])), "{said}");
    }
}

#[test]
fn job_judges_a_job_by_the_limits_as_the_table_does() {
    let mut study = grid(&json!({"N": [6], "M": [3], "alpha1_over_phi": [1],
        "mass_flow_rate": ["1 g/s", "2 g/s"]}));
    study["limits"] = json!({"peak_vz": "< 24 m/s", "verdict": "deployed"});
    let folder = TestFolder::finished(&study);
    let rows = folder.rows("results/grid");
    // The error of the piston is not known: it meets no limit for certain.
    let safety: Vec<&str> = rows.iter().map(|row| row["safety"].as_str().unwrap()).collect();
    assert_eq!(safety, ["uncertain", "unsafe"], "{rows:?}");
    for row in &rows {
        let id = row["job"].as_str().unwrap();
        let explained = json_of(&folder, &["job", id]);
        let limit = &explained["limits"][0];
        assert_eq!(
            (&limit["measure"], &limit["condition"]),
            (&json!("peak_vz"), &json!("< 24 m/s"))
        );
        assert_eq!(
            (&explained["safety"], &limit["safety"], &limit["value"], &limit["margin"]),
            (&row["safety"], &row["safety"], &row["peak_vz"], &row["margin_peak_vz"])
        );
        let said = folder.stdout(&["job", id]);
        let slow = row["safety"] == "uncertain";
        let flow = if slow { "1 g/s): done" } else { "2 g/s): done" };
        let side = if slow { "% below 24 m/s" } else { "% above 24 m/s" };
        assert!(said.contains(side) && said.contains("its error is not known"), "{said}");
        assert!(said.contains(flow), "parameters have the units of the study: {said}");
    }
}

#[test]
fn job_reports_failures_and_infeasible_points_with_time_place_and_nearest() {
    let folder = failed();
    let failed = ids(&folder, "step_limit").remove(0);
    let said = folder.stdout(&["job", &failed]);
    assert!(said.contains("step_limit: the run used all steps"), "{said}");
    assert!(said.contains("\n  time ") && said.contains("\n  location "), "{said}");
    assert!(said.contains("try       more steps: solver.step_limit"), "{said}");
    let infeasible = ids(&folder, "infeasible").remove(0);
    let said = folder.stdout(&["job", &infeasible, "results/grid"]);
    assert!(
        said.contains("no fold pattern exists for this design") && said.contains("nearest"),
        "{said}"
    );
    let rows = folder.rows("results/grid");
    let row = rows.iter().find(|row| row["job"] == infeasible.as_str()).unwrap();
    assert_eq!(json_of(&folder, &["job", &infeasible])["nearest"], row["nearest"]);
}

#[test]
fn job_ids_may_be_unique_prefixes() {
    let folder = ran();
    let mut all = ids(&folder, "done");
    all.sort();
    folder.refuses(&["job", ""], "no job has this id");
    folder.refuses(&["job", &format!("{}0000000", &all[0][..8])], &all[0][..8]);
    // 24 ids share 16 first digits.
    let known = [all, ids(&folder, "infeasible")].concat();
    let count = |first: &str| known.iter().filter(|id| id.starts_with(first)).count();
    let first = known.iter().map(|id| &id[..1]).max_by_key(|first| count(first)).unwrap();
    folder.refuses(&["job", first], &format!("{} job ids begin so", count(first)));
}

#[test]
fn job_prints_the_stored_row_scene_and_history() {
    let folder = ran();
    let row = folder.rows("results/grid").into_iter().find(|row| row["status"] == "done").unwrap();
    let id = row["job"].as_str().unwrap();
    let shown = json_of(&folder, &["job", id, "--all"]);
    let shown = shown.as_array().unwrap();
    let of = |name: &str| shown.iter().find(|row| row["name"] == name);
    for (column, value) in row.as_object().unwrap() {
        assert_eq!(of(column).map_or(&Value::Null, |row| &row["value"]), value, "{column}");
    }
    assert_eq!(of("mass_flow_rate").unwrap()["unit"], "kg/s");
    assert_eq!(of("peak_vz").unwrap()["unit"], "m/s");

    let scene: Value = serde_json::from_str(&folder.stdout(&["job", id, "--scene"])).unwrap();
    assert_eq!(scene["design"]["N"], row["N"]);
    let stored = billow_study::store::history_file::read(&file_of(&folder, id)).unwrap();
    assert_eq!(scene, serde_json::from_str::<Value>(&stored.scene).unwrap());

    let samples = stored.history.len();
    let every = json_of(&folder, &["job", id, "--history"]);
    let every = every.as_array().unwrap();
    assert_eq!(every.len(), samples);
    for (column, values) in stored.history.iter() {
        let printed = every.iter().map(|row| row[column.name].as_f64().unwrap());
        assert!(printed.eq(values.iter().copied()), "{}", column.name);
    }
    let options = ["--columns", "time,pressure", "--every", "100", "--format", "csv"];
    let thin = folder.stdout(&[&["job", id, "--history"], &options[..]].concat());
    let lines: Vec<&str> = thin.lines().collect();
    assert_eq!((lines[0], lines.len()), ("time,pressure", 8), "0.6 s by 0.1 s");
    let last = ["time", "pressure"].map(|name| stored.history.column(name)[samples - 1]);
    assert_eq!(lines[7], format!("{},{}", last[0], last[1]), "the last sample is always shown");
    let infeasible = &ids(&folder, "infeasible")[0];
    folder.refuses(&["job", infeasible, "--history"], "the point is infeasible");
    std::fs::write(file_of(&folder, id), "no history").unwrap();
    let said = folder.stdout(&["job", id, "--all"]);
    assert!(said.contains("\nhistory "), "a line says what the file has: {said}");
}

#[test]
fn job_reports_a_run_that_ends_in_motion() {
    let axes = json!({"N": [6], "M": [3], "alpha1_over_phi": [1], "mass_flow_rate": ["2 g/s"]});
    let mut study = grid(&axes);
    study["solver"]["end_time"] = json!("20 ms");
    let folder = TestFolder::finished(&study);
    let said = folder.stdout(&["job", &ids(&folder, "done")[0]]);
    for words in
        ["done, stalled", "motion    in the last tenth", "next      a longer solver.end_time"]
    {
        assert!(said.contains(words), "{words}: {said}");
    }
}

#[test]
fn job_says_from_when_on_the_pressure_was_uniform() {
    let folder = TestFolder::finished(&json!({
        "design": paper_design(2),
        "gas": { "residual_gas_mass": "0.05 g", "mass_flow_rate": 0 },
        "solver": { "model": "film", "end_time": "30 ms" },
        "outputs": { "sample_interval": "1 ms" },
        "grid": { "film.compression": [0] }
    }));
    let id = folder.rows("results/grid")[0]["job"].as_str().unwrap().to_owned();
    let stored = history_file::read(&file_of(&folder, &id)).unwrap();
    let [fractions, gaps] =
        ["pinched_volume_fraction", "pleat_gap"].map(|name| &stored.tracks[name]);
    // The bottom pleat of the stowed capsule is 40 mm/6 high.
    assert!((gaps[0] - 0.04 / 6.0).abs() < 3e-4, "{}", gaps[0]);
    let last = fractions.iter().rposition(|fraction| *fraction > 0.0).unwrap();
    assert!(fractions.iter().all(|fraction| (0.0..=1.0).contains(fraction)) && last > 2);
    let said = folder.stdout(&["job", &id]);
    let time = brief_number(stored.history.column("time")[last + 1]);
    assert!(said.contains(&format!("pressure  uniform within 10 % from {time} s on")), "{said}");
}
