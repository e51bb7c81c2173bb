//! `export --out`: the file, its message, what is refused.

use serde_json::json;

use crate::support::{TestFolder, grid, json_of, ran};

#[test]
fn a_cube_holds_every_done_job() {
    let folder = ran();
    let rows = json_of(&folder, &["export", "results/grid", "--out", "grid.nc"]);
    let row = &rows.as_array().unwrap()[0];
    let all = folder.rows("results/grid");
    let done = all.iter().filter(|row| row["status"] == "done").count();
    assert_eq!((row["file"].as_str(), &row["points"]), (Some("grid.nc"), &json!(all.len())));
    assert_eq!((&row["times"], &row["histories"]), (&json!(601), &json!(done)));
    let file = std::fs::read(folder.path().join("grid.nc")).unwrap();
    assert_eq!(&file[..8], b"\x89HDF\r\n\x1a\n");
    // The same results and program give the same bytes.
    folder.stdout(&["export", "results/grid", "--out", "again.h5"]);
    assert_eq!(std::fs::read(folder.path().join("again.h5")).unwrap(), file);
    let few = json_of(&folder, &["export", "--out", "few.nc", "--columns", "z_rim,volume"]);
    assert!(few[0]["variables"].as_u64() < row["variables"].as_u64());
}

#[test]
fn a_cube_that_is_not_possible_is_refused_with_exit_code_2_and_leaves_no_file() {
    let folder = TestFolder::new(&grid(&json!({
        "N": [6], "M": [3], "alpha1_over_phi": [1], "mass_flow_rate": ["2 g/s"]
    })));
    let refused = |arguments: &[&str], expected: &str| {
        folder.refuses(arguments, expected);
        assert!(!folder.path().join("grid.nc").exists());
    };
    refused(&["export", "grid.json", "--out", "grid.nc"], "no results here");
    folder.stdout(&["run", "grid.json", "-q"]);
    refused(&["export", "--out", "grid.csv"], "ends in .nc or .h5");
}
