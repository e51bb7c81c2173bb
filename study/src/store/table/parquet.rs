//! The only door to Parquet.
//!
//! The file-level key `billow` holds JSON: format, version, and the unit and meaning of every column.
//! Columns are written one after the other on the calling thread, so the bytes do not depend on
//! the machine and polars starts no threads of its own.

use std::io::Cursor;
use std::path::Path;

use polars::prelude::{
    AnyValue, Column as PolarsColumn, DataFrame, DataType, KeyValueMetadata, ParallelStrategy,
    ParquetCompression, ParquetReader, ParquetWriter, PolarsResult, SerReader,
};
use serde::{Deserialize, Serialize};

use super::{Column, Table};
use crate::input::value::Value;
use crate::job::row::Kind;
use crate::platform::error::{Error, Result};

/// Key of the file-level metadata, and name of the format in it.
const KEY: &str = "billow";
const FORMAT: &str = "billow-table";
/// Version of the format this program writes, and the newest it reads.
const VERSION: u64 = 1;

#[derive(Serialize, Deserialize)]
struct Metadata {
    format: String,
    version: u64,
    #[serde(default)]
    columns: Vec<ColumnMetadata>,
}

#[derive(Serialize, Deserialize)]
struct ColumnMetadata {
    name: String,
    unit: String,
    meaning: String,
}

/// The bytes of a table's file.
///
/// # Errors
/// What polars says, in words.
pub fn encode(table: &Table) -> std::result::Result<Vec<u8>, String> {
    let columns = table
        .columns
        .iter()
        .map(|column| ColumnMetadata {
            name: column.name.clone(),
            unit: column.unit.clone(),
            meaning: column.meaning.clone(),
        })
        .collect();
    let metadata = Metadata { format: FORMAT.to_owned(), version: VERSION, columns };
    let metadata = serde_json::to_string(&metadata).map_err(|error| error.to_string())?;
    write(table, metadata).map_err(|error| error.to_string())
}

fn write(table: &Table, metadata: String) -> PolarsResult<Vec<u8>> {
    let columns = table.columns.iter().map(to_polars).collect();
    let mut frame = DataFrame::new(table.rows(), columns)?;
    let mut bytes = Vec::new();
    ParquetWriter::new(&mut bytes)
        .with_compression(ParquetCompression::Snappy)
        .set_parallel(false)
        .with_key_value_metadata(Some(KeyValueMetadata::from_static(vec![(
            KEY.to_owned(),
            metadata,
        )])))
        .finish(&mut frame)?;
    Ok(bytes)
}

fn to_polars(column: &Column) -> PolarsColumn {
    let name = column.name.as_str().into();
    let cells = column.cells.iter();
    match column.kind {
        Kind::Bool => PolarsColumn::new(
            name,
            cells
                .map(|cell| if let Value::Bool(value) = cell { Some(*value) } else { None })
                .collect::<Vec<_>>(),
        ),
        Kind::Integer => PolarsColumn::new(
            name,
            cells
                .map(|cell| if let Value::Integer(value) = cell { Some(*value) } else { None })
                .collect::<Vec<_>>(),
        ),
        Kind::Number => PolarsColumn::new(
            name,
            cells
                .map(|cell| if let Value::Number(value) = cell { Some(*value) } else { None })
                .collect::<Vec<_>>(),
        ),
        Kind::Text => PolarsColumn::new(
            name,
            cells
                .map(|cell| if let Value::Text(value) = cell { Some(value.as_str()) } else { None })
                .collect::<Vec<_>>(),
        ),
    }
}

/// Reads a table from the bytes of its file; `path` names it in errors.
///
/// # Errors
/// [`Error::Disk`] for bytes that are damaged, foreign or of a newer version.
pub fn decode(path: &Path, bytes: &[u8]) -> Result<Table> {
    let broken = |problem: String| Error::Disk {
        path: path.to_owned(),
        problem: format!("{problem}\n  next: `billow run` of its study writes the table again"),
    };
    let mut reader = ParquetReader::new(Cursor::new(bytes)).read_parallel(ParallelStrategy::None);
    let stored = reader
        .get_metadata()
        .map_err(|error| broken(format!("no Parquet file: {error}")))?
        .key_value_metadata()
        .iter()
        .flatten()
        .find(|pair| pair.key == KEY)
        .and_then(|pair| pair.value.clone())
        .ok_or_else(|| broken("a Parquet file, but no billow table".to_owned()))?;
    let metadata: Metadata = serde_json::from_str(&stored)
        .map_err(|error| broken(format!("no billow table: {error}")))?;
    if metadata.format != FORMAT {
        return Err(broken(format!("format {:?} is not {FORMAT:?}", metadata.format)));
    }
    if metadata.version > VERSION {
        return Err(Error::Disk {
            path: path.to_owned(),
            problem: format!(
                "table of version {}, this program reads up to {VERSION}\n  next: use the newer \
                 billow that wrote it",
                metadata.version
            ),
        });
    }
    let frame = reader.finish().map_err(|error| broken(format!("damaged table: {error}")))?;
    let mut columns = Vec::with_capacity(frame.width());
    for column in frame.columns() {
        let told = metadata.columns.iter().find(|told| told.name == column.name().as_str());
        columns.push(
            from_polars(column, told)
                .map_err(|error| broken(format!("column {:?}: {error}", column.name())))?,
        );
    }
    Ok(Table { columns })
}

fn from_polars(
    column: &PolarsColumn,
    told: Option<&ColumnMetadata>,
) -> std::result::Result<Column, String> {
    let kind = match column.dtype() {
        DataType::Boolean => Kind::Bool,
        DataType::Int64 => Kind::Integer,
        DataType::Float64 => Kind::Number,
        DataType::String => Kind::Text,
        other => return Err(format!("type {other} is none of a billow table")),
    };
    let cells = (0..column.len()).map(|row| {
        Ok(match column.get(row).map_err(|error| error.to_string())? {
            AnyValue::Boolean(value) => Value::Bool(value),
            AnyValue::Int64(value) => Value::Integer(value),
            AnyValue::Float64(value) => Value::Number(value),
            AnyValue::String(value) => Value::Text(value.to_owned()),
            AnyValue::StringOwned(value) => Value::Text(value.to_string()),
            _ => Value::Null,
        })
    });
    Ok(Column {
        name: column.name().to_string(),
        kind,
        unit: told.map_or_else(String::new, |told| told.unit.clone()),
        meaning: told.map_or_else(String::new, |told| told.meaning.clone()),
        cells: cells.collect::<std::result::Result<_, String>>()?,
    })
}
