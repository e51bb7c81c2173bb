//! stdout and stderr that are closed or full: no panic, and the exit code of the command.

use std::fs::File;
use std::process::{Command, Stdio};

use crate::support::{TestFolder, grid};

/// A device on which every write fails: "No space left on device".
fn full() -> Stdio {
    File::options().write(true).open("/dev/full").unwrap().into()
}

/// A pipe that no program reads.
fn closed() -> Stdio {
    let mut reader = Command::new("true").stdin(Stdio::piped()).spawn().unwrap();
    let pipe = reader.stdin.take().unwrap();
    reader.wait().unwrap();
    pipe.into()
}

/// A study with a finished run of one job.
fn folder() -> TestFolder {
    TestFolder::finished(&grid(&serde_json::json!({
        "N": [6], "M": [3, 4], "alpha1_over_phi": [1], "mass_flow_rate": ["2 g/s"]
    })))
}

#[test]
fn every_command_keeps_its_exit_code_when_a_stream_is_closed_or_full() {
    let folder = folder();
    // Arguments; exit code; whether the command prints on stdout.
    for (arguments, code, prints) in [
        (&["fold", "--panels", "6", "--storeys", "3", "--bottom-radius", "0.5"][..], 2, false),
        (&["plan", "grid.json"], 0, true),
        (&["run", "grid.json"], 0, true),
        (&["run", "grid.json", "--again", "done", "-v"], 0, true),
        (&["status"], 0, true),
        (&["compare", "--by", "M", "--base", "3"], 0, true),
        (&["doctor"], 0, true),
        (&["table"], 0, true),
        (&["table", "--columns", "wrong"], 2, false),
        (&["chart", "--history", "z_centre"], 0, true),
        (&["keys"], 0, true),
        (&["keys", "--schema"], 0, true),
        (&["completions", "bash"], 0, true),
        (&["solve", "absent.json"], 2, false),
        (&["job", "zz"], 2, false),
        (&["frames", "zz"], 2, false),
        (&["--help"], 0, true),
        (&["--version"], 0, true),
        (&["nonsense"], 2, false),
        (&[], 2, false),
    ] {
        let run = |stdout: Stdio, stderr: Stdio| {
            let mut command = folder.billow(arguments);
            command.stdout(stdout).stderr(stderr).status().unwrap().code()
        };
        assert_eq!(run(Stdio::null(), Stdio::null()), Some(code), "{arguments:?}");
        assert_eq!(run(Stdio::null(), full()), Some(code), "{arguments:?}, stderr full");
        assert_eq!(run(Stdio::null(), closed()), Some(code), "{arguments:?}, stderr closed");
        assert_eq!(run(closed(), Stdio::null()), Some(code), "{arguments:?}, stdout closed");
        assert_eq!(run(closed(), closed()), Some(code), "{arguments:?}, both closed");
        // Closed descriptors: what the program opens itself takes their numbers.
        let mut shell = Command::new("sh");
        shell.args(["-c", "exec \"$@\" <&- >&- 2>&-", "sh", env!("CARGO_BIN_EXE_billow")]);
        shell.args(arguments).current_dir(folder.path());
        assert_eq!(shell.status().unwrap().code(), Some(code), "{arguments:?}, none open");
        let incomplete = if prints { 2 } else { code };
        assert_eq!(run(full(), full()), Some(incomplete), "{arguments:?}, both full");
    }
}

#[test]
fn a_full_stdout_is_an_error_with_its_reason() {
    let folder = folder();
    let output = folder.billow(&["table", "-q"]).stdout(full()).output().unwrap();
    let error = crate::support::stderr(&output);
    assert_eq!(output.status.code(), Some(2));
    assert!(error.contains("billow: stdout: No space left on device"), "{error}");
    assert!(error.contains("next: the output is not complete"), "{error}");
}
