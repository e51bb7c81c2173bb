//! `billow-checks converge`: trends and the table of mesh errors of a small study.

use std::fs;

use serde_json::{Value, json};

use crate::support::{Folder, stderr};

/// The paper's capsule on coarse film for some milliseconds.
fn study() -> Value {
    json!({
        "design": {
            "N": 6, "M": 3, "bottom_radius": "500 mm", "top_radius": "365 mm", "height": "1 m"
        },
        "gas": {"mass_flow_rate": "5 g/s"},
        "solver": {"model": "film", "end_time": "20 ms"},
        "outputs": {"frames": 0},
        "seed": 1,
        "grid": {"subdivisions": [2, 3, 4, 5]}
    })
}

#[test]
fn convergence_needs_four_meshes_and_names_what_tends_to_a_limit() {
    let folder = Folder::new();
    folder.study("meshes", &study());
    let printed = folder.stdout(&["converge", "meshes", "--json"]);
    let rows: Vec<Value> = serde_json::from_str(&printed).unwrap();
    let energy = rows.iter().find(|row| row["measure"] == "peak_kinetic_energy").unwrap();
    assert_eq!(energy["meshes"], "2 to 5");
    assert!(energy["finest"].is_f64() && energy["order"].is_f64(), "{energy}");
    // Null where no limit is known.
    let limits = ["limit", "change", "uncertainty"].map(|name| energy[name].is_f64());
    assert!(limits == [true; 3] || limits == [false; 3], "{energy}");
    let output = folder.run(&["converge", "meshes", "--table", "table.json", "--reference", "6"]);
    assert!(stderr(&output).contains("no scene has this mesh"), "{}", stderr(&output));
    assert!(!folder.path().join("table.json").exists());
    folder.stdout(&["converge", "meshes", "--table", "table.json", "--reference", "5"]);
    let table: Value =
        serde_json::from_str(&fs::read_to_string(folder.path().join("table.json")).unwrap())
            .unwrap();
    assert_eq!((&table["format"], &table["reference"]), (&json!("billow-mesh-errors"), &json!(5)));
    let mut study = study();
    study["solver"]["model"] = json!("piston");
    folder.study("piston", &study);
    let output = folder.run(&["converge", "piston"]);
    assert_eq!(output.status.code(), Some(2));
    assert!(stderr(&output).contains("at least four meshes"), "{}", stderr(&output));
}
