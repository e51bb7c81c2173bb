//! One trial of each kind that `make torture` repeats thousands of times.

use std::fs;
use std::os::unix::fs::symlink;
use std::path::PathBuf;
use std::process::{Command, Output};

use serde_json::{Value, json};

use crate::support::{
    TestFolder, file_of, histories, ids, paper_design, ran, small_grid, stderr, without_costs,
};

/// Source of the library that disturbs system calls.
const SHIM: &str = include_str!("../torture/shim.c");

/// Compiles the library with the C compiler that also links Rust.
fn shim(folder: &TestFolder) -> PathBuf {
    let (source, library) = (folder.path().join("shim.c"), folder.path().join("shim.so"));
    fs::write(&source, SHIM).unwrap();
    let mut compiler = Command::new("cc");
    compiler.args(["-O1", "-shared", "-fPIC", "-o"]).arg(&library).arg(&source).arg("-ldl");
    assert!(compiler.status().unwrap().success());
    library
}

/// Runs the study with one call disturbed: mode, number of the call, error number.
fn disturbed(folder: &TestFolder, shim: &PathBuf, mode: &str, at: u32, error: u32) -> Output {
    let mut command = folder.billow(&["run", "grid.json", "-q", "--threads", "1"]);
    command.env("LD_PRELOAD", shim).env("TORTURE_LOG", folder.path().join("calls"));
    command.env("TORTURE_MODE", mode).env("TORTURE_AT", at.to_string());
    command.env("TORTURE_ERRNO", error.to_string());
    command.output().unwrap()
}

#[test]
fn a_disturbed_system_call_loses_nothing() {
    let whole = ran();
    let rows = without_costs(whole.rows("results/grid"));
    let folder = TestFolder::new(&small_grid());
    let shim = shim(&folder);
    // Killed before a call and in a write; EIO; a full disk; interrupted and short writes.
    for (mode, at, error) in
        [("before", 9, 0), ("half", 23, 0), ("once", 31, 5), ("from", 40, 28), ("short", 1, 0)]
    {
        let output = disturbed(&folder, &shim, mode, at, error);
        let said = stderr(&output);
        match mode {
            "short" => assert_eq!(output.status.code(), Some(0), "{said}"),
            "once" | "from" => {
                assert_eq!(output.status.code(), Some(2), "{mode}: {said}");
                assert!(said.contains("results/grid") && said.contains("next:"), "{said}");
            }
            _ => assert_eq!(output.status.code(), None, "{mode}: the process was not killed"),
        }
    }
    assert_eq!(without_costs(folder.rows("results/grid")), rows);
    assert_eq!(histories(&folder.results()), histories(&whole.results()));
    assert_eq!(folder.run(&["doctor"]).status.code(), Some(0));
}

#[test]
fn closed_descriptors_change_no_exit_code() {
    let folder = ran();
    for (arguments, code) in [("table", 0), ("run grid.json", 0), ("show zz", 2)] {
        for streams in [">&-", "2>&-", "<&- >&- 2>&-"] {
            let script = format!("exec \"$0\" {arguments} {streams}");
            let mut shell = Command::new("sh");
            shell.args(["-c", &script, env!("CARGO_BIN_EXE_billow")]).current_dir(folder.path());
            assert_eq!(shell.output().unwrap().status.code(), Some(code), "{arguments} {streams}");
        }
    }
}

#[test]
fn no_reader_trusts_a_history_of_another_job() {
    let folder = ran();
    let done = ids(&folder, "done");
    let (job, other) = (&done[0], &done[1]);
    let undamaged = folder.stdout(&["job", job, "--history", "--format", "csv"]);
    fs::remove_file(file_of(&folder, job)).unwrap();
    symlink(file_of(&folder, other), file_of(&folder, job)).unwrap();
    for arguments in [
        &["job", job, "--history", "--format", "csv"][..],
        &["chart", "--history", "z_rim", "--jobs", job, "--out", "a.svg"],
    ] {
        let output = folder.run(arguments);
        let warned = stderr(&output).contains("history") || stderr(&output).contains(".h5");
        assert!(!output.status.success() || warned, "{arguments:?} read another job's history");
        assert_ne!(String::from_utf8(output.stdout).unwrap(), undamaged);
    }
    assert_eq!(folder.run(&["doctor"]).status.code(), Some(1));
}

/// Mutations of one text, in order: cut, bytes replaced, parts doubled.
fn mutations(text: &str) -> Vec<Vec<u8>> {
    let bytes = text.as_bytes();
    let places = (0..6).map(|part| part * bytes.len() / 6);
    let mut mutated = Vec::new();
    for at in places {
        mutated.push(bytes[..at].to_vec());
        for replacement in [b'\0', 0xff, b'{', b'9', b'-'] {
            let mut changed = bytes.to_vec();
            changed[at] = replacement;
            mutated.push(changed);
        }
        mutated.push([bytes, &bytes[at..]].concat());
    }
    mutated
}

fn assert_answered(output: &Output, input: &[u8]) {
    let said = stderr(output);
    let input = String::from_utf8_lossy(input);
    assert!(matches!(output.status.code(), Some(0..=2)), "{said}\n{input}");
    let next = said.contains("next:") || said.contains("allowed");
    assert!(output.status.code() != Some(2) || next, "no next step: {said}\n{input}");
}

#[test]
fn mutated_files_give_a_result_or_a_message() {
    let folder = TestFolder::new(&Value::Null);
    for bytes in mutations(&small_grid().to_string()) {
        fs::write(folder.path().join("grid.json"), &bytes).unwrap();
        assert_answered(&folder.run(&["plan", "grid.json", "--summary"]), &bytes);
    }
    let scene = json!({
        "format": "billow-scene", "version": 1, "mesh": {"positions": "square.obj"},
        "gas": {"pressure": "10 Pa"}, "solver": {"end_time": "1 us"}
    });
    fs::write(folder.path().join("scene.json"), scene.to_string()).unwrap();
    let square = "v 0 0 0\nv 1 0 0\nv 1 1 0\nv 0 1 0\nf 1 2 3\nf 1 3 4\n";
    for bytes in mutations(square) {
        fs::write(folder.path().join("square.obj"), &bytes).unwrap();
        assert_answered(&folder.run(&["solve", "scene.json", "-q"]), &bytes);
    }
}

#[test]
fn a_refused_scene_or_checkpoint_has_a_next_step() {
    let folder = TestFolder::new(&Value::Null);
    let write = |name: &str, text: &[u8]| fs::write(folder.path().join(name), text).unwrap();
    let mut scene = json!({
        "format": "billow-scene", "version": 1,
        "design": paper_design(2),
        "gas": {"mass_flow_rate": "1 g/s"}, "solver": {"end_time": "1 ms"}
    });
    write("scene.json", scene.to_string().as_bytes());
    write("checkpoint.json", b"\xff\xfe");
    let arguments = ["solve", "scene.json", "-q", "--resume", "checkpoint.json"];
    assert_answered(&folder.run(&arguments), b"a checkpoint that is not UTF-8");
    scene["design"]["bottom_radius"] = json!(0.05);
    write("scene.json", scene.to_string().as_bytes());
    assert_answered(&folder.run(&["solve", "scene.json", "-q"]), b"an infeasible cone");
    scene["design"].as_object_mut().unwrap().remove("top_radius");
    write("scene.json", scene.to_string().as_bytes());
    assert_answered(&folder.run(&["solve", "scene.json", "-q"]), b"no top_radius");
}
