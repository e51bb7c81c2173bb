//! Studies with the film model: sound rows, shared static states, the same bits on any threads.

use serde_json::{Value, json};

use crate::support::{TestFolder, histories, stderr, without_costs};

/// Two designs and two flows on the coarsest film, for some milliseconds.
fn study() -> Value {
    json!({
        "question": "Does the film model run in a study?",
        "design": {
            "M": 3, "bottom_radius": "500 mm", "top_radius": "365 mm", "height": "1 m", "subdivisions": 2
        },
        "solver": {"model": "film", "end_time": "30 ms"},
        "outputs": {"frames": 5},
        "grid": {"N": [5, 6], "mass_flow_rate": ["5 g/s", "20 g/s"]}
    })
}

#[test]
fn the_amplitude_of_the_imperfection_belongs_to_a_job_only_with_a_seed() {
    for (seed, summary) in [(0, "2 points: 1 job, 1 duplicate,"), (1, "2 points: 2 jobs,")] {
        let mut amplitudes = study();
        amplitudes["seed"] = json!(seed);
        amplitudes["grid"] = json!({"N": [6], "imperfection_amplitude": ["0.1 mm", "0.2 mm"]});
        amplitudes["gas"]["mass_flow_rate"] = json!("5 g/s");
        let planned = stderr(&TestFolder::new(&amplitudes).run(&["plan", "grid.json"]));
        assert!(planned.contains(summary), "{planned}");
        let range = "imperfection amplitude 0.1 to 0.2 mm";
        assert_eq!(planned.contains(range), seed == 1, "{planned}");
    }
}

#[test]
fn a_plan_counts_the_points_that_an_integrator_refuses_and_they_end_so() {
    let mut study = study();
    study["solver"]["end_time"] = json!("1 ms");
    study["gas"]["mass_flow_rate"] = json!("5 g/s");
    study["contact"] = json!({"adhesion": "1 kPa"});
    study["grid"] = json!({
        "N": [6], "integrator": ["explicit", "implicit", "hybrid"], "contact.friction": [0, 0.2]
    });
    let folder = TestFolder::new(&study);
    let planned = stderr(&folder.run(&["plan", "grid.json"]));
    let note =
        "note: 2 of 6 points will end as invalid: hybrid has no friction, implicit has no friction";
    assert!(
        planned.contains(note) && planned.contains("or solver.integrator explicit"),
        "{planned}"
    );
    folder.run(&["run", "grid.json", "-q"]);
    let rows = folder.rows("results/grid");
    let invalid = rows.iter().filter(|row| row["status"] == "invalid");
    assert_eq!(invalid.count(), 2, "{rows:?}");
}

#[test]
fn a_plan_says_whether_bending_changes_results_and_whether_creases_would_yield() {
    let planned = |film: Value, creases: Value, thickness: Value| {
        let mut study = study();
        study["gas"] = json!({"residual_gas_mass": "0.05 g"});
        study["strategies"] = json!({"residual": {"inflow": []}});
        study["strategy"] = json!("residual");
        (study["film"], study["creases"]) = (film, creases);
        study["grid"] = json!({"N": [6], "thickness": thickness});
        stderr(&TestFolder::new(&study).run(&["plan", "grid.json"]))
    };
    let [thin, both] = [json!(["25.4 um"]), json!(["25.4 um", "200 um"])];
    let bent = json!({"compression": 1, "bending": true});
    let (needed, idle) = ("bending may change results", "film.bending is not needed");
    let said = planned(json!({}), json!({}), both.clone());
    assert!(said.contains(needed) && !said.contains(idle), "{said}");
    let said = planned(json!({}), json!({}), thin.clone());
    assert!(!said.contains("bending may") && !said.contains(idle), "{said}");
    let said = planned(bent.clone(), json!({"length_scale": "5 mm"}), both);
    assert!(!said.contains(needed) && !said.contains(idle), "{said}");
    assert!(said.contains("film by up to 216.8 MPa; Kapton yields at 69 MPa"), "{said}");
    let yields = json!({"compression": 1, "bending": true, "yield_moment": "0.7 N"});
    let said = planned(yields, json!({"length_scale": "5 mm"}), json!(["200 um"]));
    assert!(!said.contains("Kapton"), "{said}");
    let said = planned(bent, json!({"length_scale": "5 mm"}), thin);
    assert!(said.contains(idle) && !said.contains("yields"), "{said}");
}

#[test]
fn a_film_study_gives_sound_rows_and_the_same_bits_on_any_threads() {
    let folder = TestFolder::new(&study());
    let planned = stderr(&folder.run(&["plan", "grid.json", "--threads", "4"]));
    assert!(planned.contains("forecast: 4 jobs of film, "), "{planned}");
    assert!(planned.contains(" s of core time, 1 s on 4 threads\n"), "{planned}");
    assert!(planned.contains("contact distance "), "{planned}");
    let output = folder.run(&["run", "grid.json", "--threads", "1", "--results", "one"]);
    assert!(output.status.success(), "{}", stderr(&output));
    assert!(!stderr(&output).contains("piston"), "{}", stderr(&output));
    folder.stdout(&["run", "grid.json", "--threads", "2", "--results", "two"]);
    let (one, two) = (folder.rows("one"), folder.rows("two"));
    for row in &one {
        assert_eq!(row["status"], "done", "{row}");
        assert_eq!((&row["passages"], &row["intersections"]), (&json!(0), &json!(0)));
        assert!(row["ledger_residual"].as_f64().unwrap() <= 5e-3, "{row}");
        assert!(row["verdict"].is_string() && row["reference_volume"].as_f64().unwrap() > 0.4);
        assert!(row["smallest_gap"].as_f64().unwrap() > 0.0, "{row}");
        assert!(row["interlayer_pressure"].as_f64().unwrap() >= 0.0, "{row}");
        let [stress, robust] =
            ["film_stress", "film_stress_99"].map(|name| row[name].as_f64().unwrap());
        assert!(robust > 0.0 && robust <= stress, "{row}");
        assert!((0.0..=0.03).contains(&row["t_film_stress_99"].as_f64().unwrap()), "{row}");
        let elements = 2 * row["N"].as_i64().unwrap() * 4 * 4;
        assert_eq!(row["elements"].as_i64(), Some(elements));
        // For film that never becomes quiescent, the forecast is the exact number of steps.
        let mut alone = study();
        alone["grid"] = json!({"N": [row["N"]], "mass_flow_rate": [row["mass_flow_rate"]]});
        let said = stderr(&TestFolder::new(&alone).run(&["plan", "grid.json"]));
        let millions = row["steps"].as_f64().unwrap() * row["elements"].as_f64().unwrap() / 1e6;
        assert!(said.contains(&format!("1 job of film, about {millions:.0} million")), "{said}");
        assert!(row["time_per_zone_cycle"].as_f64().unwrap() > 0.0);
    }
    // More gas lifts the top higher in the same time.
    let height = |row: &Value| row["final_z_rim"].as_f64().unwrap();
    assert!(height(&one[1]) > height(&one[0]) && height(&one[3]) > height(&one[2]));
    assert_eq!(without_costs(one), without_costs(two));
    let files = |results: &str| histories(&folder.path().join(results));
    assert_eq!(files("one"), files("two"));
}

#[test]
fn models_mix_in_a_grid() {
    let mut mixed = study();
    mixed["solver"] = json!({"end_time": "2 ms"});
    mixed["grid"] = json!({"model": ["piston", "storeys", "film"]});
    mixed["design"]["N"] = json!(5);
    mixed["gas"] = json!({"mass_flow_rate": "5 g/s"});
    let folder = TestFolder::new(&mixed);
    let run = folder.run(&["run", "grid.json"]);
    assert!(run.status.success(), "{}", stderr(&run));
    assert!(stderr(&run).contains("model piston: it gives times and upper bounds"));
    let rows = folder.rows("results/grid");
    assert!(stderr(&run).contains("model storeys: it gives times and speeds"));
    let models: Vec<&Value> = rows.iter().map(|row| &row["model"]).collect();
    assert_eq!(models, [&json!("piston"), &json!("storeys"), &json!("film")]);
    for row in &rows[..2] {
        assert!(row["passages"].is_null() && row["smallest_gap"].is_null());
    }
    assert_eq!(rows[2]["passages"], 0);
}
