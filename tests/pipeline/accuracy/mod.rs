//! Mesh errors of rows.

mod advice;
mod meshes;

use std::process::Output;

use serde_json::{Value, json};

use crate::support::{TestFolder, stderr};

/// All that a command printed.
fn said(output: &Output) -> String {
    String::from_utf8_lossy(&output.stdout).into_owned() + &stderr(output)
}

/// The paper's capsule on coarse film for some milliseconds.
pub(crate) fn film(more: &Value) -> Value {
    let mut study = json!({
        "design": {
            "N": 6, "M": 3, "bottom_radius": "500 mm", "top_radius": "365 mm", "height": "1 m"
        },
        "gas": {"mass_flow_rate": "5 g/s"},
        "solver": {"model": "film", "end_time": "0.21 s"},
        "outputs": {"frames": 0},
        "seed": 1
    });
    for (key, value) in more.as_object().unwrap() {
        match (study.get_mut(key).and_then(Value::as_object_mut), value.as_object()) {
            (Some(section), Some(members)) => section.extend(members.clone()),
            _ => study[key] = value.clone(),
        }
    }
    study
}

#[test]
fn a_row_outside_the_table_says_why_it_has_no_error() {
    let mut study = film(&json!({"contact": {"friction": 0.2}, "design": {"subdivisions": 2}}));
    study["solver"]["end_time"] = json!("20 ms");
    let folder = TestFolder::finished(&study);
    let row = &folder.rows("results/grid")[0];
    assert_eq!(row["no_error_reason"], "contact.friction 0.2: the runs of the table have 0");
    assert_eq!(row["peak_vz_change_to_n24"], Value::Null);
}
