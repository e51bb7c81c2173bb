//! `export --out`: the file and its message.

use serde_json::json;

use crate::support::{json_of, ran};

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
