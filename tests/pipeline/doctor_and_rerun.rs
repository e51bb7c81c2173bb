//! `doctor` finds damage in a results folder; `run --again` repeats jobs and compares their bits.

use std::fs;

use billow_solver::platform::seal;
use serde_json::{Value, json};

use crate::support::{
    TestFolder, failed, file_of, grid, histories, ids, json_of, ran, stderr, without_costs,
};

#[test]
fn doctor_reports_a_sound_folder_and_changes_nothing() {
    let folder = ran();
    let before = histories(&folder.results());
    let said = folder.stdout(&["doctor"]);
    assert_eq!(
        said,
        "results/grid: no faults: 16 jobs recorded, 16 histories checked, 0 findings\n"
    );
    assert_eq!(json_of(&folder, &["doctor"]), json!([]));
    assert_eq!(histories(&folder.results()), before);
    assert!(folder.stdout(&["doctor", "grid.json"]).contains("no faults"));
}

/// Damages the folder, or one of its jobs.
type Damage = fn(&TestFolder, &str);

/// Kinds of damage: name, function, whether `doctor` fails, part of its message.
const DAMAGES: [(&str, Damage, bool, &str); 16] = [
    (
        "missing history",
        |folder, id| fs::remove_file(file_of(folder, id)).unwrap(),
        true,
        ": missing",
    ),
    (
        "cut history",
        |folder, id| {
            let bytes = fs::read(file_of(folder, id)).unwrap();
            fs::write(file_of(folder, id), &bytes[..bytes.len() / 2]).unwrap();
        },
        true,
        "not the file that was written (not an HDF5 file",
    ),
    (
        "another history",
        |folder, id| {
            let other = ids(folder, "done").into_iter().find(|other| other != id).unwrap();
            fs::copy(file_of(folder, &other), file_of(folder, id)).unwrap();
        },
        true,
        "(a valid history, but another one)",
    ),
    (
        "missing table",
        |folder, _| fs::remove_file(folder.results().join("summary.parquet")).unwrap(),
        false,
        "no table yet",
    ),
    (
        "foreign table",
        |folder, _| fs::write(folder.results().join("summary.parquet"), "x").unwrap(),
        true,
        "not a Parquet file",
    ),
    (
        "table behind",
        |folder, _| {
            let other = TestFolder::finished(&grid(
                &json!({"N": [6], "M": [3], "alpha1_over_phi": [1], "mass_flow_rate": ["2 g/s"]}),
            ));
            fs::copy(
                other.results().join("summary.parquet"),
                folder.results().join("summary.parquet"),
            )
            .unwrap();
        },
        true,
        "differs from the journal in 24 rows",
    ),
    (
        "torn last line",
        |folder, _| {
            let path = folder.results().join("journal/000001.jsonl");
            let bytes = fs::read(&path).unwrap();
            fs::write(&path, &bytes[..bytes.len() - 20]).unwrap();
        },
        true,
        "line 18: torn",
    ),
    (
        "leftover",
        |folder, _| {
            fs::write(folder.results().join("jobs/.x.tmp"), "")
                .and_then(|()| fs::write(folder.results().join(".table.1-1.tmp"), ""))
                .unwrap();
        },
        false,
        "an incomplete temporary file",
    ),
    (
        "foreign file",
        |folder, _| fs::write(folder.results().join("notes.txt"), "").unwrap(),
        false,
        "not a file of billow",
    ),
    (
        "orphan",
        |folder, id| {
            let orphan = folder.results().join(format!(
                "jobs/{}/{}{}.h5",
                &id[..2],
                &id[..2],
                "0".repeat(30)
            ));
            fs::copy(file_of(folder, id), orphan).unwrap();
        },
        false,
        "a history without a record",
    ),
    (
        "study.json gone",
        |folder, _| fs::remove_file(folder.results().join("study.json")).unwrap(),
        true,
        "nothing says which study this is",
    ),
    (
        "study.json cut",
        |folder, _| {
            let path = folder.results().join("study.json");
            let bytes = fs::read(&path).unwrap();
            fs::write(&path, &bytes[..bytes.len() / 2]).unwrap();
        },
        true,
        "damaged: it does not have the contents",
    ),
    (
        "edited measure",
        |folder, id| {
            edit_journal(folder, |line| {
                let peak = line.contains(id).then(|| line.find("\"peak_vz\":"))??;
                Some(format!("{}9{}", &line[..peak + 10], &line[peak + 10..]))
            });
        },
        true,
        "it does not have the contents of its checksum: the file was changed or damaged; its job",
    ),
    (
        "edited study",
        |folder, _| {
            let path = folder.results().join("study.json");
            let text = fs::read_to_string(&path).unwrap();
            fs::write(&path, text.replacen("\"end_time\": 0.6", "\"end_time\": 0.7", 1)).unwrap();
        },
        true,
        "damaged: it does not have the contents of its checksum",
    ),
    (
        "line deleted",
        |folder, id| {
            edit_journal(folder, |line| line.contains(id).then(String::new));
        },
        true,
        "differs from the journal in 1 rows",
    ),
    (
        "same size and time",
        |folder, id| {
            let path = file_of(folder, id);
            let file = fs::OpenOptions::new().read(true).write(true).open(&path).unwrap();
            let time = file.metadata().unwrap().modified().unwrap();
            let mut bytes = fs::read(&path).unwrap();
            bytes[3000] ^= 1;
            fs::write(&path, bytes).unwrap();
            file.set_modified(time).unwrap();
        },
        true,
        "not the file that was written",
    ),
];

/// Changes lines of the journal: those for which `change` gives a new line.
fn edit_journal(folder: &TestFolder, change: impl Fn(&str) -> Option<String>) {
    let path = folder.results().join("journal/000001.jsonl");
    let text = fs::read_to_string(&path).unwrap();
    let lines: Vec<String> = text
        .split_inclusive('\n')
        .map(|line| change(line).unwrap_or_else(|| line.to_owned()))
        .collect();
    assert_ne!(lines.concat(), text);
    fs::write(&path, lines.concat()).unwrap();
}

/// `doctor` reports each damage with the next step, and the next run repairs what it can.
#[test]
fn doctor_finds_every_damage_and_run_repairs_it() {
    let whole = ran();
    let rows = without_costs(whole.rows("results/grid"));
    for (name, damage, broken, expected) in DAMAGES {
        let folder = ran();
        let id = ids(&folder, "done").remove(2);
        damage(&folder, &id);
        let output = folder.run(&["doctor"]);
        let said = String::from_utf8(output.stdout.clone()).unwrap();
        assert!(said.contains(expected), "{name}: {said}");
        let line = said.lines().find(|line| line.contains(expected)).unwrap();
        assert!(line.contains("; next: "), "{name}: {line}");
        assert_eq!(output.status.code(), Some(i32::from(broken)), "{name}: {said}");
        if broken {
            // After a repair nothing is broken; at most jobs are pending.
            let repaired = folder.run(&["doctor", "--repair"]);
            let said = String::from_utf8_lossy(&repaired.stdout);
            assert_eq!(repaired.status.code(), Some(0), "{name}: {said}");
            assert!(stderr(&repaired).contains("repaired: "), "{name}: {}", stderr(&repaired));
        }
        folder.stdout(&["run", "grid.json", "-q"]);
        let repaired = folder.run(&["doctor"]);
        assert_eq!(
            repaired.status.code(),
            Some(0),
            "{name}: {}",
            String::from_utf8_lossy(&repaired.stdout)
        );
        assert_eq!(without_costs(folder.rows("results/grid")), rows, "{name}");
    }
}

/// The first line of a text, and the rest of it from the end of the line on.
fn first_line(text: &str) -> (&str, &str) {
    text.split_at(text.find('\n').unwrap())
}

#[test]
fn files_of_a_newer_version_are_refused() {
    let folder = ran();
    let journal = folder.results().join("journal/000001.jsonl");
    let study = folder.results().join("study.json");
    for (path, from, to, expected) in [
        (
            &journal,
            "\"version\":6",
            "\"version\":7",
            "journal of version 7, this program reads version 6",
        ),
        (&study, "\"version\": 1", "\"version\": 2", "version 2, this program reads version 1"),
    ] {
        let sound = fs::read_to_string(path).unwrap();
        // The newer program wrote its checksum.
        let (first, rest) = if *path == study { (&sound[..], "") } else { first_line(&sound) };
        let newer = seal::seal(&seal::open(first).unwrap().replacen(from, to, 1));
        fs::write(path, newer + rest).unwrap();
        let output = folder.run(&["doctor"]);
        assert_eq!(output.status.code(), Some(1));
        let said = String::from_utf8(output.stdout).unwrap();
        assert!(said.contains(expected), "{said}");
        for command in [&["job", "00"][..], &["compare", "--by", "N", "--base", "5"]] {
            let refused = folder.run(command);
            assert_eq!(refused.status.code(), Some(2));
            assert!(stderr(&refused).contains(expected), "{}", stderr(&refused));
        }
        fs::write(path, sound).unwrap();
    }
    assert_eq!(folder.run(&["doctor"]).status.code(), Some(0));
}

#[test]
fn jobs_run_again_reproduce_their_bits() {
    let folder = ran();
    let before = histories(&folder.results());
    let table = without_costs(folder.rows("results/grid"));
    let done = ids(&folder, "done");
    let two = format!("{},{}", &done[0][..9], done[1]);
    let said = folder.stdout(&["run", "results/grid", "--again", &two, "-q"]);
    assert!(said.starts_with("grid: 2 jobs run, 24 points\n"), "{said}");
    assert!(said.contains("bits     2 jobs the same as before\n"), "{said}");
    let summary = json_of(&folder, &["run", "grid.json", "--again", "done", "-q"]);
    let number = json!(done.len());
    assert_eq!((&summary["ran"], &summary["same_bits"]), (&number, &number));
    assert_eq!(summary["other_bits"], json!([]));
    assert_eq!(histories(&folder.results()), before);
    assert_eq!(without_costs(folder.rows("results/grid")), table);
    assert!(folder.stdout(&["run", "grid.json", "-q"]).contains("nothing to run"));
    assert_eq!(folder.run(&["doctor"]).status.code(), Some(0));

    let infeasible = &ids(&folder, "infeasible")[0];
    for (again, expected) in [
        (infeasible.as_str(), "it has no job to run"),
        ("timeout", "no job of the study has this status"),
        ("timeoot", "no job has this id"),
    ] {
        let output = folder.run(&["run", "results/grid", "--again", again]);
        assert_eq!(output.status.code(), Some(2), "{again}");
        assert!(stderr(&output).contains(expected), "{}", stderr(&output));
    }
}

#[test]
fn a_job_runs_with_other_settings_beside_the_study() {
    let folder = ran();
    let table = folder.rows("results/grid");
    let done = ids(&folder, "done");
    let set = ["run", "grid.json", "--again", &done[0], "--set", "solver.end_time=0.2 s", "--json"];
    let rows: Vec<Value> = serde_json::from_str(&folder.stdout(&set)).unwrap();
    assert_eq!(rows.len(), 2);
    assert_eq!((&rows[0]["status"], &rows[1]["status"]), (&json!("done"), &json!("done")));
    assert_ne!(rows[0]["steps"], rows[1]["steps"]);
    assert_eq!(folder.rows("results/grid"), table);
    let refused = folder.run(&["run", "grid.json", "--again", &done[0], "--set", "N=9"]);
    assert_eq!(refused.status.code(), Some(2), "{}", stderr(&refused));
}

#[test]
fn different_bits_are_an_error() {
    let folder = ran();
    let id = &ids(&folder, "done")[0];
    let journal = folder.results().join("journal/000001.jsonl");
    let row =
        folder.rows("results/grid").into_iter().find(|row| row["job"] == id.as_str()).unwrap();
    let hash = row["content_hash"].as_str().unwrap();
    let text = fs::read_to_string(&journal).unwrap();
    // As if another program had stored the job.
    let sealed =
        |line: &str| seal::seal(&seal::open(line).unwrap().replace(hash, &"0".repeat(64))) + "\n";
    fs::write(&journal, text.lines().map(sealed).collect::<String>()).unwrap();
    let output = folder.run(&["run", "grid.json", "--again", id, "-q"]);
    assert_eq!(output.status.code(), Some(1));
    let said = stderr(&output);
    assert!(
        said.contains(&format!("1 job gave different bits than before: {}", &id[..8])),
        "{said}"
    );
}

#[test]
fn failed_jobs_run_again_by_their_status() {
    let folder = failed();
    let output = folder.run(&["run", "grid.json", "--again", "step_limit", "-q", "--json"]);
    assert_eq!(output.status.code(), Some(1), "they fail again: {}", stderr(&output));
    let summary: Value = serde_json::from_slice(&output.stdout).unwrap();
    assert_eq!((&summary["ran"], &summary["same_bits"]), (&json!(16), &json!(16)));
}

/// A results folder and its study.json name the study and its folder, also after a move.
#[test]
fn run_takes_a_results_folder() {
    let folder = ran();
    let copy = folder.path().join("copy");
    fs::rename(folder.results(), &copy).unwrap();
    let id = ids_of(&copy);
    for argument in ["copy", "copy/study.json"] {
        fs::remove_file(copy.join(format!("jobs/{}/{id}.h5", &id[..2]))).unwrap();
        let said = folder.stdout(&["run", argument, "-q"]);
        assert!(said.starts_with("grid: 1 job run") && said.contains("results  copy"), "{said}");
    }
    assert!(!folder.results().exists());
    assert_eq!(folder.run(&["doctor", "copy"]).status.code(), Some(0));
}

/// The id of a job with a history in a results folder.
fn ids_of(results: &std::path::Path) -> String {
    let mut folders = fs::read_dir(results.join("jobs")).unwrap();
    let first = folders.next().unwrap().unwrap().path();
    let file = fs::read_dir(first).unwrap().next().unwrap().unwrap().path();
    file.file_stem().unwrap().to_str().unwrap().to_owned()
}

/// Without its journal nothing confirms a table: a repair keeps it.
#[test]
fn a_repair_keeps_a_table_that_it_writes_again() {
    let folder = ran();
    let table = fs::read(folder.results().join("summary.parquet")).unwrap();
    fs::remove_dir_all(folder.results().join("journal")).unwrap();
    let output = folder.run(&["table"]);
    assert!(stderr(&output).contains("no job counts as finished"), "{}", stderr(&output));
    folder.run(&["doctor", "--repair"]);
    let kept = folder.results().join("damaged/summary.parquet.0");
    assert_eq!(fs::read(kept).unwrap(), table);
}
