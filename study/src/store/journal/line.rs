//! The lines of a journal: header, ended job, invalidated job, what is known of attempts, study.

use std::borrow::Cow;
use std::fmt;

use billow_solver::platform::seal;
use serde::de::{Error as _, MapAccess, Visitor};
use serde::{Deserialize, Deserializer, Serialize};
use serde_json::{Map, json};

use super::{Death, Record};
use crate::input::value::Value;
use crate::job::row::{COLUMNS, CellType, Cells, ColumnId};
use crate::job::{JobId, Status};
use crate::platform::files::Stamp;
use crate::platform::provenance;

/// Name of the format, in the header.
pub const FORMAT: &str = "billow-journal";
/// Version of the format. Others are refused.
pub const VERSION: u64 = 7;

/// [`Line::kind`] of a job to run again. The line of an ended job has no kind.
const INVALIDATED: &str = "invalidated";
/// The process died while a job ran.
const DIED: &str = "died";
/// A job stored a checkpoint: its earlier deaths do not count.
const PROGRESSED: &str = "progressed";
/// The text of study.json.
const STUDY: &str = "study";

/// One line after the header.
pub enum Entry {
    /// A job ended.
    Ended(Box<Record>),
    /// A job must run again.
    Invalidated(JobId),
    /// The process died while a job ran.
    Died(Death),
    /// A job stored a checkpoint.
    Progressed(JobId),
    /// The study of the folder: the text of study.json.
    Study(String),
}

/// Why a header is refused.
pub enum HeaderError {
    /// It is not the header of a journal.
    Invalid(String),
    /// It has another version. The text has the next step.
    Version(String),
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

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
struct Line {
    #[serde(default)]
    kind: Option<String>,
    #[serde(default)]
    job: String,
    #[serde(default)]
    file_hash: Option<String>,
    #[serde(default)]
    file_size: Option<u64>,
    #[serde(default)]
    file_time: Option<String>,
    #[serde(default, deserialize_with = "read_cells")]
    cells: Option<Cells>,
    #[serde(default)]
    process: String,
    #[serde(default)]
    alone: bool,
    #[serde(default)]
    text: String,
}

/// A value as the text of a line, sealed.
fn line_text(line: &impl Serialize) -> serde_json::Result<String> {
    Ok(seal::seal(&serde_json::to_string(line)?))
}

/// Text of the header of a new journal.
pub fn header_text() -> serde_json::Result<String> {
    line_text(&Header {
        format: FORMAT.to_owned(),
        version: VERSION,
        program_version: provenance::PROGRAM_VERSION.to_owned(),
        commit: provenance::COMMIT.to_owned(),
    })
}

/// The object of a line, without its checksum.
fn object(line: &[u8]) -> Result<String, String> {
    let text = std::str::from_utf8(line).map_err(|_| "not UTF-8 text".to_owned())?;
    let text = text.strip_suffix('\n').unwrap_or(text);
    seal::open(text).map_err(|error| error.to_string())
}

/// Checks the header line.
pub fn check_header(line: &[u8]) -> Result<(), HeaderError> {
    let invalid = |problem: String| Err(HeaderError::Invalid(problem));
    let header = match object(line).map(|text| serde_json::from_str::<Header>(&text)) {
        Ok(Ok(header)) => header,
        Ok(Err(_)) => return invalid("not the header of a billow journal".to_owned()),
        Err(problem) => return invalid(problem),
    };
    if header.format != FORMAT {
        return invalid(format!("format {:?} is not {FORMAT:?}", header.format));
    }
    if header.version != VERSION {
        return Err(HeaderError::Version(format!(
            "journal of version {}, this program reads version {VERSION}\n  next: use the billow that wrote it \
             ({}), or run the study into another folder (--results)",
            header.version, header.program_version
        )));
    }
    Ok(())
}

/// Text of the line of an ended job.
pub fn ended_text(record: &Record) -> serde_json::Result<String> {
    let present = record.cells.iter().filter(|(_, value)| **value != Value::Null);
    let cells: Map<String, serde_json::Value> =
        present.map(|(column, value)| (column.name.to_owned(), to_json(value))).collect();
    let mut line = json!({ "job": record.job.as_str(), "cells": cells });
    if let Some(hash) = &record.file_hash {
        line["file_hash"] = hash.as_str().into();
    }
    if let Some(Stamp { size, modified }) = &record.file_stamp {
        line["file_size"] = (*size).into();
        line["file_time"] = modified.as_str().into();
    }
    line_text(&line)
}

/// Text of the line of an invalidated job: it has no file hash and no cells.
pub fn invalidated_text(job: &JobId) -> serde_json::Result<String> {
    line_text(&json!({ "kind": INVALIDATED, "job": job.as_str() }))
}

/// Text of the line of a job that stored a checkpoint.
pub fn progressed_text(job: &JobId) -> serde_json::Result<String> {
    line_text(&json!({ "kind": PROGRESSED, "job": job.as_str() }))
}

/// Text of the line of a job whose process died.
pub fn died_text(death: &Death) -> serde_json::Result<String> {
    let Death { job, process, alone } = death;
    line_text(&json!({ "kind": DIED, "job": job.as_str(), "process": process, "alone": alone }))
}

/// Text of the line with the text of study.json.
pub fn study_text(text: &str) -> serde_json::Result<String> {
    line_text(&json!({ "kind": STUDY, "text": text }))
}

/// Reads a line after the header.
///
/// # Errors
/// What is wrong with it.
pub fn parse(line: &[u8]) -> Result<Entry, String> {
    let line: Line = serde_json::from_str(&object(line)?).map_err(|error| {
        // The line number of serde is always 1 here: it would look like the line of the file.
        let error = error.to_string();
        format!("not a journal record: {}", error.split(" at line ").next().unwrap_or_default())
    })?;
    let job = || {
        JobId::from_digits(&line.job)
            .ok_or_else(|| format!("{:?} is not a job id (32 hexadecimal digits)", line.job))
    };
    match line.kind.as_deref() {
        None => {}
        Some(INVALIDATED) => return Ok(Entry::Invalidated(job()?)),
        Some(PROGRESSED) => return Ok(Entry::Progressed(job()?)),
        Some(DIED) => {
            let death = Death { job: job()?, process: line.process, alone: line.alone };
            return Ok(Entry::Died(death));
        }
        Some(STUDY) => return Ok(Entry::Study(line.text)),
        Some(other) => return Err(format!("not a journal record: unknown kind {other:?}")),
    }
    let cells = line.cells.ok_or_else(|| "record without a status".to_owned())?;
    let stamp = |(size, modified)| Stamp { size, modified };
    Ok(Entry::Ended(Box::new(Record {
        job: job()?,
        cells,
        file_hash: line.file_hash,
        file_stamp: line.file_size.zip(line.file_time).map(stamp),
    })))
}

/// Reads the cells of an ended job, straight from the text: a large study has millions.
fn read_cells<'de, D: Deserializer<'de>>(members: D) -> Result<Option<Cells>, D::Error> {
    struct Members;
    impl<'de> Visitor<'de> for Members {
        type Value = Cells;

        fn expecting(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
            f.write_str("the cells of a job")
        }

        fn visit_map<A: MapAccess<'de>>(self, mut members: A) -> Result<Cells, A::Error> {
            let mut values = Vec::with_capacity(COLUMNS.len());
            let mut status = None;
            while let Some((name, value)) =
                members.next_entry::<Cow<'_, str>, serde_json::Value>()?
            {
                let id = ColumnId::from_name(&name)
                    .ok_or_else(|| A::Error::custom(format!("unknown column {name:?}")))?;
                if id == ColumnId::Status {
                    let name = value.as_str().unwrap_or_default();
                    let known = Status::from_name(name);
                    let unknown = || A::Error::custom(format!("unknown status {name:?}"));
                    status = Some(known.ok_or_else(unknown)?);
                }
                let value = from_json(id.column().cell_type, value).map_err(|value| {
                    A::Error::custom(format!("column {name:?} cannot hold {value}"))
                })?;
                values.push((id, value));
            }
            let status = status.ok_or_else(|| A::Error::custom("record without a status"))?;
            Ok(Cells::with(status, values))
        }
    }
    members.deserialize_map(Members).map(Some)
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

/// The value of a cell of this type; the JSON itself where it is none.
fn from_json(
    cell_type: CellType,
    value: serde_json::Value,
) -> std::result::Result<Value, serde_json::Value> {
    use serde_json::Value as Json;
    let read = match (cell_type, &value) {
        (_, Json::Null) => Some(Value::Null),
        (CellType::Bool, Json::Bool(value)) => Some(Value::Bool(*value)),
        (CellType::Integer, Json::Number(value)) => value.as_i64().map(Value::Integer),
        (CellType::Number, Json::Number(value)) => value.as_f64().map(Value::Number),
        (CellType::Number, Json::String(text)) if ["NaN", "inf", "-inf"].contains(&&**text) => {
            text.parse().ok().map(Value::Number)
        }
        (CellType::Text, Json::String(_)) => None,
        _ => return Err(value),
    };
    match (read, value) {
        (Some(read), _) => Ok(read),
        (None, Json::String(text)) => Ok(Value::Text(text)),
        (None, other) => Err(other),
    }
}
