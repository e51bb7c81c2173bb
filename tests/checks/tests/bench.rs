//! `billow-checks bench`: every measurement is present and positive. No test asserts a speed.

use billow_solver::platform::stopwatch::Stage;
use serde_json::Value;

use crate::support::{Folder, stderr};

/// The rows of a part, from the cells of all parts.
fn rows(cells: &[Value], part: &str) -> Vec<serde_json::Map<String, Value>> {
    let mut rows: Vec<serde_json::Map<String, Value>> = Vec::new();
    for cell in cells.iter().filter(|cell| cell["part"] == part) {
        let index = usize::try_from(cell["row"].as_u64().unwrap()).unwrap();
        rows.resize(rows.len().max(index + 1), serde_json::Map::new());
        rows[index].insert(cell["name"].as_str().unwrap().to_owned(), cell["value"].clone());
    }
    rows
}

#[test]
fn every_part_has_its_rows() {
    let flags = ["bench", "--subdivisions", "1,2", "--end-time", "0.05", "--json", "-q"];
    let cells: Vec<Value> = serde_json::from_str(&Folder::new().stdout(&flags)).unwrap();
    let run = ["wall_seconds", "steps", "ns_per_element_step"];
    let stages = ["membrane", "update", "output", "whole", "steps_per_second"];
    for (part, number, positive) in
        [("machine", 1, &["cores"][..]), ("stages", 2 * 3, &stages), ("runs", 2 * 2, &run)]
    {
        let rows = rows(&cells, part);
        assert_eq!(rows.len(), number, "{part}");
        for (row, name) in rows.iter().flat_map(|row| positive.iter().map(move |name| (row, name)))
        {
            assert!(row[*name].as_f64() > Some(0.0), "{name} in {row:?}");
        }
    }
    let all = rows(&cells, "stages");
    let states: Vec<&str> = all.iter().filter_map(|row| row["state"].as_str()).collect();
    assert_eq!(states, ["stowed", "rising", "end"].repeat(2));
    // Broad phase and monitor may have no work in a short run; their columns are still present.
    let present = |row: &serde_json::Map<String, Value>| {
        Stage::ALL.iter().all(|stage| row[stage.name()].as_f64() >= Some(0.0))
    };
    assert!(all.iter().all(present));
    for row in rows(&cells, "runs") {
        let steps = row["steps"].as_f64().unwrap() * row["elements"].as_f64().unwrap();
        let cost = 1e9 * row["wall_seconds"].as_f64().unwrap() / steps;
        assert!((cost / row["ns_per_element_step"].as_f64().unwrap() - 1.0).abs() < 1e-9);
        assert!(row["passages"] == 0 && row["ledger_residual"].as_f64() < Some(1e-2), "{row:?}");
    }
}

#[test]
fn parts_and_keys_are_selected_and_invalid_flags_are_bad_input() {
    let folder = Folder::new();
    let short = ["bench", "--subdivisions", "1", "--end-time", "0.01", "--only", "runs"];
    let output = folder.run(&[&short[..], &["--set", "solver.integrator=hybrid"]].concat());
    let text = String::from_utf8_lossy(&output.stdout).into_owned();
    assert!(text.contains("machine\n") && text.contains("runs\n"), "{text}");
    assert!(!text.contains("stages\n"), "{text}");
    assert!(stderr(&output).contains("run, n 1, 0.01 s"), "{}", stderr(&output));
    for (flags, words) in [
        (&["--only", "membrane"][..], "membrane"),
        (&["--subdivisions", "0"], "--subdivisions"),
        (&["--set", "solver.integratr=hybrid"], "solver.integratr"),
    ] {
        let output = folder.run(&[&short[..5], flags].concat());
        assert_eq!(output.status.code(), Some(2), "{flags:?}: {}", stderr(&output));
        assert!(output.stdout.is_empty() && stderr(&output).contains(words), "{}", stderr(&output));
    }
}
