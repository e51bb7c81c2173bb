//! What the results say: `compare`, and the answer of a run.

use serde_json::{Value, json};

use crate::support::{Desk, grid, json_of, small_grid, stderr};

#[test]
fn compare_pairs_rows_that_are_equal_in_all_else() {
    let desk = Desk::new(&grid(&json!({
        "N": [5, 6], "M": [2, 3], "alpha1_over_phi": [1],
        "mass_flow_rate": ["1 g/s", "2 g/s", "5 g/s"]
    })));
    desk.stdout(&["run", "grid.json", "-q"]);
    let rows = desk.rows("results/grid");
    let by = ["compare", "--by", "mass_flow_rate", "--base", "1 g/s"];
    let pairs = json_of(&desk, &by);
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
        if let (Some(base), Some(other)) = (base["peak_vz"].as_f64(), other["peak_vz"].as_f64()) {
            assert_eq!(pair["peak_vz_ratio"].as_f64(), Some(other / base));
            assert_eq!(pair["peak_vz_difference"].as_f64(), Some(other - base));
            let better = if base < other { "base" } else { "other" };
            assert_eq!(pair["peak_vz_better"], better);
        } else {
            assert_eq!(pair["peak_vz_better"], "neither", "M 2 has no pattern, whatever flows");
        }
    }
    let summary = json_of(&desk, &[&by[..], &["--summary", "--measures", "peak_vz"]].concat());
    assert_eq!(summary.as_array().unwrap().len(), 2, "one a value");
    assert_eq!(
        (&summary[0]["pairs"], &summary[0]["base_better"], &summary[0]["neither"]),
        (&json!(4), &json!(2), &json!(2))
    );
    let tied = json_of(
        &desk,
        &[&by[..], &["--summary", "--tie", "99%", "--measures", "peak_vz"]].concat(),
    );
    assert_eq!(tied[0]["ties"], 2);
    let one_sided = json_of(
        &desk,
        &["compare", "--by", "M", "--base", "2", "--summary", "--measures", "peak_vz"],
    );
    assert_eq!((&one_sided[0]["pairs"], &one_sided[0]["only_other"]), (&json!(6), &json!(6)));
    let few =
        json_of(&desk, &[&by[..], &["--where", "N == 6 and mass_flow_rate != '2 g/s'"]].concat());
    assert_eq!(few.as_array().unwrap().len(), 2);
    let said = desk.run(&by);
    assert!(stderr(&said).contains("base: mass_flow_rate = 0.001 kg/s"), "{}", stderr(&said));

    for (arguments, expected) in [
        (["--by", "mass_flow_rate", "--base", "3 g/s"], "0.001 kg/s, 0.002 kg/s, 0.005 kg/s"),
        (["--by", "mass_flow_rate", "--base", "1 m"], "0.001 kg/s"),
        (["--by", "mass_flow_rat", "--base", "1"], "did you mean mass_flow_rate?"),
    ] {
        let output = desk.run(&[&["compare"], &arguments[..]].concat());
        assert_eq!(output.status.code(), Some(2));
        assert!(stderr(&output).contains(expected), "{}", stderr(&output));
    }
    for (flag, value, expected) in [
        ("--measures", "verdict", "holds no numbers"),
        ("--tie", "2", "at least 0 and less than 1"),
    ] {
        let output = desk.run(&[&by[..], &[flag, value]].concat());
        assert!(stderr(&output).contains(expected), "{}", stderr(&output));
    }
}

#[test]
fn what_is_one_job_is_compared_in_every_place_it_stands_for() {
    // Without residual gas, burst and stored are the same job.
    let desk = Desk::new(&grid(&json!({
        "N": [6], "M": [3], "alpha1_over_phi": [1], "mass_flow_rate": ["2 g/s"],
        "residual_gas_mass": [0, "0.05 g"], "residual_gas": ["burst", "stored"]
    })));
    desk.stdout(&["run", "grid.json", "-q"]);
    assert_eq!(desk.rows("results/grid").len(), 3);
    let pairs = json_of(&desk, &["compare", "--by", "residual_gas", "--base", "burst"]);
    assert_eq!(pairs.as_array().unwrap().len(), 2);
    assert_eq!(pairs[0]["base_job"], pairs[0]["other_job"]);
    assert_eq!(pairs[0]["peak_vz_better"], "tie");
}

#[test]
fn a_run_ends_with_the_answer_to_its_question() {
    let mut study = small_grid();
    study["question"] = json!("Do more panels help?");
    let desk = Desk::new(&study);
    let said = desk.stdout(&["run", "grid.json", "-q"]);
    assert!(said.lines().count() <= 25, "{said}");
    assert!(said.contains("\nDo more panels help?\n"), "{said}");
    assert!(said.contains("  deployed 16 of 16 jobs"), "{said}");
    assert!(said.contains("not counted by this model"), "{said}");
    assert!(said.contains("billow compare results/grid --by residual_gas_mass --base 0"), "{said}");

    let answer = json_of(&desk, &["run", "grid.json", "-q"]);
    let rows = desk.rows("results/grid");
    let of = |name: &str| rows.iter().filter_map(|row| row[name].as_f64()).collect::<Vec<_>>();
    let largest = of("peak_vz").into_iter().fold(0.0, f64::max);
    let least = of("t_90_z_rim").into_iter().fold(f64::INFINITY, f64::min);
    assert_eq!(answer["hardest"]["peak_vz"].as_f64(), Some(largest));
    assert_eq!(answer["fastest"]["t_90_z_rim"].as_f64(), Some(least));
    let job = rows.iter().find(|row| row["job"] == answer["fastest"]["job"]).unwrap();
    assert_eq!(answer["fastest"]["parameters"]["alpha1_over_phi"], job["alpha1_over_phi"]);
    let residual = of("ledger_residual").into_iter().fold(0.0, f64::max);
    assert_eq!(answer["trust"]["ledger_residual"].as_f64(), Some(residual));
    assert!(answer["trust"]["passages"].is_null());

    // N: every M and ratio that has a pattern at 5 has one at 6. Medians by hand.
    let medians = answer["medians"].as_array().unwrap();
    let panels = medians.iter().find(|own| own["parameter"] == "N").unwrap();
    assert_eq!(panels["sets"], 8);
    for value in panels["values"].as_array().unwrap() {
        let mut own: Vec<f64> = rows
            .iter()
            .filter(|row| row["N"] == value["value"])
            .filter_map(|row| row["peak_vz"].as_f64())
            .collect();
        own.sort_by(f64::total_cmp);
        assert_eq!(value["peak_vz"].as_f64(), Some(0.5 * own[3] + 0.5 * own[4]));
    }
}
