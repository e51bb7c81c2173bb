//! `billow solve`: the scenes that ship, broken ones, checkpoints, files.

use std::fs;
use std::path::{Path, PathBuf};
use std::process::{Command, Output};

use billow_study::history_file;
use billow_study::schema::scene_schema;
use serde_json::{Value, json};

use crate::support::stderr;

fn scenes() -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("../scenes")
}

fn solve(folder: &Path, arguments: &[&str], simd: &str) -> Output {
    let mut command = Command::new(env!("CARGO_BIN_EXE_billow"));
    command.arg("solve").args(arguments).current_dir(folder).env("BILLOW_SIMD", simd);
    command.output().unwrap()
}

/// The summary of a scene that is to be done, without its wall time.
fn done(folder: &Path, arguments: &[&str], simd: &str) -> Value {
    let output = solve(folder, arguments, simd);
    assert!(output.status.success(), "{arguments:?}: {}", stderr(&output));
    without_wall(&output)
}

fn without_wall(output: &Output) -> Value {
    let mut summary: Value = serde_json::from_slice(&output.stdout).unwrap();
    assert!(summary.as_object_mut().unwrap().remove("wall_seconds").unwrap().is_number());
    summary
}

/// A folder with a scene file in it.
fn desk(scene: &Value, files: &[(&str, &str)]) -> tempfile::TempDir {
    let folder = tempfile::tempdir().unwrap();
    fs::write(folder.path().join("scene.json"), scene.to_string()).unwrap();
    for (name, text) in files {
        fs::write(folder.path().join(name), text).unwrap();
    }
    folder
}

fn number(summary: &Value, pointer: &str) -> f64 {
    summary.pointer(pointer).and_then(Value::as_f64).unwrap_or_else(|| panic!("{pointer}"))
}

/// A unit cube of quads, its lid in a group of its own.
const CUBE: &str = "o box\nv 0 0 0\nv 1 0 0\nv 1 1 0\nv 0 1 0\nv 0 0 1\nv 1 0 1\nv 1 1 1\nv 0 1 1\n\
                    v 9 9 9\nf 4 3 2 1\nf 1 2 6 5\nf 2 3 7 6\nf 3 4 8 7\nf 4 1 5 8\ng lid\nf 5 6 7 8\n";

/// A cube that runs a few steps.
fn cube(mesh: &Value, gas: &Value) -> Value {
    json!({
        "mesh": mesh, "gas": gas, "solver": {"end_time": "20 ms", "cfl": 0.1},
        "outputs": {"sample_interval": "10 ms"},
    })
}

fn capsule() -> Value {
    json!({
        "design": {
            "N": 6, "M": 3, "bottom_radius": "500 mm", "top_radius": "365 mm", "height": 1,
            "subdivisions": 2,
        },
        "gas": {"windows": [{"from": "2 ms", "to": "30 ms", "rate": "5 g/s"}], "leak_area": "1 cm2"},
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
            let scene: Value = serde_json::from_str(&fs::read_to_string(&path).unwrap()).unwrap();
            let errors: Vec<_> = validator
                .iter_errors(&scene)
                .map(|e| format!("{}: {e}", e.instance_path()))
                .collect();
            assert!(errors.is_empty(), "{}: {errors:?}", path.display());
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
    assert_eq!(printed(&["schema", "scene"]), schema);
    assert_eq!(printed(&["schema", "--scene"]), schema);
}

#[test]
fn a_sphere_at_rest_stretches_as_the_closed_form() {
    let summary = done(&scenes(), &["sphere.json", "-q"], "");
    assert_eq!(summary["status"], "done");
    // p = (t/R) E/(1 − ν) (λ² − 1)/λ at 1 kPa; 320 elements.
    let stretch = number(&summary, "/nodes/top/2") / 0.5 - 1.0;
    assert!((stretch / 1.999_027e-3 - 1.0).abs() < 0.03, "{stretch}");
    assert_eq!(summary["resultants"]["top"]["regime"], "taut");
    assert!((number(&summary, "/resultants/top/T1") / 250.5 - 1.0).abs() < 0.03);
    assert!((number(&summary, "/extents/z/1") - number(&summary, "/nodes/top/2")).abs() < 1e-9);
}

#[test]
fn the_square_airbag_has_its_known_energy() {
    let summary = done(&scenes(), &["airbag.json", "-q"], "");
    assert!((number(&summary, "/energies/potential") + 77.596_580).abs() < 0.02);
    assert!((number(&summary, "/nodes/middle/2") - 0.216_952).abs() < 0.0012);
    assert!((8.0 * number(&summary, "/volume") - 0.125).abs() < 3e-4, "{}", summary["volume"]);
    let corner = 0.6 - number(&summary, "/nodes/corner/0") * 2.0_f64.sqrt();
    assert!((corner - 0.049_174).abs() < 1e-3, "{corner}");
}

#[test]
fn a_hub_turned_in_time_and_at_rest_bears_the_same_torque() {
    let moved = done(&scenes(), &["twist.json", "-q"], "");
    let rest = done(&scenes(), &["twist.json", "-q", "--set", "solver.static=true"], "");
    let torque = |summary: &Value| number(summary, "/reactions/hub/moment/2");
    assert!((torque(&rest) / 17.367 - 1.0).abs() < 0.02, "{}", torque(&rest));
    assert!((torque(&moved) / torque(&rest) - 1.0).abs() < 0.01, "{}", torque(&moved));
    assert!(number(&moved, "/ledger/support_work") > 0.0);
    let point = moved["nodes"]["hub_point"].as_array().unwrap();
    assert!((point[1].as_f64().unwrap() - 0.1 * libm::sin(0.005)).abs() < 1e-9);
}

#[test]
fn the_papers_capsule_keeps_its_energy() {
    let summary = done(&scenes(), &["capsule.json", "-q"], "");
    assert!(number(&summary, "/ledger/residual") <= 5e-3, "{}", summary["ledger"]);
    assert!(number(&summary, "/volume") > 0.55);
    assert!((number(&summary, "/gas_mass") - 0.0015).abs() < 1e-9);
    assert!(
        summary["nodes"]["top_centre"].is_array() && summary["nodes"]["bottom_centre"].is_array()
    );
}

/// The same bits whatever the instruction set, the threads, and where it was paused.
fn same_bits(scene: &Value, pauses: &[&str]) {
    let folder = desk(scene, &[]);
    let run = |out: &str, more: &[&str], simd: &str| {
        let arguments = [&["scene.json", "-q", "--out", out][..], more].concat();
        let summary = done(folder.path(), &arguments, simd);
        (summary, fs::read(folder.path().join(out)).unwrap())
    };
    let whole = run("whole.h5", &["--threads", "1"], "");
    assert_eq!(run("threads.h5", &["--threads", "2"], ""), whole);
    for path in billow_solver::simd::Path::ALL.into_iter().filter(|path| path.available()) {
        assert_eq!(run("path.h5", &[], path.name()), whole, "{}", path.name());
    }
    let checkpoint = ["--checkpoint", "state.json"];
    let mut go_on: Vec<&str> = Vec::new();
    for steps in pauses {
        let pause =
            [&["scene.json", "-q", "--stop-after", steps], &checkpoint[..], &go_on].concat();
        let output = solve(folder.path(), &pause, "");
        assert!(output.status.success(), "{}", stderr(&output));
        assert_eq!(without_wall(&output)["status"], "paused");
        go_on = vec!["--resume", "state.json"];
    }
    let rest = [&checkpoint[..], &["--every", "700"], &go_on].concat();
    assert_eq!(run("resumed.h5", &rest, ""), whole);
}

#[test]
fn the_same_bits_on_every_path_and_resumed_from_any_step() {
    same_bits(&capsule(), &["1", "100", "1", "333"]);
}

#[test]
#[ignore = "long: 0.3 s of the paper's capsule at n 5, seven times"]
fn the_papers_capsule_has_the_same_bits_however_it_is_run() {
    let scene = fs::read_to_string(scenes().join("capsule.json")).unwrap();
    same_bits(&serde_json::from_str(&scene).unwrap(), &["1", "12345", "9999"]);
}

#[test]
fn an_erected_capsule_moves_its_ring_to_where_it_is_held_stowed() {
    let mut scene = capsule();
    scene["design"]["shape"] = json!("erected");
    scene["gas"] = json!({"pressure": "300 Pa"});
    scene["release_time"] = json!(0);
    scene["solver"]["cfl"] = json!(0.1);
    let moved = done(desk(&scene, &[]).path(), &["scene.json", "-q"], "");
    scene["solver"] = json!({"static": true});
    let rest = done(desk(&scene, &[]).path(), &["scene.json", "-q"], "");
    for summary in [&moved, &rest] {
        // The corner of the stowed N-gon, not the ring's own radius.
        let corner = number(summary, "/nodes/side/0");
        assert!((corner - 0.523_171).abs() < 1e-5, "{corner}");
    }
}

#[test]
fn histories_hold_what_was_followed() {
    let folder = desk(&capsule(), &[]);
    done(folder.path(), &["scene.json", "-q", "--out", "a.h5"], "");
    let stored = history_file::read(&folder.path().join("a.h5")).unwrap();
    assert_eq!((stored.status.as_str(), stored.history.len()), ("done", 41));
    assert_eq!(stored.history.column("z_rim").len(), 41);

    let gas = json!({"initial_pressure": "0.1 Pa"});
    let folder = desk(&cube(&json!({"positions": "cube.obj"}), &gas), &[("cube.obj", CUBE)]);
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
fn meshes_of_other_programs_are_taken() {
    let gas = json!({"initial_pressure": "0.1 Pa"});
    let volume = |mesh: &Value, files: &[(&str, &str)]| {
        let scene = cube(mesh, &gas);
        assert!(jsonschema::validator_for(&scene_schema()).unwrap().is_valid(&scene));
        number(&done(desk(&scene, files).path(), &["scene.json", "-q"], ""), "/volume")
    };
    let cube_file = ("cube.obj", CUBE);
    let near =
        |volume: f64, expected: f64| assert!((volume / expected - 1.0).abs() < 3e-3, "{volume}");
    near(volume(&json!({"positions": "cube.obj"}), &[cube_file]), 1.0);
    near(volume(&json!({"positions": "cube.obj", "scale": 0.1}), &[cube_file]), 1e-3);
    near(volume(&json!({"positions": "cube.obj", "closure": ["lid"]}), &[cube_file]), 1.0);
    // Without its lid it is open, and a fan closes it; or faces of another file do.
    let open = CUBE.lines().take(15).fold(String::new(), |text, line| text + line + "\r\n");
    near(volume(&json!({"positions": "open.obj"}), &[("open.obj", &open)]), 1.0);
    let lid = [("open.obj", open.as_str()), ("lid.obj", "f 5 6 7 8\n")];
    near(volume(&json!({"positions": "open.obj", "closure": "lid.obj"}), &lid), 1.0);
    // Every face with vertices of its own: joined where asked.
    let (vertices, faces): (Vec<&str>, Vec<&str>) =
        CUBE.lines().partition(|line| line.starts_with("v "));
    let mut apart = String::new();
    for face in faces.iter().filter(|line| line.starts_with("f ")) {
        for corner in face.split_whitespace().skip(1) {
            apart += vertices[corner.parse::<usize>().unwrap() - 1];
            apart += "\n";
        }
        apart += "f -4 -3 -2 -1\n";
    }
    let apart = [("apart.obj", apart.as_str())];
    near(volume(&json!({"positions": "apart.obj", "weld": 0}), &apart), 1.0);
    near(volume(&json!({"positions": "apart.obj", "weld": "1 um"}), &apart), 1.0);
    let scene = cube(&json!({"positions": "apart.obj"}), &gas);
    let output = solve(desk(&scene, &apart).path(), &["scene.json"], "");
    assert_eq!(output.status.code(), Some(2));
    let error = stderr(&output);
    assert!(error.contains("leaks") && error.contains("mesh.weld"), "{error}");
    // A reference cut apart, as flattening programs leave it, and the same face by face.
    let flat = "v 0 0 0\nv 1 0 0\nv 1 1 0\nv 0 1 0\n".repeat(6)
        + "f 1 2 3 4\nf 5 6 7 8\nf 9 10 11 12\nf 13 14 15 16\nf 17 18 19 20\nf 21 22 23 24\n";
    let files = [cube_file, ("flat.obj", flat.as_str())];
    near(volume(&json!({"positions": "cube.obj", "reference": "flat.obj"}), &files), 1.0);
    let square = json!([[0, 0], ["1 m", 0], [1, "100 cm"], [0, 1]]);
    let inline = json!([square, square, square, square, square, square]);
    near(volume(&json!({"positions": "cube.obj", "reference": inline}), &[cube_file]), 1.0);
}

#[test]
fn a_rigid_plane_is_a_body_of_its_own() {
    let mut scene = cube(&json!({"positions": "cube.obj"}), &json!({"pressure": "1 Pa"}));
    scene["supports"] = json!([
        {"on": "plane", "point": [0, 0, 1], "normal": [0, 0, 2],
         "body": {"mass": "2 kg", "velocity": "1 m/s", "force": "-3 N"}},
        {"on": "plane", "point": [0, 0, 0], "normal": [0, 0, 1]},
    ]);
    scene["solver"] = json!({"end_time": "1 ms"});
    scene["outputs"] = json!({"nodes": {"lid": 4}, "sample_interval": "0.5 ms"});
    let summary = done(desk(&scene, &[("cube.obj", CUBE)]).path(), &["scene.json", "-q"], "");
    assert!((number(&summary, "/nodes/lid/2") - 1.001).abs() < 1e-4);
    assert!(
        summary["reactions"]["plane"].is_object() && summary["reactions"]["plane_2"].is_object()
    );
}

#[test]
fn a_start_spins_and_flies() {
    let mut scene = cube(&json!({"positions": "cube.obj"}), &json!({"pressure": 0}));
    scene["start"] = json!({
        "velocity": [0, 0, "3 m/s"], "velocities": "cube.obj",
        "spin": {"axis": [0, 0, 1], "rate": "10 rad/s"},
    });
    scene["gravity"] = json!(["1 m/s2", 0, -10]);
    scene["solver"] = json!({"end_time": "20 us"});
    scene["outputs"] = json!({"nodes": [1], "sample_interval": "5 us"});
    let summary = done(desk(&scene, &[("cube.obj", CUBE)]).path(), &["scene.json", "-q"], "");
    let place: Vec<f64> =
        summary["nodes"]["1"].as_array().unwrap().iter().map(|n| n.as_f64().unwrap()).collect();
    // Vertex 1 starts at (1, 0, 0): spin (0, 10, 0), its own (1, 0, 0), the rest (0, 0, 3).
    for (place, expected) in place.iter().zip([1.0 + 2e-5, 2e-4, 6e-5]) {
        assert!((place - expected).abs() < 5e-6, "{place} {expected}");
    }
}

#[test]
fn what_is_wrong_is_said_once_and_where() {
    let inward: String = CUBE
        .lines()
        .map(|line| match line.strip_prefix("f ") {
            Some(rest) => {
                let mut corners: Vec<&str> = rest.split_whitespace().collect();
                corners.reverse();
                format!("f {}\n", corners.join(" "))
            }
            None => format!("{line}\n"),
        })
        .collect();
    let twisted = CUBE.replace("f 5 6 7 8", "f 8 7 6 5");
    let files: Vec<(&str, &str)> = vec![
        ("cube.obj", CUBE),
        ("inward.obj", &inward),
        ("twisted.obj", &twisted),
        ("stl.obj", "solid x\n"),
        ("none.obj", "v 0 0 0\n"),
    ];
    let sound = cube(&json!({"positions": "cube.obj"}), &json!({"initial_pressure": "0.1 Pa"}));
    let cases: Vec<(&str, Value, &[&str])> = vec![
        ("/mesh/positions", json!("inward.obj"), &["mesh.positions", "wound inward", "flip"]),
        ("/mesh/positions", json!("twisted.obj"), &["wind against each other", "vertices"]),
        ("/mesh/positions", json!("stl.obj"), &["stl.obj", "line 1", "no keyword"]),
        ("/mesh/positions", json!("none.obj"), &["no faces"]),
        ("/mesh/positions", json!("gone.obj"), &["gone.obj", "mesh.positions"]),
        ("/mesh/closure", json!(["lids"]), &["\"lids\"", "box, lid"]),
        ("/mesh/closure", json!(["box"]), &["every face"]),
        ("/mesh/weld", json!(2), &["mesh.weld", "out of range"]),
        ("/mesh/weld", json!(1), &["welding leaves a face without area"]),
        ("/mesh/reference", json!([[[0, 0], [1, 0], [1, 1]]]), &["has 1 faces", "6 of film"]),
        ("/mesh/postions", json!("x"), &["did you mean positions?"]),
        ("/design", json!({}), &["both design and mesh"]),
        ("/gas/pressure", json!(5), &["stands beside a fixed pressure"]),
        ("/gas/presure", json!(5), &["did you mean pressure?"]),
        ("/gas/initial_mass", json!(1), &["beside initial_mass"]),
        ("/gas/windows", json!([{"from": 2, "to": 1, "rate": 1}]), &["windows[0].to", "before"]),
        ("/gas/windows", json!([{"from": 0}]), &["windows[0].rate", "missing"]),
        ("/film", json!({"thickness": "1 kg"}), &["film.thickness", "is a mass"]),
        ("/supports", json!([{"on": "ring", "which": "top", "fix": "x"}]), &["no rings"]),
        ("/supports", json!([{"on": "box", "min": [5, 5, 5], "fix": "x"}]), &["selects nothing"]),
        ("/supports", json!([{"on": "nodes", "nodes": [8], "fix": "x"}]), &["vertex 8", "no face"]),
        ("/supports", json!([{"on": "nodes", "nodes": [9], "fix": "x"}]), &["vertex 9 of 9"]),
        ("/supports", json!([{"on": "all", "fix": "xx"}]), &["supports[0].fix"]),
        ("/supports", json!([{"on": "all", "min": [0, 0, 0], "fix": "x"}]), &["belongs to"]),
        ("/supports", json!([{"on": "boundary", "fix": "x"}]), &["free edges"]),
        (
            "/supports",
            json!([{"on": "plane", "point": [0, 0, 0], "normal": [0, 0, 0]}]),
            &["no direction"],
        ),
        ("/outputs/nodes", json!([99]), &["outputs.nodes", "vertex 99"]),
        ("/outputs/elements", json!({"a": 99}), &["outputs.elements", "triangle 99 of 12"]),
        ("/outputs/nodes", json!([{"a b": 1}]), &["is no name"]),
        ("/solver/static", json!(true), &["no fixed pressure"]),
        ("/solver/static", json!("yes"), &["solver.static", "true or false"]),
        ("/solver/cfl", json!(2), &["solver.cfl"]),
        ("/gravity", json!([0, 0]), &["gravity", "2 of three"]),
        ("/version", json!(2), &["newer format"]),
        ("/start", json!({"velocities": "none.obj"}), &["has 1 vertices; the mesh has 9"]),
        ("/sead", json!(1), &["is no key of a scene"]),
    ];
    for (pointer, value, expected) in cases {
        let mut scene = sound.clone();
        let (parent, leaf) = pointer.rsplit_once('/').unwrap();
        scene.pointer_mut(parent).unwrap()[leaf] = value.clone();
        let output = solve(desk(&scene, &files).path(), &["scene.json"], "");
        let error = stderr(&output);
        assert_eq!(output.status.code(), Some(2), "{pointer} = {value}: {error}");
        assert!(output.stdout.is_empty(), "{pointer} = {value}");
        for part in expected {
            assert!(error.contains(part), "{pointer} = {value}: {part:?} not in {error}");
        }
        assert_eq!(error.matches("billow: ").count(), 1, "{error}");
    }
    assert!(solve(desk(&sound, &files).path(), &["scene.json", "-q"], "").status.success());
}

#[test]
fn flags_that_cannot_be_are_refused() {
    let folder = desk(&capsule(), &[("rest.json", ""), ("broken", "{\"format\": 1}")]);
    for (arguments, simd, expected) in [
        (&["scene.json"][..], "neon", "scalar"),
        (&["scene.json", "--resume", "gone"], "", "gone"),
        (&["scene.json", "--resume", "broken"], "", "no sound checkpoint"),
        (&["scene.json", "--every", "5"], "", "--checkpoint"),
        (&["scene.json", "--threads", "0"], "", "--threads"),
        (&["gone.json"], "", "scenes/sphere.json"),
    ] {
        let output = solve(folder.path(), arguments, simd);
        assert_eq!(output.status.code(), Some(2), "{arguments:?}");
        assert!(stderr(&output).contains(expected), "{arguments:?}: {}", stderr(&output));
    }
    // A checkpoint is of its own scene.
    let pause = ["scene.json", "-q", "--stop-after", "9", "--checkpoint", "state"];
    done(folder.path(), &pause, "");
    let other = ["scene.json", "-q", "--resume", "state", "--set", "film.viscosity=0.05"];
    let output = solve(folder.path(), &other, "");
    assert_eq!(output.status.code(), Some(2));
    assert!(stderr(&output).contains("of another scene"), "{}", stderr(&output));
}

#[test]
fn a_run_that_stops_short_says_why_and_keeps_its_history() {
    let mut scene = capsule();
    scene["solver"]["step_limit"] = json!(50);
    let folder = desk(&scene, &[]);
    let output = solve(folder.path(), &["scene.json", "-q", "--out", "a.h5"], "");
    assert_eq!(output.status.code(), Some(1));
    let summary = without_wall(&output);
    assert_eq!(summary["status"], "step_limit");
    assert_eq!(summary["stop"]["kind"], "step_limit");
    assert!(number(&summary, "/stop/time") < 0.04);
    assert!(stderr(&output).contains("step_limit"));
    assert_eq!(history_file::read(&folder.path().join("a.h5")).unwrap().status, "step_limit");
    let table = solve(&scenes(), &["sphere.json", "-q", "--format", "table"], "");
    let text = String::from_utf8(table.stdout).unwrap();
    assert!(text.contains("nodes.top.2") && text.contains("status"), "{text}");
}
