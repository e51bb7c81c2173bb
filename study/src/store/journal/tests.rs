//! Journals: what is read back, what is refused, what old versions hold.

#![expect(clippy::disallowed_methods, reason = "tests read and write files directly")]

use std::io;

use super::line::FORMAT;
use super::*;
use crate::input::value::Value;
use crate::job::Status;
use crate::job::row::ColumnId;
use crate::platform::files::Disk;
use crate::platform::files::failing::FailingFiles;

fn record(number: u32, value: f64) -> Record {
    let mut cells = Cells::new(Status::Done);
    cells.set(ColumnId::FinalVolume, value);
    cells.set(ColumnId::Steps, 7_i64);
    cells.set(ColumnId::NearThreshold, true);
    cells.set(ColumnId::Reason, "line\nbreak \"quoted\"");
    let job = JobId::from_digits(&format!("{number:032x}")).unwrap();
    Record { job, cells, file_hash: Some("00".to_owned()) }
}

fn read_back(folder: &Path) -> Journal {
    read(&Disk, folder).unwrap()
}

fn problem(folder: &Path) -> String {
    read(&Disk, folder).unwrap_err().to_string()
}

#[test]
fn records_are_read_back_bit_for_bit_and_the_last_one_counts() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("journal");
    assert!(read_back(&path).records.is_empty());
    let values = [0.1 + 0.2, 5e-324, -0.0, f64::MAX, f64::INFINITY, f64::NEG_INFINITY];
    let records: Vec<_> = (0..).zip(values).map(|(n, value)| record(n, value)).collect();
    let mut writer = Writer::new(&Disk, path.clone());
    writer.append(&records[..2]).unwrap();
    writer.append(&records[2..]).unwrap();
    let journal = read_back(&path);
    assert_eq!(journal.records.values().cloned().collect::<Vec<_>>(), records);
    for (record, value) in journal.records.values().zip(values) {
        let Value::Number(number) = record.cells.get(ColumnId::FinalVolume) else { panic!() };
        assert_eq!(number.to_bits(), value.to_bits());
    }

    Writer::new(&Disk, path.clone()).append(&[record(0, 9.0)]).unwrap();
    Writer::new(&Disk, path.clone()).append(&[record(0, f64::NAN)]).unwrap();
    let journal = read_back(&path);
    let Value::Number(number) =
        journal.records[&record(0, 0.0).job].cells.get(ColumnId::FinalVolume)
    else {
        panic!()
    };
    assert!(number.is_nan());
    assert_eq!(Disk.list(&path).unwrap().len(), 3, "one file per writer");
}

#[test]
fn a_torn_line_loses_only_itself_and_gives_a_note() {
    let folder = tempfile::tempdir().unwrap();
    Writer::new(&Disk, folder.path().to_owned()).append(&[record(1, 1.0), record(2, 2.0)]).unwrap();
    let path = Disk.list(folder.path()).unwrap().remove(0);
    let bytes = Disk.read(&path).unwrap();
    let ends: Vec<usize> =
        (0..bytes.len()).filter(|index| bytes[*index] == b'\n').map(|index| index + 1).collect();
    for length in 0..bytes.len() {
        std::fs::write(&path, &bytes[..length]).unwrap();
        let journal = read_back(folder.path());
        let kept = ends.iter().filter(|end| **end <= length).count().saturating_sub(1);
        assert_eq!(journal.records.len(), kept, "cut at {length}");
        let torn = length > 0 && !ends.contains(&length);
        assert_eq!(journal.notes.len(), usize::from(torn), "cut at {length}");
    }
}

#[test]
fn an_invalid_journal_is_refused_with_file_and_line() {
    let folder = tempfile::tempdir().unwrap();
    Writer::new(&Disk, folder.path().to_owned()).append(&[record(1, 1.0)]).unwrap();
    let path = Disk.list(folder.path()).unwrap().remove(0);
    let valid = String::from_utf8(Disk.read(&path).unwrap()).unwrap();
    let broken = |text: String, expected: &str| {
        std::fs::write(&path, text).unwrap();
        let problem = problem(folder.path());
        assert!(problem.contains(expected), "{problem}");
        assert!(problem.contains("000001.jsonl"), "{problem}");
    };
    broken(valid.replacen("\"version\":3", "\"version\":4", 1), "version 4, this program reads");
    broken(valid.replacen(FORMAT, "other", 1), "line 1: format \"other\"");
    broken(format!("hello\n{valid}"), "line 1: not the header");
    broken(format!("{valid}hello\n"), "line 3: not a journal record");
    broken(valid.replacen("00000001", "0000000g", 1), "line 2: \"0000000000000000000000000000000g");
    broken(valid.replacen("final_volume", "final_colour", 1), "unknown column \"final_colour\"");
    broken(
        valid.replacen("\"status\":\"done\"", "\"status\":\"ready\"", 1),
        "unknown status \"ready\"",
    );
    broken(valid.replacen("\"steps\":7", "\"steps\":\"x\"", 1), "\"steps\" cannot hold \"x\"");
    std::fs::write(&path, [valid.as_bytes(), b"\xff\n"].concat()).unwrap();
    assert!(problem(folder.path()).contains("line 3: not UTF-8"));
}

#[test]
fn a_failing_disk_does_not_lose_an_acknowledged_record() {
    for nth in 1.. {
        let folder = tempfile::tempdir().unwrap();
        let failing = FailingFiles::new(nth, io::ErrorKind::StorageFull);
        let mut writer = Writer::new(&failing, folder.path().join("journal"));
        let acknowledged = (0..4).take_while(|n| writer.append(&[record(*n, 1.0)]).is_ok()).count();
        let journal = read_back(&folder.path().join("journal"));
        assert_eq!(journal.records.len(), acknowledged, "operation {nth}");
        if acknowledged == 4 {
            assert!(nth > 7, "only {nth} operations");
            return;
        }
    }
}

#[test]
fn an_invalidated_job_counts_as_not_ended_until_it_ends_again() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("journal");
    let id = |number| record(number, 0.0).job;
    Writer::new(&Disk, path.clone()).append(&[record(1, 1.0), record(2, 2.0)]).unwrap();
    let mut writer = Writer::new(&Disk, path.clone());
    writer.invalidate(&[id(1), id(7)]).unwrap();
    let journal = read_back(&path);
    assert_eq!(journal.records.keys().cloned().collect::<Vec<_>>(), [id(2)]);
    assert_eq!(journal.invalidated[&id(1)], record(1, 1.0), "kept for comparison");
    assert!(!journal.invalidated.contains_key(&id(7)), "it had no record");
    writer.append(&[record(1, 3.0)]).unwrap();
    let journal = read_back(&path);
    assert_eq!(journal.records[&id(1)], record(1, 3.0));
    assert!(journal.invalidated.is_empty());
}

#[test]
fn version_1_is_read() {
    let folder = tempfile::tempdir().unwrap();
    let text = format!(
        "{{\"format\":\"billow-journal\",\"version\":1}}\n\
         {{\"job\":\"{:032x}\",\"file_hash\":null,\"cells\":{{\"status\":\"done\"}}}}\n",
        5
    );
    std::fs::write(folder.path().join("000001.jsonl"), text).unwrap();
    let journal = read_back(folder.path());
    assert_eq!(journal.records[&record(5, 0.0).job].cells.status(), Status::Done);
}

#[test]
fn version_2_is_read_with_its_old_names() {
    let folder = tempfile::tempdir().unwrap();
    let text = format!(
        "{{\"format\":\"billow-journal\",\"version\":2}}\n\
         {{\"job\":\"{0:032x}\",\"cells\":{{\"status\":\"drifted\",\"stop_place\":\"gas\"}}}}\n\
         {{\"job\":\"{1:032x}\",\"cells\":{{\"status\":\"done\",\"close\":true}}}}\n\
         {{\"kind\":\"withdrawn\",\"job\":\"{1:032x}\"}}\n",
        5, 6
    );
    std::fs::write(folder.path().join("000001.jsonl"), text).unwrap();
    let journal = read_back(folder.path());
    let drifting = &journal.records[&record(5, 0.0).job].cells;
    assert_eq!(drifting.status().name(), "energy_drift");
    assert_eq!(drifting.text(ColumnId::StopLocation), "gas");
    let invalidated = &journal.invalidated[&record(6, 0.0).job].cells;
    assert_eq!(*invalidated.get(ColumnId::NearThreshold), Value::Bool(true));
}

#[test]
fn valid_lines_are_read_between_invalid_ones() {
    let folder = tempfile::tempdir().unwrap();
    Writer::new(&Disk, folder.path().to_owned()).append(&[record(1, 1.0), record(2, 2.0)]).unwrap();
    let path = Disk.list(folder.path()).unwrap().remove(0);
    let text = String::from_utf8(Disk.read(&path).unwrap()).unwrap();
    let mut lines: Vec<&str> = text.lines().collect();
    lines.insert(2, "hello");
    lines.push("{\"kind\":\"forgotten\",\"job\":\"00000000000000000000000000000001\"}");
    std::fs::write(&path, lines.join("\n") + "\n").unwrap();
    std::fs::write(folder.path().join("000002.jsonl"), "{}\n").unwrap();
    let (journal, faults) = examine(&Disk, folder.path()).unwrap();
    assert_eq!(journal.records.len(), 2);
    let faults: Vec<String> = faults.iter().map(ToString::to_string).collect();
    assert_eq!(faults.len(), 3, "{faults:?}");
    assert!(faults[0].contains("000001.jsonl: line 3: not a journal record"), "{faults:?}");
    assert!(faults[1].contains("line 5: not a journal record: unknown kind \"forgotten\""));
    assert!(faults[2].contains("000002.jsonl: line 1: not the header"), "{faults:?}");
}
