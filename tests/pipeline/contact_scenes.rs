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
        "solver": {"end_time": "1 ms"}, "seed": 1,
    });
    let summary = solved(&sheet_scene, &[("sheet.obj", &sheet(0.0))]);
    let notes = summary["notes"].to_string();
    assert!(notes.contains("creases has no effect: a mesh has no fold lines"), "{notes}");
    assert!(
        notes.contains("seed has no effect: a scene displaces a stowed design alone"),
        "{notes}"
    );
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
fn film_that_touches_film_at_the_start_loses_contact_there_alone() {
    // Two faces of another sheet lie on the first one; the others of it are 1 mm above.
    let two = format!("{}{}", sheet(0.0), sheet(0.0).replace("f ", "#"));
    let twice = two.clone() + "f 10 11 14\nf 10 14 13\n";
    let mut scene = json!({"mesh": {"positions": "sheet.obj"}, "solver": {"end_time": "1 ms"}});
    let files = [("sheet.obj", twice.as_str())];
    let folder = scene_folder(&scene, &files);
    let output = solve(folder.path(), &["scene.json"], "");
    assert_eq!(output.status.code(), Some(0), "{}", stderr(&output));
    let note = "film touches film at the start, in ";
    assert!(stderr(&output).contains(note), "{}", stderr(&output));
    let summary: Value = serde_json::from_slice(&output.stdout).expect("a summary");
    assert!(summary["notes"][0].as_str().is_some_and(|text| text.contains("have no contact")));
    assert!(number(&summary, "/contact/distance") > 1e-5, "the other pairs have theirs");
    // A file that asks for contact must say that it goes without here.
    scene["contact"] = json!({"friction": 0.1});
    refused(&scene, &files, &[note, "the face on line", "contact.ignore_start true"]);
    scene["contact"]["ignore_start"] = json!(true);
    assert_eq!(solved(&scene, &files)["passages"], 0);
}

#[test]
fn film_that_passes_through_film_at_the_start_is_refused_with_its_faces() {
    // A triangle that stands in a sheet, and one far from it.
    let stands = format!(
        "{}v 0.03 0.03 -0.02\nv 0.05 0.03 0.05\nv 0.03 0.05 0.05\nf 10 11 12\n",
        sheet(0.0)
    );
    let mut scene = json!({"mesh": {"positions": "sheet.obj"}, "solver": {"end_time": "1 ms"}});
    let files = [("sheet.obj", stands.as_str())];
    let texts = ["contact", "film passes through film at the start", "(vertices 10 11 12"];
    refused(&scene, &files, &texts);
    scene["contact"] = json!({"ignore_start": true});
    let summary = solved(&scene, &files);
    assert_eq!((&summary["passages"], &summary["intersections"]), (&json!(0), &json!(0)));
    scene["contact"] = json!({"enabled": false});
    assert!(solved(&scene, &files)["passages"].is_null());
}

/// One near pair does not decide the contact distance of all film.
#[test]
fn one_bad_spot_leaves_the_contact_distance() {
    let distance = |spot: f64| {
        // Layers 5 mm apart, of 10 by 10 faces, and one vertex near the other layer.
        let mut text = String::new();
        for z in [0.0, 0.005] {
            for (i, j) in (0..=10).flat_map(|i| (0..=10).map(move |j| (i, j))) {
                let z = if z > 0.0 && (i, j) == (5, 5) { spot } else { z };
                let _ = writeln!(text, "v {} {} {z}", 0.1 * f64::from(i), 0.1 * f64::from(j));
            }
        }
        for (layer, i, j) in [0, 121]
            .into_iter()
            .flat_map(|l| (0..10).flat_map(move |i| (0..10).map(move |j| (l, i, j))))
        {
            let at = |i: u32, j: u32| layer + 11 * i + j + 1;
            let _ = writeln!(
                text,
                "f {} {} {} {}",
                at(i, j),
                at(i + 1, j),
                at(i + 1, j + 1),
                at(i, j + 1)
            );
        }
        let scene = json!({"mesh": {"positions": "layers.obj"}, "solver": {"end_time": "1 ms"}});
        let summary = solved(&scene, &[("layers.obj", &text)]);
        assert_eq!(summary["passages"], 0);
        number(&summary, "/contact/distance")
    };
    let regular = distance(0.005);
    assert!((distance(1e-5) / regular - 1.0).abs() < 0.01, "{regular}");
}
