//! The search of an optimum: against a closed form, deterministic, resumed, extended, with two measures, and its bad input.

use std::fs;

use serde_json::{Value, json};

use crate::support::{TestFolder, json_of, paper_design, stderr};

/// A piston that a tank of gas fills within a second: its pressure at the end falls with the flow, its speed rises.
fn study(budget: usize) -> Value {
    json!({
        "design": paper_design(2),
        "gas": {"heat_transfer": "isothermal"},
        "solver": {"model": "piston", "end_time": "1 s"},
        "limits": {"final_pressure": "> 500 Pa"},
        "optimise": {
            "minimise": "final_pressure",
            "over": {"mass_flow_rate": ["2 g/s", "8 g/s"], "film.temperature": ["280 K", "310 K"]},
            "budget": budget,
        },
    })
}

const RUN: [&str; 4] = ["run", "grid.json", "-q", "--no-report"];

/// Rows as job and hash, in plan order.
fn bits(rows: &[Value]) -> Vec<[Value; 2]> {
    rows.iter().map(|row| ["job", "content_hash"].map(|name| row[name].clone())).collect()
}

#[test]
fn the_optimum_of_a_piston_is_at_its_limit() {
    let folder = TestFolder::new(&study(24));
    let answer = json_of(&folder, &RUN);
    let found = &answer["optimum"];
    assert_eq!(
        (&found["points"], &found["minimise"]),
        (&json!([24, 24]), &json!(["final_pressure"]))
    );
    // p = ṁ (1 s) R T/V: the smallest value that keeps the limit is the limit.
    let best = &found["best"][0];
    let value = best["measures"][0]["value"].as_f64().unwrap();
    assert!(value > 500.0 && value < 503.0, "{best}");
    assert_eq!(best["limit"][0], "final_pressure");
    let rows = folder.rows("results/grid");
    assert_eq!(rows.len(), 24);
    let of_job = rows.iter().find(|row| row["job"] == best["job"]).unwrap();
    let [flow, temperature, volume] = ["mass_flow_rate", "temperature", "final_volume"]
        .map(|name| of_job[name].as_f64().unwrap());
    let exact = flow * 296.803_052 * temperature / volume;
    assert!((value / exact - 1.0).abs() < 0.01, "{value} {exact}");
    // As many points spread evenly come less near.
    let even = found["of_even_points"].as_f64().unwrap();
    assert!(even > 0.999 * value && even < 1.2 * value, "{even} {value}");
    // What was found after each generation never grows.
    let course = found["course"].as_array().unwrap();
    let after: Vec<f64> = course.iter().filter_map(|step| step[1][0].as_f64()).collect();
    assert!(after.len() > 2 && after.windows(2).all(|pair| pair[1] <= pair[0]), "{after:?}");
    assert_eq!(course.last().unwrap()[0], 24);
    let text = folder.stdout(&["run", "grid.json", "--no-report"]);
    for part in [
        "answer",
        "nearest limit final_pressure",
        "of 24 points spread evenly about",
        "this is point",
    ] {
        assert!(text.contains(part), "{part}: {text}");
    }
}

#[test]
fn threads_a_stop_and_a_larger_budget_change_no_point() {
    let whole = TestFolder::new(&study(20));
    whole.stdout(&[&RUN[..], &["--threads", "1"]].concat());
    let all = bits(&whole.rows("results/grid"));
    let folder = TestFolder::new(&study(12));
    folder.stdout(&[&RUN[..], &["--threads", "2"]].concat());
    assert_eq!(bits(&folder.rows("results/grid")), all[..12]);
    let more = ["--set", "optimise.budget=20", "--threads", "2"];
    let answer = json_of(&folder, &[&RUN[..], &more[..]].concat());
    assert_eq!((answer["ran"].as_u64(), answer["jobs"].as_u64()), (Some(8), Some(20)), "{answer}");
    assert_eq!(bits(&folder.rows("results/grid")), all);
    // Another seed tries others.
    let other = TestFolder::new(&study(12));
    other.stdout(&[&RUN[..], &["--set", "optimise.seed=2"]].concat());
    assert_ne!(bits(&other.rows("results/grid")), all[..12]);
}

#[test]
fn a_point_of_a_search_runs_with_other_settings_and_a_key_that_is_set_is_not_searched() {
    let folder = TestFolder::new(&study(12));
    folder.stdout(&RUN);
    let last = folder.rows("results/grid")[11].clone();
    let job = last["job"].as_str().unwrap();
    let again =
        ["run", "results/grid", "--again", job, "--set", "gas.heat_transfer=adiabatic", "-q"];
    let text = folder.stdout(&again);
    assert!(text.contains(&job[..8]), "{text}");
    let rows = folder.rows("results/grid-again");
    assert_eq!(rows.len(), 1, "{rows:?}");
    assert!(rows[0]["final_pressure"].as_f64() > last["final_pressure"].as_f64(), "{rows:?}");
    // One key is left to search; with both set the study is one point.
    let fixed = ["plan", "grid.json", "--set", "mass_flow_rate=5 g/s"];
    let said = stderr(&folder.run(&fixed));
    assert!(said.contains("replaces gas.mass_flow_rate in optimise.over"), "{said}");
    assert!(said.contains("first generation 8 points"), "{said}");
    let said = stderr(&folder.run(&[&fixed[..], &["--set", "film.temperature=300 K"]].concat()));
    assert!(said.contains("grid: 1 point: 1 job"), "{said}");
    // A list is another range. A key of a strategy is one too.
    let said = stderr(&folder.run(&["plan", "grid.json", "--set", "mass_flow_rate=[8, 2]"]));
    assert!(
        said.contains("optimise.over.mass_flow_rate") && said.contains("does not begin below"),
        "{said}"
    );
    let range = ["plan", "grid.json", "--set", "optimise.over.film.temperature=[300, 301]"];
    assert!(folder.stdout(&range).contains("300."), "the new range");
    let over = json!({"strategies.ramp.inflow[0].from": ["0.1 s", "0.2 s"], "mass_flow_rate": ["2 g/s", "8 g/s"]});
    let optimise = json!({"minimise": "peak_vz", "budget": 8, "over": over});
    let folder = TestFolder::new(&with(&optimise, &json!({})));
    let set = ["plan", "grid.json", "--set", "strategies.ramp.inflow[0].from=0.15 s"];
    let said = stderr(&folder.run(&set));
    assert!(said.contains("replaces strategies.ramp.inflow[0].from in optimise.over"), "{said}");
    let list =
        ["plan", "grid.json", "--set", "strategies.ramp.inflow[0].from=[\"0.2 s\", \"0.1 s\"]"];
    let said = stderr(&folder.run(&list));
    assert!(said.contains("does not begin below"), "{said}");
}

#[test]
fn a_search_has_a_prior_where_the_cheap_model_can_compute_its_points() {
    let mut study = study(12);
    study["solver"] = json!({"end_time": "0.1 s"});
    let said = |study: &Value| stderr(&TestFolder::new(study).run(&["plan", "grid.json"]));
    let film = said(&study);
    assert!(
        film.contains("prior: the model of storeys") && film.contains("first generation 4 points"),
        "{film}"
    );
    study["supports"] = json!([{"on": "top_ring", "fix": "z"}]);
    let held = said(&study);
    assert!(!held.contains("prior: ") && held.contains("first generation 8 points"), "{held}");
}

#[test]
fn two_measures_have_a_front_and_failed_points_are_rows() {
    let mut study = study(24);
    // One storey has no fold pattern here.
    study["optimise"] = json!({
        "minimise": ["peak_vz", "t_90_z_rim"],
        "over": {"mass_flow_rate": ["1 g/s", "20 g/s"], "M": [1, 3], "chirality": ["same", "alternate"]},
        "budget": 24, "batch": 8,
    });
    study["limits"] = json!({"t_90_z_rim": "< 0.9 s"});
    let folder = TestFolder::new(&study);
    let answer = json_of(&folder, &RUN);
    let best = answer["optimum"]["best"].as_array().unwrap();
    assert!(best.len() > 4, "{best:?}");
    let values = |k: usize| -> Vec<f64> {
        best.iter().map(|one| one["measures"][k]["value"].as_f64().unwrap()).collect()
    };
    assert!(values(0).windows(2).all(|pair| pair[0] < pair[1]), "{:?}", values(0));
    assert!(values(1).windows(2).all(|pair| pair[0] > pair[1]), "{:?}", values(1));
    let rows = folder.rows("results/grid");
    let infeasible = rows.iter().filter(|row| row["status"] == "infeasible").count();
    assert!(
        rows.len() == 24 && infeasible > 0 && infeasible < 12,
        "{infeasible} of {}",
        rows.len()
    );
    let text = folder.stdout(&["run", "grid.json", "--no-report"]);
    assert!(text.contains("the front between peak_vz and t_90_z_rim"), "{text}");
    let charts = folder.stdout(&["chart", "grid.json", "-q"]);
    assert!(charts.contains("search.svg"), "{charts}");
}

/// A piston study with this search.
fn with(optimise: &Value, limits: &Value) -> Value {
    let mut study = study(8);
    study["optimise"] = optimise.clone();
    study["limits"] = limits.clone();
    study["strategies"] = json!({
        "ramp": {"inflow": [{"from": "0.1 s", "to": "0.5 s", "mass_flow_rate": "5 g/s"}]},
        "late": {"inflow": [{"from": "0.5 s", "mass_flow_rate": "1 g/s"}]},
    });
    study["strategy"] = json!("ramp");
    study
}

#[test]
fn a_limit_that_is_met_exactly_is_kept() {
    let optimise =
        json!({"minimise": "peak_vz", "over": {"mass_flow_rate": ["2 g/s", "8 g/s"]}, "budget": 8});
    let folder = TestFolder::new(&with(&optimise, &json!({"final_pressure": ">= 0 Pa"})));
    let answer = json_of(&folder, &RUN);
    assert_eq!(answer["optimum"]["best"][0]["keeps_limits"], true, "{}", answer["optimum"]);
}

#[test]
fn what_changes_no_job_and_what_the_study_refuses_uses_no_budget() {
    // Preinflation of `ramp` changes nothing in `late`.
    let optimise = json!({
        "minimise": "peak_vz", "budget": 24,
        "over": {"strategies.ramp.preinflation_mass": ["0 g", "0.3 g"], "strategy": ["ramp", "late"]},
    });
    let folder = TestFolder::new(&with(&optimise, &json!({})));
    let answer = json_of(&folder, &RUN);
    let jobs: std::collections::BTreeSet<String> = folder
        .rows("results/grid")
        .iter()
        .map(|row| row["job"].as_str().unwrap().to_owned())
        .collect();
    assert_eq!(answer["optimum"]["points"], json!([24, 24]), "{}", answer["optimum"]);
    assert_eq!(jobs.len(), 24);
    // A window that ends before it begins is refused: where the search wants to go, in one corner.
    let optimise = json!({
        "minimise": "peak_vz", "budget": 20,
        "over": {
            "strategies.ramp.inflow[0].from": ["0.1 s", "0.5 s"],
            "strategies.ramp.inflow[0].to": ["0.45 s", "1 s"],
        },
    });
    let folder = TestFolder::new(&with(&optimise, &json!({})));
    let answer = json_of(&folder, &RUN);
    assert_eq!(answer["optimum"]["points"], json!([20, 20]), "{}", answer["optimum"]);
    // Four designs are all that there are.
    let optimise = json!({"minimise": "peak_vz", "over": {"N": [5, 8]}, "budget": 40});
    let folder = TestFolder::new(&with(&optimise, &json!({})));
    let text = folder.stdout(&["run", "grid.json", "--no-report"]);
    assert!(
        text.contains("4 points tried of 40: all others are refused, or are the same jobs"),
        "{text}"
    );
}

#[test]
fn the_best_point_is_one_that_keeps_its_limits_on_the_finest_mesh() {
    let mut study = study(8);
    study["solver"] = json!({"model": "film", "end_time": "0.2 s"});
    study["limits"] = json!({"peak_vz": "> 29 m/s"});
    study["optimise"] = json!({"minimise": "peak_vz", "over": {"mass_flow_rate": ["2 g/s", "20 g/s"]}, "budget": 8});
    let folder = TestFolder::new(&study);
    let found = json_of(&folder, &RUN)["optimum"].clone();
    let refuted = found["refuted"].as_array().unwrap();
    assert!(!refuted.is_empty(), "{found}");
    let best = &found["best"][0];
    for (point, keeps) in refuted.iter().map(|one| (one, false)).chain([(best, true)]) {
        assert_eq!((&point["confirmed_on"], &point["keeps_limits"]), (&json!(4), &json!(keeps)));
    }
    // It stands for its run on the finest mesh.
    let rows: Vec<Value> =
        serde_json::from_str(&folder.stdout(&["table", "grid.json", "--runs", "--json"])).unwrap();
    let of_best = |row: &&Value| row["mass_flow_rate"] == best["parameters"]["mass_flow_rate"];
    let finest = rows.iter().filter(of_best).find(|row| row["subdivisions"] == 4).unwrap();
    assert_eq!(best["measures"][0]["stands_for"][0], finest["peak_vz_extrapolated"], "{best}");
    let value = |point: &Value| point["measures"][0]["value"].as_f64().unwrap();
    assert!(refuted.iter().all(|one| value(one) < value(best)), "{found}");
    let text = folder.stdout(&["run", "grid.json", "--no-report"]);
    assert!(text.contains("better, but not on the finest mesh"), "{text}");
    // Four points, then those that the model of storeys points at.
    let plan = stderr(&folder.run(&["plan", "grid.json"]));
    assert!(plan.contains("the model of storeys, less than a second a run"), "{plan}");
    // What was proposed is a memo: without it, or with a damaged one, the same points are found.
    let memo = folder.results().join("proposed.json");
    let all = bits(&folder.rows("results/grid"));
    let kept = fs::read(&memo).unwrap();
    fs::write(&memo, &kept[..kept.len() / 2]).unwrap();
    assert_eq!(bits(&folder.rows("results/grid")), all);
    fs::remove_file(&memo).unwrap();
    assert_eq!(bits(&folder.rows("results/grid")), all);
    folder.stdout(&RUN);
    assert_eq!(fs::read(&memo).unwrap(), kept);
    assert!(folder.stdout(&["doctor", "grid.json"]).contains("no faults"));
}
