//! `billow fold`: numbers, infeasible designs, files.

use std::process::{Command, Output};

use serde_json::Value;

const PAPER: &str = "--panels 6 --storeys 3 --bottom-radius 0.5 --top-radius 365␣mm --height 1";

/// Runs `billow fold` with words that are separated by blanks; `␣` is a blank within a word.
fn fold(flags: &str) -> Output {
    let words = flags.split(' ').map(|word| word.replace('␣', " "));
    Command::new(env!("CARGO_BIN_EXE_billow")).arg("fold").args(words).output().expect("runs")
}

fn json(flags: &str) -> Value {
    let output = fold(&format!("{flags} --json"));
    assert!(output.status.success(), "{}", String::from_utf8_lossy(&output.stderr));
    serde_json::from_slice(&output.stdout).expect("JSON")
}

#[test]
fn prints_the_papers_capsule_in_si() {
    let answer = json(PAPER);
    let number = |key: &str| answer[key].as_f64().expect(key);
    assert_eq!(answer["feasible"], true);
    assert!((number("phi").to_degrees() - 31.5137).abs() < 5e-5);
    assert!((number("AE") - 0.829_579).abs() < 5e-7);
    assert!(number("closure_defect") < 1e-12);
    assert_eq!(answer["top_radius"], serde_json::json!(0.365), "a given value keeps its digits");
    for key in ["alpha2", "beta1", "beta2", "gamma1", "gamma2", "theta1", "theta2", "half_angle"] {
        assert!(answer[key].is_number(), "{key}");
    }
    let units = PAPER.replace("0.5", "500␣mm").replace("height 1", "height 100␣cm");
    assert_eq!(json(&units), answer);
}

#[test]
fn an_infeasible_design_is_an_answer() {
    let flags = PAPER.replace("storeys 3", "storeys 1");
    let answer = json(&flags);
    assert_eq!(answer["feasible"], false);
    assert!(answer["reason"].as_str().expect("a reason").contains("no phi closes"));
    assert_eq!(answer["nearest"]["M"], 2);
    assert!(answer["phi"].is_null());
    assert_eq!(answer["height"], 1.0, "the given value is kept");
    // Without --json too, and nothing is written.
    let folder = tempfile::tempdir().expect("a folder");
    let out = folder.path().join("out");
    assert!(fold(&format!("{flags} --out {}", out.display())).status.success());
    assert!(!out.exists());
}

#[test]
fn a_stowed_height_too_large_is_an_answer_and_never_the_default() {
    let small = "--panels 6 --storeys 3 --bottom-radius 20␣mm --top-radius 14.6␣mm --height 40␣mm";
    let folded = json(small);
    assert_eq!(folded["feasible"], true);
    let stowed = folded["stowed_height"].as_f64().expect("a height");
    assert!(stowed > 0.001 && stowed < 0.03, "{stowed}");
    let asked = json(&format!("{small} --stowed-height 40␣mm"));
    assert_eq!(asked["feasible"], false);
    assert!(asked["reason"].as_str().expect("a reason").starts_with("stowed_height"));
    assert_eq!(asked["nearest"]["stowed_height"], stowed);
}

#[test]
fn pattern_and_shapes_are_written() {
    let folder = tempfile::tempdir().expect("a folder");
    let out = folder.path().join("new/folder");
    let output = fold(&format!("{PAPER} --out {} --glue-flaps 15␣mm", out.display()));
    assert!(output.status.success(), "{}", String::from_utf8_lossy(&output.stderr));
    let read = |name: &str| std::fs::read_to_string(out.join(name)).expect(name);
    let file: Value = serde_json::from_str(&read("crease_pattern.fold")).expect("JSON");
    assert_eq!(file["faces_vertices"].as_array().expect("faces").len(), 36);
    assert!(read("crease_pattern.svg").contains("glue_flaps"));
    for name in ["flat.obj", "stowed.obj", "developed.obj", "erected.obj"] {
        assert!(read(name).lines().any(|line| line.starts_with("f ")), "{name}");
    }
    let names = std::fs::read_dir(&out).expect("the folder").count();
    assert_eq!(names, 7, "no temporary file remains");
    let simulated = fold(&format!("{PAPER} --out {} --origami-simulator", out.display()));
    assert!(simulated.status.success(), "{}", String::from_utf8_lossy(&simulated.stderr));
    assert!(read("crease_pattern.svg").contains("stroke=\"#0000ff\" d="));
}

#[test]
fn the_written_scene_is_the_stowed_capsule_without_stress() {
    let folder = tempfile::tempdir().expect("a folder");
    let output = fold(&format!("{PAPER} --subdivisions 3 --out {}", folder.path().display()));
    assert!(output.status.success(), "{}", String::from_utf8_lossy(&output.stderr));
    let report = crate::solve::checked(folder.path());
    // Storeys of flat facets fit each other but for the strain of stowing; 15.117 litres of the design.
    for stretch in report["stretch"]["start"].as_array().expect("two") {
        assert!((stretch.as_f64().expect("a number") - 1.0).abs() < 1e-3, "{report}");
    }
    assert!((report["volume"].as_f64().expect("a number") / 0.015_117 - 1.0).abs() < 1e-3);
    assert_eq!(report["notes"], Value::Array(Vec::new()));
}

#[test]
fn circular_caps_have_an_erected_shape_only() {
    let folder = tempfile::tempdir().expect("a folder");
    let output = fold(&format!("{PAPER} --caps circular --out {}", folder.path().display()));
    assert!(output.status.success());
    let names: Vec<_> = std::fs::read_dir(folder.path())
        .expect("the folder")
        .map(|entry| entry.expect("an entry").file_name())
        .collect();
    assert_eq!(names, ["erected.obj"]);
    assert!(String::from_utf8_lossy(&output.stderr).contains("cannot be folded"));
}
