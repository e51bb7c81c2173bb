//! `compare`, and the answer at the end of a run.

use serde_json::{Value, json};

use crate::support::{TestFolder, grid, json_of, paper_design, small_grid, stderr};

#[test]
fn compare_pairs_rows_that_differ_in_one_parameter_only() {
    let folder = TestFolder::finished(&grid(&json!({
        "N": [5, 6], "M": [2, 3], "alpha1_over_phi": [1],
        "mass_flow_rate": ["1 g/s", "2 g/s", "5 g/s"]
    })));
    let rows = folder.rows("results/grid");
    let by = ["compare", "--by", "mass_flow_rate", "--base", "1 g/s"];
    let pairs = json_of(&folder, &by);
    let path = ["compare", "--by", "gas.mass_flow_rate", "--base", "1 g/s"];
    assert_eq!(json_of(&folder, &path), pairs, "a parameter by the path of its key");
    let pairs = pairs.as_array().unwrap();
    assert_eq!(pairs.len(), 8);
    for pair in pairs {
        let row = |id: &Value| rows.iter().find(|row| row["job"] == *id).unwrap();
        let (base, other) = (row(&pair["base_job"]), row(&pair["other_job"]));
        assert_eq!(base["mass_flow_rate"].as_f64(), Some(0.001));
        assert_eq!((&base["N"], &base["M"]), (&other["N"], &other["M"]));
        assert_eq!(pair["mass_flow_rate"], other["mass_flow_rate"]);
        assert_eq!(
            (&pair["peak_vz_base"], &pair["peak_vz_other"]),
            (&base["peak_vz"], &other["peak_vz"])
        );
        let better = match (base["peak_vz"].as_f64(), other["peak_vz"].as_f64()) {
            (Some(base), Some(other)) if base < other => "base",
            (Some(_), Some(_)) => "other",
            _ => "neither",
        };
        assert_eq!(pair["peak_vz_better"], better, "M 2 is infeasible at any flow");
    }
    let summary = json_of(&folder, &[&by[..], &["--summary", "--measures", "peak_vz"]].concat());
    assert_eq!(summary.as_array().unwrap().len(), 2, "one row per value");
    assert_eq!(
        (&summary[0]["pairs"], &summary[0]["base_better"], &summary[0]["neither"]),
        (&json!(4), &json!(2), &json!(2))
    );
    let tied = [&by[..], &["--summary", "--tie", "99%", "--measures", "peak_vz"]].concat();
    assert_eq!(json_of(&folder, &tied)[0]["ties"], 2);
    let few =
        json_of(&folder, &[&by[..], &["--where", "N == 6 and mass_flow_rate != '2 g/s'"]].concat());
    assert_eq!(few.as_array().unwrap().len(), 2);
    let said = folder.run(&by);
    assert!(stderr(&said).contains("base: mass_flow_rate = 1 g/s"), "{}", stderr(&said));
}

#[test]
fn a_run_ends_with_the_answer_to_its_question() {
    let mut study = small_grid();
    study["question"] = json!("Do more panels help?");
    let folder = TestFolder::new(&study);
    let said = folder.stdout(&["run", "grid.json", "-q"]);
    assert!(said.lines().count() <= 32, "{said}");
    assert!(said.contains("\nDo more panels help?\n"), "{said}");
    assert!(said.contains("  assumed  vacuum; no gravity; no floor; stack 40 mm high"), "{said}");
    assert!(said.contains("  deployed 16 of 16 jobs"), "{said}");
    assert!(said.contains("not counted by this model"), "{said}");
    let next = "billow compare results/grid --by residual_gas_mass --base \"0 g\"";
    assert!(said.contains(next), "{said}");

    let answer = json_of(&folder, &["run", "grid.json", "-q"]);
    let rows = folder.rows("results/grid");
    let of = |name: &str| rows.iter().filter_map(|row| row[name].as_f64()).collect::<Vec<_>>();
    let largest = of("peak_vz").into_iter().fold(0.0, f64::max);
    let least = of("t_90_z_rim_since_release").into_iter().fold(f64::INFINITY, f64::min);
    assert_eq!(answer["hardest"]["value"].as_f64(), Some(largest));
    assert_eq!(answer["fastest"]["value"].as_f64(), Some(least));
    let job = rows.iter().find(|row| row["job"] == answer["fastest"]["job"]).unwrap();
    assert_eq!(answer["fastest"]["parameters"]["alpha1_over_phi"], job["alpha1_over_phi"]);
    let residual = of("ledger_residual").into_iter().fold(0.0, f64::max);
    assert_eq!(answer["trust"]["ledger_residual"].as_f64(), Some(residual));
    assert!(answer["trust"]["passages"].is_null());
    assert_eq!(answer["assumptions"][0], "vacuum");
    let planned = stderr(&folder.run(&["plan", "grid.json"]));
    assert!(planned.contains("\nassumed: vacuum; no gravity; no floor; "), "{planned}");

    // Every M and ratio that is feasible at N 5 is feasible at N 6. The test computes the medians itself.
    let medians = answer["comparisons"].as_array().unwrap();
    let panels = medians.iter().find(|median| median["parameter"] == "N").unwrap();
    assert_eq!(panels["sets"], 8);
    for value in panels["values"].as_array().unwrap() {
        let mut speeds: Vec<f64> = rows
            .iter()
            .filter(|row| row["N"] == value["N"])
            .filter_map(|row| row["peak_kinetic_energy"].as_f64())
            .collect();
        speeds.sort_by(f64::total_cmp);
        assert_eq!(value["peak_kinetic_energy"].as_f64(), Some(0.5 * speeds[3] + 0.5 * speeds[4]));
    }
}

#[test]
fn an_answer_shows_what_is_limited_first_and_names_mixed_points() {
    let mut study = grid(&json!({ "mass_flow_rate": ["1 g/s", "5 g/s"] }));
    study["design"] = paper_design(8);
    study["gas"]["residual_gas"] = json!("stored");
    study["gas"]["residual_gas_mass"] = json!("0.3 g");
    study["strategies"] = json!({ "direct": { "inflow": [{ "from": "0.3 s" }] } });
    study["replicates"] = json!({ "film.thickness": ["25 um", "26 um"] });
    let folder = TestFolder::finished(&study);
    let rows = folder.rows("results/grid");
    let speeds: Vec<f64> = rows.iter().filter_map(|row| row["peak_vz"].as_f64()).collect();
    let limit = format!("limits.peak_vz=\"< {} m/s\"", 0.5 * (speeds[0] + speeds[1]));
    let again = ["run", "grid.json", "-q", "--set", &limit];
    let said = folder.stdout(&again);
    let headline = "  answer   no point is safe; 2 within the uncertainty\n  assumed ";
    assert!(said.contains(headline), "{said}");
    assert!(said.contains("  mixed    mass_flow_rate=1 g/s: 0 of 2 safe, 1 unsafe\n"), "{said}");
    assert!(
        said.contains("mass_flow_rate=5 g/s: 0 of 2 safe, 1 unsafe\n  worst    peak_vz "),
        "{said}"
    );
    let reason =
        "peak_vz the same with each value: its peak comes before the inflow that this changes";
    assert!(said.contains(reason), "{said}");
    let answer = json_of(&folder, &again);
    let largest = speeds.iter().copied().fold(0.0, f64::max);
    assert_eq!(answer["worst"][0]["value"].as_f64(), Some(largest));
    assert_eq!(answer["comparisons"][0]["measures"][0]["measure"], "peak_vz");
    assert_eq!(answer["no_effect"][0]["parameter"], "mass_flow_rate");
    assert_eq!(answer["mixed"][1]["safe"], json!({ "met": 0, "of": 2 }), "the error is not known");
    assert_eq!(answer["mixed"][1]["not_safe"], 1);
}
