//! `billow report`, and the page that a run ends with. `tests/report` uses the pages in a browser.

use std::fs;

use serde_json::{Value, json};

use crate::support::{TestFolder, grid, paper_design, small_grid, stderr};

/// The data block of a page.
fn data(page: &str) -> Value {
    let (_, rest) = page.split_once(r#"<script type="application/json" id="data">"#).unwrap();
    serde_json::from_str(rest.split_once("</script>").unwrap().0).unwrap()
}

fn read(folder: &TestFolder, path: &str) -> String {
    fs::read_to_string(folder.path().join(path)).unwrap()
}

/// Two film jobs with shapes.
fn film() -> Value {
    json!({
        "design": paper_design(2),
        "solver": {"end_time": "30 ms"},
        "outputs": {"frames": 12},
        "gas": {"mass_flow_rate": "5 g/s"},
        "grid": {"residual_gas_mass": [0, "0.05 g"]},
    })
}

#[test]
fn a_run_ends_with_a_page_of_what_is_stored() {
    let folder = TestFolder::finished(&film());
    let page = read(&folder, "results/grid/report.html");
    let found = data(&page);
    assert_eq!((&found["rows"], &found["running"]), (&json!(2), &json!(false)));
    let columns = found["columns"].as_array().unwrap();
    let names: Vec<&str> = columns.iter().map(|column| column["name"].as_str().unwrap()).collect();
    for name in ["job", "residual_gas_mass", "status", "peak_speed"] {
        assert!(names.contains(&name), "{name} in {names:?}");
    }
    // Uncertainties stand with their value.
    assert!(!names.contains(&"peak_speed_error_below"));
    let jobs = |part: &str| found[part]["jobs"].as_array().unwrap().len();
    assert_eq!((jobs("curves"), jobs("shapes")), (2, 2));
    let charts = found["charts"].as_array().unwrap();
    assert!(
        !charts.is_empty() && charts.iter().all(|c| c[1].as_str().unwrap().starts_with("<svg"))
    );
    assert_eq!(found["shapes"]["meshes"].as_array().unwrap().len(), 1, "both have one mesh");
    // The same lines as the end of the run.
    let said = folder.stdout(&["run", "grid.json"]);
    let lines = found["topics"].as_array().unwrap();
    let deployed = lines.iter().find(|topic| topic[0] == "deployed").unwrap();
    assert!(said.contains(deployed[1][0].as_str().unwrap()), "{said}");
    assert!(said.contains("report   results/grid/report.html"), "{said}");
    // The same bytes from the stored results, and nothing from a network.
    assert_eq!(folder.stdout(&["report", "--out", "again.html"]), "again.html\n");
    assert_eq!(read(&folder, "again.html"), page);
    assert!(!page.contains("src=\"http") && page.contains("default-src 'none'"));
}

#[test]
fn texts_of_a_study_cannot_leave_the_data() {
    let mut study =
        grid(&json!({"N": [6], "alpha1_over_phi": [1], "mass_flow_rate": ["1 g/s"], "M": [3]}));
    let text = "</script><script>alert(1)</script>{{style}} \"'&";
    study["question"] = json!(text);
    let folder = TestFolder::new(&study);
    folder.stdout(&["run", "grid.json", "-q"]);
    let page = read(&folder, "results/grid/report.html");
    assert_eq!(data(&page)["question"], text);
    assert!(!page.contains("<script>alert"));
}

#[test]
fn a_small_page_says_what_it_leaves_out_and_keeps_the_numbers() {
    let folder = TestFolder::finished(&film());
    let output = folder.run(&["report", "--out", "small.html", "--size", "0.5"]);
    assert!(output.status.success(), "{}", stderr(&output));
    let (whole, small) = (read(&folder, "results/grid/report.html"), read(&folder, "small.html"));
    assert!(small.len() < whole.len());
    let [whole, small] = [whole, small].map(|page| data(&page));
    assert_eq!(small["columns"], whole["columns"]);
    let notes = small["notes"].as_array().unwrap();
    assert!(!notes.is_empty(), "{notes:?}");
    for note in notes {
        assert!(stderr(&output).contains(note.as_str().unwrap()), "{}", stderr(&output));
    }
}

#[test]
fn infeasible_points_and_damaged_histories_leave_a_page() {
    let folder = TestFolder::finished(&small_grid());
    let found = data(&read(&folder, "results/grid/report.html"));
    let rows = found["rows"].as_u64().unwrap();
    let curves = found["curves"]["jobs"].as_array().unwrap().len() as u64;
    assert!(curves > 0 && curves < rows, "{curves} of {rows}");
    // One history is gone: its job has no curve, and the table keeps its row.
    let rows_now = folder.rows("results/grid");
    let done = rows_now.iter().find(|row| row["status"] == "done").unwrap();
    let id = done["job"].as_str().unwrap();
    let path = format!("results/grid/jobs/{}/{id}.h5", &id[..2]);
    fs::remove_file(folder.path().join(path)).unwrap();
    folder.stdout(&["report", "results/grid"]);
    let damaged = data(&read(&folder, "results/grid/report.html"));
    assert_eq!(damaged["rows"], rows);
    assert_eq!(damaged["curves"]["jobs"].as_array().unwrap().len() as u64, curves - 1);
}

#[test]
fn options_are_checked_and_a_run_can_do_without_a_page() {
    let folder = TestFolder::new(&grid(
        &json!({"N": [6], "alpha1_over_phi": [1], "mass_flow_rate": ["1 g/s"], "M": [3]}),
    ));
    let said = folder.stdout(&["run", "grid.json", "--no-report"]);
    assert!(!said.contains("report.html") && !folder.results().join("report.html").exists());
    // A page that cannot be written hides no answer, and fails no run.
    fs::create_dir(folder.results().join("report.html")).unwrap();
    let output = folder.run(&["run", "grid.json"]);
    assert!(output.status.success(), "{}", stderr(&output));
    assert!(String::from_utf8_lossy(&output.stdout).contains("deployed 1 of 1 job"));
    assert!(stderr(&output).contains("no report") && stderr(&output).contains("billow report"));
    fs::remove_dir(folder.results().join("report.html")).unwrap();
    folder.refuses(&["report", "--size", "0"], "--size");
    folder.refuses(&["report", "--out", "page.pdf"], ".html");
    // Nothing runs, so watching ends at once.
    assert_eq!(folder.stdout(&["report", "--watch"]), "results/grid/report.html\n");
}
