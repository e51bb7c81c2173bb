//! Killed runs keep their finished jobs.

use std::fs;
use std::process::{Child, Command};
use std::thread::sleep;
use std::time::Duration;

use crate::support::{TestFolder, grid, histories, stderr, without_costs};

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
    assert_eq!(folder.stdout(&["doctor"]).lines().count(), 1, "no temporary file remains");
}
