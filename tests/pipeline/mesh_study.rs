//! A study of film from a mesh: a flat square bag in place of a folded capsule.

use std::fmt::Write as _;
use std::fs;

use serde_json::{Value, json};

use crate::solve::{done, number};
use crate::support::{TestFolder, stderr};

/// Cells along each side of the bag.
const CELLS: usize = 6;

/// A square bag of 0.5 m in millimetres: two layers 1 mm apart that are one at the rim. `turned` turns its lower layer
/// inside out, `cut` leaves its seam open.
fn bag(turned: bool, cut: bool) -> String {
    let (mut text, mut vertices) = (String::new(), 0);
    let mut number = vec![[0; 2]; (CELLS + 1) * (CELLS + 1)];
    for top in [0, 1] {
        for (index, numbers) in number.iter_mut().enumerate() {
            let (i, j) = (index % (CELLS + 1), index / (CELLS + 1));
            let rim = [i, j].iter().any(|k| [0, CELLS].contains(k));
            if rim && top == 1 && !cut {
                numbers[1] = numbers[0];
                continue;
            }
            vertices += 1;
            numbers[top] = vertices;
            let z = if rim { 0.0 } else { top as f64 - 0.5 };
            let at = |k: usize| 500.0 * k as f64 / CELLS as f64;
            let _ = writeln!(text, "v {} {} {z}", at(i), at(j));
        }
    }
    for top in [0, 1] {
        for cell in 0..CELLS * CELLS {
            let (i, j) = (cell % CELLS, cell / CELLS);
            let at = |i: usize, j: usize| number[j * (CELLS + 1) + i][top];
            let mut corners = [at(i, j), at(i + 1, j), at(i + 1, j + 1), at(i, j + 1)];
            // The diagonals run to the corners of the bag, or its corner would be flat.
            if (i < CELLS / 2) != (j < CELLS / 2) {
                corners.rotate_left(1);
            }
            let [a, b, c, d] = corners;
            for [a, b, c] in [[a, b, c], [a, c, d]] {
                let outward = (top == 1) != (turned && top == 0);
                let _ = if outward {
                    writeln!(text, "f {a} {b} {c}")
                } else {
                    writeln!(text, "f {a} {c} {b}")
                };
            }
        }
    }
    text
}

/// A study of the bag with these further keys.
fn study(more: &Value) -> Value {
    let mut study = json!({
        "design": {"mesh": "bag.obj", "unit": "mm"},
        "gas": {"mass_flow_rate": "0.5 g/s"},
        "strategies": {"rapid": {"inflow": [{"from": 0, "mass": "0.05 g"}]}},
        "strategy": "rapid", "seed": 0,
        "solver": {"end_time": "0.6 s"}, "outputs": {"frames": 4}
    });
    for (key, value) in more.as_object().unwrap() {
        study[key] = value.clone();
    }
    study
}

/// A folder with a study and the bag.
fn folder(study: &Value) -> TestFolder {
    let folder = TestFolder::new(study);
    fs::write(folder.path().join("bag.obj"), bag(false, false)).unwrap();
    folder
}

#[test]
fn a_bag_inflates_as_its_scene_does_and_its_folder_needs_no_other_file() {
    let grid = json!({"grid": {"film.thickness": ["25 um", "50 um"]}});
    let folder = folder(&study(&grid));
    folder.stdout(&["run", "grid.json", "-q"]);
    let rows = folder.rows("grid.json");
    let of = |name: &str| -> Vec<Value> { rows.iter().map(|row| row[name].clone()).collect() };
    assert_eq!(of("verdict"), ["deployed", "deployed"]);
    for name in ["z_rim", "peak_vz", "t_90_z_rim", "ringing_rms", "phi", "top_radius"] {
        assert!(of(name).iter().all(Value::is_null), "{name}");
    }
    for name in ["t_90_volume", "t_deployed", "final_height", "peak_film_speed", "peak_base_force"]
    {
        assert!(of(name).iter().all(|value| value.as_f64() > Some(0.0)), "{name}");
    }
    // The largest volume of a square bag of inextensible film is near 0.2 of its side cubed.
    let volume = rows[0]["final_volume"].as_f64().unwrap();
    assert!((0.19..0.21).contains(&(volume / 0.125)), "{volume}");
    // The same film as a scene: the same bits.
    let scene = json!({
        "mesh": {"positions": "bag.obj", "scale": 0.001},
        "film": {"thickness": "25 um"}, "solver": {"end_time": "0.6 s"},
        "gas": {"windows": [{"from": 0, "to": 0.05 / 0.5, "mass_flow_rate": "0.5 g/s"}]}
    });
    fs::write(folder.path().join("scene.json"), scene.to_string()).unwrap();
    let summary = done(folder.path(), &["scene.json", "-q"], "");
    assert_eq!(rows[0]["final_volume"].as_f64(), Some(number(&summary, "/volume")));
    // Its results are read, planned and run again without the mesh file.
    let ids = of("job");
    let jobs = folder.stdout(&["plan", "grid.json"]);
    fs::remove_file(folder.path().join("bag.obj")).unwrap();
    assert_eq!(
        folder.rows("results/grid").iter().map(|row| row["job"].clone()).collect::<Vec<_>>(),
        ids
    );
    assert_eq!(folder.stdout(&["plan", "results/grid/study.json"]), jobs);
    let again = folder.stdout(&[
        "run",
        "results/grid/study.json",
        "-q",
        "--again",
        ids[0].as_str().unwrap(),
    ]);
    assert!(again.contains("1 job the same as before"), "{again}");
    let picture = folder.path().join("bag.svg");
    folder.stdout(&["frames", &ids[0].as_str().unwrap()[..8], "results/grid", "--out", "bag.svg"]);
    assert!(fs::read_to_string(picture).unwrap().contains("height of the whole film"));
    folder.refuses(&["plan", "grid.json"], "bag.obj");
}

#[test]
fn finer_meshes_of_a_bag_give_the_error_that_its_limit_needs() {
    let more = json!({
        "solver": {"end_time": "60 ms"}, "limits": {"peak_film_speed": "< 60 m/s"},
        "gas": {"mass_flow_rate": "0.25 g/s"}
    });
    let folder_of = folder;
    let folder = folder_of(&study(&more));
    let plan = folder.run(&["plan", "grid.json"]);
    assert!(stderr(&plan).contains("on n 2 and 3"), "{}", stderr(&plan));
    let answer = folder.stdout(&["run", "grid.json", "-q"]);
    assert!(answer.contains("1 of 1 point safe"), "{answer}");
    let row = &folder.points("grid.json")[0];
    let value = |end: &str| row[format!("peak_film_speed{end}")].as_f64().unwrap();
    let error = value("_error_below");
    assert!(error > 0.0 && error < value(""), "{error}");
    let runs = folder.rows("grid.json");
    let speeds: Vec<f64> =
        runs.iter().map(|run| run["peak_film_speed"].as_f64().unwrap()).collect();
    let changes = [2.0 * (speeds[1] - speeds[0]), 6.0 * (speeds[2] - speeds[1])];
    let largest = changes.map(f64::abs).into_iter().fold(0.0, f64::max);
    assert!((error / (1.25 * largest / 3.0) - 1.0).abs() < 1e-9, "{error} {speeds:?}");
    // Replicates are runs of a film that starts with small differences.
    let more = json!({"solver": {"end_time": "20 ms", "meshes": [1]}, "replicates": {"seed": 3}, "seed": 1});
    let folder = folder_of(&study(&more));
    folder.stdout(&["run", "grid.json", "-q"]);
    let runs = folder.rows("grid.json");
    let speed = |run: usize| runs[run]["peak_film_speed"].as_f64().unwrap();
    let change = (speed(0) / speed(1) - 1.0).abs();
    assert!(change > 0.0 && change < 0.5, "{change}");
}

#[test]
fn a_bag_that_no_run_can_start_from_is_refused_with_its_key() {
    let refused = |more: &Value, file: &str, texts: &[&str]| {
        let folder = TestFolder::new(&study(more));
        fs::write(folder.path().join("bag.obj"), file).unwrap();
        for text in texts {
            folder.refuses(&["plan", "grid.json"], text);
        }
    };
    let sound = bag(false, false);
    let none = json!({});
    refused(&none, &bag(true, false), &["design.mesh.positions", "wind against each other"]);
    refused(&none, &bag(false, true), &["leaks", "design.mesh.positions", "mesh.weld"]);
    refused(&none, "v 0 0 0\n", &["has no faces"]);
    let of = |key: &str, value: Value| json!({ key: value });
    let design = |more: Value| {
        let mut design = json!({"mesh": "bag.obj"});
        for (key, value) in more.as_object().unwrap() {
            design[key] = value.clone();
        }
        of("design", design)
    };
    refused(&design(json!({"N": 6})), &sound, &["design.N", "beside mesh"]);
    refused(&design(json!({"unit": "kg"})), &sound, &["design.mesh.unit", "unit of length"]);
    refused(&design(json!({"mesh": "bug.obj"})), &sound, &["did you mean bag.obj?"]);
    let inside = json!({"mesh": {"positions": "bag.obj", "subdivisions": 2}});
    refused(&design(inside), &sound, &["design.mesh.subdivisions", "design.subdivisions"]);
    refused(&design(json!({"mesh": 3})), &sound, &["design.mesh", "is not a mesh"]);
    refused(&of("grid", json!({"N": [4, 6]})), &sound, &["grid.N", "design.mesh"]);
    refused(
        &of("supports", json!([{"on": "bottom_ring", "fix": "xyz"}])),
        &sound,
        &["rings and caps"],
    );
    let loops = json!([{"on": "loop", "loop": 1, "fix": "xyz"}]);
    refused(&of("supports", loops), &sound, &["has 0 loops of free edges"]);
    let piston = json!({"end_time": 1, "model": "piston"});
    refused(&of("solver", piston), &sound, &["solver.model", "no panels and storeys"]);
}
