//! The advice of `billow plan --accuracy`.

use serde_json::{Value, json};

use super::film;
use crate::support::{TestFolder, stderr};

/// The plan of a study says its advice on stderr.
fn advice(study: &Value, options: &[&str]) -> String {
    let output = TestFolder::new(study).run(&[&["plan", "grid.json"], options].concat());
    assert!(output.status.success(), "{}", stderr(&output));
    stderr(&output)
}

#[test]
fn advice_names_the_cheapest_method_that_keeps_an_accuracy() {
    let study = film(&json!({"design": {"subdivisions": 16}}));
    let text = advice(&study, &["--accuracy", "15 %"]);
    assert!(text.contains("advice: film, n ") && text.contains("cheaper than now"), "{text}");
    assert!(text.contains("keeps 15 % of times, energy and final state"), "{text}");
    assert!(text.contains("\"meshes\": [") && text.contains("at solver.cfl 0.45"), "{text}");
    assert!(!text.contains("peak_speed"), "{text}");
    let limits = json!({"peak_speed": "< 20 m/s"});
    let limited = film(&json!({"design": {"subdivisions": 16}, "limits": limits}));
    let text = advice(&limited, &["--accuracy", "15 %"]);
    assert!(text.contains("in 19 of 20 runs (") && text.contains(", peak_speed "), "{text}");
    let text = advice(&study, &["--accuracy", "25 %"]);
    assert!(text.contains("\"subdivisions\": "), "{text}");
    assert!(advice(&study, &["--accuracy", "1e-6"]).contains("advice: none: no method keeps"));
    assert!(!advice(&study, &[]).contains("advice"), "nothing asks for an accuracy");
    let refused = TestFolder::new(&study).run(&["plan", "grid.json", "--accuracy", "much"]);
    assert_eq!(refused.status.code(), Some(2));
    assert!(stderr(&refused).contains("not a relative error"), "{}", stderr(&refused));
}

#[test]
fn advice_names_a_model_without_mesh_where_it_is_enough_and_film_where_it_is_not() {
    // The piston is a third early (README), storeys some percent, with an energy a fifth off.
    let text = advice(&film(&json!({})), &["--accuracy", "70 %"]);
    assert!(text.contains("advice: storeys keeps "), "{text}");
    assert!(text.contains("\"model\": \"storeys\"") && text.contains("cannot lock"), "{text}");
    let text = advice(&film(&json!({})), &["--accuracy", "15 %"]);
    assert!(text.contains("advice: film, n ") && !text.contains("cannot lock"), "{text}");
    let mut piston = film(&json!({}));
    piston["solver"]["model"] = json!("piston");
    let text = advice(&piston, &["--accuracy", "95 %"]);
    assert!(text.contains("1.0 times the cost of now): as it is"), "{text}");
    let text = advice(&piston, &["--accuracy", "15 %"]);
    assert!(text.contains("\"solver\": {\"model\": \"film\""), "{text}");
}

#[test]
fn outside_the_table_the_advice_says_why_there_is_none_and_what_helps() {
    for (section, value) in [
        ("film", json!({"compression": 0.03})),
        ("contact", json!({"friction": 0.2})),
        ("gravity", json!(-9.81)),
        ("solver", json!({"cfl": 0.3, "end_time": "0.21 s"})),
    ] {
        let mut outside = film(&json!({}));
        outside[section] = value;
        let text = advice(&outside, &["--accuracy", "0.5"]);
        assert!(text.contains("advice: none: ") && text.contains(section), "{text}");
        assert!(text.contains("\"meshes\": [4, 6, 8]"), "{text}");
    }
    let mut piston = film(&json!({}));
    piston["solver"]["model"] = json!("piston");
    piston["solver"]["stepping"] = json!({"fixed": "1 ms"});
    let text = advice(&piston, &["--accuracy", "5 %"]);
    assert!(
        text.contains("solver.stepping.fixed 0.001: the runs of the table have none"),
        "{text}"
    );
    assert!(text.contains("billow compare STUDY --by model --base film"), "{text}");
}
