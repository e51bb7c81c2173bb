//! Work-precision diagrams: table, pictures, stored scenes, messages.

use serde_json::json;

use crate::support::{TestFolder, grid, stderr};

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
fn the_front_is_printed_drawn_and_read_again() {
    let folder = TestFolder::new(&study());
    folder.stdout(&["run", "grid.json", "-q"]);
    let arguments = ["pareto", "grid.json", "--scenes", "early", "--all", "--json", "-q"];
    let printed = folder.stdout(&arguments);
    let rows: serde_json::Value = serde_json::from_str(&printed).unwrap();
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
    // The error of the table follows from its values.
    let reference = energies[0]["reference"].as_f64().unwrap();
    let piston = energies.iter().find(|row| row["configuration"] == "piston").unwrap();
    let expected = (piston["value"].as_f64().unwrap() / reference - 1.0).abs();
    assert!((piston["error"].as_f64().unwrap() - expected).abs() < 1e-12);
    assert_eq!(of("early", "volume").count(), 3, "courses are compared too");
    assert_eq!(of("late", "volume").count(), 0);
    for name in ["pareto", "pareto_early"] {
        for ending in ["svg", "png"] {
            let path = folder.path().join(format!("results/grid/charts/{name}.{ending}"));
            assert!(std::fs::metadata(&path).unwrap().len() > 1000, "{}", path.display());
        }
    }
    let one = ["pareto", "grid.json", "--scenes", "early,late", "--all", "--json", "-q"];
    let one = folder.stdout(&[&one[..], &["--measures", "late:volume"]].concat());
    let one: serde_json::Value = serde_json::from_str(&one).unwrap();
    let of_late = one.as_array().unwrap().iter().filter(|row| row["scene"] == "late");
    assert!(of_late.clone().count() > 0 && of_late.clone().all(|row| row["quantity"] == "volume"));
    assert!(one.as_array().unwrap().iter().any(|row| row["quantity"] == "final_volume"));
    let alone = folder.run(&["pareto", "grid.json"]);
    let text = stderr(&alone);
    assert!(text.contains("early: errors refer to film, subdivisions 3"), "{text}");
    let doctor = folder.run(&["doctor"]);
    assert_eq!(doctor.status.code(), Some(0), "{}", stderr(&doctor));
}

#[test]
fn unknown_names_are_refused_with_those_that_exist() {
    let mut study = study();
    study["grid"]["solver.model"] = json!(["piston"]);
    let folder = TestFolder::new(&study);
    folder.stdout(&["run", "grid.json", "-q"]);
    std::fs::write(folder.path().join("peer.json"), b"{\"name\": \"x\"}").unwrap();
    for (arguments, expected) in [
        (["--scenes", "earl"], "did you mean early?"),
        (["--scenes", "early,nowhere"], "early, late"),
        (["--peer", "peer.json"], "missing field"),
    ] {
        let output = folder.run(&[&["pareto", "grid.json"], &arguments[..]].concat());
        assert_eq!(output.status.code(), Some(2), "{}", stderr(&output));
        assert!(stderr(&output).contains(expected), "{}", stderr(&output));
    }
    let output = folder.run(&["pareto", "grid.json", "--scenes", "early", "--measures", "peak_v"]);
    assert!(stderr(&output).contains("did you mean peak_vz?"), "{}", stderr(&output));
}
