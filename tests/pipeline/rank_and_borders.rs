//! Limits, replicates and searches: the answer of a run, `compare --rank`, `table --borders`, and the notes of `plan`.

use serde_json::{Value, json};

use crate::support::{TestFolder, grid, json_of, stderr};

/// Strategies and rates with four thicknesses each, and limits. The piston deploys with a gas supply.
fn safety_study(rates: &Value) -> Value {
    let mut study = grid(&json!({
        "N": [6], "M": [3], "alpha1_over_phi": [1],
        "strategy": ["rapid", "preinflate"], "mass_flow_rate": rates
    }));
    study["strategies"] = json!({
        "rapid": {"inflow": [{"from": 0, "to": "0.4 s"}]},
        "preinflate": {"preinflation_mass": "0.15 g", "inflow": [{"from": "0.1 s"}]}
    });
    study["replicates"] = json!({"film.thickness": ["20 um", "25 um", "30 um", "35 um"]});
    study["limits"] = json!({"peak_vz": "< 41 m/s", "verdict": "deployed"});
    study
}

#[test]
fn the_answer_counts_points_and_names_the_gentler_strategy() {
    let folder = TestFolder::new(&safety_study(&json!(["0.5 g/s", "2 g/s", "5 g/s"])));
    let said = folder.stdout(&["run", "grid.json", "-q"]);
    assert!(said.contains("deployed all runs of 6 of 6 points deploy"), "{said}");
    assert!(said.contains("(peak_vz < 41 m/s, deployed)"), "{said}");
    assert!(said.contains(" strategy: safe rapid 0 of 3 ("), "{said}");
    assert!(said.contains("billow compare results/grid --rank"), "{said}");
    let answer = json_of(&folder, &["run", "grid.json", "-q"]);
    let rows = folder.rows("results/grid");
    assert_eq!(rows.len(), 24);
    // The test counts the safe points itself.
    let rates = [0.0005, 0.002, 0.005];
    let runs = |strategy: &str, rate: f64| {
        let of = move |row: &&Value| {
            row["strategy"] == *strategy && row["mass_flow_rate"].as_f64() == Some(rate)
        };
        rows.iter().filter(of).collect::<Vec<_>>()
    };
    // The error of the piston is not known: what meets the limits is within its uncertainty.
    let met = |strategy: &str, rate: f64| {
        runs(strategy, rate).iter().filter(|row| row["safety"] == "uncertain").count()
    };
    let points: Vec<usize> = ["rapid", "preinflate"]
        .iter()
        .flat_map(|strategy| rates.map(|rate| met(strategy, rate)))
        .collect();
    let safe = &answer["safe"];
    let number = |wanted: fn(usize) -> bool| points.iter().filter(|n| wanted(**n)).count();
    assert_eq!((&safe["safe"], &safe["uncertain"]), (&json!(0), &json!(number(|runs| runs > 0))));
    assert!(number(|runs| runs == 4) > 0 && number(|runs| runs < 4) > 0, "{points:?}");
    assert_eq!(safe["missed"], json!({"peak_vz": number(|runs| runs < 4)}));
    let compared = answer["comparisons"].as_array().unwrap().iter();
    let of_strategy = compared.clone().find(|by| by["parameter"] == "strategy").unwrap();
    assert_eq!((compared.len(), &of_strategy["sets"]), (2, &json!(3)));
    assert_eq!(answer["points_with_runs"]["replicates"], json!(["thickness"]));

    let ranked = json_of(&folder, &["compare", "--rank", "grid.json"]);
    assert_eq!(ranked[0]["strategy"], "rapid");
    let of_answer = |row: &Value, name: &str| {
        let rows = of_strategy["values"].as_array().unwrap();
        rows.iter().find(|other| other["strategy"] == row["strategy"]).unwrap()[name].clone()
    };
    for (index, row) in ranked.as_array().unwrap().iter().enumerate() {
        let strategy = row["strategy"].as_str().unwrap();
        assert_eq!(row["rank"], index + 1);
        for name in ["rank", "safe", "smallest_margin", "peak_vz"] {
            assert_eq!(of_answer(row, name), row[name], "the answer is the same comparison");
        }
        assert_eq!((&row["points"], &row["safe_runs_of"]), (&json!(3), &json!(12)));
        assert_eq!((&row["safe_runs"], &row["safe"]), (&json!(0), &json!(0)));
        let margins = rows.iter().filter(|run| run["strategy"] == strategy);
        let worst = margins.filter_map(|run| run["smallest_margin"].as_f64());
        assert_eq!(row["smallest_margin"].as_f64(), worst.reduce(f64::min));
    }
    let output = folder.run(&["compare", "--rank", "--measures", "smallest_margin,peak_vz"]);
    let said = stderr(&output);
    let order = "order: points not safe (peak_vz < 41 m/s, deployed), runs not safe, smallest_margin, peak_vz\n";
    assert!(said.contains(order), "{said}");
    assert!(said.contains("over 3 sets of points that are equal in mass_flow_rate"), "{said}");
    folder.refuses(&["compare", "--rank", "--by", "strateg"], "did you mean strategy?");
    let measures = ["compare", "--rank", "--measures", "final_pressure"];
    folder.refuses(&measures, "smaller or larger is better");
    folder.refuses(&["table", "--borders"], "searches no border");
}

#[test]
fn runs_that_end_too_early_are_named_beside_what_a_search_found() {
    let bisect = json!({"bisect": ["2 g/s", "20 g/s"], "on": "verdict", "tolerance": "50 %"});
    let mut study = safety_study(&bisect);
    study["solver"]["end_time"] = json!("0.05 s");
    study.as_object_mut().unwrap().remove("replicates");
    let folder = TestFolder::new(&study);
    let early = "did not deploy and still moved at the end: a longer solver.end_time may change";
    let said = folder.stdout(&["run", "grid.json", "-q"]).replace("\n           ", " ");
    assert!(said.contains(early), "{said}");
    let borders = folder.run(&["table", "grid.json", "--borders"]);
    assert!(stderr(&borders).contains(early), "{}", stderr(&borders));
    let long = folder.stdout(&["run", "grid.json", "-q", "--set", "solver.end_time=2 s"]);
    assert!(!long.contains("still moved"), "{long}");
}

#[test]
fn a_search_encloses_the_rate_at_which_a_limit_is_missed() {
    let bisect = json!({"bisect": ["0.5 g/s", "20 g/s"], "on": "peak_vz", "tolerance": "1 %"});
    let mut study = safety_study(&bisect);
    study.as_object_mut().unwrap().remove("replicates");
    let folder = TestFolder::new(&study);
    let planned = stderr(&folder.run(&["plan", "grid.json"]));
    assert!(
        planned.contains("search: 2 searches along mass_flow_rate; first generation 10 jobs"),
        "{planned}"
    );
    assert!(planned.contains("limits: safe is peak_vz < 41 m/s and deployed"), "{planned}");
    let film =
        ["plan", "grid.json", "--set", "solver.model=film", "--set", "design.subdivisions=2"];
    let alone = "warning: one run decides each value of mass_flow_rate";
    assert!(stderr(&folder.run(&film)).contains(alone) && !planned.contains(alone), "{planned}");
    let said = folder.stdout(&["run", "grid.json", "-q"]);
    let rows = folder.rows("results/grid");
    assert!(rows.len() > 10, "the search goes on after its first values");
    assert!(said.contains(&format!("{} points", rows.len())), "{said}");
    let status = json_of(&folder, &["status"]);
    assert_eq!((&status["points"], &status["pending"]), (&json!(rows.len()), &json!(0)));

    let borders = json_of(&folder, &["table", "--borders"]);
    assert_eq!(borders.as_array().unwrap().len(), 2);
    let mut found = 0;
    for border in borders.as_array().unwrap().iter().filter(|row| row["outcome"] == "border") {
        found += 1;
        let [low, high] = ["low", "high"].map(|end| border[end].as_f64().unwrap());
        assert!(0.0 < high - low && high - low <= 0.0002, "{border}");
        assert_eq!((&border["below"], &border["limit"]), (&json!("met"), &json!("peak_vz")));
        for row in rows.iter().filter(|row| row["strategy"] == border["strategy"]) {
            let (rate, speed) =
                (row["mass_flow_rate"].as_f64().unwrap(), row["peak_vz"].as_f64().unwrap());
            assert!(rate > low || speed < 41.0, "{row}");
            assert!(rate < high || speed >= 41.0, "{row}");
        }
        let strategy = border["strategy"].as_str().unwrap();
        assert!(
            said.contains(&format!("peak_vz < 41 m/s below, not above (strategy={strategy})")),
            "{said}"
        );
    }
    assert!(found > 0, "{borders}");
    let few = json_of(
        &folder,
        &["table", "--borders", "--where", "strategy == 'rapid' and outcome != 'open'"],
    );
    assert_eq!(few.as_array().unwrap().len(), 1);

    // In the table the values of a search ascend, although they were planned in generations.
    let listed = json_of(&folder, &["table", "--where", "strategy == 'rapid'"]);
    let rates =
        listed.as_array().unwrap().iter().map(|row| row["mass_flow_rate"].as_f64().unwrap());
    assert!(rates.is_sorted(), "{listed}");

    // Only the values that both strategies have are ranked: the five of the scan.
    let ranked = json_of(&folder, &["compare", "--rank"]);
    assert!(ranked.as_array().unwrap().iter().all(|row| row["points"] == 5), "{ranked}");
}

#[test]
fn other_limits_judge_the_stored_runs() {
    let folder = TestFolder::finished(&safety_study(&json!(["0.5 g/s", "2 g/s", "5 g/s"])));
    let rows = folder.rows("results/grid");
    let set = ["--set", "limits.peak_vz=< 38 m/s"];
    let output = folder.run(&[&["table", "grid.json", "--runs", "--json"], &set[..]].concat());
    let said = stderr(&output);
    assert!(
        said.contains("note: limits peak_vz < 38 m/s, deployed; the last run had peak_vz < 41 m/s"),
        "{said}"
    );
    let judged: Value = serde_json::from_slice(&output.stdout).unwrap();
    assert_eq!(judged.as_array().unwrap().len(), rows.len());
    let safe = |rows: &[Value], limit: f64| {
        rows.iter().filter(|row| row["peak_vz"].as_f64().unwrap() < limit).count()
    };
    assert!(safe(&rows, 38.0) < safe(&rows, 41.0), "the limits differ in what they find safe");
    for row in judged.as_array().unwrap() {
        let missed = row["peak_vz"].as_f64().unwrap() >= 38.0;
        assert_eq!(row["safety"], if missed { "unsafe" } else { "uncertain" }, "{row}");
    }
    let margins = |of: &[&str]| {
        let ranked = json_of(&folder, &[&["compare", "--rank"], of].concat());
        let rows = ranked.as_array().unwrap().iter();
        rows.filter_map(|row| row["smallest_margin"].as_f64()).fold(f64::INFINITY, f64::min)
    };
    let fastest = rows.iter().filter_map(|row| row["peak_vz"].as_f64()).fold(0.0, f64::max);
    let near = |margin: f64, limit: f64| (margin - (limit - fastest) / limit).abs() < 1e-12;
    assert!(near(margins(&["grid.json", "--set", "limits.peak_vz=< 38 m/s"]), 38.0));
    // A folder keeps the limits of its last run.
    assert!(near(margins(&["results/grid"]), 41.0));
}

#[test]
fn plan_says_which_limits_the_piston_cannot_judge() {
    let mut study = safety_study(&json!(["1 g/s"]));
    study["limits"] =
        json!({"film_stress_99": "< 100 MPa", "passages": "< 1", "film_stress": "< 1 GPa"});
    let folder = TestFolder::new(&study);
    let said = stderr(&folder.run(&["plan", "grid.json"]));
    assert!(said.contains("a capsule that does not deploy can be safe"), "{said}");
    let expected =
        "the model piston does not compute film_stress_99, passages: 8 points cannot be judged";
    assert!(said.contains(expected), "{said}");
    // The list of these measures is that of the empty columns of a run.
    folder.stdout(&["run", "grid.json", "-q"]);
    let rows = folder.rows("results/grid");
    let empty = |name: &str| rows.iter().all(|row| row[name].is_null());
    for name in [
        "film_stress_99",
        "t_film_stress_99",
        "passages",
        "intersections",
        "interlayer_pressure",
        "contact_area_fraction",
        "smallest_gap",
    ] {
        assert!(empty(name), "{name}");
    }
    for name in ["film_stress", "peak_vz", "peak_kinetic_energy", "final_overpressure", "t_settled"]
    {
        assert!(!empty(name), "{name}");
    }
}
