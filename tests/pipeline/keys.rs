//! `billow keys` finds keys by name and by meaning, and `billow keys --schema` prints small schemas.

use std::process::{Command, Output};

use billow_study::cli::Cli;
use billow_study::input::keys::listing::{FileKind, entries};
use clap::CommandFactory;
use serde_json::Value;

fn billow(arguments: &[&str]) -> Output {
    Command::new(env!("CARGO_BIN_EXE_billow")).args(arguments).output().unwrap()
}

fn stdout(arguments: &[&str]) -> String {
    let output = billow(arguments);
    assert!(output.status.success(), "{}", String::from_utf8_lossy(&output.stderr));
    String::from_utf8(output.stdout).unwrap()
}

#[test]
fn keys_are_found_by_name_and_by_meaning() {
    let listed = |arguments: &[&str]| -> Vec<String> {
        let rows: Value = serde_json::from_str(&stdout(arguments)).unwrap();
        let rows = rows.as_array().unwrap().iter();
        rows.map(|row| row["key"].as_str().unwrap().to_owned()).collect()
    };
    assert_eq!(listed(&["keys", "thickness", "--json"]), ["film.thickness"]);
    let elastic = listed(&["keys", "young's modulus", "--json"]);
    assert_eq!(elastic, ["film.youngs_modulus"]);
    assert_eq!(listed(&["keys", "--json"]).len(), entries(FileKind::Study).len());
    let scene = listed(&["keys", "--scene", "--json"]);
    assert_eq!(scene.len(), entries(FileKind::Scene).len());
    assert!(scene.contains(&"supports[].move.rotation.angle".to_owned()));

    // A name before a meaning; one letter is one key.
    assert_eq!(listed(&["keys", "N", "--json"]), ["design.N"]);
    assert_eq!(listed(&["keys", "m", "--json"]), ["design.M"]);
    assert_eq!(listed(&["keys", "height", "--json"]), ["design.height"]);
    let mass = listed(&["keys", "mass", "--json"]);
    assert!(mass.iter().all(|key| key.contains("mass")), "{mass:?}");
    // A column of the table.
    assert_eq!(listed(&["keys", "peak_vz", "--json"]), ["peak_vz"]);
    let peaks = listed(&["keys", "peak", "--json"]);
    assert!(
        peaks.contains(&"peak_speed".to_owned())
            && peaks.iter().all(|name| !name.contains("error"))
    );
    assert!(listed(&["keys", "peak_speed_error", "--json"]).len() == 2);
    assert!(stdout(&["keys", "peak_vz"]).starts_with("peak_vz (column of the table)\n"));

    let found = stdout(&["keys", "t_90_z_rim_error_below"]);
    assert!(found.contains("t_90_z_rim_error_below") && found.contains("19 of 20 runs"), "{found}");
    assert!(stdout(&["keys", "smallest_margin"]).starts_with("smallest_margin (column"));
    assert!(stdout(&["keys", "no_error"]).starts_with("no_error_reason (column"));
    let text = stdout(&["keys", "thickness"]);
    for part in
        ["film.thickness\n", "unit m", "default 2.54e-5", "from 1e-7 to 0.01 m", "Thickness."]
    {
        assert!(text.contains(part), "{part:?} is not in {text}");
    }
}

#[test]
fn help_shows_options_of_the_command_before_global_ones_and_lists_the_exit_codes() {
    let help = stdout(&["table", "--help"]);
    let positions = ["--columns", "Shared options", "--results", "--format", "--quiet"]
        .map(|text| help.find(text).unwrap_or_else(|| panic!("{text}: {help}")));
    assert!(positions.is_sorted(), "{help}");
    let help = stdout(&["--help"]);
    assert!(help.contains("Exit codes:") && help.contains("130: Ctrl-C"), "{help}");
    assert!(!help.contains("Shared options"), "{help}");
    for command in Cli::command().get_subcommands() {
        let line = format!("\n  {} ", command.get_name());
        assert!(help.contains(&line), "{} is in no group: {help}", command.get_name());
    }
}
