//! `billow run`, `billow table` and `billow plan`: output, exit codes, files.

use serde_json::json;

use crate::support::{TestFolder, small_grid, stderr};

#[test]
fn a_study_runs_and_reports_its_results() {
    let folder = TestFolder::new(&small_grid());
    let output = folder.run(&["run", "grid.json"]);
    assert_eq!(output.status.code(), Some(0), "{}", stderr(&output));
    let said = String::from_utf8(output.stdout.clone()).unwrap();
    assert!(said.starts_with("grid: 16 jobs run, 24 points\n"), "{said}");
    assert!(said.contains("status   16 done, 8 infeasible\n"), "{said}");
    assert!(said.contains("results  results/grid\n"), "{said}");
    assert!(said.contains("next     billow table results/grid\n"), "{said}");
    let progress = stderr(&output);
    assert!(progress.contains("16 jobs, 0 finished, 16 to run"), "{progress}");
    assert!(progress.contains("16 of 16 jobs finished, 0 failed"), "{progress}");
    assert!(!progress.contains('\u{1b}'), "no control characters without a terminal");

    let rows = folder.rows("results/grid");
    assert_eq!(rows.len(), 24);
    for row in &rows {
        let done = row["status"] == "done";
        let tall = row["M"] == 3 || row["alpha1_over_phi"].as_f64() == Some(9.0);
        assert_eq!(done, tall, "two storeys reach 1 m only at a large ratio: {row}");
        if done {
            for column in ["final_volume", "final_pressure", "phi", "top_radius", "steps"] {
                assert!(row[column].as_f64().unwrap() > 0.0, "{column}: {row}");
            }
            assert!(["deployed", "partial", "stalled"].contains(&row["verdict"].as_str().unwrap()));
            assert!(row["passages"].is_null(), "a piston has no film");
            assert!(row["ledger_residual"].as_f64().unwrap() < 1e-3, "{row}");
        } else {
            assert!(!row["reason"].as_str().unwrap().is_empty());
            assert!(row["final_volume"].is_null() && row["content_hash"].is_null());
        }
    }
}

#[test]
fn a_quiet_run_leaves_stderr_empty_and_prints_json() {
    let folder = TestFolder::new(&small_grid());
    let output = folder.run(&["run", "grid.json", "-q", "--json", "--threads", "1"]);
    assert_eq!(stderr(&output), "");
    let summary: serde_json::Value = serde_json::from_slice(&output.stdout).unwrap();
    assert_eq!(summary["ran"], 16);
    assert_eq!(summary["status"], json!({ "done": 16, "infeasible": 8 }));
}

/// The command that a failed run names lists the failed jobs, with replicates too.
#[test]
fn failed_jobs_give_exit_code_1_rows_and_a_next_step_that_works() {
    let mut study = small_grid();
    study["solver"]["step_limit"] = json!(3);
    study["replicates"] = json!({"film.thickness": ["25 um", "26 um"]});
    let folder = TestFolder::new(&study);
    for _ in 0..2 {
        let output = folder.run(&["run", "grid.json", "-q"]);
        assert_eq!(output.status.code(), Some(1), "{}", stderr(&output));
        assert!(stderr(&output).contains("32 jobs failed\n  next: billow table results/grid"));
    }
    let rows = folder.rows("results/grid");
    let failed: Vec<_> = rows.iter().filter(|row| row["status"] == "step_limit").collect();
    assert_eq!(failed.len(), 32);
    for row in failed {
        assert!(row["stop_time"].is_number() && row["content_hash"].is_string(), "{row}");
        assert!(row["verdict"].is_null(), "{row}");
    }
    let said = stderr(&folder.run(&["run", "grid.json", "-q"]));
    let command = said.lines().find_map(|line| line.split_once("next: billow "));
    let words = command.expect("a next step").1.split([' ', ';']);
    let words: Vec<&str> = words.take_while(|word| !word.is_empty()).collect();
    let table = folder.stdout(&words);
    let failed = table.lines().filter(|line| line.contains("step_limit")).count();
    assert_eq!(failed, 32, "{words:?} {table}");
}

#[test]
fn table_selects_sorts_and_filters() {
    let folder = TestFolder::finished(&small_grid());
    let csv = |more: &[&str]| folder.stdout(&[&["table", "--format", "csv"], more].concat());
    let picked =
        csv(&["--columns", "N,M,status", "--where", "N == 6 and residual_gas_mass > '0.01 g'"]);
    assert_eq!(picked.lines().count(), 7, "{picked}");
    assert_eq!(picked.lines().next(), Some("N,M,status"));
    assert!(picked.lines().skip(1).all(|line| line.starts_with("6,")));
    let sorted = csv(&["--columns", "status,N", "--sort", "N:desc,status"]);
    let lines: Vec<&str> = sorted.lines().skip(1).collect();
    assert_eq!((lines[0], lines[8], lines[23]), ("done,6", "infeasible,6", "infeasible,5"));
    let nulls_last = csv(&["--columns", "status", "--sort", "final_volume:desc"]);
    assert!(nulls_last.trim_end().ends_with("infeasible"));

    for table in [folder.stdout(&["table"]), folder.stdout(&["table", "grid.json"])] {
        assert_eq!(table.lines().count(), 26, "two lines of header, one row per point");
        assert!(table.lines().all(|line| line.chars().count() <= 120), "{table}");
        let header = table.lines().next().unwrap();
        assert!(header.starts_with("job ") && header.contains("  status "), "{header}");
    }
    // A person sees to which point a row belongs, a program the columns that it asked for.
    let header = |more: &[&str]| {
        let table = folder.stdout(&[&["table"], more].concat());
        table.lines().next().unwrap().split_whitespace().collect::<Vec<_>>().join(" ")
    };
    let of_six = ["--where", "N == 6", "--columns"];
    let varying = "M alpha1_over_phi residual_gas_mass status";
    assert_eq!(header(&[&of_six[..], &["status"]].concat()), varying);
    assert_eq!(header(&[&of_six[..], &["design.M,status"]].concat()), "design.M status");
    assert_eq!(csv(&["--columns", "status"]).lines().next(), Some("status"));
    let all = folder.stdout(&["table", "results/grid", "--columns", "all", "--format", "csv"]);
    assert_eq!(all, csv(&[]));
    // The first rows alone are built, and are those of the whole table.
    let first: Vec<&str> = all.lines().take(8).collect();
    assert_eq!(csv(&["--limit", "7"]).lines().collect::<Vec<_>>(), first);
    let limited = stderr(&folder.run(&["table", "--limit", "7"]));
    assert!(limited.contains("7 of 24 rows: --limit leaves out 17"), "{limited}");
}

#[test]
fn every_shell_has_completions() {
    let folder = TestFolder::new(&small_grid());
    for shell in ["bash", "zsh", "fish", "elvish", "powershell"] {
        let script = folder.stdout(&["completions", shell]);
        assert!(script.contains("billow") && script.contains("completions"), "{shell}");
    }
}

#[test]
fn a_folder_with_other_files_is_refused() {
    let folder = TestFolder::new(&small_grid());
    let papers = folder.path().join("papers");
    std::fs::create_dir(&papers).unwrap();
    std::fs::write(papers.join("thesis.txt"), "years of work").unwrap();
    let output = folder.run(&["run", "grid.json", "--results", "papers"]);
    assert_eq!(output.status.code(), Some(2));
    assert!(stderr(&output).contains("not a folder of results"), "{}", stderr(&output));
    assert_eq!(std::fs::read_dir(&papers).unwrap().count(), 1);
    // A page and what is published beside results that are not there yet are accepted, as in results/paper.
    std::fs::rename(papers.join("thesis.txt"), papers.join("README.md")).unwrap();
    std::fs::create_dir(papers.join("published")).unwrap();
    assert_eq!(
        folder.run(&["run", "grid.json", "--results", "papers", "-q"]).status.code(),
        Some(0)
    );
}

#[test]
fn plan_reports_finished_jobs_and_forecasts_the_rest() {
    let folder = TestFolder::new(&small_grid());
    let before = stderr(&folder.run(&["plan", "grid.json"]));
    assert!(before.contains("forecast: 16 jobs without film"), "{before}");
    assert!(!before.contains("finished already"), "{before}");
    folder.stdout(&["run", "grid.json", "-q"]);
    let after = stderr(&folder.run(&["plan", "grid.json"]));
    assert!(after.contains("results/grid: 16 of 16 jobs finished already"), "{after}");
    assert!(!after.contains("forecast"), "{after}");
    let other = ["plan", "grid.json", "--set", "solver.end_time=0.5 s"];
    let other = stderr(&folder.run(&other));
    assert!(other.contains("forecast: 16 jobs") && !other.contains("finished already"), "{other}");
}
