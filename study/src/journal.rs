//! The journal: which jobs of a study have ended, and with which row.
//!
//! `journal/<writer>.jsonl` holds a header line, then one line a finished job, appended and synced.
//! Every process that finishes jobs writes a file of its own, numbered upward and never reused, so
//! that no two write to one file and a line torn by a crash is always the last of its file. Where a
//! job has several records, the one in the later file, and there the later line, counts.

use std::collections::BTreeMap;
use std::io;
use std::path::{Path, PathBuf};

use serde::{Deserialize, Serialize};
use serde_json::Map;

use crate::error::{Error, Result};
use crate::files::{Append, Files, disk_error};
use crate::job::JobId;
use crate::provenance;
use crate::row::{self, Cells, Kind};
use crate::value::Value;

/// Name of the format, in the header.
const FORMAT: &str = "billow-journal";
/// Version of the format this program writes, and the newest it reads.
const VERSION: u64 = 1;

/// A finished job.
#[derive(Debug, Clone, PartialEq)]
pub struct Record {
    /// Its name.
    pub job: JobId,
    /// Its row.
    pub cells: Cells,
    /// SHA-256 of the bytes of its history file; `None` for a job that left none.
    pub file_hash: Option<String>,
}

/// What the journals of a study hold.
#[derive(Debug, Default)]
pub struct Journal {
    /// Last record of every job.
    pub records: BTreeMap<JobId, Record>,
    /// Torn lines, for the user to know.
    pub notes: Vec<String>,
}

#[derive(Serialize, Deserialize)]
struct Header {
    format: String,
    version: u64,
    #[serde(default)]
    program_version: String,
    #[serde(default)]
    commit: String,
}

#[derive(Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
struct Line {
    job: String,
    file_hash: Option<String>,
    cells: Map<String, serde_json::Value>,
}

/// Reads every journal in a folder; none when the folder is not there.
///
/// # Errors
/// [`Error::Disk`] naming file and line for what is no journal of ours, or of a newer version.
pub fn read(files: &dyn Files, folder: &Path) -> Result<Journal> {
    let mut journal = Journal::default();
    let paths = files.list(folder).map_err(|error| disk_error(folder, &error))?;
    for path in paths.iter().filter(|path| path.extension().is_some_and(|end| end == "jsonl")) {
        let bytes = files.read(path).map_err(|error| disk_error(path, &error))?;
        read_file(path, &bytes, &mut journal)?;
    }
    Ok(journal)
}

fn read_file(path: &Path, bytes: &[u8], journal: &mut Journal) -> Result<()> {
    let foreign = |number: usize, problem: &str| Error::Disk {
        path: path.to_owned(),
        problem: format!(
            "line {number}: {problem}\n  next: restore the file from a copy, or move it away; \
             jobs it recorded are then run again"
        ),
    };
    let whole = bytes.iter().rposition(|byte| *byte == b'\n').map_or(0, |last| last + 1);
    if whole < bytes.len() {
        let line = line_after(&bytes[..whole]);
        journal.notes.push(format!(
            "{}: line {line} is torn (the program was stopped while writing it); its job is run again",
            path.display()
        ));
    }
    let text = std::str::from_utf8(&bytes[..whole]).map_err(|error| {
        let line = line_after(&bytes[..error.valid_up_to()]);
        foreign(line, "not UTF-8 text")
    })?;
    let mut lines = text.lines();
    let Some(header) = lines.next() else { return Ok(()) };
    let header: Header = serde_json::from_str(header)
        .map_err(|_| foreign(1, "not the header of a billow journal"))?;
    if header.format != FORMAT {
        return Err(foreign(1, &format!("format {:?} is not {FORMAT:?}", header.format)));
    }
    if header.version > VERSION {
        return Err(Error::Disk {
            path: path.to_owned(),
            problem: format!(
                "journal of version {}, this program reads up to {VERSION}\n  next: use the newer \
                 billow that wrote it ({})",
                header.version, header.program_version
            ),
        });
    }
    for (number, line) in (2..).zip(lines) {
        let record = parse(line).map_err(|problem| foreign(number, &problem))?;
        journal.records.insert(record.job.clone(), record);
    }
    Ok(())
}

/// Number of the line that follows these bytes.
fn line_after(bytes: &[u8]) -> usize {
    bytes.split(|byte| *byte == b'\n').count()
}

fn parse(line: &str) -> std::result::Result<Record, String> {
    let line: Line =
        serde_json::from_str(line).map_err(|error| format!("not a journal record: {error}"))?;
    let job = JobId::from_digits(&line.job)
        .ok_or_else(|| format!("{:?} is not a job id (32 hexadecimal digits)", line.job))?;
    let mut cells = Cells::new("");
    for (name, value) in &line.cells {
        let kind = row::index(name)
            .map(|index| row::COLUMNS[index].kind)
            .ok_or_else(|| format!("unknown column {name:?}"))?;
        let value =
            from_json(kind, value).ok_or_else(|| format!("column {name:?} cannot hold {value}"))?;
        cells.set(name, value);
    }
    if cells.status().is_empty() {
        return Err("record without a status".to_owned());
    }
    Ok(Record { job, cells, file_hash: line.file_hash })
}

/// Numbers JSON has no digits for are kept as text.
fn to_json(value: &Value) -> serde_json::Value {
    match value {
        Value::Null => serde_json::Value::Null,
        Value::Bool(value) => (*value).into(),
        Value::Integer(value) => (*value).into(),
        Value::Number(value) if value.is_finite() => (*value).into(),
        Value::Number(value) => value.to_string().into(),
        Value::Text(value) => value.as_str().into(),
    }
}

fn from_json(kind: Kind, value: &serde_json::Value) -> Option<Value> {
    match kind {
        _ if value.is_null() => Some(Value::Null),
        Kind::Bool => value.as_bool().map(Value::Bool),
        Kind::Integer => value.as_i64().map(Value::Integer),
        Kind::Number => match value.as_str() {
            Some(text @ ("NaN" | "inf" | "-inf")) => text.parse().ok().map(Value::Number),
            _ => value.as_f64().map(Value::Number),
        },
        Kind::Text => value.as_str().map(|text| Value::Text(text.to_owned())),
    }
}

fn encode(record: &Record) -> serde_json::Result<String> {
    let cells = record
        .cells
        .iter()
        .filter(|(_, value)| **value != Value::Null)
        .map(|(column, value)| (column.name.to_owned(), to_json(value)))
        .collect();
    let line =
        Line { job: record.job.as_str().to_owned(), file_hash: record.file_hash.clone(), cells };
    serde_json::to_string(&line).map(|text| text + "\n")
}

/// Appends the records of one process. Its file comes into being with the first record.
pub struct Writer<'a> {
    files: &'a dyn Files,
    folder: PathBuf,
    open: Option<(PathBuf, Box<dyn Append>)>,
}

impl<'a> Writer<'a> {
    /// A writer into that folder.
    pub fn new(files: &'a dyn Files, folder: PathBuf) -> Self {
        Self { files, folder, open: None }
    }

    /// Appends records and syncs once. After an error the writer leaves its file, whose last line
    /// may be torn, and would go on in a new one.
    ///
    /// # Errors
    /// [`Error::Disk`]; none of these records then counts as written.
    pub fn append(&mut self, records: &[Record]) -> Result<()> {
        let mut bytes = Vec::new();
        for record in records {
            let line = encode(record)
                .map_err(|error| disk_error(&self.folder, &io::Error::other(error)))?;
            bytes.extend_from_slice(line.as_bytes());
        }
        let (path, mut file) = match self.open.take() {
            Some(open) => open,
            None => self.create()?,
        };
        file.append(&bytes).map_err(|error| disk_error(&path, &error))?;
        self.open = Some((path, file));
        Ok(())
    }

    fn create(&self) -> Result<(PathBuf, Box<dyn Append>)> {
        let at = |path: &Path, error: io::Error| disk_error(path, &error);
        self.files.create_folder(&self.folder).map_err(|error| at(&self.folder, error))?;
        let paths = self.files.list(&self.folder).map_err(|error| at(&self.folder, error))?;
        let last = paths
            .iter()
            .filter_map(|path| path.file_stem()?.to_str()?.parse::<u64>().ok())
            .max()
            .unwrap_or(0);
        for number in last + 1.. {
            let path = self.folder.join(format!("{number:06}.jsonl"));
            match self.files.create_append(&path) {
                Ok(mut file) => {
                    let header = Header {
                        format: FORMAT.to_owned(),
                        version: VERSION,
                        program_version: provenance::PROGRAM_VERSION.to_owned(),
                        commit: provenance::COMMIT.to_owned(),
                    };
                    let mut line = serde_json::to_string(&header)
                        .map_err(|error| at(&path, io::Error::other(error)))?;
                    line.push('\n');
                    file.append(line.as_bytes()).map_err(|error| at(&path, error))?;
                    self.files
                        .sync_folder(&self.folder)
                        .map_err(|error| at(&self.folder, error))?;
                    return Ok((path, file));
                }
                // Another process took this number between the look and the try.
                Err(error) if error.kind() == io::ErrorKind::AlreadyExists => {}
                Err(error) => return Err(at(&path, error)),
            }
        }
        unreachable!("there are more numbers than files")
    }
}

#[cfg(test)]
#[expect(clippy::disallowed_methods, reason = "looks at the disk with its own eyes")]
mod tests {
    use super::*;
    use crate::files::Disk;
    use crate::files::failing::FailingFiles;

    fn record(number: u32, value: f64) -> Record {
        let mut cells = Cells::new("done");
        cells.set("final_volume", value);
        cells.set("steps", 7_i64);
        cells.set("close", true);
        cells.set("reason", "line\nbreak \"quoted\"");
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
    fn records_come_back_to_the_bit_and_the_last_one_counts() {
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
            let Value::Number(number) = record.cells.get("final_volume") else { panic!() };
            assert_eq!(number.to_bits(), value.to_bits());
        }

        Writer::new(&Disk, path.clone()).append(&[record(0, 9.0)]).unwrap();
        Writer::new(&Disk, path.clone()).append(&[record(0, f64::NAN)]).unwrap();
        let journal = read_back(&path);
        let Value::Number(number) = journal.records[&record(0, 0.0).job].cells.get("final_volume")
        else {
            panic!()
        };
        assert!(number.is_nan());
        assert_eq!(Disk.list(&path).unwrap().len(), 3, "one file a writer");
    }

    #[test]
    fn a_line_torn_anywhere_costs_only_that_line_and_is_told() {
        let folder = tempfile::tempdir().unwrap();
        Writer::new(&Disk, folder.path().to_owned())
            .append(&[record(1, 1.0), record(2, 2.0)])
            .unwrap();
        let path = Disk.list(folder.path()).unwrap().remove(0);
        let whole = Disk.read(&path).unwrap();
        let ends: Vec<usize> =
            (0..whole.len()).filter(|at| whole[*at] == b'\n').map(|at| at + 1).collect();
        for length in 0..whole.len() {
            std::fs::write(&path, &whole[..length]).unwrap();
            let journal = read_back(folder.path());
            let kept = ends.iter().filter(|end| **end <= length).count().saturating_sub(1);
            assert_eq!(journal.records.len(), kept, "cut at {length}");
            let torn = length > 0 && !ends.contains(&length);
            assert_eq!(journal.notes.len(), usize::from(torn), "cut at {length}");
        }
    }

    #[test]
    fn what_is_no_journal_of_ours_is_refused_by_file_and_line() {
        let folder = tempfile::tempdir().unwrap();
        Writer::new(&Disk, folder.path().to_owned()).append(&[record(1, 1.0)]).unwrap();
        let path = Disk.list(folder.path()).unwrap().remove(0);
        let sound = String::from_utf8(Disk.read(&path).unwrap()).unwrap();
        let broken = |text: String, expected: &str| {
            std::fs::write(&path, text).unwrap();
            let problem = problem(folder.path());
            assert!(problem.contains(expected), "{problem}");
            assert!(problem.contains("000001.jsonl"), "{problem}");
        };
        broken(
            sound.replacen("\"version\":1", "\"version\":2", 1),
            "version 2, this program reads",
        );
        broken(sound.replacen(FORMAT, "other", 1), "line 1: format \"other\"");
        broken(format!("hello\n{sound}"), "line 1: not the header");
        broken(format!("{sound}hello\n"), "line 3: not a journal record");
        broken(
            sound.replacen("00000001", "0000000g", 1),
            "line 2: \"0000000000000000000000000000000g",
        );
        broken(
            sound.replacen("final_volume", "final_colour", 1),
            "unknown column \"final_colour\"",
        );
        broken(sound.replacen("\"steps\":7", "\"steps\":\"x\"", 1), "\"steps\" cannot hold \"x\"");
        std::fs::write(&path, [sound.as_bytes(), b"\xff\n"].concat()).unwrap();
        assert!(problem(folder.path()).contains("line 3: not UTF-8"));
    }

    #[test]
    fn a_failing_disk_never_loses_a_record_that_was_acknowledged() {
        for nth in 1.. {
            let folder = tempfile::tempdir().unwrap();
            let failing = FailingFiles::new(nth, io::ErrorKind::StorageFull);
            let mut writer = Writer::new(&failing, folder.path().join("journal"));
            let acknowledged =
                (0..4).take_while(|n| writer.append(&[record(*n, 1.0)]).is_ok()).count();
            let journal = read_back(&folder.path().join("journal"));
            assert_eq!(journal.records.len(), acknowledged, "operation {nth}");
            if acknowledged == 4 {
                assert!(nth > 7, "only {nth} operations");
                return;
            }
        }
    }
}
