//! What is stored stays sound: `doctor`, `rerun`.

use std::fs;

use serde_json::{Value, json};

use crate::support::{
    Desk, failed, file_of, grid, histories, ids, json_of, ran, stderr, without_costs,
};

#[test]
fn a_sound_folder_is_sound_and_the_doctor_changes_nothing() {
    let desk = ran();
    let before = histories(&desk.results());
    let said = desk.stdout(&["doctor"]);
    assert_eq!(
        said,
        "results/grid: no faults: 16 jobs recorded, 16 histories checked, 0 findings\n"
    );
    assert_eq!(json_of(&desk, &["doctor"]), json!([]));
    assert_eq!(histories(&desk.results()), before);
    assert!(desk.stdout(&["doctor", "grid.json"]).contains("no faults"));
}

/// Hurts the folder, or one job of it.
type Hurt = fn(&Desk, &str);

/// Every way a folder can be hurt: its name, how, whether that breaks it, what the doctor says.
const HURTS: [(&str, Hurt, bool, &str); 12] = [
    ("missing history", |desk, id| fs::remove_file(file_of(desk, id)).unwrap(), true, ": missing"),
    (
        "cut history",
        |desk, id| {
            let bytes = fs::read(file_of(desk, id)).unwrap();
            fs::write(file_of(desk, id), &bytes[..bytes.len() / 2]).unwrap();
        },
        true,
        "not the file that was written (not an HDF5 file",
    ),
    (
        "another history",
        |desk, id| {
            let other = ids(desk, "done").into_iter().find(|other| other != id).unwrap();
            fs::copy(file_of(desk, &other), file_of(desk, id)).unwrap();
        },
        true,
        "(a valid history, but another one)",
    ),
    (
        "missing table",
        |desk, _| fs::remove_file(desk.results().join("summary.parquet")).unwrap(),
        false,
        "no table yet",
    ),
    (
        "foreign table",
        |desk, _| fs::write(desk.results().join("summary.parquet"), "x").unwrap(),
        true,
        "not a Parquet file",
    ),
    (
        "table behind",
        |desk, _| {
            let other = Desk::new(&grid(
                &json!({"N": [6], "M": [3], "alpha1_over_phi": [1], "mass_flow_rate": ["2 g/s"]}),
            ));
            other.stdout(&["run", "grid.json", "-q"]);
            fs::copy(
                other.results().join("summary.parquet"),
                desk.results().join("summary.parquet"),
            )
            .unwrap();
        },
        true,
        "differs from the journal in 24 rows",
    ),
    (
        "torn last line",
        |desk, _| {
            let path = desk.results().join("journal/000001.jsonl");
            let bytes = fs::read(&path).unwrap();
            fs::write(&path, &bytes[..bytes.len() - 20]).unwrap();
        },
        true,
        "line 17 is torn",
    ),
    (
        "leftover",
        |desk, _| {
            fs::write(desk.results().join("jobs/.x.tmp"), "")
                .and_then(|()| fs::write(desk.results().join(".table.1-1.tmp"), ""))
                .unwrap();
        },
        false,
        "an incomplete temporary file",
    ),
    (
        "foreign file",
        |desk, _| fs::write(desk.results().join("notes.txt"), "").unwrap(),
        false,
        "not a file of billow",
    ),
    (
        "orphan",
        |desk, id| {
            let orphan =
                desk.results().join(format!("jobs/{}/{}{}.h5", &id[..2], &id[..2], "0".repeat(30)));
            fs::copy(file_of(desk, id), orphan).unwrap();
        },
        false,
        "a history without a record",
    ),
    (
        "study.json gone",
        |desk, _| fs::remove_file(desk.results().join("study.json")).unwrap(),
        true,
        "nothing says which study this is",
    ),
    (
        "study.json cut",
        |desk, _| {
            let path = desk.results().join("study.json");
            let bytes = fs::read(&path).unwrap();
            fs::write(&path, &bytes[..bytes.len() / 2]).unwrap();
        },
        true,
        "not a study.json of billow",
    ),
];

/// Found, told with what to do, and healed by the next run where it can be.
#[test]
fn the_doctor_finds_whatever_is_broken() {
    let whole = ran();
    let rows = without_costs(whole.rows("results/grid"));
    for (name, hurt, broken, expected) in HURTS {
        let desk = ran();
        let id = ids(&desk, "done").remove(2);
        hurt(&desk, &id);
        let output = desk.run(&["doctor"]);
        let said = String::from_utf8(output.stdout.clone()).unwrap();
        assert!(said.contains(expected), "{name}: {said}");
        let line = said.lines().find(|line| line.contains(expected)).unwrap();
        assert!(line.contains("; next: "), "{name}: {line}");
        assert_eq!(output.status.code(), Some(i32::from(broken)), "{name}: {said}");
        if name == "study.json cut" {
            // Another study's folder is not overwritten by guess.
            let refused = desk.run(&["run", "grid.json", "-q"]);
            assert_eq!(refused.status.code(), Some(2));
            continue;
        }
        desk.stdout(&["run", "grid.json", "-q"]);
        let healed = desk.run(&["doctor"]);
        assert_eq!(
            healed.status.code(),
            Some(0),
            "{name}: {}",
            String::from_utf8_lossy(&healed.stdout)
        );
        assert_eq!(without_costs(desk.rows("results/grid")), rows, "{name}");
    }
}

#[test]
fn what_a_newer_program_wrote_is_named_and_refused() {
    let desk = ran();
    let journal = desk.results().join("journal/000001.jsonl");
    let study = desk.results().join("study.json");
    for (path, from, to, expected) in [
        (&journal, "\"version\":3", "\"version\":9", "journal of version 9"),
        (&study, "\"version\": 1", "\"version\": 9", "version 9, this program reads up to 1"),
    ] {
        let sound = fs::read_to_string(path).unwrap();
        fs::write(path, sound.replacen(from, to, 1)).unwrap();
        let output = desk.run(&["doctor"]);
        assert_eq!(output.status.code(), Some(1));
        let said = String::from_utf8(output.stdout).unwrap();
        assert!(said.contains(expected), "{said}");
        for command in [&["show", "00"][..], &["compare", "--by", "N", "--base", "5"]] {
            let refused = desk.run(command);
            assert_eq!(refused.status.code(), Some(2));
            assert!(stderr(&refused).contains(expected), "{}", stderr(&refused));
        }
        fs::write(path, sound).unwrap();
    }
    assert_eq!(desk.run(&["doctor"]).status.code(), Some(0));
}

#[test]
fn a_rerun_gives_the_same_bits_and_says_so() {
    let desk = ran();
    let before = histories(&desk.results());
    let table = without_costs(desk.rows("results/grid"));
    let done = ids(&desk, "done");
    let listed = desk.stdout(&["rerun", &done[0][..9], &done[1], "--dry-run", "--format", "csv"]);
    assert_eq!(listed.lines().count(), 3, "{listed}");
    assert_eq!(histories(&desk.results()), before);
    let said = desk.stdout(&["rerun", &done[0][..9], &done[1], "results/grid", "-q"]);
    assert!(said.starts_with("grid: 2 jobs run, 24 points\n"), "{said}");
    assert!(said.contains("bits     2 jobs the same as before\n"), "{said}");
    let summary = json_of(&desk, &["rerun", "--where", "N == 6 and M == 3", "grid.json", "-q"]);
    assert_eq!((&summary["ran"], &summary["same_bits"]), (&json!(6), &json!(6)));
    assert_eq!(summary["other_bits"], json!([]));
    assert_eq!(histories(&desk.results()), before);
    assert_eq!(without_costs(desk.rows("results/grid")), table);
    assert!(desk.stdout(&["run", "grid.json", "-q"]).contains("nothing to run"));
    assert_eq!(desk.run(&["doctor"]).status.code(), Some(0));

    let infeasible = &ids(&desk, "infeasible")[0];
    for (arguments, expected) in [
        (&["rerun"][..], "no job is named"),
        (&["rerun", infeasible], "it has no job to run"),
        (&["rerun", &done[0], "--where", "N == 6"], "both by id and by --where"),
    ] {
        let output = desk.run(arguments);
        assert_eq!(output.status.code(), Some(2), "{arguments:?}");
        assert!(stderr(&output).contains(expected), "{}", stderr(&output));
    }
}

#[test]
fn other_bits_than_before_are_an_error() {
    let desk = ran();
    let id = &ids(&desk, "done")[0];
    let journal = desk.results().join("journal/000001.jsonl");
    let row = desk.rows("results/grid").into_iter().find(|row| row["job"] == id.as_str()).unwrap();
    let text = fs::read_to_string(&journal).unwrap();
    let hash = row["content_hash"].as_str().unwrap();
    fs::write(&journal, text.replace(hash, &"0".repeat(64))).unwrap();
    let output = desk.run(&["rerun", id, "-q"]);
    assert_eq!(output.status.code(), Some(1));
    let said = stderr(&output);
    assert!(
        said.contains(&format!("1 job gave different bits than before: {}", &id[..8])),
        "{said}"
    );
}

#[test]
fn failed_jobs_are_run_again_by_condition() {
    let desk = failed();
    let output = desk.run(&["rerun", "--where", "status == 'step_limit'", "-q", "--json"]);
    assert_eq!(output.status.code(), Some(1), "they fail again: {}", stderr(&output));
    let summary: Value = serde_json::from_slice(&output.stdout).unwrap();
    assert_eq!((&summary["ran"], &summary["same_bits"]), (&json!(16), &json!(16)));
    let none = desk.run(&["rerun", "--where", "status == 'done'"]);
    assert_eq!(none.status.code(), Some(0));
    assert!(stderr(&none).contains("0 jobs would run"), "{}", stderr(&none));
}
