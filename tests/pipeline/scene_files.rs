//! Scene files: meshes of other programs, and errors of invalid scenes, flags and files.

use billow_study::input::schema::scene_schema;
use serde_json::{Value, json};

use crate::solve::{CUBE, capsule, cube, done, number, refused, scene_folder, solve, solved};
use crate::support::stderr;

#[test]
fn meshes_of_other_programs_are_read() {
    let gas = json!({"initial_pressure": "0.1 Pa"});
    let volume = |mesh: &Value, files: &[(&str, &str)]| {
        let scene = cube(mesh, &gas);
        assert!(jsonschema::validator_for(&scene_schema()).unwrap().is_valid(&scene));
        number(&solved(&scene, files), "/volume")
    };
    let cube_file = ("cube.obj", CUBE);
    let near =
        |volume: f64, expected: f64| assert!((volume / expected - 1.0).abs() < 3e-3, "{volume}");
    near(volume(&json!({"positions": "cube.obj"}), &[cube_file]), 1.0);
    near(volume(&json!({"positions": "cube.obj", "scale": 0.1}), &[cube_file]), 1e-3);
    near(volume(&json!({"positions": "cube.obj", "closure": ["lid"]}), &[cube_file]), 1.0);
    // Without its lid the cube is open: a fan closes it.
    let open = CUBE.lines().take(15).fold(String::new(), |text, line| text + line + "\r\n");
    near(volume(&json!({"positions": "open.obj"}), &[("open.obj", &open)]), 1.0);
    // Every face has separate vertices: `weld` joins them.
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
    refused(&scene, &apart, &["leaks", "mesh.weld"]);
    // A reference with separate faces, as flattening programs write it.
    let flat = "v 0 0 0\nv 1 0 0\nv 1 1 0\nv 0 1 0\n".repeat(6)
        + "f 1 2 3 4\nf 5 6 7 8\nf 9 10 11 12\nf 13 14 15 16\nf 17 18 19 20\nf 21 22 23 24\n";
    let files = [cube_file, ("flat.obj", flat.as_str())];
    near(volume(&json!({"positions": "cube.obj", "reference": "flat.obj"}), &files), 1.0);
}

#[test]
fn a_vertex_of_closure_that_no_rim_places_is_refused() {
    let open = CUBE.lines().take(15).fold(String::new(), |text, line| text + line + "\n");
    // Three of four faces about the centre: one edge is free.
    let part = open.replace("v 9 9 9", "v 0.4 0.5 1") + "g lid\nf 5 6 9\nf 6 7 9\nf 7 8 9\n";
    let whole = part.clone() + "f 8 5 9\n";
    let scene =
        cube(&json!({"positions": "cube.obj", "closure": "lid"}), &json!({"pressure": "0.1 Pa"}));
    solved(&scene, &[("cube.obj", &whole)]);
    let texts = ["mesh.closure", "OBJ vertex 9", "belongs to no film", "fix xyz"];
    refused(&scene, &[("cube.obj", &part)], &texts);
}

#[test]
fn a_checkpoint_of_another_scene_is_refused() {
    let folder = scene_folder(&capsule(), &[]);
    let pause = ["scene.json", "-q", "--stop-after", "9", "--checkpoint", "state"];
    done(folder.path(), &pause, "");
    let other = ["scene.json", "-q", "--resume", "state", "--set", "film.numerical_damping=0.05"];
    let output = solve(folder.path(), &other, "");
    assert_eq!(output.status.code(), Some(2));
    assert!(stderr(&output).contains("of another scene"), "{}", stderr(&output));
}

/// Two square sheets on each other, joined at the rim.
#[test]
fn a_flat_bag_opens_under_pressure_and_cannot_contain_gas() {
    let mut text = String::new();
    for [x, y] in [[0, 0], [2, 0], [2, 2], [0, 2], [1, 1], [1, 1]] {
        text.push_str(&["v", &x.to_string(), &y.to_string(), "0\n"].join(" "));
    }
    for [a, b] in [[1, 2], [2, 3], [3, 4], [4, 1]] {
        text.push_str(&["f", &a.to_string(), &b.to_string(), "5\n"].join(" "));
        text.push_str(&["f", &b.to_string(), &a.to_string(), "6\n"].join(" "));
    }
    let scene = |gas: &Value| {
        json!({
            "mesh": {"positions": "bag.obj"}, "gas": gas, "solver": {"end_time": "1 ms"},
        })
    };
    let files = [("bag.obj", text.as_str())];
    let folder = scene_folder(&scene(&json!({"pressure": "100 Pa"})), &files);
    let rest = ["scene.json", "--set", "solver.static=true"];
    let summary = done(folder.path(), &rest, "");
    assert!(number(&summary, "/volume") > 0.1, "{summary}");
    // A negative pressure turns it inside out: no result.
    let output = solve(folder.path(), &[&rest[..], &["--set", "gas.pressure=-100"]].concat(), "");
    assert_eq!(output.status.code(), Some(1), "{}", stderr(&output));
    assert!(stderr(&output).contains("inverted_volume"), "{}", stderr(&output));

    let gas = scene(&json!({"initial_mass": "1 g"}));
    refused(&gas, &files, &["encloses no volume: its layers touch each other"]);
}

#[test]
fn keys_without_effect_are_noted() {
    let mut scene = capsule();
    scene["outputs"]["nodes"] = json!({"off": [200, 0, 500]});
    scene["release_time"] = json!("1 s");
    scene["gas"] = json!({"windows": [{"mass_flow_rate": "5 g/s"}]});
    scene["outputs"]["sample_interval"] = json!("10 ms");
    scene["solver"] = json!({"end_time": "10 ms"});
    let summary = solved(&scene, &[]);
    let notes = summary["notes"].to_string();
    assert!(notes.contains("the one nearest to [200.0, 0.0, 500.0] m is"), "{notes}");
    assert!(notes.contains("release_time has no effect: the film stays packed"), "{notes}");
}
