//! Scene files: meshes of other programs, and errors of invalid scenes, flags and files.

use std::fmt::Write as _;

use billow_study::input::schema::scene_schema;
use serde_json::{Value, json};

use crate::solve::{
    CUBE, capsule, checked, cube, done, number, refused, scene_folder, solve, solved,
};
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
fn texture_coordinates_are_the_stress_free_shape_on_request() {
    let gas = json!({"pressure": "0.1 Pa"});
    // A sheet of 1 m by 1 m, flattened to half of it in the units of its texture.
    let sheet = "v 0 0 0\nv 1 0 0\nv 1 1 0\nv 0 1 0\nvt 0 0\nvt 0.5 0\nvt 0.5 0.5\nvt 0 0.5\nf 1/1 2/2 3/3 4/4\n";
    let files = [("cube.obj", sheet)];
    let scene = |unit: Value| {
        let mut scene = cube(&json!({"positions": "cube.obj", "texture_unit": unit}), &gas);
        scene["supports"] = json!([{"on": "boundary", "fix": "xyz"}]);
        scene
    };
    let folder = scene_folder(&scene(json!("2 m")), &files);
    let report = checked(folder.path());
    for key in ["/area", "/stretch/start/0", "/stretch/start/1"] {
        assert!((number(&report, key) - 1.0).abs() < 1e-12, "{report}");
    }
    let folder = scene_folder(&scene(json!("1 m")), &files);
    let report = checked(folder.path()).to_string();
    assert!(report.contains("stretched to 2.0000 times"), "{report}");
    let plain = [("cube.obj", "v 0 0 0\nv 1 0 0\nv 1 1 0\nv 0 1 0\nf 1 2 3 4\n")];
    refused(&scene(json!("1 m")), &plain, &["mesh.texture_unit", "the face on line 5", "vt u v"]);
}

#[test]
fn an_inflow_is_a_table_in_the_scene_or_a_file() {
    let scene = |table: Value| {
        let windows = json!([{"from": "1 ms", "table": table}]);
        let gas = json!({"initial_pressure": "0.1 Pa", "windows": windows});
        let mut scene = cube(&json!({"positions": "cube.obj"}), &gas);
        scene["solver"]["end_time"] = json!("12 ms");
        scene
    };
    let csv = "time (ms),mass_flow_rate (g/s)\n0,0\n4,2\n10,2\n";
    let files = [("cube.obj", CUBE), ("flow.csv", csv)];
    let points = json!([["0 s", 0], ["4 ms", "2 g/s"], ["10 ms", "2 g/s"]]);
    let inside = solved(&scene(points), &files);
    // 4 ms of 1 g/s in the mean, then 6 ms of 2 g/s; 0.1 Pa of nitrogen before.
    let before = 0.1 / (296.8 * 293.0);
    let mass = number(&inside, "/gas_mass") - before;
    assert!((mass / 16e-6 - 1.0).abs() < 1e-3, "{mass}");
    let from_file = solved(&scene(json!("flow.csv")), &files);
    assert_eq!(from_file["gas_mass"], inside["gas_mass"]);
    for (table, texts) in [
        (json!([[0, 1]]), vec!["gas.windows[0].table", "has 1 points"]),
        (json!([[0, 1], [0, 2]]), vec!["do not ascend"]),
        (json!([[0, 1], [1, -2]]), vec!["not a time and a mass flow rate", "CSV file"]),
        (json!([[0, "1 m"], [1, 2]]), vec!["not a time and a mass flow rate"]),
        (json!(7), vec!["neither a list nor a file"]),
    ] {
        refused(&scene(table), &files, &texts);
    }
    let mut both = scene(json!("flow.csv"));
    both["gas"]["windows"][0]["mass_flow_rate"] = json!("1 g/s");
    refused(&both, &files, &["gas.windows[0].mass_flow_rate", "beside table"]);
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
    let texts = ["mesh.closure", "vertex 9", "belongs to no film", "fix xyz"];
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

/// A box from 0 to these lengths, its faces outward or inward, with its lower corner here.
fn block(lengths: [f64; 3], at: [f64; 3], outward: bool, first: u32) -> String {
    let mut text = String::new();
    for corner in 0..8_u32 {
        let x = [0, 1, 2].map(|k| at[k] + if corner >> k & 1 == 1 { lengths[k] } else { 0.0 });
        writeln!(text, "v {} {} {}", x[0], x[1], x[2]).unwrap();
    }
    for face in [[0, 2, 3, 1], [4, 5, 7, 6], [0, 1, 5, 4], [1, 3, 7, 5], [3, 2, 6, 7], [2, 0, 4, 6]]
    {
        let mut corners = face.map(|corner| (corner + first).to_string());
        if !outward {
            corners.reverse();
        }
        writeln!(text, "f {}", corners.join(" ")).unwrap();
    }
    text
}

#[test]
fn a_face_that_is_not_convex_may_be_listed_from_any_corner() {
    let corners = [[0, 0], [2, 0], [2, 1], [1, 1], [1, 2], [0, 2]];
    let mut volumes = Vec::new();
    for first in 0..6 {
        let mut text = String::new();
        for z in [0.0, 0.5] {
            for [x, y] in corners {
                writeln!(text, "v {x} {y} {z}").unwrap();
            }
        }
        let around: Vec<usize> = (0..6).map(|k| (k + first) % 6).collect();
        let list = |of: &dyn Fn(usize) -> usize| {
            around.iter().map(|k| of(*k).to_string()).collect::<Vec<_>>().join(" ")
        };
        writeln!(text, "f {}\nf {}", list(&|k| 6 - k), list(&|k| 7 + k)).unwrap();
        for k in 0..6 {
            let next = (k + 1) % 6;
            writeln!(text, "f {} {} {} {}", k + 1, next + 1, next + 7, k + 7).unwrap();
        }
        let scene = cube(&json!({"positions": "l.obj"}), &json!({"initial_pressure": "0.1 Pa"}));
        volumes.push(number(&solved(&scene, &[("l.obj", &text)]), "/volume"));
    }
    let first = volumes[0];
    assert!((first / 1.5 - 1.0).abs() < 0.02, "{volumes:?}");
    assert!(volumes.iter().all(|volume| (volume / first - 1.0).abs() < 1e-9), "{volumes:?}");
    let crossed = "v 0 0 0\nv 1 1 0\nv 1 0 0\nv 0 1.1 0\nf 1 2 3 4\n";
    let scene = cube(&json!({"positions": "x.obj"}), &json!({"pressure": 1}));
    refused(&scene, &[("x.obj", crossed)], &["line 5", "crosses itself"]);
}

/// A cube whose lid has vertices of its own, this far above its rim.
fn with_lid(gap: f64) -> String {
    let open = CUBE.lines().take(15).fold(String::new(), |text, line| text + line + "\n");
    let lid = [[0, 0], [1, 0], [1, 1], [0, 1]];
    let vertices = lid.map(|[x, y]| format!("v {x} {y} {}\n", 1.0 + gap)).concat();
    open + &vertices + "f -4 -3 -2 -1\n"
}

#[test]
fn free_edges_near_each_other_are_refused_under_any_pressure() {
    for gap in [0.0, 1e-9, 1e-6, 1e-4, 9e-4] {
        for gas in [json!({"initial_pressure": 1}), json!({"pressure": 1})] {
            let mut scene = cube(&json!({"positions": "lid.obj"}), &gas);
            let file = with_lid(gap);
            let files = [("lid.obj", file.as_str())];
            refused(&scene, &files, &["leaks", "counted from 1", "mesh.weld"]);
            scene["mesh"]["weld"] = json!(1.2 * gap);
            near_one(number(&solved(&scene, &files), "/volume"));
        }
    }
    // A vertex on the edge of a face on the other side.
    let split = with_lid(0.0).replace("f -4 -3 -2 -1", "v 0.5 0 1\nf -5 -1 -4 -3 -2");
    let scene = cube(&json!({"positions": "lid.obj", "weld": 0}), &json!({"pressure": 1}));
    refused(&scene, &[("lid.obj", &split)], &["leaks", "and the edge between"]);
}

#[test]
fn a_check_runs_nothing_and_says_what_the_film_is() {
    let scene = cube(&json!({"positions": "lid.obj"}), &json!({"initial_pressure": 1}));
    let file = with_lid(1e-4);
    let folder = scene_folder(&scene, &[("lid.obj", file.as_str())]);
    let checked = solve(folder.path(), &["scene.json", "--check", "--picture", "mesh.svg"], "");
    assert_eq!(checked.status.code(), Some(2), "{}", stderr(&checked));
    // Also a mesh that is refused is drawn, with a cross where it leaks.
    let picture = std::fs::read_to_string(folder.path().join("mesh.svg")).unwrap();
    assert!(picture.contains(">1</text>") && picture.contains("1: "), "{picture}");
    let checked = solve(folder.path(), &["scene.json", "--check", "--weld", "0.2mm"], "");
    let report: Value = serde_json::from_slice(&checked.stdout).unwrap();
    assert_eq!(report["status"], "checked");
    assert_eq!((&report["nodes"], &report["elements"]), (&json!(8), &json!(12)));
    assert_eq!(report["free_edges"], json!([]));
    assert_eq!(report["pieces"].as_array().unwrap().len(), 1);
    near_one(number(&report, "/pieces/0/volume"));
    assert!(number(&report, "/steps") * number(&report, "/step") >= 0.02, "{report}");
    // Without the lid, under a pressure: one loop.
    let open = CUBE.lines().take(15).fold(String::new(), |text, line| text + line + "\n");
    let scene = cube(&json!({"positions": "open.obj"}), &json!({"pressure": 1}));
    let folder = scene_folder(&scene, &[("open.obj", &open)]);
    let checked = solve(folder.path(), &["scene.json", "--check", "-q"], "");
    let report: Value = serde_json::from_slice(&checked.stdout).unwrap();
    assert_eq!(report["free_edges"][0]["edges"], 4);
    assert!((number(&report, "/free_edges/0/length") - 4.0).abs() < 1e-12, "{report}");
    assert_eq!(report["pieces"][0]["volume"], Value::Null);
}

fn near_one(volume: f64) {
    assert!((volume - 1.0).abs() < 0.02, "{volume}");
}

#[test]
fn every_piece_has_its_sense_and_cavities_theirs() {
    let outer = block([1.0; 3], [0.0; 3], true, 1);
    let gas = json!({"initial_pressure": "0.1 Pa"});
    let scene = cube(&json!({"positions": "two.obj"}), &gas);
    let beside = |outward| outer.clone() + &block([0.5; 3], [2.0, 0.0, 0.0], outward, 9);
    near_one(number(&solved(&scene, &[("two.obj", &beside(true))]), "/volume") / 1.125);
    let texts = ["piece 2 of 2", "vertex 10", "wound inward", "flip the normals of this piece"];
    refused(&scene, &[("two.obj", &beside(false))], &texts);
    let inside = |outward| outer.clone() + &block([0.5; 3], [0.25; 3], outward, 9);
    let cavity = solved(&scene, &[("two.obj", &inside(false))]);
    near_one(number(&cavity, "/volume") / 0.875);
    assert!(!cavity["notes"].to_string().contains("count twice"), "{cavity}");
    let twice = solved(&scene, &[("two.obj", &inside(true))]);
    assert!(twice["notes"].to_string().contains("count twice"), "{twice}");
}

#[test]
fn size_stretch_place_and_step_are_judged_before_a_run() {
    let still = |mesh: Value, pressure: f64| {
        let mut scene = cube(&mesh, &json!({"pressure": pressure}));
        scene["solver"] = json!({"static": true});
        scene
    };
    let far = |by: f64| block([1.0; 3], [by, -2.0 * by, 3.0], true, 1);
    let solve_at = |by: f64| {
        let file = far(by);
        let scene = still(json!({"positions": "far.obj"}), 1.0);
        number(&solved(&scene, &[("far.obj", &file)]), "/volume")
    };
    let home = solve_at(0.0);
    for by in [1e3, 1e7] {
        assert!((solve_at(by) / home - 1.0).abs() < 1e-6, "{by}: {} {home}", solve_at(by));
    }
    // Metres for millimetres: the stress grows with the size.
    let large = block([1000.0; 3], [0.0; 3], true, 1);
    let large = [("large.obj", large.as_str())];
    let folder = scene_folder(&still(json!({"positions": "large.obj"}), 1e3), &large);
    let output = solve(folder.path(), &["scene.json"], "");
    let text = stderr(&output);
    assert_eq!(output.status.code(), Some(1), "{text}");
    assert!(text.contains("overstretched") && text.contains("mesh.unit"), "{text}");
    // A reference in millimetres, and one that is too small.
    for (scale, text) in [(1000.0, "slack everywhere"), (0.8, "stretched to 1.25")] {
        let reference = block([scale; 3], [0.0; 3], true, 1);
        let mesh = json!({"positions": "cube.obj", "reference": "flat.obj"});
        let cube_file = block([1.0; 3], [0.0; 3], true, 1);
        let files = [("cube.obj", cube_file.as_str()), ("flat.obj", reference.as_str())];
        let summary = solved(&still(mesh, 1.0), &files);
        assert!(summary["notes"].to_string().contains(text), "{summary}");
        assert!((number(&summary, "/stretch/start/1") * scale - 1.0).abs() < 1e-9, "{summary}");
    }
    // A sliver needs more steps than there are.
    let sliver = block([1.0; 3], [0.0; 3], true, 1)
        .replace("f 5 6 8 7", "v 0.5 1e-9 1\nf 5 6 9\nf 6 8 7 5 9");
    let scene = cube(&json!({"positions": "sliver.obj"}), &json!({"initial_pressure": 1}));
    refused(
        &scene,
        &[("sliver.obj", &sliver)],
        &["solver.step_limit", "the face on line", "vertices 5 6 9"],
    );
}
