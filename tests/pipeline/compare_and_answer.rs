//! `compare`, and the answer at the end of a run.

use serde_json::{Value, json};

use crate::support::{TestFolder, grid, json_of, small_grid, stderr};

#[test]
fn compare_pairs_rows_that_differ_in_one_parameter_only() {
    let folder = TestFolder::finished(&grid(&json!({
        "N": [5, 6], "M": [2, 3], "alpha1_over_phi": [1],
        "mass_flow_rate": ["1 g/s", "2 g/s", "5 g/s"]
    })));
    let rows = folder.rows("results/grid");
    let by = ["compare", "--by", "mass_flow_rate", "--base", "1 g/s"];
    let pairs = json_of(&folder, &by);
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
            assert_eq!(pair["peak_vz_better"], "neither", "M 2 is infeasible at any flow");
        }
    }
    let summary = json_of(&folder, &[&by[..], &["--summary", "--measures", "peak_vz"]].concat());
    assert_eq!(summary.as_array().unwrap().len(), 2, "one row per value");
    assert_eq!(
        (&summary[0]["pairs"], &summary[0]["base_better"], &summary[0]["neither"]),
        (&json!(4), &json!(2), &json!(2))
    );
    let tied = json_of(
        &folder,
        &[&by[..], &["--summary", "--tie", "99%", "--measures", "peak_vz"]].concat(),
    );
    assert_eq!(tied[0]["ties"], 2);
    let one_sided = json_of(
        &folder,
        &["compare", "--by", "M", "--base", "2", "--summary", "--measures", "peak_vz"],
    );
    assert_eq!((&one_sided[0]["pairs"], &one_sided[0]["only_other"]), (&json!(6), &json!(6)));
    let few =
        json_of(&folder, &[&by[..], &["--where", "N == 6 and mass_flow_rate != '2 g/s'"]].concat());
    assert_eq!(few.as_array().unwrap().len(), 2);
    let said = folder.run(&by);
    assert!(stderr(&said).contains("base: mass_flow_rate = 1 g/s"), "{}", stderr(&said));

    for (arguments, expected) in [
        (["--by", "mass_flow_rate", "--base", "3 g/s"], "1 g/s, 2 g/s, 5 g/s"),
        (["--by", "mass_flow_rate", "--base", "1 m"], "1 g/s"),
        (["--by", "mass_flow_rat", "--base", "1"], "did you mean mass_flow_rate?"),
    ] {
        folder.refuses(&[&["compare"], &arguments[..]].concat(), expected);
    }
    for (flag, value, expected) in [
        ("--measures", "verdict", "holds no numbers"),
        ("--tie", "2", "at least 0 and less than 1"),
    ] {
        let output = folder.run(&[&by[..], &[flag, value]].concat());
        assert!(stderr(&output).contains(expected), "{}", stderr(&output));
    }
}

#[test]
fn a_job_shared_by_two_points_has_both_rows() {
    // Without residual gas, burst and stored are the same job.
    let folder = TestFolder::new(&grid(&json!({
        "N": [6], "M": [3], "alpha1_over_phi": [1], "mass_flow_rate": ["2 g/s"],
        "residual_gas_mass": [0, "0.05 g"], "residual_gas": ["burst", "stored"]
    })));
    let said = folder.stdout(&["run", "grid.json", "-q"]);
    assert!(said.contains("deployed 3 of 3 jobs"), "counted once: {said}");
    let rows = folder.rows("results/grid");
    assert_eq!(rows.len(), 4, "one row per point");
    assert_eq!(rows[0]["job"], rows[1]["job"]);
    assert_eq!(rows[0]["same_job_as"], "residual_gas=stored");
    assert_eq!(rows[1]["same_job_as"], "residual_gas=burst");
    assert!(rows[2]["same_job_as"].is_null());
    let found = folder.run(&["table", "--where", "residual_gas == 'stored'", "--columns", "job"]);
    assert_eq!(String::from_utf8_lossy(&found.stdout).lines().count(), 3, "both points are found");
    let short = &rows[0]["job"].as_str().unwrap()[..8];
    let all = folder.run(&["table", "--columns", "job"]);
    assert!(stderr(&all).contains("1 of these 4 rows are the same job as another (same_job_as)"));
    let drawn = ["chart", "--jobs", short, "--measure", "peak_vz", "--over", "residual_gas"];
    let chart = folder.stdout(&[&drawn[..], &["--out", "both.svg"]].concat());
    assert!(chart.contains("both.svg"));
    let svg = std::fs::read_to_string(folder.path().join("both.svg")).unwrap();
    assert!(svg.contains("2 points") && svg.contains("stored"), "both points are drawn");
    let histories = ["chart", "--history", "z_rim", "--jobs", short, "--out", "one.svg"];
    folder.stdout(&histories);
    let svg = std::fs::read_to_string(folder.path().join("one.svg")).unwrap();
    assert!(svg.contains("2 points are 1 job"), "one history per job");
    let pairs = json_of(&folder, &["compare", "--by", "residual_gas", "--base", "burst"]);
    assert_eq!(pairs.as_array().unwrap().len(), 2);
    assert_eq!(pairs[0]["base_job"], pairs[0]["other_job"]);
    assert_eq!(pairs[0]["peak_vz_better"], "same_job");
    let summary = [
        "compare",
        "--by",
        "residual_gas",
        "--base",
        "burst",
        "--summary",
        "--measures",
        "peak_vz",
    ];
    let summary = json_of(&folder, &summary);
    assert_eq!((&summary[0]["pairs"], &summary[0]["same_job"]), (&json!(1), &json!(1)));
}

/// A grid of strategies and masses, and a single point outside it; `shared/repro/safety.json` in small.
#[test]
fn a_point_outside_the_grid_leaves_every_parameter_in_the_summary() {
    let study = |points: Value| {
        let mut study = grid(&json!({
            "N": [6], "M": [3], "alpha1_over_phi": [1], "mass_flow_rate": ["5 g/s"],
            "strategy": ["rapid", "preinflate", "residual"],
            "residual_gas_mass": ["0.05 g", "0.1 g"], "points": points
        }));
        study["strategies"] = json!({
            "rapid": {"inflow": [{"from": "0.05 s", "to": "0.4 s"}]},
            "preinflate": {"preinflation_mass": "0.15 g", "inflow": [{"from": "0.25 s"}]},
            "residual": {"inflow": []}
        });
        study
    };
    let point = json!([{"N": 6, "M": 3, "alpha1_over_phi": 1, "strategy": "direct",
                        "mass_flow_rate": "5 g/s", "residual_gas_mass": 0}]);
    let run = |points: Value| {
        let folder = TestFolder::new(&study(points));
        let said = folder.stdout(&["run", "grid.json", "-q"]);
        (said, json_of(&folder, &["run", "grid.json", "-q"]), folder)
    };
    let (_, without, _) = run(json!([]));
    let (said, with, folder) = run(point);
    let effects = [&with, &without].map(|answer| answer["comparisons"].as_array().unwrap());
    assert_eq!(effects.map(Vec::len), [2, 2]);
    for (with, without) in effects[0].iter().zip(effects[1]) {
        assert_eq!(with["parameter"], without["parameter"]);
        assert_eq!(with["measures"], without["measures"], "{}", with["parameter"]);
        assert_eq!(with["values"], without["values"], "{}", with["parameter"]);
        assert_eq!(with["left_out"].as_array().unwrap().len(), 1);
    }
    assert!(said.contains(" strategy=direct: it is in 1 of 3 sets"), "{said}");
    assert!(said.contains("strategy: deployed rapid 2 of 2, "), "{said}");
    let mut medians = with["comparisons"].as_array().unwrap().iter();
    let strategy = medians.find(|compared| compared["parameter"] == "strategy").unwrap();
    let time = strategy["measures"].as_array().unwrap().iter();
    let mut time = time.filter(|measure| measure["measure"] == "t_90_z_rim_since_release");
    let time = time.next().unwrap();
    assert_eq!((&time["sets"], &time["best"]), (&json!(2), &json!("rapid")));
    let compared = ["compare", "grid.json", "--by", "strategy", "--base", "rapid"];
    let said = stderr(&folder.run(&compared));
    assert!(
        said.contains("tie: t_90_z_rim_since_release within 3 % (spread of the method)"),
        "{said}"
    );
    assert!(said.contains("1 row without a partner") && said.contains("strategy=direct"), "{said}");
    let changed = folder.run(&[&compared[..], &["--set", "solver.end_time=0.5"]].concat());
    let said = stderr(&changed);
    assert!(said.contains("solver.end_time 0.6 → 0.5"), "{said}");
}

#[test]
fn a_run_ends_with_the_answer_to_its_question() {
    let mut study = small_grid();
    study["question"] = json!("Do more panels help?");
    let folder = TestFolder::new(&study);
    let said = folder.stdout(&["run", "grid.json", "-q"]);
    assert!(said.lines().count() <= 32, "{said}");
    assert!(said.contains("\nDo more panels help?\n"), "{said}");
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
