//! Interrupted runs: killed, ended by a signal, resumed, started twice. Finished jobs are kept.

use std::collections::BTreeMap;
use std::fs;
use std::path::{Path, PathBuf};
use std::process::{Child, Command};
use std::thread::sleep;
use std::time::{Duration, SystemTime};

use crate::support::{TestFolder, grid, histories, small_grid, stderr, without_costs};

/// A study that runs long enough to be interrupted: many jobs with fine samples.
fn long_grid() -> serde_json::Value {
    let flows: Vec<f64> = (1..=30).map(|flow| 0.0002 * f64::from(flow)).collect();
    let mut study = grid(&serde_json::json!({
        "N": [5, 6], "M": [2, 3], "alpha1_over_phi": [0.8], "mass_flow_rate": flows
    }));
    study["outputs"] = serde_json::json!({ "sample_interval": "0.1 ms" });
    study
}

fn finished(folder: &TestFolder) -> usize {
    let Ok(folders) = fs::read_dir(folder.results().join("jobs")) else { return 0 };
    let count = |folder: fs::DirEntry| {
        let files = fs::read_dir(folder.path()).unwrap();
        files
            .filter(|file| !file.as_ref().unwrap().file_name().to_string_lossy().starts_with('.'))
            .count()
    };
    folders.map(|folder| count(folder.unwrap())).sum()
}

/// Waits until this number of jobs is finished; false if the run ended first.
fn wait_for(folder: &TestFolder, child: &mut Child, jobs: usize) -> bool {
    loop {
        if child.try_wait().unwrap().is_some() {
            return false;
        }
        if finished(folder) >= jobs {
            return true;
        }
        sleep(Duration::from_millis(1));
    }
}

pub(crate) fn signal(child: &Child, name: &str) {
    // The shell's builtin: a minimal system has no kill program.
    let kill = format!("kill {name} {}", child.id());
    let sent = Command::new("sh").args(["-c", &kill]).status().unwrap();
    assert!(sent.success());
}

#[test]
fn a_killed_run_keeps_its_finished_jobs() {
    let whole = TestFolder::finished(&long_grid());

    let folder = TestFolder::new(&long_grid());
    let mut killed = 0;
    // The delays spread the kills over the run and over the writing of a job.
    for round in 0..8_u64 {
        let mut child = folder.billow(&["run", "grid.json", "-q"]).spawn().unwrap();
        let until = finished(&folder) + 3;
        if wait_for(&folder, &mut child, until) {
            sleep(Duration::from_micros(1300 * round));
            child.kill().unwrap();
            killed += 1;
        }
        child.wait().unwrap();
    }
    assert!(killed >= 2, "only {killed} runs were killed before their end");
    let kept = finished(&folder);
    let output = folder.run(&["run", "grid.json", "-q", "--json"]);
    assert_eq!(output.status.code(), Some(0), "{}", stderr(&output));
    let summary: serde_json::Value = serde_json::from_slice(&output.stdout).unwrap();
    let ran = usize::try_from(summary["ran"].as_u64().unwrap()).unwrap();
    // A killed job may have its file but not yet its journal record.
    assert!(60 - ran <= kept, "{kept} files were there and {ran} jobs were run");
    assert!(ran < 60, "no job was kept");

    assert_eq!(
        without_costs(folder.rows("results/grid")),
        without_costs(whole.rows("results/grid"))
    );
    assert_eq!(histories(&folder.results()), histories(&whole.results()));
    let remaining = files(&folder.results());
    let temporary = |path: &PathBuf| path.extension().is_some_and(|extension| extension == "tmp");
    assert!(!remaining.keys().any(temporary), "{remaining:?}");
}

#[test]
fn signals_keep_the_finished_jobs() {
    for (name, code) in [("-INT", 130), ("-TERM", 143)] {
        let folder = TestFolder::new(&long_grid());
        let mut child = folder.billow(&["run", "grid.json"]).spawn().unwrap();
        assert!(wait_for(&folder, &mut child, 2), "the run ended before the signal");
        signal(&child, name);
        let output = child.wait_with_output().unwrap();
        assert_eq!(output.status.code(), Some(code), "{}", stderr(&output));
        let said = stderr(&output);
        assert!(
            said.contains("finished jobs are kept, the same command runs the remaining ones"),
            "{said}"
        );
        let rows = folder.rows("results/grid");
        let count = |status: &str| rows.iter().filter(|row| row["status"] == status).count();
        assert_eq!(rows.len(), 120);
        assert!(count("done") >= 2 && count("pending") > 0);
        assert_eq!(count("done") + count("pending") + count("infeasible"), 120);

        let summary = folder.stdout(&["run", "grid.json", "-q", "--json"]);
        let summary: serde_json::Value = serde_json::from_str(&summary).unwrap();
        assert_eq!(summary["ran"], count("pending"));
    }
}

/// Every file under a folder: its bytes and time of last change.
fn files(root: &Path) -> BTreeMap<PathBuf, (Vec<u8>, SystemTime)> {
    let mut found = BTreeMap::new();
    let mut folders = vec![root.to_owned()];
    while let Some(folder) = folders.pop() {
        for entry in fs::read_dir(folder).unwrap() {
            let path = entry.unwrap().path();
            if path.is_dir() {
                folders.push(path);
            } else {
                let changed = path.metadata().unwrap().modified().unwrap();
                found.insert(path.clone(), (fs::read(&path).unwrap(), changed));
            }
        }
    }
    found
}

#[test]
fn a_finished_study_runs_nothing() {
    let folder = TestFolder::finished(&small_grid());
    let before = files(&folder.results());
    let said = folder.stdout(&["run", "grid.json"]);
    assert!(said.starts_with("grid: nothing to run, all 16 jobs are finished\n"), "{said}");
    assert_eq!(files(&folder.results()), before);
    let said = folder.stdout(&["run", "results/grid/study.json"]);
    assert!(said.starts_with("grid: nothing to run"), "the stored study is the same study: {said}");
}

#[test]
fn a_second_run_of_a_running_study_is_refused() {
    let folder = TestFolder::new(&long_grid());
    let mut first = folder.billow(&["run", "grid.json", "-q"]).spawn().unwrap();
    assert!(wait_for(&folder, &mut first, 1), "the first run ended before the second");
    folder.refuses(&["run", "grid.json", "-q"], "another billow command is running this study");
    let first = first.wait_with_output().unwrap();
    assert_eq!(first.status.code(), Some(0), "{}", stderr(&first));
    assert!(folder.rows("results/grid").iter().all(|row| row["status"] != "pending"));
}
