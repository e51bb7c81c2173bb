//! Mistakes that people make, and what the program says: exit code, what is wrong and where, what is
//! allowed, the next step. `BILLOW_MISTAKES=FILE` writes the table with the whole messages.

use std::fmt::Write as _;
use std::fs;
use std::path::Path;

use serde_json::json;

use crate::support::{TestFolder, grid, stderr};

mod table;

use table::{FILES, MISTAKES, Mistake};

/// A folder with the files, a finished study and a damaged copy of its results.
fn folder() -> TestFolder {
    let axes = json!({
        "N": [6], "M": [3], "alpha1_over_phi": [1], "mass_flow_rate": ["2 g/s"],
        "strategy": ["direct", "late"]
    });
    let mut study = grid(&axes);
    study["strategies"] = json!({"late": {"release_time": "10 ms"}});
    let folder = TestFolder::new(&study);
    folder.stdout(&["run", "grid.json", "-q"]);
    for (name, content) in FILES {
        fs::write(folder.path().join(name), content).unwrap();
    }
    let broken = folder.path().join("results/broken");
    fs::create_dir(&broken).unwrap();
    fs::copy(folder.results().join("study.json"), broken.join("study.json")).unwrap();
    fs::write(broken.join("summary.parquet"), "PAR1 no table").unwrap();
    folder
}

#[test]
fn every_mistake_gives_a_message_with_place_and_next_step() {
    let folder = folder();
    let rows = folder.rows("results/grid");
    let job = rows[0]["job"].as_str().unwrap()[..8].to_owned();
    let mut table = "| mistake | command | message |\n|---|---|---|\n".to_owned();
    let mut wrong = Vec::new();
    for Mistake { what, command, parts } in MISTAKES {
        let words: Vec<String> =
            command.split_whitespace().map(|word| word.replace("{job}", &job)).collect();
        let words: Vec<&str> = words.iter().map(String::as_str).collect();
        let output = folder.run(&words);
        let message = stderr(&output);
        let missing: Vec<&&str> = parts.iter().filter(|part| !message.contains(**part)).collect();
        let exit = output.status.code();
        let steps = message.contains("\n  allowed: ") || message.contains("\n  next: ");
        let one = message.starts_with("billow: ") && message.matches("billow: ").count() == 1;
        if exit != Some(2) || !missing.is_empty() || !steps || !one || !output.stdout.is_empty() {
            wrong.push(format!("{what}: {exit:?}, missing {missing:?} in\n{message}"));
        }
        let cell = |text: &str| text.trim_end().replace('|', "\\|").replace('\n', "<br>");
        let message = message.replace("  ", "\u{a0}\u{a0}");
        let _ = writeln!(table, "| {what} | `billow {command}` | {} |", cell(&message));
    }
    if let Some(path) = std::env::var_os("BILLOW_MISTAKES") {
        fs::write(Path::new(&path), table).unwrap();
    }
    assert!(MISTAKES.len() >= 30);
    assert!(wrong.is_empty(), "{}", wrong.join("\n\n"));
}

#[test]
fn texts_of_the_user_are_cut_and_cannot_act_on_the_terminal() {
    /// Longest message about a long text, characters (chosen: a screen of 80 columns and 40 lines).
    const MAX_MESSAGE: usize = 3200;
    let folder = folder();
    let long = "k".repeat(70_000);
    let escape = "a\u{1b}[2J\u{7}\u{202e}b";
    for (name, content) in [
        ("long.json", json!({"design": {&long: 1}}).to_string()),
        ("value.json", json!({"design": {"fit": &long}}).to_string()),
        ("unit.json", json!({"design": {"height": format!("1 {long}")}}).to_string()),
        ("filter.json", json!({"grid": {"N": [5], "filter": format!("{long} > 1")}}).to_string()),
        ("escape.json", json!({"design": {escape: escape}}).to_string()),
        ("raw.json", format!("{{\"design\": {{\"{escape}\": 1}}}}")),
        ("line.json", format!("{{\"design\": {{\"a\": \"{long}\" \"b\": \"{long}\"}}}}")),
        ("binary.json", "\u{0}\u{1}\u{2}".repeat(1000)),
    ] {
        fs::write(folder.path().join(name), content).unwrap();
    }
    let set = format!("{long}=1");
    for arguments in [
        &["plan", "long.json"][..],
        &["plan", "value.json"],
        &["plan", "unit.json"],
        &["plan", "filter.json"],
        &["plan", "escape.json"],
        &["plan", "raw.json"],
        &["plan", "line.json"],
        &["plan", "binary.json"],
        &["plan", &long],
        &["plan", escape],
        &["plan", "grid.json", "--set", &set],
        &["plan", "grid.json", "--set", escape],
        &["plan", "grid.json", &long],
        &["table", &long],
        &["table", "grid", "--columns", &long],
        &["table", "grid", "--where", &long],
        &["table", "grid", "--format", &long],
        &["job", &long, "grid"],
        &["job", escape, "grid"],
        &["keys", &long],
        &["keys", escape],
        &["validate", "--case", escape],
        &[&long],
        &[escape],
    ] {
        let output = folder.run(arguments);
        let message = stderr(&output);
        let shown: Vec<String> =
            arguments.iter().map(|text| text.chars().take(20).collect()).collect();
        assert_eq!(output.status.code(), Some(2), "{shown:?}");
        assert!(message.chars().count() < MAX_MESSAGE, "{shown:?}: {} bytes", message.len());
        let acts = |c: char| c != '\n' && billow_study::platform::quote::acts(c);
        assert!(!message.contains(acts), "{shown:?}: {message:?}");
    }
}
