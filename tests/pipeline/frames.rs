//! Frames: stored, read, drawn, and refused if a job has none.

use std::collections::BTreeSet;
use std::fs;
use std::path::Path;

use billow_solver::output::frames::Frame;
use billow_study::store::history_file::{self, StoredFrames};
use resvg::usvg::roxmltree::Document;
use serde_json::{Value, json};

use crate::support::{TestFolder, file_of, json_of, paper_design, png_size, stderr};

/// A film study of a few milliseconds: a job with frames, a job without.
fn study() -> Value {
    json!({
        "design": paper_design(2),
        "film": { "compression": 0 },
        "gas": { "species": "nitrogen", "mass_flow_rate": "5 g/s" },
        "solver": { "model": "film", "end_time": "4 ms" },
        "outputs": { "sample_interval": "0.5 ms" },
        "grid": { "outputs.frames": [4, 0] }
    })
}

/// A finished study: its folder, the job with frames, the job without.
fn ran() -> (TestFolder, String, String) {
    let folder = TestFolder::finished(&study());
    let rows = folder.rows("results/grid");
    assert_eq!(rows.len(), 2);
    let job = |row: &Value| row["job"].as_str().unwrap().to_owned();
    (folder, job(&rows[0]), job(&rows[1]))
}

fn frames(path: &Path) -> (StoredFrames, Vec<Frame>) {
    let stored = history_file::read_frames(path).unwrap().unwrap();
    let all = (0..stored.times().len()).map(|number| stored.frame(number).unwrap()).collect();
    (stored, all)
}

/// Panels of a picture and elements in each.
fn panels(path: &Path) -> Vec<usize> {
    let text = fs::read_to_string(path).unwrap();
    let svg = Document::parse(&text).unwrap();
    let panels = svg
        .descendants()
        .filter(|node| node.attribute("id").is_some_and(|id| id.starts_with("frame")));
    panels
        .map(|panel| panel.children().filter(|child| child.has_tag_name("path")).count())
        .collect()
}

#[test]
fn frames_of_a_job_are_stored_and_drawn() {
    let (folder, job, _) = ran();
    let path = file_of(&folder, &job);
    let (stored, all) = frames(&path);
    let elements = stored.triangles().len();
    let rows = folder.rows("results/grid");
    assert_eq!(rows[0]["elements"].as_u64(), Some(elements as u64));
    let storeys: BTreeSet<_> = stored.storeys().iter().copied().collect();
    assert_eq!(storeys, BTreeSet::from([0, 1, 2, 3, 4]), "caps 0 and 4, storeys 1 to 3");
    assert_eq!((all.len(), stored.times()[3].to_bits()), (4, 0.004_f64.to_bits()));
    // Velocities, stresses and gaps belong to the shapes.
    let nodes = all[0].positions.len();
    for frame in &all {
        assert_eq!((frame.velocities.len(), frame.gaps.len()), (nodes, nodes));
        assert_eq!(frame.stresses.len(), elements);
    }
    let moved = |node: usize| all[3].positions[node][2] - all[2].positions[node][2];
    let top = (0..nodes).max_by(|a, b| moved(*a).total_cmp(&moved(*b))).unwrap();
    assert!(moved(top) > 0.0 && all[3].velocities[top][2] > 0.0, "the top rises");
    assert!(all[3].stresses.iter().any(|stress| stress[0] > 0.0), "the film carries gas");
    // A frame is the shape at a sample: both have the same highest node.
    let history = history_file::read(&path).unwrap().history;
    for frame in &all {
        let times = history.column("time");
        let sample = times.iter().position(|time| time.to_bits() == frame.time.to_bits()).unwrap();
        #[expect(clippy::cast_possible_truncation, reason = "frames are stored in f32")]
        let z_max = history.column("z_max")[sample] as f32;
        let highest = frame.positions.iter().map(|place| place[2]).fold(f32::MIN, f32::max);
        assert_eq!(highest.to_bits(), z_max.to_bits(), "at {}", frame.time);
    }

    let rows = json_of(&folder, &["frames", &job[..6], "results/grid"]);
    let charts = folder.results().join("charts");
    let [svg, png] = ["svg", "png"].map(|kind| charts.join(format!("frames_{}.{kind}", &job[..8])));
    let files = rows.as_array().unwrap().iter().map(|row| row["file"].as_str().unwrap());
    assert!(files.map(|file| folder.path().join(file)).eq([svg.clone(), png.clone()]));
    assert_eq!((&rows[0]["frames"], &rows[0]["to"]), (&json!(4), &json!(0.004)));
    assert_eq!(panels(&svg), [elements; 4]);
    assert_eq!(png_size(&png)[0], 180 * 12);

    // A repetition gives the same bytes; a history file may be named directly.
    let [first, first_png] = [&svg, &png].map(|path| fs::read(path).unwrap());
    folder.stdout(&["frames", &job, "grid.json", "-q"]);
    assert!(fs::read(&svg).unwrap() == first && fs::read(&png).unwrap() == first_png);
    let path = path.to_str().unwrap();
    let arguments = ["--count", "2", "--colour", "regime", "--view=-60,35", "--out", "two.svg"];
    folder.stdout(&[&["frames", path], arguments.as_slice()].concat());
    assert_eq!(panels(&folder.path().join("two.svg")), [elements; 2]);
    assert!(fs::read_to_string(folder.path().join("two.svg")).unwrap().contains("wrinkled"));
    let smooth = ["frames", path, "--smooth", "--count", "2", "--out", "smooth.svg"];
    folder.stdout(&smooth);
    assert_eq!(panels(&folder.path().join("smooth.svg")), [elements; 2]);
    let text = fs::read_to_string(folder.path().join("smooth.svg")).unwrap();
    assert!(text.contains("fill=\"url(#light1_"), "no shading");
    let output = folder.run(&["frames", path, "--times", "3.9 ms,0.004,0", "--out", "a.PNG"]);
    assert!(stderr(&output).contains("1 of these 3 times"), "{}", stderr(&output));
    assert_eq!(png_size(&folder.path().join("a.PNG"))[0], 180 * 12);
}

#[test]
fn invalid_requests_give_one_error() {
    let (folder, job, without) = ran();
    let results = "results/grid";
    for (arguments, part) in [
        (&[&without, results][..], "no frames"),
        (&["ffffffffffffffff", results], &job[..8]),
        (&["nothing.h5"], "nothing.h5: no such file"),
        (&["grid.json"], "not an HDF5 file"),
        (&[&job, results, "--times", "5 ms"], "0 to 0.004 s"),
        (&[&job, results, "--view", "north"], "degrees"),
        (&[&job, results, "--out", "a.gif"], ".svg, .png, .obj"),
        (&[&job, results, "--out", "grid.json/a.svg"], "grid.json"),
    ] {
        folder.refuses(&[&["frames"], arguments].concat(), part);
    }
    let path = file_of(&folder, &job);
    let bytes = fs::read(&path).unwrap();
    fs::write(&path, &bytes[..bytes.len() / 2]).unwrap();
    folder.refuses(&["frames", &job, results], &job);
    fs::remove_file(&path).unwrap();
    folder.refuses(&["frames", &job, results], "missing");
    assert!(!folder.results().join("charts").exists(), "nothing was drawn");
}

#[test]
fn a_solved_scene_stores_frames_too() {
    let folder = TestFolder::new(&Value::Null);
    let scene = json!({
        "design": paper_design(2),
        "gas": { "windows": [{ "from": 0, "mass_flow_rate": "5 g/s" }] },
        "solver": { "end_time": "4 ms" },
        "outputs": { "sample_interval": "0.5 ms", "frames": 3 }
    });
    fs::write(folder.path().join("scene.json"), scene.to_string()).unwrap();
    folder.stdout(&["solve", "scene.json", "--out", "run.h5"]);
    let (stored, all) = frames(&folder.path().join("run.h5"));
    assert_eq!(all.len(), 3);
    folder.stdout(&["frames", "run.h5"]);
    assert_eq!(panels(&folder.path().join("run_frames.svg")), [stored.triangles().len(); 3]);
}

#[test]
fn a_motion_and_its_shapes_go_to_other_programs() {
    let (folder, job, _) = ran();
    let write = |arguments: &[&str]| {
        let words = [&["frames", job.as_str(), "results/grid"], arguments, &["--json"]].concat();
        let rows: Value = serde_json::from_str(&folder.stdout(&words)).unwrap();
        (fs::read(folder.path().join(arguments[1])).unwrap(), rows[0]["frames"].as_u64().unwrap())
    };
    let (gif, shown) = write(&["--animate", "motion.gif"]);
    assert!(gif.starts_with(b"GIF89a") && shown == 201, "{shown}");
    let (_, all) = frames(&file_of(&folder, &job));
    let (glb, shown) = write(&["--out", "motion.glb"]);
    assert!(glb.starts_with(b"glTF") && shown == all.len() as u64, "{shown}");
    // The last shape, and one at a time.
    let top = |text: &[u8]| {
        let heights = str::from_utf8(text).unwrap().lines().filter(|line| line.starts_with("v "));
        let height = |line: &str| line.rsplit(' ').next().unwrap().parse::<f32>().unwrap();
        heights.map(height).fold(0.0, f32::max)
    };
    let highest = |frame: &Frame| frame.positions.iter().map(|p| p[2]).fold(0.0, f32::max);
    let (last, _) = write(&["--out", "last.obj"]);
    assert!((top(&last) - highest(&all[3])).abs() < 1e-6);
    let (first, shown) = write(&["--out", "first.obj", "--times", "0"]);
    assert!((top(&first) - highest(&all[0])).abs() < 1e-6 && shown == 1);
    assert_eq!(write(&["--out", "last.stl"]).0.len(), 84 + 50 * all[3].stresses.len());
    for (arguments, said) in [
        (&["--animate", "motion.mp4"][..], ".webm"),
        (&["--out", "shape.obj", "--times", "0,1ms"], "one time"),
        (&["--out", "shape.step"], ".glb"),
        (&["--animate", "a.gif", "--count", "3"], "--count"),
    ] {
        folder.refuses(&[&["frames", job.as_str(), "results/grid"], arguments].concat(), said);
    }
}

/// What a deck holds is checked by `tests/readers/deck.py`.
#[test]
fn a_deck_is_of_a_job_of_film_that_may_not_have_run() {
    let (folder, job, _) = ran();
    let rows = json_of(&folder, &["export", &job[..8], "--deck", "radioss", "deck"]);
    let lines: Vec<u64> =
        rows.as_array().unwrap().iter().map(|row| row["lines"].as_u64().unwrap()).collect();
    let [starter, engine] = ["0000", "0001"].map(|number| {
        let name = format!("deck/job_{}_{number}.rad", &job[..8]);
        fs::read_to_string(folder.path().join(name)).unwrap()
    });
    assert_eq!(lines, [starter.lines().count() as u64, engine.lines().count() as u64]);
    assert!(starter.ends_with("/END\n") && engine.starts_with("/RUN/job_"), "{engine}");
    // Nothing has run: the same deck, but for what has flowed in until the release, which is nothing here.
    fs::remove_dir_all(folder.path().join("results/grid/journal")).unwrap();
    fs::create_dir(folder.path().join("results/grid/journal")).unwrap();
    folder.stdout(&["export", &job[..8], "--deck", "radioss", "pending"]);
    let pending = folder.path().join(format!("pending/job_{}_0000.rad", &job[..8]));
    assert_eq!(fs::read_to_string(pending).unwrap(), starter);
    let piston = TestFolder::finished(&json!({
        "design": paper_design(2),
        "solver": { "model": "piston", "end_time": "0.1 s" },
        "grid": { "mass_flow_rate": ["5 g/s"] }
    }));
    let job = piston.rows("results/grid")[0]["job"].as_str().unwrap().to_owned();
    piston.refuses(&["export", &job, "--deck", "dyna", "x.k"], "its model has no mesh");
}
