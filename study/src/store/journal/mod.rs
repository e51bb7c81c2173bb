//! The journal: which jobs of a study have ended, and with which row.
//!
//! `journal/<writer>.jsonl` holds a header line, then one line a finished job, appended and synced.
//! Every process that finishes jobs writes a file of its own, numbered upward and never reused, so
//! that no two write to one file and a line torn by a crash is always the last of its file. Where a
//! job has several lines, the one in the later file, and there the later line, counts.
//!
//! ```text
//! {"format":"billow-journal","version":2,…}
//! {"job":"<id>","file_hash":"<SHA-256 of its history file>","cells":{…}}   a finished job
//! {"kind":"withdrawn","job":"<id>"}                                        to be run again
//! ```
//!
//! Version 1 knows no `kind`; everything else is the same, and it is read.

use std::collections::BTreeMap;
use std::io;
use std::path::{Path, PathBuf};

use serde::{Deserialize, Serialize};
use serde_json::Map;

use crate::input::value::Value;
use crate::job::JobId;
use crate::job::point::Point;
use crate::job::row::{self, Cells, Kind};
use crate::platform::error::{Error, Result};
use crate::platform::files::{Append, Files, disk_error};
use crate::platform::provenance;

/// Name of the format, in the header.
const FORMAT: &str = "billow-journal";
/// Version of the format this program writes, and the newest it reads.
const VERSION: u64 = 2;

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

/// How a point ended; `None` while its job has not.
pub fn cells_of(point: &Point, records: &BTreeMap<JobId, Record>) -> Option<Cells> {
    match &point.infeasible {
        Some(infeasible) => Some(Cells::infeasible(infeasible)),
        None => records.get(&point.job.id).map(|record| record.cells.clone()),
    }
}

/// What the journals of a study hold.
#[derive(Debug, Default)]
pub struct Journal {
    /// Last record of every job that is finished.
    pub records: BTreeMap<JobId, Record>,
    /// Last record of every job that was withdrawn and has not ended again since.
    pub withdrawn: BTreeMap<JobId, Record>,
    /// Torn lines, for the user to know.
    pub notes: Vec<String>,
}

/// One line after the header.
enum Entry {
    Finished(Record),
    Withdrawn(JobId),
}

impl Journal {
    fn take(&mut self, entry: Entry) {
        match entry {
            Entry::Finished(record) => {
                self.withdrawn.remove(&record.job);
                self.records.insert(record.job.clone(), record);
            }
            Entry::Withdrawn(job) => self.withdraw(&job),
        }
    }

    /// Counts a job as not finished; its record is kept beside, to compare with.
    pub fn withdraw(&mut self, job: &JobId) {
        if let Some(record) = self.records.remove(job) {
            self.withdrawn.insert(job.clone(), record);
        }
    }
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
    #[serde(default, skip_serializing_if = "Option::is_none")]
    kind: Option<String>,
    job: String,
    #[serde(default)]
    file_hash: Option<String>,
    #[serde(default)]
    cells: Map<String, serde_json::Value>,
}

/// [`Line::kind`] of a job to be run again; a finished job has none.
const WITHDRAWN: &str = "withdrawn";

/// Reads every journal in a folder; none when the folder is not there.
///
/// # Errors
/// [`Error::Disk`] naming file and line for what is no journal of ours, or of a newer version.
pub fn read(files: &dyn Files, folder: &Path) -> Result<Journal> {
    let (journal, faults) = examine(files, folder)?;
    faults.into_iter().next().map_or(Ok(journal), Err)
}

/// Reads what can be read of every journal in a folder: what is no line of ours is told, and passed
/// over.
///
/// # Errors
/// [`Error::Disk`] when the folder cannot be listed.
pub fn examine(files: &dyn Files, folder: &Path) -> Result<(Journal, Vec<Error>)> {
    let mut journal = Journal::default();
    let mut faults = Vec::new();
    let paths = files.list(folder).map_err(|error| disk_error(folder, &error))?;
    for path in paths.iter().filter(|path| is_journal(path)) {
        match files.read(path) {
            Ok(bytes) => read_file(path, &bytes, &mut journal, &mut faults),
            Err(error) => faults.push(disk_error(path, &error)),
        }
    }
    Ok((journal, faults))
}

/// Whether a file has the name of a journal.
pub fn is_journal(path: &Path) -> bool {
    path.extension().is_some_and(|end| end == "jsonl")
}

fn read_file(path: &Path, bytes: &[u8], journal: &mut Journal, faults: &mut Vec<Error>) {
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
            "{}: line {line} is torn (the program was stopped while writing it); the job it is \
             about is run again",
            path.display()
        ));
    }
    let mut lines = bytes[..whole].split_inclusive(|byte| *byte == b'\n');
    let Some(header) = lines.next() else { return };
    if let Err(error) = read_header(path, header, &foreign) {
        faults.push(error);
        return;
    }
    for (number, line) in (2..).zip(lines) {
        match parse(line) {
            Ok(entry) => journal.take(entry),
            Err(problem) => faults.push(foreign(number, &problem)),
        }
    }
}

fn read_header(path: &Path, line: &[u8], foreign: &dyn Fn(usize, &str) -> Error) -> Result<()> {
    let header: Header = serde_json::from_slice(line)
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
    Ok(())
}

/// Number of the line that follows these bytes.
fn line_after(bytes: &[u8]) -> usize {
    bytes.split(|byte| *byte == b'\n').count()
}

fn parse(line: &[u8]) -> std::result::Result<Entry, String> {
    let line = std::str::from_utf8(line).map_err(|_| "not UTF-8 text".to_owned())?;
    let line: Line = serde_json::from_str(line.trim_end_matches('\n')).map_err(|error| {
        // Its own "at line 1" would be taken for the line of the file.
        let error = error.to_string();
        format!("not a journal record: {}", error.split(" at line ").next().unwrap_or_default())
    })?;
    let job = JobId::from_digits(&line.job)
        .ok_or_else(|| format!("{:?} is not a job id (32 hexadecimal digits)", line.job))?;
    match line.kind.as_deref() {
        None => {}
        Some(WITHDRAWN) => return Ok(Entry::Withdrawn(job)),
        Some(other) => return Err(format!("not a journal record: unknown kind {other:?}")),
    }
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
    Ok(Entry::Finished(Record { job, cells, file_hash: line.file_hash }))
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

fn finished(record: &Record) -> Line {
    let cells = record
        .cells
        .iter()
        .filter(|(_, value)| **value != Value::Null)
        .map(|(column, value)| (column.name.to_owned(), to_json(value)))
        .collect();
    let job = record.job.as_str().to_owned();
    Line { kind: None, job, file_hash: record.file_hash.clone(), cells }
}

/// A withdrawal says nothing but which job: no file hash, no cells.
fn withdrawn(job: &JobId) -> serde_json::Value {
    serde_json::json!({ "kind": WITHDRAWN, "job": job.as_str() })
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
        self.write(records.iter().map(|record| serde_json::to_string(&finished(record))))
    }

    /// Appends that these jobs count as not finished, and syncs once.
    ///
    /// # Errors
    /// As [`Self::append`].
    pub fn withdraw(&mut self, jobs: &[JobId]) -> Result<()> {
        self.write(jobs.iter().map(|job| serde_json::to_string(&withdrawn(job))))
    }

    fn write(&mut self, lines: impl Iterator<Item = serde_json::Result<String>>) -> Result<()> {
        let mut bytes = Vec::new();
        for line in lines {
            let line = line.map_err(|error| disk_error(&self.folder, &io::Error::other(error)))?;
            bytes.extend_from_slice(line.as_bytes());
            bytes.push(b'\n');
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
mod tests;
