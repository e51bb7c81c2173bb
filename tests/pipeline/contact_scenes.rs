//! Contact in `billow solve`: film on film, plates, the lid, and invalid contact.

use std::fmt::Write as _;

use billow_solver::scene::Film;
use billow_study::store::history_file;
use serde_json::{Value, json};

use crate::solve::{done, number, refused, scene_folder, solve, solved};
use crate::support::{paper_design, stderr};

/// The paper's capsule on a coarse mesh for 20 ms, with changed keys.
fn capsule(changes: &Value) -> Value {
    let mut scene = json!({
        "design": paper_design(2),
        "film": {"compression": 0, "numerical_damping": 0.1},
        "gas": {"windows": [{"from": 0, "mass_flow_rate": "5 g/s"}]},
        "solver": {"end_time": "20 ms"},
    });
    for (key, value) in changes.as_object().expect("an object") {
        scene[key] = value.clone();
    }
    scene
}

/// A flat sheet of two by two cells, 0.2 m wide, at this height (m).
fn sheet(height: f64) -> String {
    let mut text = String::new();
    for j in 0..3 {
        for i in 0..3 {
            let (x, y) = (0.1 * f64::from(i), 0.1 * f64::from(j));
            let _ = writeln!(text, "v {x} {y} {height}");
        }
    }
    for j in 0..2 {
        for i in 0..2 {
            let a = 3 * j + i + 1;
            let _ = writeln!(text, "f {a} {} {}\nf {a} {} {}", a + 1, a + 4, a + 4, a + 3);
        }
    }
    text
}

/// Smallest stowed gap of the paper's capsule at 16 subdivisions, m.
const REFERENCE_GAP: f64 = 0.791_899_699e-3;

#[test]
fn creases_and_yield_need_bending_and_change_the_motion() {
    let with = |film: &Value, creases: &Value| capsule(&json!({"film": film, "creases": creases}));
    let (stiff, length) = (json!({"compression": 1}), json!({"length_scale": "5 mm"}));
    refused(&with(&stiff, &length), &[], &["film.bending = false", "allowed: true"]);
    let bending = json!({"compression": 1, "bending": true});
    let angle = json!({"rest_angle": "90 deg"});
    refused(&with(&bending, &angle), &[], &["creases.length_scale: missing", "give it"]);
    let yielding =
        |bending: bool| json!({"compression": 1, "bending": bending, "yield_moment": "1e-6 N"});
    let elastic = ["film.bending = false", "the file has film.yield_moment"];
    refused(&with(&yielding(false), &json!({})), &[], &elastic);
    let mut still = with(&yielding(true), &json!({}));
    still["solver"] = json!({"static": true});
    refused(
        &still,
        &[],
        &["film.yield_moment", "static equilibrium", "allowed: no film.yield_moment"],
    );
    still["solver"] = json!({"integrator": "implicit", "end_time": "1 ms"});
    refused(&still, &[], &["implicit has no yield", "allowed: no film.yield_moment, or explicit"]);
    let volume =
        |film: &Value, creases: &Value| number(&solved(&with(film, creases), &[]), "/volume");
    let volumes = [
        (&stiff, json!({})),
        (&bending, json!({})),
        (&bending, length.clone()),
        (&yielding(true), length.clone()),
    ]
    .map(|(film, creases)| volume(film, &creases).to_bits());
    assert!(volumes.windows(2).all(|pair| pair[0] != pair[1]), "{volumes:?}");
    let sheet_scene = json!({
        "mesh": {"positions": "sheet.obj"}, "film": bending, "creases": length, "contact": {"enabled": false},
        "solver": {"end_time": "1 ms"},
    });
    let summary = solved(&sheet_scene, &[("sheet.obj", &sheet(0.0))]);
    let notes = summary["notes"].to_string();
    assert!(notes.contains("creases has no effect: a mesh has no fold lines"), "{notes}");
}

#[test]
fn a_folded_capsule_reports_its_contact() {
    let folder = scene_folder(&capsule(&json!({})), &[]);
    let summary = done(folder.path(), &["scene.json", "-q", "--out", "a.h5"], "");
    assert_eq!(summary["status"], "done");
    assert_eq!((number(&summary, "/passages"), number(&summary, "/intersections")), (0.0, 0.0));
    let contact = |key: &str| number(&summary, &format!("/contact/{key}"));
    assert!((contact("distance") - 0.4 * REFERENCE_GAP).abs() < 1e-9);
    assert!(summary["imperfection_amplitude"].is_null() && contact("smallest_gap") > 0.0);
    assert!(contact("broad_phase_rebuilds") >= 1.0 && contact("pairs") > 0.0);
    assert!(contact("interlayer_pressure") > 0.0 && contact("contact_area_fraction") > 0.01);
    let peak = number(&summary, "/measures/peak_kinetic_energy");
    assert!(
        contact("unrecovered_contact_energy").abs() < 0.01 * peak
            && number(&summary, "/ledger/residual") < 5e-3
    );
    let stored = history_file::read(&folder.path().join("a.h5")).expect("a history");
    let tracks = [
        "interlayer_pressure",
        "interlayer_pressure_mean",
        "contact_area_fraction",
        "smallest_gap",
        "contact_pairs",
        "broad_phase_rebuilds",
        "vz_centre",
        "film_stress_99",
    ];
    for name in tracks {
        assert!(stored.tracks.contains_key(name), "{name}");
    }

    // Without contact, passages are not counted; a message says so.
    let without_contact = ["scene.json", "--set", "contact.enabled=false"];
    let output = solve(folder.path(), &without_contact, "");
    assert!(stderr(&output).contains("contact is off: film passes through film"));
    let summary: Value = serde_json::from_slice(&output.stdout).expect("a summary");
    assert!(summary["passages"].is_null() && summary["contact"].is_null());
}

#[test]
fn the_force_on_a_plate_is_the_weight_of_the_film() {
    let plate = json!({"name": "floor", "point": [0, 0, 0], "normal": [0, 0, 2]});
    let scene = json!({
        "mesh": {"positions": "sheet.obj"},
        "gravity": -10,
        "film": {"density": "1400 kg/m3", "thickness": "25.4 um"},
        "contact": {"distance": "2 mm", "plates": [plate]},
        "solver": {"end_time": "0.3 s", "mass_damping": 100},
        "outputs": {"sample_interval": "10 ms"},
    });
    // Released at 4 mm, and just above the plate.
    for height in [0.004, 1e-6] {
        let summary = solved(&scene, &[("sheet.obj", &sheet(height))]);
        // 0.2 m square.
        let weight = 0.04 * Film::PAPER.area_density() * 10.0;
        let force = number(&summary, "/contact/plates/floor");
        assert!((force / weight - 1.0).abs() < 0.01, "{force} of {weight}");
        assert!(number(&summary, "/extents/z/0") > 0.0);
    }
}

#[test]
fn contact_of_film_that_touches_film_is_off() {
    let two = format!("{}{}", sheet(0.0), sheet(0.0).replace("f ", "#"));
    let twice = two.clone() + "f 10 11 14\nf 10 14 13\n";
    let scene = json!({"mesh": {"positions": "sheet.obj"}, "solver": {"end_time": "1 ms"}});
    let folder = scene_folder(&scene, &[("sheet.obj", &twice)]);
    // Film that lies on film has no side: by default contact is off, with a note.
    let output = solve(folder.path(), &["scene.json"], "");
    assert_eq!(output.status.code(), Some(0), "{}", stderr(&output));
    assert!(stderr(&output).contains("film touches film at the start"));
    let summary: Value = serde_json::from_slice(&output.stdout).expect("a summary");
    assert!(summary["notes"][0].as_str().is_some_and(|note| note.contains("touches film")));
}
