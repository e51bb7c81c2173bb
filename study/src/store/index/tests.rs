use super::*;
use crate::job::Status;
use crate::job::row::Cells;
use crate::platform::files::{Disk, Files};
use crate::store::journal::Writer;
use crate::study::{PlanSize, plan};

/// Two axes, an infeasible ratio, replicates; one ratio is written twice, so points share jobs.
const TEXT: &str = r#"{
    "name": "a",
    "design": {"fit": "height", "M": 2, "bottom_radius": 0.5, "height": 1},
    "gas": {"mass_flow_rate": 0.002},
    "solver": {"model": "piston", "end_time": 0.3},
    "replicates": {"seed": 2},
    "grid": {"N": [5, 6], "alpha1_over_phi": [0.8, 9, 0.8]}
}"#;

/// A folder with the records of all jobs but the last, and the key before they are read.
fn results(folder: &std::path::Path) -> Results<'static> {
    let results = Results::new(&Disk, folder);
    let study = Study::from_text(TEXT, "a.json", "a", &[], PlanSize::default()).unwrap();
    let text = results.write_study("a", &study.resolved(), &Journal::default()).unwrap();
    let mut writer = Writer::new(&Disk, results.journal_path());
    writer.study(&text).unwrap();
    let points = plan::next_jobs(&study, &[]).unwrap().points;
    let jobs: Vec<&JobId> = points
        .iter()
        .filter(|point| point.infeasible.is_none())
        .map(|point| &point.job.id)
        .collect();
    for id in &jobs[1..] {
        let cells = Cells::new(Status::Done);
        let record = Record { job: (*id).clone(), cells, file_hash: None, file_stamp: None };
        writer.append(&[record]).unwrap();
    }
    let stored = Stored::read(results.clone()).unwrap();
    results.write_table(&stored.table()).unwrap();
    results
}

fn index(results: &Results<'_>) -> Option<Index> {
    let key = Key::of(results)?;
    let stored = Stored::read(results.clone()).unwrap();
    let index = Index::of(&stored, key, &stored.table())?;
    index.write(results).unwrap().then_some(index)
}

#[test]
fn an_entry_gives_the_point_and_the_record_of_the_whole_folder() {
    let folder = tempfile::tempdir().unwrap();
    let results = results(folder.path());
    let written = index(&results).unwrap();
    let read = Index::read(&results).unwrap();
    assert_eq!(read, written);
    let whole = Stored::read(results.clone()).unwrap();
    assert_eq!(read.runs, whole.planned_runs());
    assert!(whole.points.iter().any(|point| !point.merged.is_empty()));
    assert!(whole.points.iter().any(|point| point.infeasible.is_some()));
    for (position, point) in whole.points.iter().enumerate() {
        let id = point.job.id.as_str();
        assert_eq!(read.position(id), Some(position));
        let one = read.stored(&results, &[position]).unwrap();
        assert_eq!(one.points, std::slice::from_ref(point));
        assert_eq!(one.record(&point.job.id), whole.record(&point.job.id));
        assert_eq!(one.units, whole.units);
    }
    assert_eq!(read.position(""), None);
    let all: Vec<usize> = (0..whole.points.len()).collect();
    assert_eq!(read.stored(&results, &all).unwrap().points, whole.points);
}

#[test]
fn an_index_of_other_files_or_of_another_program_is_not_used() {
    type Change = fn(&Results<'_>);
    let append = |path: &std::path::Path, more: &str| {
        let mut bytes = Disk.read(path).unwrap();
        bytes.extend(more.bytes());
        Disk.remove(path).unwrap();
        Disk.write_new(path, &bytes).unwrap();
    };
    let changes: [(&str, Change); 7] = [
        ("a journal that grew", |results| {
            let path = journal::paths(&Disk, &results.journal_path()).unwrap().remove(0);
            let mut writer = Writer::new(&Disk, results.journal_path());
            writer.progress(&[JobId::from_digits(&"0".repeat(32)).unwrap()]).unwrap();
            assert_eq!(journal::paths(&Disk, &results.journal_path()).unwrap()[0], path);
        }),
        ("a table that was written again", |results| {
            let bytes = Disk.read(&results.table_path()).unwrap();
            // Times of files have a resolution of some milliseconds.
            std::thread::sleep(std::time::Duration::from_millis(50));
            write_atomic(&Disk, &results.table_path(), &bytes).unwrap();
        }),
        ("another study", |results| {
            let text = Disk.read(&results.study_path()).unwrap();
            let text = String::from_utf8(text).unwrap().replace("0.3", "0.4");
            write_atomic(&Disk, &results.study_path(), text.as_bytes()).unwrap();
        }),
        ("another program", |results| sealed(results, "\"program_version\":\"", "x")),
        ("another commit", |results| sealed(results, "\"commit\":\"", "x")),
        ("another physics version", |results| sealed(results, "\"physics_version\":", "9")),
        ("a damaged index", |results| {
            let mut bytes = Disk.read(&results.index_path()).unwrap();
            let middle = bytes.len() / 2;
            bytes[middle] ^= 1;
            write_atomic(&Disk, &results.index_path(), &bytes).unwrap();
        }),
    ];
    for (name, change) in changes {
        let folder = tempfile::tempdir().unwrap();
        let results = results(folder.path());
        assert!(index(&results).is_some(), "{name}");
        assert!(Index::read(&results).is_some(), "{name}");
        change(&results);
        assert_eq!(Index::read(&results), None, "{name}");
    }
    let folder = tempfile::tempdir().unwrap();
    let results = results(folder.path());
    index(&results).unwrap();
    append(&results.index_path(), "\n");
    assert_eq!(Index::read(&results), None);
}

/// Puts a text after the first place of `before` in the index, with a valid checksum.
fn sealed(results: &Results<'_>, before: &str, more: &str) {
    let text = String::from_utf8(Disk.read(&results.index_path()).unwrap()).unwrap();
    let object = seal::open(&text).unwrap();
    assert!(object.contains(before));
    let changed = object.replacen(before, &format!("{before}{more}"), 1);
    write_atomic(&Disk, &results.index_path(), seal::seal(&changed).as_bytes()).unwrap();
}

#[test]
fn results_that_are_not_plain_have_no_index() {
    let folder = tempfile::tempdir().unwrap();
    let results = results(folder.path());
    let id = |number: u32| JobId::from_digits(&format!("{number:032x}")).unwrap();
    // A record of a job that the study does not plan.
    let record =
        Record { job: id(1), cells: Cells::new(Status::Done), file_hash: None, file_stamp: None };
    let mut writer = Writer::new(&Disk, results.journal_path());
    writer.append(&[record]).unwrap();
    assert_eq!(index(&results), None);
    writer.invalidate(&[id(1)]).unwrap();
    assert_eq!(index(&results), None, "a job that must run again");

    // A table that does not say what the journal says.
    let folder = tempfile::tempdir().unwrap();
    let results = self::results(folder.path());
    let mut table = Stored::read(results.clone()).unwrap().table();
    table.columns.pop();
    results.write_table(&table).unwrap();
    assert_eq!(index(&results), None);
}
