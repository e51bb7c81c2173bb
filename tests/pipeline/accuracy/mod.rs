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
    assert_eq!(row["peak_vz_error_below"], Value::Null);
}

/// One run, judged by limits above, near and below its speed.
#[test]
fn a_limit_counts_as_met_only_beyond_the_uncertainty_of_the_measure() {
    let folder = TestFolder::new(&film(&json!({
        "design": {"subdivisions": 4},
        "solver": {"end_time": "40 ms"},
        "limits": {"peak_speed": "< 100 m/s"}
    })));
    folder.stdout(&["run", "grid.json", "-q"]);
    let row = |limit: f64| {
        let set = format!("limits.peak_speed=< {limit} m/s");
        let text = folder.stdout(&["table", "grid.json", "--json", "--set", &set]);
        serde_json::from_str::<Value>(&text).unwrap()[0].clone()
    };
    let first = row(100.0);
    let number = |name: &str| first[name].as_f64().unwrap();
    let speed = number("peak_speed");
    let [below, above] = ["below", "above"].map(|side| {
        number(&format!("peak_speed_error_{side}"))
            .hypot(number(&format!("peak_speed_assumed_{side}")))
    });
    assert!(
        below > 0.0 && above > 0.0 && below.max(above) < 0.5 * speed,
        "{speed} {below} {above}"
    );
    // A limit above the speed is met for certain if the speed cannot be as much larger.
    let safety = [1.01 * above, 0.99 * above, -0.99 * below, -1.01 * below];
    let safety = safety.map(|distance| row(speed + distance));
    let safety = safety.each_ref().map(|row| row["safety"].as_str().unwrap());
    assert_eq!(safety, ["safe", "uncertain", "uncertain", "unsafe"]);
    let other = folder.stdout(&["table", "grid.json", "--json", "--set", "limits.overshoot=< 9"]);
    assert!(other.contains("\"safety\": \"uncertain\""), "no error is known: {other}");
    let plan = stderr(&folder.run(&["plan", "grid.json", "--set", "limits.overshoot=< 9"]));
    assert!(plan.contains("note: the error of overshoot is not known on any mesh"), "{plan}");
    assert!(!plan.contains("the error of peak_speed"), "{plan}");
}
