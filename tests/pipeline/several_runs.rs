//! One study in several runs: parts in folders of their own, runs that share a folder, scripts for a cluster.

use std::fs;
use std::thread::sleep;
use std::time::{Duration, Instant};

use serde_json::json;

use crate::interruption::signal;
use crate::support::{TestFolder, grid, small_grid, stderr, without_costs};

#[test]
fn parts_are_merged_into_the_table_of_the_whole() {
    let folder = TestFolder::new(&small_grid());
    folder.stdout(&["run", "grid.json", "-q"]);
    for part in ["1", "2", "3"] {
        let points = format!("{part}/3");
        let text =
            folder.stdout(&["run", "grid.json", "--points", &points, "--results", part, "-q"]);
        assert!(text.contains("in other parts (--points)"), "{text}");
    }
    let text = folder.stdout(&["merge", "1", "2", "--results", "all"]);
    assert!(text.contains("copied") && text.contains("next     billow run all"), "{text}");
    folder.stdout(&["merge", "1", "2", "3", "--results", "all"]);
    assert_eq!(without_costs(folder.rows("all")), without_costs(folder.rows("results/grid")));
    let status = folder.stdout(&["status", "all", "--json"]);
    fs::remove_file(folder.path().join("all/index.json")).unwrap();
    assert_eq!(folder.stdout(&["status", "all", "--json"]), status);
    assert!(
        folder.stdout(&["run", "grid.json", "--results", "all", "-q"]).contains("nothing to run")
    );
    folder.stdout(&["doctor", "all"]);
}

#[test]
fn what_cannot_be_merged_or_run_in_parts_is_refused() {
    let folder = TestFolder::new(&small_grid());
    folder.stdout(&["run", "grid.json", "--results", "one", "-q"]);
    folder.stdout(&["run", "grid.json", "--set", "grid.N=[5]", "--results", "two", "-q"]);
    let cases: [(&[&str], &str); 7] = [
        (&["merge", "one", "two", "--results", "all"], "two: not results of the study"),
        (&["merge", "one", "two"], "none into which they are joined"),
        (&["merge", "nothing"], "no results here"),
        (&["run", "grid.json", "--points", "4/3"], "--points = \"4/3\": is no part"),
        (&["run", "grid.json", "--chunk", "0001/1", "--shared"], "there is no"),
        (&["run", "grid.json", "--results", "two", "--shared"], "another version of this study"),
        (&["submit", "grid.json", "--time", "soon"], "--time = \"soon\""),
    ];
    for (arguments, expected) in cases {
        let output = folder.run(arguments);
        let text = stderr(&output);
        assert_eq!(output.status.code(), Some(2), "{arguments:?}: {text}");
        let found = text.contains(expected) || text.contains(&expected.replace('"', ""));
        assert!(found && text.contains("\n  "), "{arguments:?}: {text}");
    }
    assert!(!folder.path().join("all").exists());
}

#[test]
#[ignore = "waits two minutes for the lease of a dead run"]
fn runs_that_share_a_folder_give_one_table_although_one_is_killed() {
    let flows: Vec<f64> = (1..=400).map(|flow| 0.00002 * f64::from(flow)).collect();
    let mut study =
        grid(&json!({ "N": [5, 6], "M": [3], "alpha1_over_phi": [0.8], "mass_flow_rate": flows }));
    study["outputs"] = json!({ "sample_interval": "0.1 ms" });
    let folder = TestFolder::new(&study);
    folder.stdout(&["run", "grid.json", "--results", "whole", "-q"]);
    let shared = ["run", "grid.json", "--shared", "--threads", "1", "-q"];
    let mut killed = folder.billow(&shared).spawn().unwrap();
    let start = Instant::now();
    while fs::read_dir(folder.results().join("claims")).map_or(0, Iterator::count) < 1 {
        assert!(start.elapsed() < Duration::from_mins(1), "no run began");
        sleep(Duration::from_millis(1));
    }
    sleep(Duration::from_millis(30));
    let other = folder.billow(&shared).spawn().unwrap();
    assert!(killed.try_wait().unwrap().is_none(), "it ended before it was killed");
    signal(&killed, "-9");
    killed.wait().unwrap();
    let refused = folder.run(&["run", "grid.json", "-q"]);
    assert!(stderr(&refused).contains("--shared"), "{}", stderr(&refused));
    let output = other.wait_with_output().unwrap();
    assert!(output.status.success(), "{}", stderr(&output));
    // The other run waits for the lease of the dead one, then has its job.
    folder.stdout(&["merge", "results/grid", "-q"]);
    assert_eq!(without_costs(folder.rows("results/grid")), without_costs(folder.rows("whole")));
    let status = folder.stdout(&["status", "grid.json", "--json"]);
    let status: serde_json::Value = serde_json::from_str(&status).unwrap();
    assert_eq!((&status["pending"], &status["workers"]["runs"]), (&json!(0), &json!([])));
}

#[test]
fn the_scripts_for_a_cluster_are_printed_without_one() {
    let folder = TestFolder::new(&small_grid());
    let text = folder.stdout(&[
        "submit",
        "grid.json",
        "--dry-run",
        "--tasks",
        "3",
        "--time",
        "90 min",
        "--mem",
        "2 GiB",
        "--sbatch=--account=film",
    ]);
    for line in [
        "#SBATCH --array=1-3",
        "#SBATCH --time=01:30:00",
        "#SBATCH --mem=2048M",
        "#SBATCH --account=film",
    ] {
        assert!(text.lines().any(|found| found == line), "{line}: {text}");
    }
    assert!(
        text.contains("--shared --chunk 0001/\"$SLURM_ARRAY_TASK_ID\"") && text.contains(" merge ")
    );
    assert!(!folder.results().exists());
    // As Slurm writes time and memory.
    let of_slurm = ["--tasks", "3", "--time", "1:30:00", "--mem", "2G", "--sbatch=--account=film"];
    let same = folder.stdout(&[&["submit", "grid.json", "--dry-run"], &of_slurm[..]].concat());
    assert_eq!(same, text);
    folder.stdout(&["run", "grid.json", "-q"]);
    let output = folder.run(&["submit", "grid.json", "--dry-run"]);
    assert!(stderr(&output).contains("nothing to submit"), "{}", stderr(&output));
}
