use super::*;
use crate::analysis::work_precision::{Ending, Outcome, Quantity, Run, SceneRuns};
use crate::input::value::Value;
use crate::render::figure::check;

fn run(model: &str, n: Option<i64>, value: f64) -> Run {
    let size = n.map_or(0.0, |n| n as f64);
    let steps = 5000.0 * size.max(0.1);
    Run {
        configuration: vec![
            ("solver.model".to_owned(), Value::Text(model.to_owned())),
            ("subdivisions".to_owned(), n.map_or(Value::Null, Value::Integer)),
        ],
        ending: Ending::Trusted,
        elements: 48.0 * size * size,
        steps,
        implicit: false,
        seconds: Some(1e-6 * (1.0 + size * size) * steps),
        results: vec![Some(Outcome::Number(value)), None],
        mesh_errors: Vec::new(),
    }
}

fn diagram(name: &str, exact: Option<f64>) -> Diagram {
    let quantity = |name: &str| Quantity {
        name: name.to_owned(),
        unit: "J".to_owned(),
        meaning: String::new(),
        exact: exact.filter(|_| name != "t_90_z_rim"),
        is_course: false,
    };
    let mut runs = vec![run("piston", None, 24.0)];
    for n in [4, 8, 16] {
        let size = n as f64;
        runs.extend(
            [0.9, 1.1].map(|part| run("film", Some(n), 20.0 * (1.0 + part / (size * size)))),
        );
    }
    Diagram::of(SceneRuns {
        name: name.to_owned(),
        meaning: "a made-up scene".to_owned(),
        quantities: vec![quantity("peak_kinetic_energy"), quantity("t_90_z_rim")],
        per_simulated_second: true,
        runs,
        without_result: 2,
    })
}

const PEER: &[u8] =
    br#"{"name": "another code", "provenance": "measured elsewhere", "scene": "capsule_direct",
    "times": [{"model": "film", "subdivisions": 8, "simulated": 0.3, "ratio": [6.3, 7.5]}],
    "measures": [{"name": "peak_kinetic_energy", "range": [18.1, 22.0], "note": "a difference"}]}"#;

#[test]
fn a_picture_has_orders_front_reference_and_gaps() {
    let texts = check::figure(&scene(&diagram("capsule_direct", None), Cost::Work, None));
    let has = |wanted: &str| texts.iter().any(|text| text.contains(wanted));
    assert!(has("Work and precision: capsule direct"), "{texts:?}");
    assert!(has("on the front (dotted line)") && has("reference, at its uncertainty"));
    assert!(has("no trusted configuration"), "{texts:?}");
    assert!(has("film, over subdivisions") && has("piston"));
    assert!(has("2 runs have not ended") && has("Numbers beside points: subdivisions."));
    let exact = check::figure(&scene(&diagram("disc", Some(20.0)), Cost::Work, None));
    assert!(exact.iter().any(|text| text.contains("order 2")), "{exact:?}");
    assert!(exact.iter().any(|text| text.contains("Reference: the exact value.")), "{exact:?}");
}

#[test]
fn a_peer_stands_on_the_chart_of_seconds_alone() {
    let peer = Peer::from_text(PEER).unwrap();
    let diagram = diagram("capsule_direct", None);
    let of = |cost| check::figure(&scene(&diagram, cost, Some(&peer))).join(" ");
    assert!(of(Cost::Seconds).contains("another code, difference"));
    assert!(of(Cost::Seconds).contains("6.3 to 7.5 times"));
    assert!(!of(Cost::Work).contains("another code"));
}

#[test]
fn the_overview_has_a_panel_for_each_scene() {
    let scenes = [("a_scene", None), ("b", Some(20.0)), ("c", Some(20.0))];
    // Without the quantity that no run has.
    let diagrams = scenes.map(|(name, exact)| {
        let mut diagram = diagram(name, exact);
        diagram.quantities.truncate(1);
        diagram
    });
    let texts = check::figure(&overview(&diagrams, Cost::Work));
    for wanted in ["A scene", "B (order 2)", "C (order 2)"] {
        assert!(texts.iter().any(|text| text.contains(wanted)), "{wanted}: {texts:?}");
    }
    let nothing = overview(&[], Cost::Seconds);
    assert!(!check::figure(&nothing).is_empty());
}
