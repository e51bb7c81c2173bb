//! Journals: what is read back, what is refused.

#![expect(clippy::disallowed_methods, reason = "tests read and write files directly")]

use std::io;

use billow_solver::platform::seal;

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
    Record { job, cells, file_hash: Some("00".to_owned()), file_stamp: None }
}

fn read_back(folder: &Path) -> Journal {
    read(&Disk, folder).unwrap()
}

fn faults(folder: &Path) -> Vec<String> {
    read_back(folder).faults.iter().map(ToString::to_string).collect()
}

/// The lines of a journal with two records, each with its end.
fn lines_of_two(folder: &Path) -> (PathBuf, Vec<String>) {
    Writer::new(&Disk, folder.to_owned()).append(&[record(1, 1.0), record(2, 2.0)]).unwrap();
    let path = Disk.list(folder).unwrap().remove(0);
    let text = String::from_utf8(Disk.read(&path).unwrap()).unwrap();
    (path, text.split_inclusive('\n').map(str::to_owned).collect())
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
        assert_eq!(journal.faults.len(), usize::from(torn), "cut at {length}");
        assert!(journal.faults.iter().all(|fault| fault.torn), "cut at {length}");
    }
}

#[test]
fn a_line_that_is_not_valid_costs_its_own_record_only() {
    let folder = tempfile::tempdir().unwrap();
    let (path, lines) = lines_of_two(folder.path());
    let [header, first, second] = &lines[..] else { panic!("{lines:?}") };
    let broken = |text: String, expected: &str, kept: usize| {
        std::fs::write(&path, text).unwrap();
        let found = faults(folder.path());
        assert!(found.len() == 1 && found[0].contains(expected), "{expected}: {found:?}");
        assert!(found[0].contains("000001.jsonl: line "), "{found:?}");
        assert_eq!(read_back(folder.path()).records.len(), kept, "{expected}");
    };
    let changed = "does not have the contents of its checksum";
    let edited = first.replacen("\"final_volume\":1.0", "\"final_volume\":9.0", 1);
    assert_ne!(&edited, first);
    broken(format!("{header}{edited}{second}"), changed, 1);
    broken(format!("{header}{first}hello\n{second}"), "line 3: it has no checksum", 2);
    broken(format!("{}{first}{second}", header.replacen(FORMAT, "other", 1)), changed, 2);
    broken(format!("hello\n{first}{second}"), "line 1: it has no checksum", 2);
    broken(format!("{first}{second}"), "line 1: not the header", 1);
    let record = "{\"job\":\"00000000000000000000000000000007\",\"cells\":{\"status\":\"done\"}}\n";
    broken(format!("{header}{first}{record}{second}"), "line 3: it has no checksum", 2);
    std::fs::write(&path, [header.as_bytes(), b"\xff\n", second.as_bytes()].concat()).unwrap();
    assert!(faults(folder.path())[0].contains("line 2: not UTF-8"));
}

#[test]
fn every_flipped_bit_of_a_journal_is_found_or_changes_nothing() {
    let folder = tempfile::tempdir().unwrap();
    let (path, _) = lines_of_two(folder.path());
    let bytes = Disk.read(&path).unwrap();
    let whole = read_back(folder.path()).records;
    for index in 0..bytes.len() {
        let mut changed = bytes.clone();
        changed[index] ^= 1 << (index % 8);
        std::fs::write(&path, &changed).unwrap();
        let journal = read_back(folder.path());
        assert!(!journal.faults.is_empty(), "byte {index}");
        assert!(journal.records.iter().all(|(id, record)| whole[id] == *record), "byte {index}");
        assert!(journal.records.len() + 2 >= whole.len(), "byte {index}");
    }
}

#[test]
fn a_mended_journal_has_its_valid_lines_and_the_damaged_file_is_kept() {
    let folder = tempfile::tempdir().unwrap();
    let (journal, kept) = (folder.path().join("journal"), folder.path().join("damaged"));
    let (path, lines) = lines_of_two(&journal);
    let damaged =
        format!("{}{}{}", lines[0].replacen("billow", "bellow", 1), &lines[1][1..], lines[2]);
    for (text, copies) in [(damaged.clone(), 1), (lines.concat() + "{\"che", 1), (damaged, 2)] {
        std::fs::write(&path, &text).unwrap();
        let found = read_back(&journal);
        let records = found.records.len();
        assert_eq!(mend(&Disk, &found.faults, &kept).unwrap(), std::slice::from_ref(&path));
        let mended = read_back(&journal);
        assert!(mended.faults.is_empty(), "{:?}", mended.faults);
        assert_eq!(mended.records.len(), records);
        assert_eq!(Disk.list(&kept).unwrap().len(), copies);
    }
}

#[test]
fn lines_are_checked_for_their_meaning() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("000001.jsonl");
    let header = super::line::header_text().unwrap() + "\n";
    let line = "{\"job\":\"00000000000000000000000000000001\",\"cells\":{\"status\":\"done\",\
                \"final_volume\":1.0,\"steps\":7}}";
    let broken = |old: &str, new: &str, expected: &str| {
        let line = seal::seal(&line.replacen(old, new, 1)) + "\n";
        std::fs::write(&path, format!("{header}{line}")).unwrap();
        let found = faults(folder.path());
        assert!(found.len() == 1 && found[0].contains(expected), "{expected}: {found:?}");
    };
    broken("00000001", "0000000g", "line 2: \"0000000000000000000000000000000g");
    broken("final_volume", "final_colour", "unknown column \"final_colour\"");
    broken("done", "ready", "unknown status \"ready\"");
    broken("\"steps\":7", "\"steps\":\"x\"", "\"steps\" cannot hold \"x\"");
    let kind = "{\"kind\":\"forgotten\",\"job\"";
    broken("{\"job\"", kind, "not a journal record: unknown kind \"forgotten\"");
    std::fs::write(&path, header + &seal::seal(line) + "\n").unwrap();
    assert!(faults(folder.path()).is_empty());
}

#[test]
fn a_journal_of_another_version_is_refused() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("000001.jsonl");
    for version in [6, 8] {
        let header = format!("{{\"format\":\"billow-journal\",\"version\":{version}}}");
        std::fs::write(&path, seal::seal(&header) + "\n").unwrap();
        let problem = read(&Disk, folder.path()).unwrap_err().to_string();
        let expected = format!("version {version}, this program reads version 7");
        assert!(problem.contains(&expected), "{problem}");
    }
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
