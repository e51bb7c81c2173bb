//! Mistakes that people make, and what the program says: exit code 2, one message with what is wrong and where, what is
//! allowed or the next step, nothing on stdout, no file written. `cases.txt` lists them.

use std::collections::BTreeSet;
use std::fs;

use billow_study::input::schema::study_schema;
use serde_json::{Value, json};

use crate::search::{replicated, searching};
use crate::solve::CUBE;
use crate::support::{TestFolder, grid, stderr};

/// The cases, one a line: what is done, and parts of the message after `=>`, separated by `;;`. `\n` is the end of a line,
/// `␣` a blank within a word. What is done is a command line (`{job}` is the id of a finished job), or changes of a valid
/// file, separated by `&&`: `study KEY = JSON`, `film` (a study of film), `search`, `seeds` (a search with replicates) for
/// `plan`; `scene` (a cube), `sheets` (two sheets that touch), `capsule` for `solve`.
const CASES: &str = include_str!("cases.txt");

/// Files with a mistake: name and content.
const FILES: &[(&str, &[u8])] = &[
    ("binary.json", b"{\"question\": \"\xFF\"}"),
    ("list.json", b"[1, 2]"),
    ("huge.json", b"{\"gravity\": 1e999}"),
    ("comma.json", b"{\n  \"design\": {\n    \"N\": 6\n    \"M\": 3\n  }\n}\n"),
    (
        "brace.json",
        b"{\n  \"design\": {\n    \"N\": 6,\n  \"gas\": {\n    \"species\": \"air\"\n  }\n}\n",
    ),
    ("quote.json", b"{\n  \"design\": {\"fit\": \"height, \"N\": 6}\n}\n"),
    ("unit.json", b"{\r\n\t\"design\": {\"height\": 1000 mm}\r\n}\r\n"),
    ("twice.json", b"{\n  \"design\": {\"N\": 6, \"M\": 3, \"N\": 5}\n}\n"),
    ("python.json", b"{'design': {'N': 6}}"),
    ("yaml.json", b"design:\n  N: 6\n"),
    ("key.json", b"{\n  \"film\": {\"thicknes\": \"25 um\"}\n}\n"),
    ("range.json", b"{\n  \"design\": {\n    \"N\": 3\n  }\n}\n"),
    ("filter.json", b"{\"grid\": {\"N\": [5, 6], \"filter\": \"n > 5\"}}"),
    ("empty.json", b""),
    ("zip.json", b"{\"grid\": {\"zip\": [{\"N\": [5, 6], \"M\": [3, 4]}]}}"),
    ("table.json", b"PAR1 and so on"),
    ("scene.json", b"{\"format\": \"billow-scene\", \"mesh\": {\"positions\": \"spere.obj\"}}"),
    ("sphere.obj", b"v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n"),
    ("stl.obj", b"solid x\n"),
    ("none.obj", b"v 0 0 0\n"),
    ("line.obj", b"v 0 0 0\nv 1 0 0\nv 2 0 0\nv 0 1 0\nf 1 2 3\nf 1 3 4\n"),
    ("no_state", b"{\"format\": 1}"),
];

/// A folder with the files, a finished study and a damaged copy of its results.
fn folder() -> TestFolder {
    let axes = json!({
        "N": [6], "M": [3], "alpha1_over_phi": [1], "mass_flow_rate": ["2 g/s"],
        "strategy": ["direct", "late"]
    });
    let mut study = grid(&axes);
    study["strategies"] = json!({"late": {"release_time": "10 ms"}});
    let folder = TestFolder::finished(&study);
    for (name, content) in FILES {
        fs::write(folder.path().join(name), content).unwrap();
    }
    fs::write(folder.path().join("deep.json"), "[".repeat(200_000)).unwrap();
    let broken = folder.path().join("results/broken");
    fs::create_dir(&broken).unwrap();
    fs::copy(folder.results().join("study.json"), broken.join("study.json")).unwrap();
    fs::write(broken.join("summary.parquet"), "PAR1 no table").unwrap();
    fs::create_dir(folder.path().join("nothing")).unwrap();
    meshes(&folder);
    folder
}

/// The cube, and cubes and sheets with a mistake.
fn meshes(folder: &TestFolder) {
    let reversed = |line: &str| match line.strip_prefix("f ") {
        Some(corners) => {
            let reversed: Vec<&str> = corners.split_whitespace().rev().collect();
            format!("f {}\n", reversed.join(" "))
        }
        None => format!("{line}\n"),
    };
    // A square of two faces, then the same with further vertices.
    let square = "v 0 0 0\nv 0.1 0 0\nv 0.1 0.1 0\nv 0 0.1 0\n";
    let sheets = format!("{square}f 1 2 3\nf 1 3 4\n{square}f 5 6 7\nf 5 7 8\n");
    for (name, text) in [
        ("cube.obj", CUBE.to_owned()),
        ("inward.obj", CUBE.lines().map(reversed).collect()),
        ("nan.obj", CUBE.replace("v 1 0 0", "v nan 0 0")),
        ("wild.obj", CUBE.to_owned() + "f 1 2 99\n"),
        ("twisted.obj", CUBE.replace("f 5 6 7 8", "f 8 7 6 5")),
        ("sheets.obj", sheets),
        ("capsule.json", crate::solve::capsule().to_string()),
        ("search.json", replicated().to_string()),
    ] {
        fs::write(folder.path().join(name), text).unwrap();
    }
}

/// The valid file that a case changes, and the command that reads it.
fn valid(kind: &str) -> Option<(&'static str, Value)> {
    let design = json!({"N": 6, "M": 3, "bottom_radius": 0.5, "top_radius": 0.365, "height": 1});
    match kind {
        "study" => {
            let study = json!({
                "design": design, "gas": {"mass_flow_rate": 0.005},
                "solver": {"model": "piston", "end_time": 0.5},
            });
            Some(("plan", study))
        }
        "scene" => Some((
            "solve",
            crate::solve::cube(
                &json!({"positions": "cube.obj"}),
                &json!({"initial_pressure": "0.1 Pa"}),
            ),
        )),
        "sheets" => {
            let scene =
                json!({"mesh": {"positions": "sheets.obj"}, "solver": {"end_time": "1 ms"}});
            Some(("solve", scene))
        }
        "capsule" => Some(("solve", crate::solve::capsule())),
        "film" => Some(("plan", crate::accuracy::film(&json!({})))),
        "search" => Some(("plan", searching())),
        "seeds" => {
            let mut study = searching();
            study["replicates"] = json!({"seed": 5});
            Some(("plan", study))
        }
        _ => None,
    }
}

/// The command line of a case, and the file that it reads, which is written.
fn command(folder: &TestFolder, case: &str, job: &str) -> (Vec<String>, Value) {
    let (kind, changes) = case.split_once(' ').unwrap_or((case, ""));
    let Some((command, mut json)) = valid(kind) else {
        let word = |word: &str| word.replace("{job}", job).replace('␣', " ");
        return (case.split_whitespace().map(word).collect(), Value::Null);
    };
    for change in changes.split(" && ") {
        let (key, value) = change.split_once(" = ").expect("KEY = JSON");
        let value = serde_json::from_str(value).unwrap_or_else(|error| panic!("{case}: {error}"));
        *key.split('.').fold(&mut json, |json, part| &mut json[part]) = value;
    }
    fs::write(folder.path().join("changed.json"), json.to_string()).unwrap();
    (vec![command.to_owned(), "changed.json".to_owned()], json)
}

/// Names of the files in the folder.
fn names(folder: &TestFolder) -> BTreeSet<std::ffi::OsString> {
    fs::read_dir(folder.path()).unwrap().map(|entry| entry.unwrap().file_name()).collect()
}

#[test]
fn every_mistake_gives_a_message_with_place_and_next_step() {
    let folder = folder();
    let job = folder.rows("results/grid")[0]["job"].as_str().unwrap()[..8].to_owned();
    fs::write(folder.path().join("changed.json"), "").unwrap();
    let before = names(&folder);
    let (mut wrong, mut refused_by_schema) = (Vec::new(), 0);
    let schema = jsonschema::validator_for(&study_schema()).unwrap();
    let cases = CASES.lines().filter(|line| !line.is_empty() && !line.starts_with('#'));
    for line in cases {
        let (case, parts) = line.split_once(" => ").unwrap_or_else(|| panic!("{line}"));
        let (words, json) = command(&folder, case, &job);
        refused_by_schema += u32::from(case.starts_with("study ") && !schema.is_valid(&json));
        let output = folder.run(&words.iter().map(String::as_str).collect::<Vec<_>>());
        let message = stderr(&output);
        let parts = parts.split(" ;; ").map(|part| part.replace("\\n", "\n"));
        let missing: Vec<String> = parts.filter(|part| !message.contains(part)).collect();
        let steps = message.contains("\n  allowed: ") || message.contains("\n  next: ");
        let one = message.starts_with("billow: ") && message.matches("billow: ").count() == 1;
        let exit = output.status.code();
        if exit != Some(2) || !missing.is_empty() || !steps || !one || !output.stdout.is_empty() {
            wrong.push(format!("{case}: {exit:?}, missing {missing:?} in\n{message}"));
        }
    }
    assert!(wrong.is_empty(), "{}", wrong.join("\n\n"));
    assert_eq!(names(&folder), before, "no file is written");
    // An editor with the schema finds most mistakes, and takes what the program takes.
    assert!(refused_by_schema >= 20, "{refused_by_schema}");
    for kind in ["study", "film", "search", "seeds", "scene", "capsule"] {
        let (command, json) = valid(kind).unwrap();
        assert!(command == "solve" || schema.is_valid(&json), "{kind}");
        fs::write(folder.path().join("changed.json"), json.to_string()).unwrap();
        folder.stdout(&[command, "changed.json", "-q"]);
    }
}

#[test]
fn every_command_that_simulates_refuses_an_unknown_instruction_set() {
    let folder = folder();
    for arguments in [
        &["run", "grid.json"][..],
        &["run", "results/grid", "--again", "done"],
        &["solve", "capsule.json"],
    ] {
        let output = folder.billow(arguments).env("BILLOW_SIMD", "neon").output().unwrap();
        let message = stderr(&output);
        assert_eq!(output.status.code(), Some(2), "{arguments:?}: {message}");
        assert!(message.contains("BILLOW_SIMD = neon: unknown instruction set"), "{message}");
        assert!(message.contains("allowed: scalar"), "{message}");
    }
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
        ("units.json", json!({"design": {"height": format!("1 {long}")}}).to_string()),
        ("filters.json", json!({"grid": {"N": [5], "filter": format!("{long} > 1")}}).to_string()),
        ("escape.json", json!({"design": {escape: escape}}).to_string()),
        ("raw.json", format!("{{\"design\": {{\"{escape}\": 1}}}}")),
        ("line.json", format!("{{\"design\": {{\"a\": \"{long}\" \"b\": \"{long}\"}}}}")),
        ("zeros.json", "\u{0}\u{1}\u{2}".repeat(1000)),
    ] {
        fs::write(folder.path().join(name), content).unwrap();
    }
    let set = format!("{long}=1");
    for arguments in [
        &["plan", "long.json"][..],
        &["plan", "value.json"],
        &["plan", "units.json"],
        &["plan", "filters.json"],
        &["plan", "escape.json"],
        &["plan", "raw.json"],
        &["plan", "line.json"],
        &["plan", "zeros.json"],
        &["plan", &long],
        &["plan", escape],
        &["plan", "grid.json", "--set", &set],
        &["plan", "grid.json", "--set", escape],
        &["table", "grid", "--where", &long],
        &["job", escape, "grid"],
        &["keys", &long],
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
