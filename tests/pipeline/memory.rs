//! Jobs and scenes that need more memory than the process may use.

use std::fmt::Write as _;
use std::fs;
use std::process::{Command, Output, Stdio};

use serde_json::{Value, json};

use crate::support::{TestFolder, stderr};

/// Runs the program under `ulimit -v` (kB).
fn limited(folder: &TestFolder, kilobytes: u32, arguments: &[&str]) -> Output {
    let mut command = Command::new("sh");
    command.args(["-c", "ulimit -v \"$1\"; shift; exec \"$@\"", "sh"]);
    command.arg(kilobytes.to_string()).arg(env!("CARGO_BIN_EXE_billow")).args(arguments);
    command.current_dir(folder.path()).stdin(Stdio::null());
    command.output().unwrap()
}

/// Runs the program, which must be refused under `ulimit -v` (kB) with these texts.
fn too_large(folder: &TestFolder, kilobytes: u32, arguments: &[&str], texts: &[&str]) {
    let output = limited(folder, kilobytes, arguments);
    let said = stderr(&output);
    assert_eq!(output.status.code(), Some(2), "{said}");
    assert!(texts.iter().all(|text| said.contains(text)), "{texts:?}: {said}");
}

/// Two small jobs and one of 1.9 million elements.
fn mixed() -> Value {
    json!({
        "design": {
            "fit": "cone", "N": 6, "M": 3, "bottom_radius": "500 mm", "top_radius": "365 mm",
            "height": "1 m", "stowed_height": "40 mm"
        },
        "solver": { "model": "film", "end_time": "0.1 ms" },
        "gas": { "mass_flow_rate": "1 g/s" },
        "grid": { "subdivisions": [1, 200, 2] }
    })
}

#[test]
fn a_job_that_does_not_fit_is_a_row_and_the_others_run() {
    let folder = TestFolder::new(&mixed());
    let run = ["run", "grid.json", "--threads", "2"];
    let output = limited(&folder, 700_000, &run);
    let said = stderr(&output);
    assert_eq!(output.status.code(), Some(1), "{said}");
    assert!(
        said.contains("note: 1 of 3 points (subdivisions=200) will end as out_of_memory"),
        "{said}"
    );
    let rows = folder.rows("results/grid");
    let statuses: Vec<&str> = rows.iter().map(|row| row["status"].as_str().unwrap()).collect();
    assert_eq!(statuses, ["done", "out_of_memory", "done"]);
    let reason = rows[1]["reason"].as_str().unwrap();
    assert!(reason.contains("the address space limit of 717 MB (ulimit -v)"), "{reason}");
    let again = limited(&folder, 700_000, &[&run[..], &["--json"]].concat());
    let result: Value = serde_json::from_slice(&again.stdout).unwrap();
    assert_eq!((&result["ran"], &result["failed"]), (&json!(0), &json!(1)), "{}", stderr(&again));
}

#[test]
fn an_out_of_memory_job_runs_again_with_more_memory() {
    let mut study = mixed();
    study["grid"]["subdivisions"] = json!([16]);
    study["solver"]["end_time"] = json!("2e-6 s");
    let folder = TestFolder::new(&study);
    for limit in [292_000, 300_000, 308_000] {
        let _ = fs::remove_dir_all(folder.path().join("results"));
        let output = limited(&folder, limit, &["run", "grid.json", "-q", "--threads", "1"]);
        assert_eq!(output.status.code(), Some(1), "{limit} kB: {}", stderr(&output));
    }
    assert_eq!(folder.rows("results/grid")[0]["status"], "out_of_memory");
    let again = ["run", "grid.json", "--again", "out_of_memory", "-q"];
    // The limit of the study refuses a job by its estimate.
    folder.run(&[&again[..], &["--set", "job_limits.memory=20 MB"]].concat());
    let row = folder.rows("results/grid").remove(0);
    assert!(row["reason"].as_str().unwrap().contains("job_limits.memory"), "{row}");
    let output = folder.run(&again);
    assert_eq!(folder.rows("results/grid")[0]["status"], "done", "{}", stderr(&output));
}

#[test]
fn a_plan_names_the_jobs_that_do_not_fit_and_builds_no_mesh_of_them() {
    let mut study = mixed();
    study["grid"] = json!({ "subdivisions": [2, 1000], "M": [3, 1000] });
    let folder = TestFolder::new(&study);
    let output = limited(&folder, 700_000, &["plan", "grid.json"]);
    let said = stderr(&output);
    assert!(output.status.success(), "{said}");
    assert!(said.contains("will end as out_of_memory"), "{said}");
    assert!(said.contains("next: a coarser mesh"), "{said}");
}

/// A folder with an OBJ file of these many vertices and faces, and its scene.
fn mesh(vertices: usize, faces: usize) -> TestFolder {
    let folder = TestFolder::new(&json!({}));
    let mut text = String::new();
    for vertex in 0..vertices {
        writeln!(text, "v {} {} 0", vertex % 7, vertex / 7).unwrap();
    }
    text.push_str(&"f 1 2 9\n".repeat(faces));
    fs::write(folder.path().join("large.obj"), text).unwrap();
    let scene = json!({
        "mesh": { "positions": "large.obj", "scale": 1 },
        "gas": { "pressure": 1000 },
        "solver": { "end_time": "1e-5 s" }
    });
    fs::write(folder.path().join("scene.json"), scene.to_string()).unwrap();
    folder
}

#[test]
fn a_mesh_file_that_does_not_fit_is_one_clear_error() {
    for (vertices, faces, counts) in
        [(3_000_000, 0, " MB: about"), (10, 200_000, "has 200000 elements: about")]
    {
        let folder = mesh(vertices, faces);
        let texts = [
            "mesh.positions = \"large.obj\": has",
            counts,
            "of memory needed",
            "the address space limit of 410 MB (ulimit -v)",
            "next: use a coarser mesh",
        ];
        too_large(&folder, 400_000, &["solve", "scene.json"], &texts);
    }
}

#[test]
fn a_capsule_and_shapes_that_do_not_fit_are_one_clear_error() {
    let folder = TestFolder::new(&json!({}));
    let mut scene = mixed();
    scene.as_object_mut().unwrap().remove("grid");
    scene["solver"] = json!({ "end_time": "1e-5 s" });
    scene["gas"] = json!({ "windows": [{ "from": 0, "mass_flow_rate": "5 g/s" }] });
    scene["design"]["subdivisions"] = json!(250);
    fs::write(folder.path().join("scene.json"), scene.to_string()).unwrap();
    let made = "design.subdivisions = 250: makes a capsule of 3000000 elements";
    too_large(&folder, 700_000, &["solve", "scene.json"], &[made, "of memory needed"]);
    let fold = "fold --panels 6 --storeys 3 --bottom-radius 0.5 --top-radius 0.365 --height 1";
    let fold = format!("{fold} --subdivisions 250 --out shapes");
    let made = "--subdivisions = 250: gives shapes with 3000000 elements";
    too_large(&folder, 700_000, &fold.split(' ').collect::<Vec<_>>(), &[made]);
    assert!(!folder.path().join("shapes").exists());
}
