//! The lines of a journal: header, ended job, invalidated job.

use serde::{Deserialize, Serialize};
use serde_json::Map;

use super::Record;
use crate::input::value::Value;
use crate::job::row::{CellType, Cells, ColumnId, current_column_name};
use crate::job::{JobId, Status};
use crate::platform::provenance;

/// Name of the format, in the header.
pub const FORMAT: &str = "billow-journal";
/// Version of the format that this program writes, and the newest that it reads.
pub const VERSION: u64 = 3;

/// [`Line::kind`] of a job to run again. The line of an ended job has no kind.
const INVALIDATED: &str = "invalidated";
/// The same in version 2.
const OLD_INVALIDATED: &str = "withdrawn";

/// One line after the header.
pub enum Entry {
    /// A job ended.
    Ended(Record),
    /// A job must run again.
    Invalidated(JobId),
}

/// Why a header is refused.
pub enum HeaderError {
    /// It is not the header of a journal.
    Invalid(String),
    /// A newer program wrote the journal. The text has the next step.
    Newer(String),
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

/// Text of the header of a new journal.
pub fn header_text() -> serde_json::Result<String> {
    serde_json::to_string(&Header {
        format: FORMAT.to_owned(),
        version: VERSION,
        program_version: provenance::PROGRAM_VERSION.to_owned(),
        commit: provenance::COMMIT.to_owned(),
    })
}

/// Checks the header line.
pub fn parse_header(line: &[u8]) -> Result<(), HeaderError> {
    let header: Header = serde_json::from_slice(line)
        .map_err(|_| HeaderError::Invalid("not the header of a billow journal".to_owned()))?;
    if header.format != FORMAT {
        let problem = format!("format {:?} is not {FORMAT:?}", header.format);
        return Err(HeaderError::Invalid(problem));
    }
    if header.version > VERSION {
        return Err(HeaderError::Newer(format!(
            "journal of version {}, this program reads up to {VERSION}\n  next: use the newer billow \
             that wrote it ({})",
            header.version, header.program_version
        )));
    }
    Ok(())
}

/// Text of the line of an ended job.
pub fn ended_text(record: &Record) -> serde_json::Result<String> {
    let cells = record
        .cells
        .iter()
        .filter(|(_, value)| **value != Value::Null)
        .map(|(column, value)| (column.name.to_owned(), to_json(value)))
        .collect();
    let job = record.job.as_str().to_owned();
    serde_json::to_string(&Line { kind: None, job, file_hash: record.file_hash.clone(), cells })
}

/// Text of the line of an invalidated job: it has no file hash and no cells.
pub fn invalidated_text(job: &JobId) -> serde_json::Result<String> {
    serde_json::to_string(&serde_json::json!({ "kind": INVALIDATED, "job": job.as_str() }))
}

/// Reads a line after the header.
///
/// # Errors
/// What is wrong with it.
pub fn parse(line: &[u8]) -> Result<Entry, String> {
    let line = std::str::from_utf8(line).map_err(|_| "not UTF-8 text".to_owned())?;
    let line: Line = serde_json::from_str(line.trim_end_matches('\n')).map_err(|error| {
        // The line number of serde is always 1 here: it would look like the line of the file.
        let error = error.to_string();
        format!("not a journal record: {}", error.split(" at line ").next().unwrap_or_default())
    })?;
    let job = JobId::from_digits(&line.job)
        .ok_or_else(|| format!("{:?} is not a job id (32 hexadecimal digits)", line.job))?;
    match line.kind.as_deref() {
        None => {}
        Some(INVALIDATED | OLD_INVALIDATED) => return Ok(Entry::Invalidated(job)),
        Some(other) => return Err(format!("not a journal record: unknown kind {other:?}")),
    }
    let cells = parse_cells(&line.cells)?;
    Ok(Entry::Ended(Record { job, cells, file_hash: line.file_hash }))
}

/// Reads the cells of an ended job. Old names of columns and of the status are read.
fn parse_cells(members: &Map<String, serde_json::Value>) -> Result<Cells, String> {
    let status = ColumnId::Status.name();
    let status = match members.get(status).and_then(serde_json::Value::as_str) {
        Some(name) => Status::from_name(name).ok_or_else(|| format!("unknown status {name:?}"))?,
        None => return Err("record without a status".to_owned()),
    };
    let mut cells = Cells::new(status);
    for (name, value) in members {
        let id = ColumnId::from_name(current_column_name(name).0)
            .ok_or_else(|| format!("unknown column {name:?}"))?;
        if id == ColumnId::Status {
            continue;
        }
        let cell_type = id.column().cell_type;
        let value = from_json(cell_type, value)
            .ok_or_else(|| format!("column {name:?} cannot hold {value}"))?;
        cells.set(id, value);
    }
    Ok(cells)
}

/// JSON of a value. NaN and infinities, which JSON does not have, become text.
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

fn from_json(cell_type: CellType, value: &serde_json::Value) -> Option<Value> {
    match cell_type {
        _ if value.is_null() => Some(Value::Null),
        CellType::Bool => value.as_bool().map(Value::Bool),
        CellType::Integer => value.as_i64().map(Value::Integer),
        CellType::Number => match value.as_str() {
            Some(text @ ("NaN" | "inf" | "-inf")) => text.parse().ok().map(Value::Number),
            _ => value.as_f64().map(Value::Number),
        },
        CellType::Text => value.as_str().map(|text| Value::Text(text.to_owned())),
    }
}
