//! One trial of each kind that `make torture` repeats thousands of times.

use std::fs;
use std::os::unix::fs::symlink;
use std::path::PathBuf;
use std::process::{Command, Output};

use crate::support::{TestFolder, file_of, histories, ids, ran, small_grid, stderr, without_costs};

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
