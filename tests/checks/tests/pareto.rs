//! `billow-checks pareto`: rows, pictures, messages.

use std::fs;

use serde_json::Value;

use crate::support::{Folder, stderr};

#[test]
fn a_scene_is_run_and_drawn() {
    let folder = Folder::new();
    let printed = folder.stdout(&["pareto", "--scenes", "injected_piston", "--json", "-q"]);
    let rows: Vec<Value> = serde_json::from_str(&printed).unwrap();
    // The explicit step is of second order, the exact value known.
    let orders: Vec<f64> = rows
        .iter()
        .filter(|row| row["configuration"].as_str().unwrap().starts_with("film, explicit"))
        .filter_map(|row| row["order"].as_f64())
        .collect();
    let second = |order: &f64| (1.8..2.2).contains(order);
    assert!(orders.len() > 4 && orders.iter().all(second), "{orders:?}");
    for name in ["pareto_exact", "pareto_injected_piston", "pareto_injected_piston_seconds"] {
        for ending in ["svg", "png"] {
            let path = folder.path().join(format!("results/exact/charts/{name}.{ending}"));
            assert!(fs::metadata(&path).unwrap().len() > 1000, "{}", path.display());
        }
    }
}

#[test]
fn an_unknown_scene_is_refused() {
    let output = Folder::new().run(&["pareto", "--scenes", "injected_pisto"]);
    assert_eq!(output.status.code(), Some(2), "{}", stderr(&output));
    assert!(stderr(&output).contains("did you mean injected_piston?"), "{}", stderr(&output));
}
