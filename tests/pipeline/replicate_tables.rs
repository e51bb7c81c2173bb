//! `table` and `compare` of a study with replicates and limits.

use serde_json::{Value, json};

use crate::support::{TestFolder, grid, json_of};

/// Two strategies at three rates, four thicknesses each; faster than 0.8 m/s is not safe.
fn ran(limits: &Value) -> TestFolder {
    let mut study = grid(&json!({
        "strategy": ["rapid", "late"], "mass_flow_rate": ["1 g/s", "2 g/s", "5 g/s"]
    }));
    study["design"]["N"] = json!(6);
    study["design"]["M"] = json!(3);
    study["design"]["alpha1_over_phi"] = json!(1);
    study["strategies"] = json!({
        "rapid": {"inflow": [{"from": 0, "to": "0.4 s"}]},
        "late": {"release_time": "20 ms", "inflow": [{"from": "50 ms", "to": "0.4 s"}]}
    });
    study["replicates"] = json!({"film.thickness": ["25 um", "26 um", "27 um", "28 um"]});
    study["limits"] = limits.clone();
    TestFolder::finished(&study)
}

fn numbers(rows: &[&Value], column: &str) -> Vec<f64> {
    let mut numbers: Vec<f64> = rows.iter().filter_map(|row| row[column].as_f64()).collect();
    numbers.sort_by(f64::total_cmp);
    numbers
}

#[test]
fn a_table_has_one_row_per_point_and_runs_on_request() {
    let folder = ran(&json!({"peak_vz": "< 10 m/s"}));
    let points = folder.points("results/grid");
    let runs = json_of(&folder, &["table", "--runs"]);
    let runs = runs.as_array().unwrap();
    assert_eq!((points.len(), runs.len()), (6, 24));
    for point in &points {
        assert!(point.get("thickness").is_none() && point.get("job").is_none());
        let same = |run: &&Value| {
            ["strategy", "mass_flow_rate"].iter().all(|name| run[*name] == point[*name])
        };
        let of_point: Vec<&Value> = runs.iter().filter(same).collect();
        assert_eq!((of_point.len(), &point["runs"]), (4, &json!(4)));
        let speeds = numbers(&of_point, "peak_vz");
        assert_eq!(point["peak_vz_least"].as_f64(), Some(speeds[0]));
        assert_eq!(point["peak_vz_largest"].as_f64(), Some(speeds[3]));
        let median = 0.5 * speeds[1] + 0.5 * speeds[2];
        assert_eq!(point["peak_vz"].as_f64(), Some(median));
        // The error of the piston is not known: no run is safe for certain.
        let missed = of_point.iter().filter(|run| run["safety"] == "unsafe").count();
        let safety = if missed == 4 { "unsafe" } else { "uncertain" };
        assert_eq!((&point["safe"], &point["safe_of"]), (&json!(0), &json!(4)));
        assert_eq!(point["safety"], safety);
        let margins = numbers(&of_point, "smallest_margin");
        assert_eq!(point["smallest_margin"].as_f64(), Some(margins[0]));
    }
    let count =
        |more: &[&str]| json_of(&folder, &[&["table"], more].concat()).as_array().unwrap().len();
    let safe = ["--where", "safety != 'unsafe' and smallest_margin > 0.1"];
    let expected = points.iter().filter(|point| {
        point["safety"] != "unsafe" && point["smallest_margin"].as_f64().unwrap() > 0.1
    });
    assert_eq!(count(&safe), expected.count());
    assert_eq!(count(&["--where", "film.thickness < '26.5 um'"]), 6);
    assert_eq!(count(&["--runs", "--where", "thickness < '26.5 um'"]), 12);
    let few = json_of(&folder, &["table", "--where", "thickness < '26.5 um'"]);
    assert_eq!(few[0]["runs"], 2);

    let table = folder.stdout(&["table"]);
    assert_eq!(table.lines().count(), 8, "two lines of header, one row per point: {table}");
    let header: Vec<&str> = table.lines().next().unwrap().split_whitespace().collect();
    for name in ["strategy", "runs", "safety", "safe", "smallest_margin", "peak_vz"] {
        assert!(header.contains(&name), "{name}: {header:?}");
    }
    assert!(
        !header.contains(&"job") && table.contains(" of 4 (") && table.contains(" ["),
        "{table}"
    );
    folder.refuses(&["table", "--columns", "job"], "--runs");
}

#[test]
fn compare_pairs_points_by_their_medians() {
    let folder = ran(&json!({"peak_vz": "< 10 m/s"}));
    let by = ["compare", "--by", "strategy", "--base", "rapid"];
    let points = folder.points("results/grid");
    let pairs = json_of(&folder, &by);
    let pairs = pairs.as_array().unwrap();
    assert_eq!(pairs.len(), 3);
    for pair in pairs {
        let point = |strategy: &str| {
            let same = |point: &&Value| {
                point["strategy"] == strategy && point["mass_flow_rate"] == pair["mass_flow_rate"]
            };
            points.iter().find(same).unwrap()
        };
        let (base, other) = (point("rapid"), point("late"));
        for (figure, point) in [("base", base), ("other", other)] {
            for end in ["", "_least", "_largest"] {
                let name = format!("peak_vz{end}");
                assert_eq!(pair[format!("peak_vz_{figure}{end}")], point[&name], "{name}");
            }
            assert_eq!(pair[format!("{figure}_deployed_of")], point["deployed_of"]);
        }
        let ratio = other["peak_vz"].as_f64().unwrap() / base["peak_vz"].as_f64().unwrap();
        assert_eq!(pair["peak_vz_ratio"].as_f64(), Some(ratio));
        assert!(pair.get("smallest_margin_better").is_some(), "a limit is a measure");
    }
    let single = json_of(&folder, &[&by[..], &["--runs"]].concat());
    assert_eq!(single.as_array().unwrap().len(), 12);
    let replicate = json_of(&folder, &["compare", "--by", "thickness", "--base", "25 um"]);
    assert_eq!(replicate.as_array().unwrap().len(), 18, "single runs");
}

#[test]
fn limits_alone_add_what_is_safe_to_the_table() {
    let mut study = grid(&json!({"N": [5, 6], "mass_flow_rate": ["1 g/s", "5 g/s"]}));
    study["design"]["M"] = json!(3);
    study["design"]["alpha1_over_phi"] = json!(1);
    study["limits"] = json!({"peak_vz": "< 10 m/s"});
    let folder = TestFolder::finished(&study);
    let table = folder.stdout(&["table"]);
    let header: Vec<&str> = table.lines().next().unwrap().split_whitespace().collect();
    let at = |name: &str| header.iter().position(|word| *word == name).unwrap();
    assert!(at("status") < at("safety") && at("safety") + 1 == at("smallest_margin"), "{header:?}");
    assert!(at("smallest_margin") + 1 == at("smallest_margin_of"), "{header:?}");
    assert!(at("smallest_margin_of") + 1 == at("peak_vz"), "what has a limit is shown: {header:?}");
    assert!(!header.contains(&"runs"), "{header:?}");
    let text = folder.stdout(&["compare", "--by", "N", "--base", "5"]);
    assert!(text.contains("smallest_margin_better"), "{text}");
}
