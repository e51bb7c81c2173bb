//! One study in several runs: parts in folders of their own, tasks and scripts for a cluster.

use serde_json::json;

use crate::support::{TestFolder, json_of, small_grid, stderr, without_costs};

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
    assert!(
        folder.stdout(&["run", "grid.json", "--results", "all", "-q"]).contains("nothing to run")
    );
    folder.stdout(&["doctor", "all"]);
}

/// The command of the array of `billow submit`, run here for each task; the queue is not asked.
#[test]
fn tasks_store_parts_of_the_missing_jobs_and_are_merged() {
    let folder = TestFolder::new(&small_grid());
    folder.stdout(&["run", "grid.json", "--results", "whole", "-q"]);
    folder.stdout(&["run", "grid.json", "--points", "1/4", "-q"]);
    let root = "results/grid";
    let ran = |task: &str| -> u64 {
        let (points, part) = (format!("{task}/2"), format!("{root}/parts/{task}-2"));
        let arguments = ["run", root, "--points", &points, "--results", &part, "-q"];
        json_of(&folder, &arguments)["ran"].as_u64().unwrap()
    };
    let before = json_of(&folder, &["status", root]);
    let tasks = ran("1") + ran("2");
    assert_eq!(json!(tasks), before["pending"], "no job of the whole runs again");
    assert_eq!(ran("1"), 0, "a task that starts again");
    let status = json_of(&folder, &["status", root]);
    assert_eq!(
        (&status["pending"], &status["workers"]["unmerged"]),
        (&json!(tasks), &json!(tasks))
    );
    let text = folder.stdout(&["merge", root]);
    assert!(text.contains(&format!("{tasks} jobs copied")), "{text}");
    assert_eq!(without_costs(folder.rows(root)), without_costs(folder.rows("whole")));
    let status = json_of(&folder, &["status", root]);
    assert_eq!((&status["pending"], &status["workers"]["unmerged"]), (&json!(0), &json!(0)));
    folder.stdout(&["doctor", root]);
}

#[test]
fn the_scripts_for_a_cluster_are_printed_without_one() {
    let folder = TestFolder::new(&small_grid());
    let options = "--tasks 3 --time 90min --mem 2GiB --sbatch=--account=film";
    let arguments = ["submit", "grid.json", "--dry-run"].into_iter().chain(options.split(' '));
    let text = folder.stdout(&arguments.collect::<Vec<_>>());
    for line in ["array=1-3", "time=01:30:00", "mem=2048M", "account=film"] {
        assert!(text.contains(&format!("\n#SBATCH --{line}\n")), "{line}: {text}");
    }
    assert!(text.contains("--points \"$SLURM_ARRAY_TASK_ID/3\"") && text.contains(" merge "));
    assert!(!folder.results().exists());
    folder.stdout(&["run", "grid.json", "-q"]);
    let output = folder.run(&["submit", "grid.json", "--dry-run"]);
    assert!(stderr(&output).contains("nothing to submit"), "{}", stderr(&output));
}
