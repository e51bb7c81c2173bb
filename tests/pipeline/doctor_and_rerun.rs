//! `doctor` finds damage in a results folder; `run --again` repeats jobs and compares their bits.

use std::fs;

use billow_solver::platform::seal;
use serde_json::{Value, json};

use crate::support::{
    TestFolder, file_of, grid, histories, ids, json_of, ran, stderr, without_costs,
};

#[test]
fn doctor_reports_a_sound_folder_and_changes_nothing() {
    let folder = ran();
    let before = histories(&folder.results());
    let said = "results/grid: no faults: 16 jobs recorded, 16 histories checked, 0 findings\n";
    assert_eq!(folder.stdout(&["doctor", "grid.json"]), said);
    assert_eq!(json_of(&folder, &["doctor"]), json!([]));
    assert_eq!(histories(&folder.results()), before);
}

/// A change of one file.
enum Change {
    Remove,
    /// The first half remains.
    Cut,
    /// Without its last bytes.
    Torn,
    Write(&'static str),
    /// The first part of the text that is this one becomes the other.
    Edit(&'static str, &'static str),
    /// The line of the job is removed.
    Unlist,
    /// One bit differs; size and time of change are the same.
    Flip,
    /// The file of another job.
    Exchange,
    /// The file of another study.
    Foreign,
}
use Change::{Cut, Edit, Exchange, Flip, Foreign, Remove, Torn, Unlist, Write};

const HISTORY: &str = "jobs/{job}.h5";
const JOURNAL: &str = "journal/000001.jsonl";
const STUDY: &str = "study.json";
const TABLE: &str = "summary.parquet";

/// Damages: file, change, whether `doctor` fails, part of its message.
const DAMAGES: [(&str, Change, bool, &str); 17] = [
    (HISTORY, Remove, true, ": missing"),
    (HISTORY, Cut, true, "not the file that was written (not an HDF5 file"),
    (HISTORY, Exchange, true, "(a valid history, but another one)"),
    (HISTORY, Flip, true, "not the file that was written"),
    (TABLE, Remove, false, "no table yet"),
    (TABLE, Write("x"), true, "not the table of plan and journal"),
    (TABLE, Foreign, true, "not the table of plan and journal"),
    (JOURNAL, Torn, true, "line 18: torn"),
    (
        JOURNAL,
        Edit("\"peak_vz\":", "\"peak_vz\":9"),
        true,
        "the file was changed or damaged; its job",
    ),
    (JOURNAL, Unlist, true, "not the table of plan and journal"),
    ("jobs/00/.x.1-1.tmp", Write(""), false, "an incomplete temporary file"),
    (".table.1-1.tmp", Write(""), false, "an incomplete temporary file"),
    ("notes.txt", Write(""), false, "not a file of billow"),
    ("jobs/00/00000000000000000000000000000000.h5", Exchange, false, "a history without a record"),
    (STUDY, Remove, true, "nothing says which study this is"),
    (STUDY, Cut, true, "damaged: it does not have the contents"),
    (
        STUDY,
        Edit("\"end_time\": \"0.6 s\"", "\"end_time\": \"0.7 s\""),
        true,
        "damaged: it does not have the contents",
    ),
];

/// Changes the file of the results folder.
fn damage(folder: &TestFolder, file: &str, change: &Change) {
    let done = ids(folder, "done");
    let [job, other] = [&done[2], &done[3]];
    let path = folder.results().join(file.replace("{job}", &format!("{}/{job}", &job[..2])));
    fs::create_dir_all(path.parent().unwrap()).unwrap();
    let bytes = fs::read(&path).unwrap_or_default();
    let text = || String::from_utf8(bytes.clone()).unwrap();
    let bytes = match change {
        Remove => return fs::remove_file(&path).unwrap(),
        Cut => bytes[..bytes.len() / 2].to_vec(),
        Torn => bytes[..bytes.len() - 20].to_vec(),
        Write(text) => text.as_bytes().to_vec(),
        Edit(from, to) => {
            assert!(text().contains(from), "{from}");
            text().replacen(from, to, 1).into_bytes()
        }
        Unlist => text()
            .split_inclusive('\n')
            .filter(|line| !line.contains(job))
            .collect::<String>()
            .into_bytes(),
        Flip => {
            let time = path.metadata().unwrap().modified().unwrap();
            let mut bytes = bytes;
            bytes[3000] ^= 1;
            fs::write(&path, bytes).unwrap();
            let file = fs::OpenOptions::new().write(true).open(&path).unwrap();
            return file.set_modified(time).unwrap();
        }
        Exchange => fs::read(file_of(folder, other)).unwrap(),
        Foreign => {
            let axes =
                json!({"N": [6], "M": [3], "alpha1_over_phi": [1], "mass_flow_rate": ["2 g/s"]});
            fs::read(TestFolder::finished(&grid(&axes)).results().join(TABLE)).unwrap()
        }
    };
    fs::write(&path, bytes).unwrap();
}

#[test]
fn what_a_killed_run_leaves_is_no_damage() {
    let folder = ran();
    damage(&folder, TABLE, &Foreign);
    fs::write(folder.results().join("attempts.jsonl"), "").unwrap();
    let said = folder.stdout(&["doctor"]);
    assert!(said.starts_with("note ") && said.contains("older than the journal"), "{said}");
    damage(&folder, JOURNAL, &Torn);
    let status = folder.stdout(&["status"]);
    let next = "nothing else is lost, `billow run` runs it again\n";
    assert!(status.contains(next) && !status.contains("doctor"), "{status}");
    folder.stdout(&["run", "grid.json", "-q"]);
    assert_eq!(json_of(&folder, &["doctor"]), json!([]));
}

/// `doctor` reports each damage with the next step, and the next run repairs what it can.
#[test]
fn doctor_finds_every_damage_and_run_repairs_it() {
    let whole = ran();
    let rows = without_costs(whole.rows("results/grid"));
    for (file, change, broken, expected) in &DAMAGES {
        let folder = ran();
        damage(&folder, file, change);
        if *file == TABLE {
            let read = without_costs(folder.rows("results/grid"));
            assert_eq!(read, rows, "a damaged table changes no answer");
        }
        let output = folder.run(&["doctor"]);
        let said = String::from_utf8(output.stdout.clone()).unwrap();
        let line = said.lines().find(|line| line.contains(expected));
        let line = line.unwrap_or_else(|| panic!("{file}: {expected}: {said}"));
        assert!(line.contains("; next: "), "{file}: {line}");
        assert_eq!(output.status.code(), Some(i32::from(*broken)), "{file}: {said}");
        if *broken {
            // After a repair nothing is broken; at most jobs are pending.
            let repaired = folder.run(&["doctor", "--repair"]);
            assert_eq!(repaired.status.code(), Some(0), "{file}: {}", stderr(&repaired));
            assert!(stderr(&repaired).contains("repaired: "), "{file}: {}", stderr(&repaired));
        }
        folder.stdout(&["run", "grid.json", "-q"]);
        folder.stdout(&["doctor"]);
        assert_eq!(without_costs(folder.rows("results/grid")), rows, "{file}: {expected}");
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
            "\"version\":7",
            "\"version\":8",
            "journal of version 8, this program reads version 7",
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

    let infeasible = &ids(&folder, "infeasible")[0];
    folder.refuses(&["run", "results/grid", "--again", infeasible], "it has no job to run");
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

/// A results folder and its study.json name the study and its folder, also after a move.
#[test]
fn run_takes_a_results_folder() {
    let folder = ran();
    let copy = folder.path().join("copy");
    let id = ids(&folder, "done").remove(0);
    fs::rename(folder.results(), &copy).unwrap();
    for argument in ["copy", "copy/study.json"] {
        fs::remove_file(copy.join(format!("jobs/{}/{id}.h5", &id[..2]))).unwrap();
        let said = folder.stdout(&["run", argument, "-q"]);
        assert!(said.starts_with("grid: 1 job run") && said.contains("results  copy"), "{said}");
    }
    assert!(!folder.results().exists());
    assert_eq!(folder.run(&["doctor", "copy"]).status.code(), Some(0));
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
