//! `billow chart` on a finished study: every kind, as SVG and PNG.

use std::fs;

use serde_json::json;

use crate::support::{TestFolder, grid};

/// N × ratio × flow × end time with the piston: infeasible points, and runs that end before deployment.
fn study() -> serde_json::Value {
    let mut study = grid(&json!({
        "N": [5, 6],
        "alpha1_over_phi": [1, 9.0],
        "mass_flow_rate": ["1 g/s", "5 g/s"],
        "solver.end_time": ["20 ms", "0.4 s"]
    }));
    study["design"]["M"] = json!(2);
    study
}

/// The texts of an SVG, which must be well formed.
fn texts(svg: &[u8]) -> Vec<String> {
    let svg = std::str::from_utf8(svg).unwrap();
    let parsed = resvg::usvg::roxmltree::Document::parse(svg).unwrap();
    assert_eq!(parsed.root_element().tag_name().name(), "svg");
    let texts = parsed.descendants().filter(|node| node.has_tag_name("text"));
    texts.map(|node| node.text().unwrap_or("").to_owned()).collect()
}

/// Width and height of a PNG, from its header.
fn size(png: &[u8]) -> [u32; 2] {
    assert_eq!(&png[..8], b"\x89PNG\r\n\x1a\n");
    assert_eq!(&png[12..16], b"IHDR");
    [16, 20].map(|at| u32::from_be_bytes(png[at..at + 4].try_into().unwrap()))
}

#[test]
fn every_kind_is_drawn_as_svg_and_png() {
    let folder = TestFolder::finished(&study());
    let feasible = "alpha1_over_phi == 9";
    for (arguments, name, expected) in [
        (
            &["--history", "z_rim,pressure", "--where", feasible, "--to", "50 ms"][..],
            "history-z_rim-pressure",
            &[
                "Time t (ms)",
                "Mean height of the top ring, gas pressure over time",
                "5 g/s",
                "End time 400 ms",
            ][..],
        ),
        (
            &["--measure", "peak_vz", "--over", "mass_flow_rate"],
            "peak_vz-over-mass_flow_rate",
            &["Mass flow rate (g/s)", "infeasible (8)", "∅", "no value"],
        ),
        (
            &["--measure", "peak_vz", "--over", "mass_flow_rate", "--by", "N", "--where", feasible],
            "peak_vz-over-mass_flow_rate-by-N",
            &["End time 20 ms", "End time 400 ms"],
        ),
        (
            &["--measure", "peak_vz", "--map", "mass_flow_rate,N"],
            "peak_vz-map-mass_flow_rate-N",
            &["Mass flow rate (g/s)", "Number of panels N", "infeasible (8)"],
        ),
    ] {
        let printed = folder.stdout(&[&["chart"], arguments].concat());
        let paths: Vec<&str> = printed.lines().collect();
        let charts = "results/grid/charts";
        assert_eq!(paths, [format!("{charts}/{name}.svg"), format!("{charts}/{name}.png")]);
        let shown = texts(&fs::read(folder.path().join(paths[0])).unwrap());
        for text in expected {
            let there = |shown: &String| shown == text;
            assert!(shown.iter().any(there), "{name}: {text}: {shown:?}");
        }
        let png = fs::read(folder.path().join(paths[1])).unwrap();
        let [width, height] = size(&png);
        assert!(width == 1920 && height > 600, "{width} {height}");
        assert!(png.len() > 20_000, "{name}: {} bytes is a blank page", png.len());
    }
}

#[test]
fn the_default_set_is_drawn_with_reproducible_bytes() {
    let mut study = study();
    study["grid"].as_object_mut().unwrap().remove("solver.end_time");
    let folder = TestFolder::finished(&study);
    let read = || -> Vec<(String, Vec<u8>)> {
        let printed = folder.stdout(&["chart", "grid.json", "--json"]);
        let rows: serde_json::Value = serde_json::from_str(&printed).unwrap();
        let files = rows.as_array().unwrap().iter();
        let names = files.map(|row| row["file"].as_str().unwrap().to_owned());
        names.map(|name| (name.clone(), fs::read(folder.path().join(name)).unwrap())).collect()
    };
    let drawn = read();
    let names: Vec<&str> = drawn.iter().map(|(name, _)| name.as_str()).collect();
    for stem in [
        "history-z_rim",
        "history-vz",
        "history-pressure",
        "t_90_z_rim-over-mass_flow_rate",
        "peak_vz-over-mass_flow_rate",
    ] {
        for ending in ["svg", "png"] {
            let path = format!("results/grid/charts/{stem}.{ending}");
            assert!(names.contains(&path.as_str()), "{path}: {names:?}");
        }
    }
    assert!(names.iter().any(|name| name.contains("-map-mass_flow_rate-")), "{names:?}");
    assert!(drawn == read());
    // Charts in a results folder do not prevent another run.
    folder.stdout(&["run", "grid.json", "-q"]);
}

#[test]
fn jobs_are_selected_by_id_prefix_and_formats_by_file_extension() {
    let folder = TestFolder::finished(&study());
    let rows = folder.rows("results/grid");
    let done: Vec<&str> = rows
        .iter()
        .filter(|row| row["status"] == "done")
        .map(|row| &row["job"].as_str().unwrap()[..10])
        .collect();
    let ids = done[..2].join(",");
    let arguments = ["chart", "--history", "vz", "--jobs", &ids, "--out"];
    let printed = folder.stdout(&[&arguments[..], &["two.SVG"]].concat());
    assert_eq!(printed, "two.SVG\n");
    let shown = texts(&fs::read(folder.path().join("two.SVG")).unwrap());
    assert!(shown.iter().any(|text| text.contains("2 points")), "{shown:?}");
    folder.stdout(&[&arguments[..], &["two.png"]].concat());
    size(&fs::read(folder.path().join("two.png")).unwrap());
    assert!(!folder.results().join("charts").exists());
}

#[test]
fn invalid_charts_give_exit_code_2_and_no_file() {
    let folder = TestFolder::finished(&study());
    for (arguments, expected) in [
        (&["--history", "z_rims"][..], "did you mean z_rim?"),
        (&["--measure", "peak_v", "--over", "N"], "did you mean peak_vz?"),
        (&["--measure", "status", "--over", "N"], "not a column of numbers"),
        (&["--measure", "peak_vz"], "needs a parameter to be drawn over"),
        (&["--measure", "peak_vz", "--over", "panels"], "not a parameter"),
        (&["--measure", "peak_vz", "--map", "N"], "not two parameters"),
        (&["--measure", "peak_vz", "--over", "N", "--by", "flow"], "--by = flow"),
        (&["--history", "vz", "--jobs", "zz"], "no job id starts with this"),
        (&["--history", "vz", "--jobs", ","], "job ids start with this"),
        (&["--history", "vz", "--from", "5 g"], "--from = 5 g"),
        (&["--history", "vz", "--from", "0.3", "--to", "0.2"], "the time range is empty"),
        (&["--history", "vz", "--where", "N == 7"], "no row fulfils this condition"),
        (&["--history", "vz", "--where", "n_ == 7"], "^"),
        (&["--history", "vz", "--out", "vz.pdf"], ".svg or .png"),
        (&["--history", "vz", "--out", "nowhere/vz.png"], "nowhere/vz.png"),
        (&["--out", "vz.png"], "one file for several charts"),
        (&["--title", "Mine"], "one title for several charts"),
        (&["nowhere"], "nowhere"),
    ] {
        folder.refuses(&[&["chart"], arguments].concat(), expected);
    }
    assert!(!folder.results().join("charts").exists());
}

#[test]
fn a_lost_history_is_reported_and_nothing_is_drawn() {
    let folder = TestFolder::finished(&study());
    let row = folder.rows("results/grid").into_iter().find(|row| row["status"] == "done").unwrap();
    let job = row["job"].as_str().unwrap();
    fs::remove_file(folder.results().join(format!("jobs/{}/{job}.h5", &job[..2]))).unwrap();
    folder.refuses(&["chart", "--history", "vz"], job);
    assert!(!folder.results().join("charts").exists());
}

/// Strategies over residual masses with four thicknesses of each point, limits, and a search of the largest
/// inflow.
fn question() -> serde_json::Value {
    let mut study = grid(&json!({
        "strategy": ["direct", "late"],
        "residual_gas_mass": [0, "0.05 g"],
        "mass_flow_rate": {
            "bisect": ["0.5 g/s", "20 g/s"], "on": "peak_vz", "tolerance": "20 %", "spacing": "log"
        }
    }));
    study["design"]["N"] = json!(6);
    study["design"]["M"] = json!(3);
    study["design"]["alpha1_over_phi"] = json!(1);
    study["strategies"] = json!({
        "direct": {}, "late": { "inflow": [{ "from": "0.1 s", "to": "0.5 s" }] }
    });
    study["limits"] = json!({ "peak_vz": "< 27 m/s", "verdict": "deployed" });
    study["replicates"] = json!({ "film.thickness": ["25 um", "26 um", "27 um", "28 um"] });
    study
}

#[test]
fn the_default_set_of_a_question_shows_borders_limits_and_medians() {
    let folder = TestFolder::finished(&question());
    let printed = folder.stdout(&["chart", "grid.json", "-q"]);
    let charts = "results/grid/charts";
    let read = |name: &str| {
        let path = format!("{charts}/{name}.svg");
        assert!(printed.lines().any(|line| line == path), "{path}: {printed}");
        texts(&fs::read(folder.path().join(path)).unwrap())
    };
    for (name, expected) in [
        (
            "borders",
            &[
                "Largest mass flow rate with peak_vz < 27 m/s over residual gas mass",
                "Mass flow rate (g/s)",
                "Inflation strategy",
                "late",
                "ends of the search",
            ][..],
        ),
        ("smallest_margin-over-mass_flow_rate", &["limit", "0.05 g"]),
        ("peak_vz-over-mass_flow_rate", &["limit 27 m/s", "inflation strategy", "direct"]),
        ("history-z_rim", &["median, and range from least to largest"]),
    ] {
        let shown = read(name);
        for text in expected {
            let there = |shown: &String| shown.contains(text);
            assert!(shown.iter().any(there), "{name}: {text}: {shown:?}");
        }
        assert!(!shown.iter().any(|text| text.contains("Thickness")), "{name}: {shown:?}");
    }
    let arguments = ["chart", "grid.json", "-q", "--measure", "safe", "--out", "map.svg"];
    let chosen = ["--map", "residual_gas_mass,strategy", "--where", "mass_flow_rate == '0.5 g/s'"];
    folder.stdout(&[&arguments[..], &chosen].concat());
    let map = texts(&fs::read(folder.path().join("map.svg")).unwrap());
    assert!(map.iter().any(|text| text == "4/4"), "{map:?}");
}
