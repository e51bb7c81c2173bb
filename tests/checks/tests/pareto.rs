//! `billow-checks pareto`: rows, pictures, stored scenes, messages.

use std::fs;

use serde_json::Value;

use crate::support::{Folder, stderr};

#[test]
fn a_scene_runs_once_and_is_drawn() {
    let folder = Folder::new();
    let arguments = ["pareto", "--scenes", "injected_piston", "--json", "-q"];
    let printed = folder.stdout(&arguments);
    let rows: Vec<Value> = serde_json::from_str(&printed).unwrap();
    // The explicit step is of second order, the exact value known.
    let orders: Vec<f64> = rows
        .iter()
        .filter(|row| row["configuration"].as_str().unwrap().starts_with("film, explicit"))
        .filter_map(|row| row["order"].as_f64())
        .collect();
    let second = |order: &f64| (1.8..2.2).contains(order);
    assert!(orders.len() > 4 && orders.iter().all(second), "{orders:?}");
    for name in ["pareto_exact", "pareto_injected_piston"] {
        for ending in ["svg", "png"] {
            let path = folder.path().join(format!("results/exact/charts/{name}.{ending}"));
            assert!(fs::metadata(&path).unwrap().len() > 1000, "{}", path.display());
        }
    }
    // The second call reads what the first one stored.
    let again = folder.run(&["pareto", "--scenes", "injected_piston"]);
    assert!(again.status.success() && stderr(&again).is_empty(), "{}", stderr(&again));
    assert_eq!(folder.stdout(&arguments), printed, "seconds too are those of the first call");
}

#[test]
fn an_unknown_scene_is_refused() {
    let output = Folder::new().run(&["pareto", "--scenes", "injected_pisto"]);
    assert_eq!(output.status.code(), Some(2), "{}", stderr(&output));
    assert!(stderr(&output).contains("did you mean injected_piston?"), "{}", stderr(&output));
}
