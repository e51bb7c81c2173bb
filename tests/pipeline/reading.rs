//! What is stored is read: `status`, `why`, `show`.

use std::fs;

use billow_study::platform::files::{Disk, Files};
use serde_json::{Value, json};

use crate::support::{Desk, failed, file_of, grid, ids, json_of, ran, small_grid, stderr};

#[test]
fn status_counts_what_the_table_holds() {
    let desk = ran();
    let status = json_of(&desk, &["status"]);
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
    let rows = desk.rows("results/grid");
    let wall: f64 = rows.iter().filter_map(|row| row["wall_seconds"].as_f64()).sum();
    assert!((status["wall_seconds"].as_f64().unwrap() - wall).abs() < 1e-9);
    assert!(desk.stdout(&["status", "grid.json"]).starts_with("grid: finished\n"));

    // An invalidated job is pending again; the remaining time is the mean time of the jobs that ran.
    let journal = desk.results().join("journal/000001.jsonl");
    let text = fs::read_to_string(&journal).unwrap();
    let id = &ids(&desk, "done")[0];
    let line = format!("{{\"kind\":\"invalidated\",\"job\":\"{id}\"}}\n");
    fs::write(&journal, format!("{text}{line}")).unwrap();
    let status = json_of(&desk, &["status", "--threads", "1"]);
    assert_eq!(
        (&status["done"], &status["pending"], &status["invalidated"]),
        (&json!(15), &json!(1), &json!(1))
    );
    assert_eq!(status["remaining_seconds"], status["mean_wall_seconds"]);
    let said = desk.stdout(&["status"]);
    assert!(said.contains("15 done, 0 failed, 1 pending (1 invalidated)"), "{said}");
    assert!(said.contains("remaining about "), "{said}");
}

#[test]
fn status_works_while_another_process_holds_the_lock_and_leaves_it_alone() {
    let desk = ran();
    let lock = Disk.try_lock(&desk.results().join("lock")).unwrap().unwrap();
    assert_eq!(json_of(&desk, &["status"])["running"], true);
    assert!(desk.stdout(&["status"]).starts_with("grid: running: another process holds its lock"));
    let refused = desk.run(&["rerun", &ids(&desk, "done")[0], "-q"]);
    assert_eq!(refused.status.code(), Some(2));
    assert!(stderr(&refused).contains("another billow command is running"), "{}", stderr(&refused));
    drop(lock);
    // Looking on does not keep a run from starting.
    let mut watch = desk.billow(&["status"]).spawn().unwrap();
    desk.stdout(&["run", "grid.json", "-q"]);
    assert!(watch.wait().unwrap().success());
}

#[test]
fn status_says_in_one_line_what_is_broken_and_counts_around_it() {
    let desk = ran();
    fs::remove_file(file_of(&desk, &ids(&desk, "done")[3])).unwrap();
    let journal = desk.results().join("journal/000001.jsonl");
    let text = fs::read_to_string(&journal).unwrap();
    fs::write(&journal, format!("{text}hello\n")).unwrap();
    let status = json_of(&desk, &["status"]);
    assert_eq!((&status["done"], &status["broken"]), (&json!(16), &json!(2)));
    let said = desk.stdout(&["status"]);
    assert!(said.contains("line 18: not a journal record"), "{said}");
    assert!(said.contains("and 1 more; next: billow doctor results/grid"), "{said}");
}

#[test]
fn why_gives_the_numbers_behind_a_verdict() {
    let desk = ran();
    for row in desk.rows("results/grid").iter().filter(|row| row["status"] == "done") {
        let id = row["job"].as_str().unwrap();
        let why = json_of(&desk, &["why", &id[..7]]);
        for column in ["job", "status", "verdict", "near_threshold", "ledger_residual", "passages"]
        {
            assert_eq!(why[column], row[column], "{column}");
        }
        let check = &why["checks"][0];
        assert_eq!(
            (&check["measure"], &check["value"]),
            (&json!("volume_ratio"), &row["volume_ratio"])
        );
        let (value, least) = (check["value"].as_f64().unwrap(), check["least"].as_f64().unwrap());
        assert_eq!(check["margin"], json!(value / least - 1.0));
        let said = desk.stdout(&["why", id]);
        assert!(said.contains("done, deployed") && said.contains("height_ratio"), "{said}");
        assert!(said.contains("≤ 0.01") && said.contains("counted by this model"), "{said}");
        assert!(said.contains(&format!("next      billow show {}", &id[..8])), "{said}");
    }
    // A stall: the gas is not enough to fill it.
    let mut study = grid(&json!({"N": [6], "M": [3], "alpha1_over_phi": [1]}));
    study["gas"] = json!({"mass_flow_rate": "0.01 g/s"});
    let desk = Desk::new(&study);
    desk.stdout(&["run", "grid.json", "-q"]);
    let id = ids(&desk, "done").remove(0);
    let row = desk.rows("results/grid").remove(0);
    let said = desk.stdout(&["why", &id]);
    let verdict = row["verdict"].as_str().unwrap();
    assert_ne!(verdict, "deployed", "{row}");
    assert!(
        said.contains(&format!("done, {verdict}")) && said.contains("volume_ratio 0."),
        "{said}"
    );
}

#[test]
fn why_tells_failures_and_infeasible_points_with_time_place_and_nearest() {
    let desk = failed();
    let failed = ids(&desk, "step_limit").remove(0);
    let said = desk.stdout(&["why", &failed]);
    assert!(said.contains("step_limit: the run used all steps"), "{said}");
    assert!(said.contains("\n  time ") && said.contains("\n  location "), "{said}");
    assert!(said.contains("raise solver.step_limit"), "{said}");
    let infeasible = ids(&desk, "infeasible").remove(0);
    let said = desk.stdout(&["why", &infeasible, "results/grid"]);
    assert!(
        said.contains("no fold pattern exists for this design") && said.contains("nearest"),
        "{said}"
    );
    let rows = desk.rows("results/grid");
    let row = rows.iter().find(|row| row["job"] == infeasible.as_str()).unwrap();
    assert_eq!(json_of(&desk, &["why", &infeasible])["nearest"], row["nearest"]);
}

#[test]
fn ids_are_any_unique_prefix_and_others_are_refused_with_the_nearest() {
    let desk = ran();
    let mut all = ids(&desk, "done");
    all.sort();
    for (arguments, expected) in [
        (["why", "zzz"], "no job has this id"),
        (["show", ""], "no job has this id"),
        (["rerun", "fffffffffffffffffffffffffffffffff0"], "neither a study file"),
        (["why", &format!("{}0000000", &all[0][..8])], &all[0][..8]),
    ] {
        let output = desk.run(&arguments);
        assert_eq!(output.status.code(), Some(2), "{arguments:?}");
        assert!(stderr(&output).contains(expected), "{arguments:?}: {}", stderr(&output));
    }
    let known: Vec<String> = desk
        .rows("results/grid")
        .iter()
        .map(|row| row["job"].as_str().unwrap().to_owned())
        .collect();
    let (first, count) = (0..16)
        .map(|digit| format!("{digit:x}"))
        .map(|first| (first.clone(), known.iter().filter(|id| id.starts_with(&first)).count()))
        .max_by_key(|(_, count)| *count)
        .unwrap();
    assert!(count > 1, "24 ids share 16 first digits");
    let output = desk.run(&["why", &first]);
    assert!(stderr(&output).contains(&format!("{count} job ids begin so")), "{}", stderr(&output));
}

#[test]
fn show_prints_the_row_the_scene_and_the_history_that_are_stored() {
    let desk = ran();
    let row = desk.rows("results/grid").into_iter().find(|row| row["status"] == "done").unwrap();
    let id = row["job"].as_str().unwrap();
    let shown = json_of(&desk, &["show", id]);
    let shown = shown.as_array().unwrap();
    let of = |group: &str, name: &str| {
        shown.iter().find(|own| own["group"] == group && own["name"] == name)
    };
    for (column, value) in row.as_object().unwrap() {
        let groups =
            ["job", "parameters", "outcome", "measures", "audit", "pattern", "cost", "provenance"];
        let found = groups.iter().find_map(|group| of(group, column));
        assert_eq!(found.map_or(&Value::Null, |own| &own["value"]), value, "{column}");
    }
    assert_eq!(of("parameters", "mass_flow_rate").unwrap()["unit"], "kg/s");
    assert_eq!(of("measures", "peak_vz").unwrap()["unit"], "m/s");
    assert!(of("scene", "film.youngs_modulus").unwrap()["value"].as_f64().unwrap() > 1e9);

    let scene: Value = serde_json::from_str(&desk.stdout(&["show", id, "--scene"])).unwrap();
    assert_eq!(scene["design"]["N"], row["N"]);
    let stored = billow_study::store::history_file::read(&file_of(&desk, id)).unwrap();
    assert_eq!(scene, serde_json::from_str::<Value>(&stored.scene).unwrap());

    let samples = stored.history.len();
    let every = json_of(&desk, &["show", id, "--history"]);
    assert_eq!(every.as_array().unwrap().len(), samples);
    for (at, row) in every.as_array().unwrap().iter().enumerate() {
        for (column, values) in stored.history.iter() {
            assert_eq!(row[column.name].as_f64(), Some(values[at]), "{} at {at}", column.name);
        }
    }
    let thin = desk.stdout(&[
        "show",
        id,
        "--history",
        "--columns",
        "time,pressure",
        "--every",
        "100",
        "--format",
        "csv",
    ]);
    let lines: Vec<&str> = thin.lines().collect();
    assert_eq!(lines[0], "time,pressure");
    let last = format!(
        "{},{}",
        stored.history.column("time")[samples - 1],
        stored.history.column("pressure")[samples - 1]
    );
    assert_eq!(*lines.last().unwrap(), last, "the last sample is always shown");
    assert_eq!(
        lines.len(),
        1 + samples.div_ceil(100) + usize::from(!(samples - 1).is_multiple_of(100))
    );
    for (arguments, expected) in [
        (&["show", id, "--history", "--columns", "presure"][..], "did you mean pressure?"),
        (&["show", id, "--history", "--every", "0"], "must be positive"),
        (&["show", &ids(&desk, "infeasible")[0], "--history"], "the point is infeasible"),
    ] {
        let output = desk.run(arguments);
        assert_eq!(output.status.code(), Some(2));
        assert!(stderr(&output).contains(expected), "{}", stderr(&output));
    }
}

#[test]
fn a_folder_without_results_is_one_clear_error_for_every_command() {
    let desk = Desk::new(&small_grid());
    fs::create_dir(desk.path().join("empty")).unwrap();
    for command in [
        &["status", "empty"][..],
        &["why", "ab", "empty"],
        &["show", "ab", "empty"],
        &["rerun", "ab", "empty/"],
        &["compare", "empty", "--by", "N", "--base", "5"],
        &["doctor", "empty"],
        &["doctor", "."],
        &["status", "nowhere"],
        &["status"],
    ] {
        let output = desk.run(command);
        assert_eq!(output.status.code(), Some(2), "{command:?}: {}", stderr(&output));
        assert!(stderr(&output).contains("next: "), "{command:?}: {}", stderr(&output));
        assert!(output.stdout.is_empty());
    }
    assert_eq!(
        fs::read_dir(desk.path().join("empty")).unwrap().count(),
        0,
        "nothing is left there"
    );
}

#[test]
fn a_run_that_ends_on_its_way_is_told_from_one_that_stands() {
    let axes = json!({"N": [6], "M": [3], "alpha1_over_phi": [1], "mass_flow_rate": ["2 g/s"]});
    let mut study = grid(&axes);
    study["solver"]["end_time"] = json!("20 ms");
    let desk = Desk::new(&study);
    desk.stdout(&["run", "grid.json", "-q"]);
    let said = desk.stdout(&["why", &ids(&desk, "done")[0]]);
    for words in
        ["done, stalled", "motion    in the last tenth", "next      a longer solver.end_time"]
    {
        assert!(said.contains(words), "{words}: {said}");
    }
}

#[test]
fn results_in_place_of_a_job_are_told() {
    let desk = ran();
    for command in ["why", "show", "frames"] {
        let output = desk.run(&[command, "results/grid"]);
        assert_eq!(output.status.code(), Some(2), "{command}");
        let said = stderr(&output);
        assert!(said.contains("is a results folder or study file, not a job"), "{command}: {said}");
    }
}
