//! Jobs that end early: signals, kills, limits. They continue with the same bits.

use std::fs;
use std::path::PathBuf;
use std::process::{Child, Command, Stdio};
use std::thread::sleep;
use std::time::{Duration, Instant};

use billow_solver::platform::seal;
use serde_json::{Value, json};

use crate::support::{
    TestFolder, histories, ids, json_of, paper_design, signal, stderr, without_costs,
};

/// One long film job on the coarsest mesh, packed at first, and a short one.
fn study() -> Value {
    json!({
        "design": paper_design(2),
        "solver": {"model": "film"},
        "strategies": {"packed": {"release_time": "5 ms"}},
        "strategy": "packed",
        "gas": {"mass_flow_rate": "5 g/s"},
        "outputs": {"frames": 5},
        "grid": {"end_time": ["20 ms", "1.8 s"]}
    })
}

fn rows(folder: &TestFolder) -> Vec<Value> {
    without_costs(folder.rows("results/grid"))
}

/// The same rows and histories.
fn assert_same_bits(folder: &TestFolder, whole: &TestFolder) {
    assert_eq!(rows(folder), rows(whole));
    assert_eq!(histories(&folder.results()), histories(&whole.results()));
}

fn files(folder: &TestFolder, name: &str) -> Vec<PathBuf> {
    let Ok(entries) = fs::read_dir(folder.results().join(name)) else { return Vec::new() };
    entries.map(|entry| entry.unwrap().path()).collect()
}

fn wait_until(child: &mut Child, what: &str, reached: impl Fn() -> bool) {
    while !reached() {
        assert!(child.try_wait().unwrap().is_none(), "the run ended before {what}");
        sleep(Duration::from_millis(5));
    }
}

/// A run until its second job has computed for a while.
fn running(folder: &TestFolder) -> Child {
    let mut child = folder.billow(&["run", "grid.json", "-q"]).spawn().unwrap();
    wait_until(&mut child, "its second job", || attempts(folder) == 3);
    wait_until(&mut child, "the end of the short job", || files(folder, "jobs").len() == 1);
    sleep(Duration::from_millis(50));
    child
}

/// Number of lines of the attempts of a running process; one is its header.
fn attempts(folder: &TestFolder) -> usize {
    let text = fs::read_to_string(folder.results().join("attempts.jsonl")).unwrap_or_default();
    text.lines().count()
}

#[test]
fn a_signal_stores_the_running_job_which_then_continues_with_the_same_bits() {
    let whole = TestFolder::finished(&study());
    // Under nohup a hangup stops nothing.
    let signals = [("-INT", 130), ("-USR1", 138), ("-HUP", 129)];
    for (name, code) in signals.into_iter().filter(|(name, _)| *name != "-HUP" || !hangup_ignored())
    {
        let folder = TestFolder::new(&study());
        let child = running(&folder);
        let start = Instant::now();
        signal(&child, name);
        let output = child.wait_with_output().unwrap();
        assert!(start.elapsed() < Duration::from_secs(2));
        assert_eq!(output.status.code(), Some(code), "{}", stderr(&output));
        let said = stderr(&output);
        assert!(
            said.contains("finished jobs are kept, the same command runs the remaining"),
            "{said}"
        );
        let statuses = rows(&folder).iter().map(|row| row["status"].clone()).collect::<Vec<_>>();
        assert_eq!(statuses, ["done", "pending"]);
        assert_eq!(files(&folder, "checkpoints").len(), 1);
        assert!(!folder.results().join("attempts.jsonl").exists());
        let status = folder.stdout(&["status", "results/grid"]);
        let checkpoint = status.split_once("with a checkpoint: ");
        assert!(checkpoint.is_some_and(|(_, job)| job.contains(" at ")), "{status}");
        folder.stdout(&["doctor", "results/grid"]);
        folder.stdout(&["run", "grid.json", "-q"]);
        assert!(files(&folder, "checkpoints").is_empty());
        assert_same_bits(&folder, &whole);
    }
}

/// Whether this process ignores SIGHUP, and so do its children.
fn hangup_ignored() -> bool {
    let status = fs::read_to_string("/proc/self/status").unwrap();
    let ignored = status.lines().find_map(|line| line.strip_prefix("SigIgn:")).unwrap();
    u64::from_str_radix(ignored.trim(), 16).unwrap() & 1 == 1
}

#[test]
fn a_run_that_stops_at_any_time_leaves_no_damage_and_continues_with_the_same_bits() {
    let mut study = study();
    study["grid"] =
        json!({"integrator": ["explicit", "implicit", "hybrid"], "end_time": ["0.8 s"]});
    let whole = TestFolder::finished(&study);
    let folder = TestFolder::new(&study);
    let mut stored = 0;
    // Between two kills a job stores a checkpoint, or it would be set aside.
    let stops = ["INT", "KILL", "TERM", "INT", "KILL", "TERM"];
    for (name, pause) in stops.into_iter().zip((40..).step_by(40)) {
        let mut child = folder.billow(&["run", "grid.json", "--threads", "1"]).spawn().unwrap();
        let process = format!("\"process\":\"{}-", child.id());
        wait_until(&mut child, "its first job", || {
            let text = fs::read_to_string(folder.results().join("attempts.jsonl"));
            text.is_ok_and(|text| text.contains(&process) && text.lines().count() > 1)
        });
        sleep(Duration::from_millis(pause));
        signal(&child, &format!("-{name}"));
        let output = child.wait_with_output().unwrap();
        let code = match name {
            "INT" => Some(130),
            "TERM" => Some(143),
            _ => None,
        };
        assert_eq!(output.status.code(), code, "{}", stderr(&output));
        assert!(!stderr(&output).contains("from its beginning"), "{}", stderr(&output));
        stored += files(&folder, "checkpoints").len();
        let status = folder.stdout(&["status", "results/grid"]);
        assert!(!status.contains("doctor"), "{name}: {status}");
        let times = status.matches(" at ").count();
        assert_eq!(times, files(&folder, "checkpoints").len(), "{name}: {status}");
        let findings = json_of(&folder, &["doctor"]);
        assert!(code.is_none() || findings == json!([]), "{name}: {findings}");
    }
    assert!(stored > 2, "the stops came too early");
    let output = folder.run(&["run", "grid.json"]);
    assert!(!stderr(&output).contains("from its beginning"), "{}", stderr(&output));
    assert_same_bits(&folder, &whole);
}

#[test]
fn a_damaged_checkpoint_costs_time_only() {
    let changed = |text: &str| text.replacen("0.0", "0.1", 1);
    // Valid for its job, but of a program with other tracks.
    let misfit = |text: &str| {
        let mut object: Value = serde_json::from_str(&seal::open(text).unwrap()).unwrap();
        object["run"]["tracks"][0] = json!([]);
        seal::seal(&object.to_string())
    };
    let whole = TestFolder::finished(&study());
    for damage in [&changed as &dyn Fn(&str) -> String, &misfit] {
        let folder = TestFolder::new(&study());
        let mut child = running(&folder);
        signal(&child, "-TERM");
        assert_eq!(child.wait().unwrap().code(), Some(143));
        let path = files(&folder, "checkpoints").remove(0);
        fs::write(&path, damage(&fs::read_to_string(&path).unwrap())).unwrap();
        let output = folder.run(&["run", "grid.json"]);
        assert_eq!(output.status.code(), Some(0), "{}", stderr(&output));
        let said = stderr(&output);
        let note = ["checkpoint of job", "from its beginning"];
        assert!(note.iter().all(|part| said.contains(part)), "{said}");
        assert_same_bits(&folder, &whole);
    }
}

#[test]
fn a_job_that_is_killed_twice_is_quarantined_and_runs_again_on_request() {
    let whole = TestFolder::finished(&study());
    let folder = TestFolder::new(&study());
    for _ in 0..2 {
        let mut child = folder.billow(&["run", "grid.json", "-q"]).spawn().unwrap();
        // The second run has one job left, the suspect.
        let wanted = if files(&folder, "journal").is_empty() { 3 } else { 2 };
        wait_until(&mut child, "the long job", || attempts(&folder) == wanted);
        let short = || files(&folder, "jobs").len() == 1;
        wait_until(&mut child, "the end of the short job", short);
        sleep(Duration::from_millis(30));
        child.kill().unwrap();
        child.wait().unwrap();
    }
    let output = folder.run(&["run", "grid.json"]);
    assert_eq!(output.status.code(), Some(1), "{}", stderr(&output));
    let said = stderr(&output);
    assert!(
        said.contains("1 crashed") && said.contains("run results/grid --again crashed"),
        "{said}"
    );
    let crashed = ids(&folder, "crashed");
    assert_eq!((crashed.len(), ids(&folder, "done").len()), (1, 1));
    let why = folder.stdout(&["job", &crashed[0][..8], "results/grid"]);
    assert!(why.contains("died in two attempts") && why.contains("--again"), "{why}");
    folder.stdout(&["run", "results/grid", "--again", "crashed", "-q"]);
    assert_same_bits(&folder, &whole);
}

#[test]
fn a_limited_job_is_a_row_and_goes_on_with_a_higher_limit() {
    let whole = TestFolder::finished(&study());
    let mut limited = study();
    limited["job_limits"] = json!({"steps": 2000});
    let folder = TestFolder::new(&limited);
    let output = folder.run(&["run", "grid.json", "-q"]);
    assert_eq!(output.status.code(), Some(1));
    let said = stderr(&output);
    assert!(said.contains("--again step_limit --set job_limits.steps=…"), "{said}");
    let failed = ids(&folder, "step_limit");
    assert_eq!((failed.len(), files(&folder, "checkpoints").len()), (1, 1));
    let row = folder.rows("results/grid").pop().unwrap();
    assert!(row["reason"].as_str().unwrap().starts_with("job_limits.steps of 2000 is reached"));
    assert!(row["final_volume"].is_null() && row["content_hash"].is_null(), "{row}");
    let why = folder.stdout(&["job", &failed[0][..8], "results/grid"]);
    assert!(why.contains("--set job_limits.steps=…"), "{why}");

    // An attempt of a moment; then one with enough of both.
    let timeout = ["--set", "job_limits.steps=1e7", "--set", "job_limits.wall_time=0.05", "-q"];
    let again = ["run", "results/grid", "--again", "step_limit"];
    let output = folder.run(&[&again[..], &timeout].concat());
    assert_eq!(output.status.code(), Some(1), "{}", stderr(&output));
    assert_eq!(ids(&folder, "timeout"), failed);
    let again = ["run", "results/grid", "--again", "timeout"];
    folder.stdout(&[&again[..], &["--set", "job_limits.steps=1e7", "-q"]].concat());
    assert_same_bits(&folder, &whole);
    // The limits are no change of the study.
    let said = stderr(&folder.run(&["run", "grid.json", "--set", "job_limits.steps=9"]));
    assert!(!said.contains("job_limits"), "{said}");
}

#[test]
fn a_hangup_does_not_end_a_run_that_ignores_it() {
    let folder = TestFolder::new(&study());
    let script = format!("trap '' HUP; exec {} run grid.json -q", env!("CARGO_BIN_EXE_billow"));
    let mut command = Command::new("sh");
    command.args(["-c", &script]).current_dir(folder.path());
    let mut child = command.stdout(Stdio::piped()).stderr(Stdio::piped()).spawn().unwrap();
    wait_until(&mut child, "its second job", || attempts(&folder) == 3);
    signal(&child, "-HUP");
    let output = child.wait_with_output().unwrap();
    assert_eq!(output.status.code(), Some(0), "{}", stderr(&output));
    assert_eq!(ids(&folder, "done").len(), 2);
}
