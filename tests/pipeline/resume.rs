//! Stopping a run, in order or not, costs nothing that was finished.

use std::collections::BTreeMap;
use std::fs;
use std::path::{Path, PathBuf};
use std::process::{Child, Command};
use std::thread::sleep;
use std::time::{Duration, SystemTime};

use crate::support::{Desk, grid, histories, small_grid, stderr, without_costs};

/// Enough work for a run to be caught in the middle: fine samples, many jobs.
fn long_grid() -> serde_json::Value {
    let flows: Vec<f64> = (1..=30).map(|flow| 0.0002 * f64::from(flow)).collect();
    let mut study = grid(&serde_json::json!({
        "N": [5, 6], "M": [2, 3], "alpha1_over_phi": [0.8], "mass_flow_rate": flows
    }));
    study["outputs"] = serde_json::json!({ "sample_interval": "0.1 ms" });
    study
}

fn finished(desk: &Desk) -> usize {
    let Ok(folders) = fs::read_dir(desk.results().join("jobs")) else { return 0 };
    let count = |folder: fs::DirEntry| {
        let files = fs::read_dir(folder.path()).unwrap();
        files
            .filter(|file| !file.as_ref().unwrap().file_name().to_string_lossy().starts_with('.'))
            .count()
    };
    folders.map(|folder| count(folder.unwrap())).sum()
}

/// Waits until more jobs than that are finished, or the run is over.
fn wait_for(desk: &Desk, child: &mut Child, jobs: usize) -> bool {
    loop {
        if child.try_wait().unwrap().is_some() {
            return false;
        }
        if finished(desk) >= jobs {
            return true;
        }
        sleep(Duration::from_millis(1));
    }
}

pub(crate) fn signal(child: &Child, name: &str) {
    // The shell's own: a bare system has no kill program.
    let kill = format!("kill {name} {}", child.id());
    let sent = Command::new("sh").args(["-c", &kill]).status().unwrap();
    assert!(sent.success());
}

#[test]
fn kill_9_at_any_moment_costs_nothing() {
    let whole = Desk::new(&long_grid());
    whole.stdout(&["run", "grid.json", "-q"]);

    let desk = Desk::new(&long_grid());
    let mut killed = 0;
    // Moments spread over the run, and by a few odd milliseconds over the writing of a job.
    for round in 0..8_u64 {
        let mut child = desk.billow(&["run", "grid.json", "-q"]).spawn().unwrap();
        let until = finished(&desk) + 3;
        if wait_for(&desk, &mut child, until) {
            sleep(Duration::from_micros(1300 * round));
            child.kill().unwrap();
            killed += 1;
        }
        child.wait().unwrap();
    }
    assert!(killed >= 2, "only {killed} runs were caught in the middle");
    let kept = finished(&desk);
    let output = desk.run(&["run", "grid.json", "-q", "--json"]);
    assert_eq!(output.status.code(), Some(0), "{}", stderr(&output));
    let summary: serde_json::Value = serde_json::from_slice(&output.stdout).unwrap();
    let ran = usize::try_from(summary["ran"].as_u64().unwrap()).unwrap();
    // A job may have its file but not yet its record: at most what one kill can catch, two threads
    // and a full channel.
    assert!(60 - ran <= kept, "{kept} files were there and {ran} jobs were run");
    assert!(ran < 60, "nothing was kept");

    assert_eq!(without_costs(desk.rows("results/grid")), without_costs(whole.rows("results/grid")));
    assert_eq!(histories(&desk.results()), histories(&whole.results()));
    let left = files(&desk.results());
    assert!(left.keys().all(|path| path.extension().is_none_or(|end| end != "tmp")), "{left:?}");
}

#[test]
fn ctrl_c_and_terminate_keep_what_is_finished() {
    for (name, code) in [("-INT", 130), ("-TERM", 143)] {
        let desk = Desk::new(&long_grid());
        let mut child = desk.billow(&["run", "grid.json"]).spawn().unwrap();
        assert!(wait_for(&desk, &mut child, 2), "too quick to stop");
        signal(&child, name);
        let output = child.wait_with_output().unwrap();
        assert_eq!(output.status.code(), Some(code), "{}", stderr(&output));
        let said = stderr(&output);
        assert!(
            said.contains("finished jobs are kept, the same command runs the remaining ones"),
            "{said}"
        );
        let rows = desk.rows("results/grid");
        let count = |status: &str| rows.iter().filter(|row| row["status"] == status).count();
        assert_eq!(rows.len(), 120);
        assert!(count("done") >= 2 && count("pending") > 0);
        assert_eq!(count("done") + count("pending") + count("infeasible"), 120);

        let summary = desk.stdout(&["run", "grid.json", "-q", "--json"]);
        let summary: serde_json::Value = serde_json::from_str(&summary).unwrap();
        assert_eq!(summary["ran"], count("pending"));
    }
}

/// Every file under a folder: bytes and time of last change.
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
fn a_second_run_does_nothing_and_says_so() {
    let desk = Desk::new(&small_grid());
    desk.stdout(&["run", "grid.json", "-q"]);
    let before = files(&desk.results());
    let said = desk.stdout(&["run", "grid.json"]);
    assert!(said.starts_with("grid: nothing to run, all 16 jobs are finished\n"), "{said}");
    assert_eq!(files(&desk.results()), before);
    let said = desk.stdout(&["run", "results/grid/study.json"]);
    assert!(said.starts_with("grid: nothing to run"), "the stored study is the study: {said}");
}

#[test]
fn two_runs_at_once_never_mix() {
    let desk = Desk::new(&long_grid());
    let mut first = desk.billow(&["run", "grid.json", "-q"]).spawn().unwrap();
    assert!(wait_for(&desk, &mut first, 1), "too quick to meet");
    let second = desk.run(&["run", "grid.json", "-q"]);
    assert_eq!(second.status.code(), Some(2));
    assert!(stderr(&second).contains("another billow command is running this study"));
    let first = first.wait_with_output().unwrap();
    assert_eq!(first.status.code(), Some(0), "{}", stderr(&first));
    assert!(desk.rows("results/grid").iter().all(|row| row["status"] != "pending"));
}
