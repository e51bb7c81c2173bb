//! The reference pages of the commands and exit codes, and which command has which option.

use std::fs;
use std::path::Path;
use std::process::Command;

use billow_study::cli::reference;

/// Fails when a committed page differs from the generated text; `BILLOW_UPDATE_REFERENCE=1` writes it.
fn assert_current(path: &str, text: &str) {
    let file = Path::new(env!("CARGO_MANIFEST_DIR")).join("..").join(path);
    if std::env::var_os("BILLOW_UPDATE_REFERENCE").is_some_and(|value| value == "1") {
        fs::create_dir_all(file.parent().unwrap()).unwrap();
        fs::write(&file, text).unwrap();
    }
    let committed = fs::read_to_string(&file).unwrap_or_default();
    assert!(
        committed == text,
        "{path} is stale; next: BILLOW_UPDATE_REFERENCE=1 cargo test --release -p billow-study \
         --test pipeline reference_commands"
    );
}

/// What `billow` prints on stdout and stderr, and its exit code.
fn billow(arguments: &[&str]) -> (String, String, Option<i32>) {
    let output = Command::new(env!("CARGO_BIN_EXE_billow")).args(arguments).output().unwrap();
    let text = |bytes: Vec<u8>| String::from_utf8(bytes).unwrap();
    (text(output.stdout), text(output.stderr), output.status.code())
}

#[test]
fn the_page_of_the_commands_is_current() {
    assert_current("docs/reference/commands.md", &reference::commands());
}

#[test]
fn the_page_of_the_exit_codes_is_current() {
    assert_current("docs/reference/exit-codes.md", &reference::exit_codes());
}

#[test]
fn a_command_has_only_the_global_options_that_apply_to_it() {
    for (command, without) in [
        (&["fold", "--panels", "6", "--storeys", "3", "--bottom-radius", "0.5"][..], "--threads"),
        (&["plan", "study.json"], "--threads"),
        (&["plan", "study.json"], "--verbose"),
        (&["status"], "--set"),
        (&["status"], "--quiet"),
        (&["why", "ab"], "--quiet"),
        (&["show", "ab"], "--threads"),
        (&["doctor"], "--set"),
        (&["schema"], "--json"),
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
fn help_shows_own_options_before_global_ones_and_lists_the_exit_codes() {
    let (help, _, code) = billow(&["table", "--help"]);
    assert_eq!(code, Some(0));
    let positions = ["--columns", "Global options", "--results", "--format", "--quiet"]
        .map(|text| help.find(text).unwrap_or_else(|| panic!("{text}: {help}")));
    assert!(positions.is_sorted(), "{help}");
    let (help, _, _) = billow(&["--help"]);
    assert!(help.contains("Exit codes:") && help.contains("130: Ctrl-C"), "{help}");
    assert!(!help.contains("Global options"), "{help}");
}
