//! `billow-checks bench`: every measurement is present and positive. No test asserts a speed.

use billow_solver::platform::stopwatch::Stage;
use serde_json::Value;

use crate::support::{Folder, stderr};

#[test]
fn every_part_has_its_rows() {
    let flags = ["bench", "--subdivisions", "1,2", "--end-time", "0.05", "--json", "-q"];
    let text = Folder::new().stdout(&flags);
    let parts: Vec<Vec<Value>> =
        serde_json::Deserializer::from_str(&text).into_iter().collect::<Result<_, _>>().unwrap();
    let [machine, stages, runs] = parts.as_slice() else { panic!("{text}") };
    assert!(machine[0]["cores"].as_u64() > Some(0), "{machine:?}");
    let states: Vec<&str> = stages.iter().filter_map(|row| row["state"].as_str()).collect();
    assert_eq!(states, ["stowed", "rising", "end"].repeat(2));
    for row in stages {
        // Broad phase and monitor may have no work in a short run; their columns are still present.
        assert!(Stage::ALL.iter().all(|stage| row[stage.name()].as_f64() >= Some(0.0)), "{row}");
        let positive = ["membrane", "update", "output", "whole", "steps_per_second"];
        assert!(positive.iter().all(|name| row[*name].as_f64() > Some(0.0)), "{row}");
    }
    assert_eq!(runs.len(), 2);
    for row in runs {
        let steps = row["steps"].as_f64().unwrap() * row["elements"].as_f64().unwrap();
        let cost = 1e9 * row["wall_seconds"].as_f64().unwrap() / steps;
        assert!((cost / row["ns_per_element_step"].as_f64().unwrap() - 1.0).abs() < 1e-9);
        assert!(row["passages"] == 0 && row["ledger_residual"].as_f64() < Some(1e-2), "{row:?}");
    }
}

#[test]
fn keys_are_set_and_invalid_flags_are_bad_input() {
    let folder = Folder::new();
    let short = ["bench", "--subdivisions", "1", "--end-time", "0.01"];
    let output = folder.run(&[&short[..], &["--set", "solver.integrator=hybrid"]].concat());
    let text = String::from_utf8_lossy(&output.stdout).into_owned();
    assert!(text.contains("ns_per_element_step") && !text.contains("rising"), "{text}");
    assert!(stderr(&output).contains("n 1, 0.01 s"), "{}", stderr(&output));
    for (flags, words) in [
        (["--subdivisions", "0"], "--subdivisions"),
        (["--set", "solver.integratr=hybrid"], "solver.integratr"),
    ] {
        let output = folder.run(&[&short[..1], &flags].concat());
        assert_eq!(output.status.code(), Some(2), "{flags:?}: {}", stderr(&output));
        assert!(output.stdout.is_empty() && stderr(&output).contains(words), "{}", stderr(&output));
    }
}
