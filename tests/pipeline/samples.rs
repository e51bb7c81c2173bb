//! Samples of inputs: paired over the grid, extended, resumed, and an answer that is known.

use serde_json::{Value, json};

use crate::support::{TestFolder, json_of, paper_design, stderr};

/// A piston that is full at the end: its pressure is m R T/V with m from the mass flow rate.
fn study(number: usize) -> Value {
    json!({
        "design": paper_design(2),
        "gas": {"heat_transfer": "isothermal"},
        "solver": {"model": "piston", "end_time": "1 s"},
        "limits": {"final_pressure": "< 850 Pa"},
        "grid": {"residual_gas_mass": [0, "0.5 g"]},
        "samples": {"number": number, "of": {
            "mass_flow_rate": {"uniform": ["4 g/s", "6 g/s"]},
            "film.temperature": {"normal": ["293 K", "2 %"]},
        }},
    })
}

fn close(found: &Value, exact: f64, tolerance: f64) {
    let found = found.as_f64().unwrap();
    assert!((found / exact - 1.0).abs() < tolerance, "{found} instead of {exact}");
}

#[test]
fn the_tolerances_of_a_piston_are_those_of_its_closed_form() {
    let folder = TestFolder::new(&study(256));
    let answer = json_of(&folder, &["run", "grid.json", "-q", "--no-report"]);
    let points = answer["tolerances"].as_array().unwrap();
    assert_eq!(points.len(), 2);
    let rows = folder.rows("results/grid");
    // Every point has the same samples.
    let samples = |mass: f64| -> Vec<[f64; 2]> {
        let of_mass = |row: &&Value| row["residual_gas_mass"].as_f64() == Some(mass);
        let input =
            |row: &Value| ["mass_flow_rate", "temperature"].map(|name| row[name].as_f64().unwrap());
        rows.iter().filter(of_mass).map(input).collect()
    };
    assert_eq!((samples(0.0).len(), samples(0.0) == samples(0.0005)), (256, true));
    let volume = rows[0]["final_volume"].as_f64().unwrap();
    let point = &points[0];
    let spread = &point["measures"][0];
    assert_eq!(spread["measure"], "final_pressure");
    // p = ṁ (1 s) R T/V: the median at 5 g/s and 293 K; the variances of the two relative inputs add.
    let median = 0.005 * 296.803_052 * 293.0 / volume;
    close(&spread["quantiles"][1]["value"], median, 0.02);
    let between = &spread["quantiles"][1]["between"];
    assert!(between[0].as_f64().unwrap() < median && median < between[1].as_f64().unwrap());
    close(&spread["quantiles"][0]["value"], median * 0.82, 0.02);
    let (flow, temperature) = (0.4 / 12.0_f64.sqrt(), 0.02_f64);
    close(&spread["deviation"], median * flow.hypot(temperature), 0.03);
    let part = |name: &str| {
        let parts = spread["inputs"]["parts"].as_array().unwrap();
        parts.iter().find(|part| part["name"] == name).unwrap().clone()
    };
    close(
        &part("mass_flow_rate")["part"],
        flow * flow / (flow * flow + temperature * temperature),
        0.02,
    );
    // Nothing else makes it, and a surrogate foresees all of it.
    assert_eq!(spread["inputs"]["indices"], true);
    assert!(spread["inputs"]["seen"].as_f64().unwrap() > 0.999, "{}", spread["inputs"]);
    let total = part("temperature")["total"][0].as_f64().unwrap();
    close(&part("temperature")["part"], total, 0.1);
    // The mesh error of a piston is not known: no sample counts as safe, and the interval says what is possible.
    let unsafe_runs = point["not_safe"].as_f64().unwrap();
    assert_eq!(
        (point["safe"]["met"].as_u64(), point["safe_between"][0].as_f64()),
        (Some(0), Some(0.0))
    );
    // P(p > 850 Pa) for a uniform flow rate.
    let bound = 850.0 / median;
    let exact = ((1.2 - bound) / 0.4).clamp(0.0, 1.0);
    assert!((unsafe_runs / 256.0 - exact).abs() < 0.03, "{unsafe_runs} of 256, {exact}");
    assert!(point["safe_between"][1].as_f64().unwrap() > 1.0 - unsafe_runs / 256.0);
}

#[test]
fn more_samples_keep_the_finished_ones_and_threads_change_no_bit() {
    let folder = TestFolder::new(&study(16));
    folder.stdout(&["run", "grid.json", "-q", "--no-report", "--threads", "1"]);
    let before = folder.rows("results/grid");
    let run = ["run", "grid.json", "-q", "--no-report", "--set", "samples.number=32"];
    let answer = json_of(&folder, &run);
    assert_eq!((answer["ran"].as_u64(), answer["jobs"].as_u64()), (Some(32), Some(64)), "{answer}");
    let after = folder.rows("results/grid");
    for row in &before {
        let same = after.iter().find(|other| other["job"] == row["job"]).unwrap();
        assert_eq!(same["content_hash"], row["content_hash"]);
    }
    let other = TestFolder::new(&study(32));
    other.stdout(&["run", "grid.json", "-q", "--no-report", "--threads", "2"]);
    let bits = |rows: &[Value]| -> Vec<[Value; 2]> {
        rows.iter().map(|row| ["job", "content_hash"].map(|name| row[name].clone())).collect()
    };
    assert_eq!(bits(&other.rows("results/grid")), bits(&after));
    // A Latin hypercube has half of its samples in each half; one storey has no fold pattern, and a row.
    let samples = json!({"number": 8, "method": "latin_hypercube", "of": {
        "M": {"values": [1, 3]}, "height": {"uniform": ["0.9 m", "1.1 m"]},
    }});
    folder.stdout(&[
        "run",
        "grid.json",
        "-q",
        "--no-report",
        "--set",
        &format!("samples={samples}"),
        "--set",
        "gas.mass_flow_rate=0.005",
    ]);
    let rows = folder.rows("results/grid");
    let infeasible = rows.iter().filter(|row| row["status"] == "infeasible");
    assert_eq!((rows.len(), infeasible.count()), (16, 8));
}

#[test]
fn a_key_that_is_set_is_not_sampled_and_a_sample_runs_with_other_settings() {
    let mut study = study(8);
    study["samples"]["correlations"] = json!([["mass_flow_rate", "film.temperature", 0.5]]);
    let folder = TestFolder::new(&study);
    folder.stdout(&["run", "grid.json", "-q", "--no-report"]);
    let row = folder.rows("results/grid")[3].clone();
    let again = ["run", "results/grid", "--again", row["job"].as_str().unwrap(), "-q"];
    folder.stdout(&[&again[..], &["--set", "mass_flow_rate=8 g/s"]].concat());
    let rows = folder.rows("results/grid-again");
    let ran = rows.iter().find(|row| row["status"] == "done").unwrap();
    // Its temperature is that of the sample; the gas is at that of the film.
    assert_eq!(ran["final_temperature"], row["temperature"]);
    let ratio = ran["final_pressure"].as_f64().unwrap() / row["final_pressure"].as_f64().unwrap();
    close(&json!(ratio), 0.008 / row["mass_flow_rate"].as_f64().unwrap(), 0.02);
    let said = stderr(&folder.run(&["plan", "grid.json", "--set", "mass_flow_rate=5 g/s"]));
    assert!(said.contains("replaces gas.mass_flow_rate in samples.of"), "{said}");
    let said = stderr(&folder.run(&["plan", "grid.json"]));
    assert!(said.contains("8 samples of 2 inputs") && said.contains("at least 10"), "{said}");
}

#[test]
fn what_is_assumed_has_a_distribution() {
    let jobs = |of: &Value, ranges: &Value| -> Vec<Value> {
        let mut study = study(8);
        study["assumed"] = ranges.clone();
        study["samples"]["of"] = json!({
            "mass_flow_rate": {"uniform": ["4 g/s", "6 g/s"]},
            "gas.heat_transfer": of["heat"], "film.loss_factor": of["loss"], "contact.friction": of["friction"],
        });
        study["solver"] = json!({"end_time": "1 ms"});
        let folder = TestFolder::new(&study);
        folder.stdout(&["run", "grid.json", "-q", "--no-report"]);
        folder.rows("results/grid").iter().map(|row| row["job"].clone()).collect()
    };
    let assumed = json!({"assumed": true});
    let given = json!({
        "heat": {"log_uniform": [0.1, 1]}, "loss": {"log_uniform": [0.003, 0.03]}, "friction": {"uniform": [0, 0.48]},
    });
    let all_assumed = json!({"heat": assumed, "loss": assumed, "friction": assumed});
    let all = jobs(&all_assumed, &json!({}));
    assert_eq!((jobs(&given, &json!({})), all.len()), (all, 16));
    // The study's section says what it assumes.
    let mut narrow = given.clone();
    narrow["loss"] = json!({"log_uniform": [0.01, 0.02]});
    let ranges = json!({"loss_factor": [0.01, 0.02]});
    assert_eq!(jobs(&all_assumed, &ranges), jobs(&narrow, &json!({})));
}
