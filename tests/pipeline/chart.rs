//! `billow chart` on a finished study: every kind, as SVG and PNG.

use std::fs;

use serde_json::json;

use crate::search::searching;
use crate::support::{TestFolder, file_of, grid, ids, json_of, png_size};

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

#[test]
fn every_kind_is_drawn_as_svg_and_png() {
    let folder = TestFolder::finished(&study());
    for (arguments, name, expected) in [
        ("--history z_rim,pressure --to 50ms", "history-z_rim-pressure", "End time 400 ms"),
        (
            "--measure peak_vz --over mass_flow_rate",
            "peak_vz-over-mass_flow_rate",
            "infeasible (8)",
        ),
        (
            "--measure peak_vz --over gas.mass_flow_rate --by design.N --where alpha1_over_phi==9",
            "peak_vz-over-mass_flow_rate-by-N",
            "End time 20 ms",
        ),
        (
            "--measure peak_vz --map mass_flow_rate,N",
            "peak_vz-map-mass_flow_rate-N",
            "Number of panels N",
        ),
    ] {
        let words: Vec<&str> = ["chart"].into_iter().chain(arguments.split(' ')).collect();
        let printed = folder.stdout(&words);
        let paths: Vec<&str> = printed.lines().collect();
        let path = format!("results/grid/charts/{name}");
        assert_eq!(paths, [format!("{path}.svg"), format!("{path}.png")]);
        let [svg, png] = [0, 1].map(|kind| folder.path().join(paths[kind]));
        let shown = texts(&fs::read(svg).unwrap());
        assert!(shown.iter().any(|text| text == expected), "{name}: {shown:?}");
        let [width, height] = png_size(&png);
        let length = fs::metadata(png).unwrap().len();
        assert!(width == 1920 && height > 600, "{width} {height}");
        assert!(length > 20_000, "{name}: {length} bytes is a blank page");
    }
}

/// The default set of a study with limits, replicates and a search, drawn twice.
#[test]
fn the_default_set_is_drawn_with_reproducible_bytes() {
    let mut study = searching();
    study["grid"]["N"] = json!([6]);
    study["grid"]["residual_gas_mass"] = json!([0, "0.05 g"]);
    study["replicates"] = json!({ "film.thickness": ["24 um", "25 um", "26 um", "27 um"] });
    let folder = TestFolder::finished(&study);
    let read = || -> Vec<(String, Vec<u8>)> {
        let printed = json_of(&folder, &["chart", "grid.json", "-q"]);
        let names = printed.as_array().unwrap().iter().map(|row| row["file"].as_str().unwrap());
        names.map(|name| (name.to_owned(), fs::read(folder.path().join(name)).unwrap())).collect()
    };
    let drawn = read();
    for (name, expected) in [
        ("borders", "Largest mass flow rate with peak_vz < 40 m/s over residual gas mass"),
        ("smallest_margin-over-mass_flow_rate", "limit"),
        ("peak_vz-over-mass_flow_rate", "limit 40 m/s"),
        ("history-z_rim", "median, and range from least to largest"),
    ] {
        let path = format!("results/grid/charts/{name}.svg");
        let (_, svg) = drawn.iter().find(|(name, _)| *name == path).expect(&path);
        let shown = texts(svg);
        assert!(shown.iter().any(|text| text.contains(expected)), "{name}: {shown:?}");
        assert!(drawn.iter().any(|(name, _)| *name == path.replace(".svg", ".png")), "{name}");
    }
    assert!(drawn == read());
    // Charts in a results folder do not prevent another run.
    folder.stdout(&["run", "grid.json", "-q"]);
}

#[test]
fn jobs_are_selected_by_id_prefix_and_formats_by_file_extension() {
    let folder = TestFolder::finished(&study());
    let done = ids(&folder, "done");
    let two = format!("{},{}", &done[0][..10], &done[1][..10]);
    let arguments = ["chart", "--history", "vz", "--jobs", &two, "--out"];
    let printed = folder.stdout(&[&arguments[..], &["two.SVG"]].concat());
    assert_eq!(printed, "two.SVG\n");
    let shown = texts(&fs::read(folder.path().join("two.SVG")).unwrap());
    assert!(shown.iter().any(|text| text.contains("2 points")), "{shown:?}");
    folder.stdout(&[&arguments[..], &["two.png"]].concat());
    png_size(&folder.path().join("two.png"));
    let both = folder.stdout(&[&arguments[..], &["pictures"]].concat());
    assert!(
        both.lines().all(|line| line.starts_with("pictures/")) && both.lines().count() == 2,
        "{both}"
    );
    folder.stdout(&["chart", "grid", "--out", "all"]);
    assert!(fs::read_dir(folder.path().join("all")).unwrap().count() > 2);
    assert!(!folder.results().join("charts").exists());
}

#[test]
fn a_lost_history_is_reported_and_nothing_is_drawn() {
    let folder = TestFolder::finished(&study());
    let job = ids(&folder, "done").remove(0);
    fs::remove_file(file_of(&folder, &job)).unwrap();
    folder.refuses(&["chart", "--history", "vz"], &job);
    assert!(!folder.results().join("charts").exists());
}
