//! Which command has which option, and what the help shows.

use std::process::Command;

/// What `billow` prints on stdout and stderr, and its exit code.
fn billow(arguments: &[&str]) -> (String, String, Option<i32>) {
    let output = Command::new(env!("CARGO_BIN_EXE_billow")).args(arguments).output().unwrap();
    let text = |bytes: Vec<u8>| String::from_utf8(bytes).unwrap();
    (text(output.stdout), text(output.stderr), output.status.code())
}

#[test]
fn a_command_has_only_the_global_options_that_apply_to_it() {
    for (command, without) in [
        (&["fold", "--panels", "6", "--storeys", "3", "--bottom-radius", "0.5"][..], "--threads"),
        (&["plan", "study.json"], "--threads"),
        (&["plan", "study.json"], "--verbose"),
        (&["status"], "--set"),
        (&["status"], "--quiet"),
        (&["job", "ab"], "--threads"),
        (&["doctor"], "--set"),
        (&["completions", "bash"], "--results"),
        (&["bench"], "--threads"),
        (&["solve", "scene.json"], "--results"),
    ] {
        let (_, stderr, code) = billow(&[command, &[without]].concat());
        assert_eq!(code, Some(2), "{command:?} {without}");
        assert!(stderr.contains("unexpected argument"), "{command:?} {without}: {stderr}");
    }
}

#[test]
fn help_shows_options_of_the_command_before_global_ones_and_lists_the_exit_codes() {
    let (help, _, code) = billow(&["table", "--help"]);
    assert_eq!(code, Some(0));
    let positions = ["--columns", "Global options", "--results", "--format", "--quiet"]
        .map(|text| help.find(text).unwrap_or_else(|| panic!("{text}: {help}")));
    assert!(positions.is_sorted(), "{help}");
    let (help, _, _) = billow(&["--help"]);
    assert!(help.contains("Exit codes:") && help.contains("130: Ctrl-C"), "{help}");
    assert!(!help.contains("Global options"), "{help}");
}
