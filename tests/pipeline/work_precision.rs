//! Work-precision diagrams: table and pictures.

use serde_json::json;

use crate::support::{TestFolder, grid, json_of};

/// Film on two coarse meshes, and the piston, of one capsule for a few milliseconds.
fn study() -> serde_json::Value {
    let mut study = grid(&json!({
        "N": [6], "M": [3], "alpha1_over_phi": [1],
        "strategy": ["early", "late"],
        "solver.model": ["film", "piston"], "subdivisions": [2, 3]
    }));
    study["strategies"] = json!({
        "early": {"inflow": [{"from": 0}]},
        "late": {"inflow": [{"from": "5 ms"}]}
    });
    study["gas"]["mass_flow_rate"] = json!("5 g/s");
    study["solver"]["end_time"] = json!("40 ms");
    study["outputs"] = json!({"sample_interval": "1 ms"});
    study["replicates"] = json!({"seed": [1, 2]});
    study
}

#[test]
fn the_front_is_printed_and_drawn() {
    let folder = TestFolder::new(&study());
    folder.stdout(&["run", "grid.json", "-q"]);
    let rows = json_of(&folder, &["chart", "grid.json", "--work-precision"]);
    let rows = rows.as_array().unwrap();
    let of = |scene: &'static str, quantity: &'static str| {
        rows.iter().filter(move |row| row["scene"] == scene && row["quantity"] == quantity)
    };
    // Film on two meshes and the piston, whose mesh and seed are ignored.
    let energies: Vec<_> = of("early", "peak_kinetic_energy").collect();
    assert_eq!(energies.len(), 3, "{rows:?}");
    let runs = |model: &str| {
        let row =
            energies.iter().find(|row| row["configuration"].as_str().unwrap().contains(model));
        row.unwrap()["runs"].clone()
    };
    assert_eq!((runs("piston"), runs("film")), (json!(1), json!(2)));
    let seconds = ["chart", "grid.json", "--work-precision", "--cost", "seconds"];
    let front = folder.stdout(&seconds);
    assert!(
        front.contains("early") && front.contains("work-precision-late-seconds.png"),
        "{front}"
    );
    for name in ["work-precision", "work-precision-early", "work-precision-early-seconds"] {
        for ending in ["svg", "png"] {
            let path = folder.path().join(format!("results/grid/charts/{name}.{ending}"));
            assert!(std::fs::metadata(&path).unwrap().len() > 1000, "{}", path.display());
        }
    }
}
