//! `billow solve`: shipped scenes, equal bits, checkpoints, histories.

use billow_solver::platform::simd::InstructionSet;
use std::fs;
use std::path::{Path, PathBuf};
use std::process::{Command, Output, Stdio};
use std::time::Duration;

use billow_study::input::schema::scene_schema;
use billow_study::store::history_file;
use serde_json::{Value, json};

use crate::support::{assert_valid, paper_design, signal, stderr};

fn scenes() -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("../scenes")
}

pub(crate) fn solve(folder: &Path, arguments: &[&str], simd: &str) -> Output {
    let mut command = Command::new(env!("CARGO_BIN_EXE_billow"));
    command.arg("solve").args(arguments).current_dir(folder).env("BILLOW_SIMD", simd);
    command.output().unwrap()
}

/// The summary of a run that must succeed, without its wall time.
pub(crate) fn done(folder: &Path, arguments: &[&str], simd: &str) -> Value {
    let output = solve(folder, arguments, simd);
    assert!(output.status.success(), "{arguments:?}: {}", stderr(&output));
    without_wall(&output)
}

/// What `--check` prints of the scene in a folder.
pub(crate) fn checked(folder: &Path) -> Value {
    let output = solve(folder, &["scene.json", "-q", "--check"], "");
    assert!(output.status.success(), "{}", stderr(&output));
    serde_json::from_slice(&output.stdout).unwrap()
}

fn without_wall(output: &Output) -> Value {
    let mut summary: Value = serde_json::from_slice(&output.stdout).unwrap();
    assert!(summary.as_object_mut().unwrap().remove("wall_seconds").unwrap().is_number());
    summary
}

/// The summary of a scene with these files.
pub(crate) fn solved(scene: &Value, files: &[(&str, &str)]) -> Value {
    done(scene_folder(scene, files).path(), &["scene.json", "-q"], "")
}

/// Solves a scene with these files, which must be refused with these texts on stderr.
pub(crate) fn refused(scene: &Value, files: &[(&str, &str)], texts: &[&str]) {
    let output = solve(scene_folder(scene, files).path(), &["scene.json"], "");
    let error = stderr(&output);
    assert_eq!(output.status.code(), Some(2), "{error}");
    assert!(texts.iter().all(|text| error.contains(text)), "{texts:?} not in {error}");
}

/// A folder with a scene file and further files.
pub(crate) fn scene_folder(scene: &Value, files: &[(&str, &str)]) -> tempfile::TempDir {
    let folder = tempfile::tempdir().unwrap();
    fs::write(folder.path().join("scene.json"), scene.to_string()).unwrap();
    for (name, text) in files {
        fs::write(folder.path().join(name), text).unwrap();
    }
    folder
}

pub(crate) fn number(summary: &Value, pointer: &str) -> f64 {
    summary.pointer(pointer).and_then(Value::as_f64).unwrap_or_else(|| panic!("{pointer}"))
}

/// A unit cube of quads, its lid in a separate group.
pub(crate) const CUBE: &str = "o box\nv 0 0 0\nv 1 0 0\nv 1 1 0\nv 0 1 0\nv 0 0 1\nv 1 0 1\nv 1 1 1\nv 0 1 1\n\
                    v 9 9 9\nf 4 3 2 1\nf 1 2 6 5\nf 2 3 7 6\nf 3 4 8 7\nf 4 1 5 8\ng lid\nf 5 6 7 8\n";

/// A scene of a cube for a few steps.
pub(crate) fn cube(mesh: &Value, gas: &Value) -> Value {
    json!({
        "mesh": mesh, "gas": gas, "solver": {"end_time": "20 ms", "cfl": 0.1},
        "outputs": {"sample_interval": "10 ms"},
    })
}

pub(crate) fn capsule() -> Value {
    json!({
        "design": paper_design(2),
        "gas": {"windows": [{"from": "2 ms", "to": "30 ms", "mass_flow_rate": "5 g/s"}], "leak_area": "1 cm2"},
        "release_time": "5 ms",
        "solver": {"end_time": "40 ms"},
        "outputs": {"nodes": [0, {"side": [0.5, 0, 0.02]}], "elements": {"first": 0}},
    })
}

#[test]
fn every_scene_that_ships_is_sound_by_the_schema_and_listed() {
    let schema = scene_schema();
    jsonschema::meta::validate(&schema).unwrap();
    let validator = jsonschema::validator_for(&schema).unwrap();
    let readme = fs::read_to_string(scenes().join("README.md")).unwrap();
    let mut count = 0;
    for entry in fs::read_dir(scenes()).unwrap() {
        let path = entry.unwrap().path();
        if path.extension().is_some_and(|extension| extension == "json") {
            assert_valid(&validator, &fs::read_to_string(&path).unwrap());
            let name = path.file_name().unwrap().to_str().unwrap().to_owned();
            assert!(readme.contains(&format!("`{name}`")), "{name} is not listed");
            count += 1;
        }
    }
    assert!(count >= 4);
    assert!(validator.is_valid(&capsule()));
    let printed = |arguments: &[&str]| {
        let output =
            Command::new(env!("CARGO_BIN_EXE_billow")).args(arguments).output().unwrap().stdout;
        serde_json::from_slice::<Value>(&output).unwrap()
    };
    assert_eq!(printed(&["keys", "--schema", "scene"]), schema);
}

/// A value of a summary: place, value, tolerance.
type Expected = (&'static str, f64, f64);

/// Scene, options, and values of its summary. The sphere has the closed form p = (t/R) E/(1 − ν)
/// (λ² − 1)/λ, T = p R λ/2; the airbag is that of the reference case `square_airbag`; the torque of the hub is the
/// same in motion and at rest.
const REFERENCES: [(&str, &[&str], &[Expected]); 5] = [
    (
        "sphere.json",
        &[],
        &[
            ("/resultants/top/T1", 250.5, 1.2),
            ("/resultants/top/P1", 251.0, 1.2),
            ("/nodes/top/2", 0.500_999_5, 5e-6),
        ],
    ),
    (
        "airbag.json",
        &[],
        &[
            ("/energies/potential", -77.596_580, 0.02),
            ("/nodes/middle/2", 0.216_952, 0.0012),
            ("/volume", 0.125 / 8.0, 4e-5),
        ],
    ),
    (
        "twist.json",
        &[],
        &[("/reactions/hub/moment/2", 17.367, 0.35), ("/ledger/support_work", 0.05, 0.005)],
    ),
    (
        "twist.json",
        &["--set", "solver.static=true"],
        &[("/reactions/hub/moment/2", 17.367, 0.35), ("/nodes/hub_point/1", 0.000_5, 1e-6)],
    ),
    (
        "capsule.json",
        &[],
        &[
            ("/ledger/residual", 0.0, 5e-3),
            ("/gas_mass", 0.0015, 1e-9),
            ("/volume", 0.6, 0.05),
            ("/passages", 0.0, 0.0),
        ],
    ),
];

#[test]
fn shipped_scenes_have_their_reference_values() {
    for (scene, options, values) in REFERENCES {
        let summary = done(&scenes(), &[&[scene, "-q"], options].concat(), "");
        assert_eq!(summary["status"], "done", "{scene}");
        for (place, value, tolerance) in values {
            let found = number(&summary, place);
            assert!((found - value).abs() <= *tolerance, "{scene} {place}: {found}, not {value}");
        }
    }
}

/// The same bits on every instruction set, and after a pause at any step.
fn same_bits(scene: &Value, pauses: &[&str]) {
    let folder = scene_folder(scene, &[]);
    let run = |out: &str, more: &[&str], simd: &str| {
        let arguments = [&["scene.json", "-q", "--out", out][..], more].concat();
        let summary = done(folder.path(), &arguments, simd);
        (summary, fs::read(folder.path().join(out)).unwrap())
    };
    let whole = run("whole.h5", &[], "");
    for set in InstructionSet::ALL.into_iter().filter(|set| set.available()) {
        let (summary, file) = run("set.h5", &[], set.name());
        assert_eq!(summary, whole.0, "{}", set.name());
        assert!(file == whole.1, "{}: the files differ", set.name());
    }
    let checkpoint = ["--checkpoint", "state.json"];
    let mut resume: Vec<&str> = Vec::new();
    for steps in pauses {
        let pause =
            [&["scene.json", "-q", "--stop-after", steps], &checkpoint[..], &resume].concat();
        let output = solve(folder.path(), &pause, "");
        assert!(output.status.success(), "{}", stderr(&output));
        assert_eq!(without_wall(&output)["status"], "paused");
        resume = vec!["--resume", "state.json"];
    }
    let rest = [&checkpoint[..], &["--every", "700"], &resume].concat();
    let (summary, file) = run("resumed.h5", &rest, "");
    assert_eq!(summary, whole.0);
    assert!(file == whole.1, "the files differ");
}

#[test]
fn bits_are_the_same_on_every_instruction_set_and_after_a_resume() {
    same_bits(&capsule(), &["1", "100", "1", "333"]);
}

#[test]
fn a_signal_stores_a_checkpoint_and_says_how_to_resume() {
    let mut scene = capsule();
    scene["solver"]["end_time"] = json!("100 s");
    let folder = scene_folder(&scene, &[]);
    let state = folder.path().join("state.json");
    let mut command = Command::new(env!("CARGO_BIN_EXE_billow"));
    command.args(["solve", "scene.json", "-q", "--checkpoint", "state.json", "--every", "2000"]);
    let child = command.current_dir(folder.path()).stderr(Stdio::piped()).spawn().unwrap();
    while !state.exists() {
        std::thread::sleep(Duration::from_millis(10));
    }
    signal(&child, "-INT");
    let output = child.wait_with_output().unwrap();
    assert_eq!(output.status.code(), Some(130));
    let error = stderr(&output);
    assert!(error.contains("is stored") && error.contains("--resume state.json"), "{error}");
    let more = ["scene.json", "-q", "--resume", "state.json", "--checkpoint", "state.json"];
    let paused = done(folder.path(), &[&more[..], &["--stop-after", "10"]].concat(), "");
    assert_eq!(paused["status"], "paused");
    assert!(number(&paused, "/steps") > 2000.0);
}

#[test]
fn an_erected_capsule_moves_its_ring_to_the_stowed_polygon() {
    let mut scene = capsule();
    scene["design"]["shape"] = json!("erected");
    scene["gas"] = json!({"pressure": "300 Pa"});
    scene["release_time"] = json!(0);
    scene["solver"]["cfl"] = json!(0.1);
    let moved = solved(&scene, &[]);
    scene["solver"] = json!({"static": true});
    let rest = solved(&scene, &[]);
    for summary in [&moved, &rest] {
        // The corner of the stowed N-gon, not the radius of the ring.
        let corner = number(summary, "/nodes/side/0");
        assert!((corner - 0.523_171).abs() < 1e-5, "{corner}");
    }
}

#[test]
fn histories_contain_the_tracked_columns() {
    let folder = scene_folder(&capsule(), &[]);
    done(folder.path(), &["scene.json", "-q", "--out", "a.h5"], "");
    let stored = history_file::read(&folder.path().join("a.h5")).unwrap();
    assert_eq!((stored.status.name(), stored.history.len()), ("done", 41));
    assert_eq!(stored.history.column("z_rim").len(), 41);

    let gas = json!({"initial_pressure": "0.1 Pa"});
    let folder =
        scene_folder(&cube(&json!({"positions": "cube.obj"}), &gas), &[("cube.obj", CUBE)]);
    done(folder.path(), &["scene.json", "-q", "--out", "a.h5", "--shape", "end.obj"], "");
    let stored = history_file::read(&folder.path().join("a.h5")).unwrap();
    assert_eq!(stored.history.column("volume").len(), 3);
    assert!(stored.history.column("z_rim").is_empty(), "a mesh has no rings");
    assert!(stored.scene.contains("\"cube.obj\""));
    let shape = fs::read_to_string(folder.path().join("end.obj")).unwrap();
    assert_eq!(shape.lines().filter(|line| line.starts_with("v ")).count(), 9);
    assert!(shape.contains("v 9 9 9") && shape.contains("f 5 6 7 8"), "{shape}");
}

#[test]
fn a_rigid_plane_moves_as_a_body() {
    let mut scene = cube(&json!({"positions": "cube.obj"}), &json!({"pressure": "1 Pa"}));
    scene["supports"] = json!([
        {"on": "plane", "point": [0, 0, 1], "normal": [0, 0, 2],
         "body": {"mass": "2 kg", "velocity": "1 m/s", "force": "-3 N"}},
        {"on": "plane", "point": [0, 0, 0], "normal": [0, 0, 1]},
    ]);
    scene["solver"] = json!({"end_time": "1 ms"});
    scene["outputs"] = json!({"nodes": {"lid": 4}, "sample_interval": "0.5 ms"});
    let summary = solved(&scene, &[("cube.obj", CUBE)]);
    assert!((number(&summary, "/nodes/lid/2") - 1.001).abs() < 1e-4);
    assert!(
        summary["reactions"]["plane"].is_object() && summary["reactions"]["plane_2"].is_object()
    );
}

#[test]
fn initial_velocities_add_up() {
    let mut scene = cube(&json!({"positions": "cube.obj"}), &json!({"pressure": 0}));
    scene["start"] = json!({
        "velocity": ["1 m/s", 0, "3 m/s"],
        "spin": {"axis": [0, 0, 1], "rate": "10 rad/s"},
    });
    scene["gravity"] = json!(["1 m/s2", 0, -10]);
    scene["solver"] = json!({"end_time": "20 us"});
    scene["outputs"] = json!({"nodes": [1], "sample_interval": "5 us"});
    let summary = solved(&scene, &[("cube.obj", CUBE)]);
    let position: Vec<f64> =
        summary["nodes"]["1"].as_array().unwrap().iter().map(|n| n.as_f64().unwrap()).collect();
    // Vertex 1 starts at (1, 0, 0): velocity (0, 10, 0) by spin, (1, 0, 3) for all.
    for (x, expected) in position.iter().zip([1.0 + 2e-5, 2e-4, 6e-5]) {
        assert!((x - expected).abs() < 5e-6, "{x} {expected}");
    }
}

#[test]
fn a_failed_run_reports_the_reason_and_keeps_its_history() {
    let mut scene = capsule();
    scene["solver"]["step_limit"] = json!(50);
    let folder = scene_folder(&scene, &[]);
    let output = solve(folder.path(), &["scene.json", "-q", "--out", "a.h5"], "");
    assert_eq!(output.status.code(), Some(1));
    let summary = without_wall(&output);
    assert_eq!(summary["status"], "step_limit");
    assert_eq!(summary["stop"]["kind"], "step_limit");
    assert!(number(&summary, "/stop/time") < 0.04);
    assert!(stderr(&output).contains("step_limit"));
    assert_eq!(
        history_file::read(&folder.path().join("a.h5")).unwrap().status.name(),
        "step_limit"
    );
}
