//! Reads and writes Parquet; no other module does.
//!
//! The file-level key `billow` holds JSON: format, version, and the unit and meaning of every column.
//! Columns are written one after the other on the calling thread. So the bytes do not depend on the
//! machine, and polars starts no threads.
//!
//! The metadata have a checksum of names and cells too.

use std::io::Cursor;
use std::path::Path;

use billow_solver::platform::seal::hexadecimal;
use polars::prelude::{
    AnyValue, Column as PolarsColumn, DataFrame, DataType, KeyValueMetadata, ParallelStrategy,
    ParquetCompression, ParquetReader, ParquetWriter, PolarsResult, SerReader,
};
use serde::{Deserialize, Serialize};
use sha2::{Digest, Sha256};

use super::{Column, Table};
use crate::input::value::Value;
use crate::job::row::CellType;
use crate::platform::error::{Error, Result};

/// Key of the file-level metadata.
const KEY: &str = "billow";
/// Name of the format.
const FORMAT: &str = "billow-table";
/// Version of the format. Others are refused.
const VERSION: u64 = 1;

#[derive(Serialize, Deserialize)]
struct Metadata {
    format: String,
    version: u64,
    /// [`checksum`] of the table.
    checksum: String,
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
/// The message of polars.
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
    let checksum = checksum(table);
    let metadata = Metadata { format: FORMAT.to_owned(), version: VERSION, checksum, columns };
    let metadata = serde_json::to_string(&metadata).map_err(|error| error.to_string())?;
    write(table, metadata).map_err(|error| error.to_string())
}

/// SHA-256 of the names, units, meanings and cells of a table, in lower-case hexadecimal digits.
pub fn checksum(table: &Table) -> String {
    let mut hash = Sha256::new();
    let mut add = |bytes: &[u8]| {
        hash.update((bytes.len() as u64).to_le_bytes());
        hash.update(bytes);
    };
    for column in &table.columns {
        for text in [&column.name, &column.unit, &column.meaning] {
            add(text.as_bytes());
        }
        for cell in &column.cells {
            match cell {
                Value::Null => add(b"n"),
                Value::Bool(value) => add(&[u8::from(*value)]),
                Value::Integer(value) => add(&value.to_le_bytes()),
                Value::Number(value) => add(&value.to_bits().to_le_bytes()),
                Value::Text(value) => add(value.as_bytes()),
            }
        }
    }
    hexadecimal(&hash.finalize())
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
    match column.cell_type {
        CellType::Bool => PolarsColumn::new(
            name,
            cells
                .map(|cell| if let Value::Bool(value) = cell { Some(*value) } else { None })
                .collect::<Vec<_>>(),
        ),
        CellType::Integer => PolarsColumn::new(
            name,
            cells
                .map(|cell| if let Value::Integer(value) = cell { Some(*value) } else { None })
                .collect::<Vec<_>>(),
        ),
        CellType::Number => PolarsColumn::new(
            name,
            cells
                .map(|cell| if let Value::Number(value) = cell { Some(*value) } else { None })
                .collect::<Vec<_>>(),
        ),
        CellType::Text => PolarsColumn::new(
            name,
            cells
                .map(|cell| if let Value::Text(value) = cell { Some(value.as_str()) } else { None })
                .collect::<Vec<_>>(),
        ),
    }
}

/// The metadata of a table's file.
///
/// # Errors
/// What is wrong with them.
fn metadata(reader: &mut ParquetReader<Cursor<&[u8]>>) -> std::result::Result<Metadata, String> {
    let stored = reader
        .get_metadata()
        .map_err(|error| format!("not a Parquet file: {error}"))?
        .key_value_metadata()
        .iter()
        .flatten()
        .find(|pair| pair.key == KEY)
        .and_then(|pair| pair.value.clone())
        .ok_or_else(|| "a Parquet file, but not a billow table".to_owned())?;
    let metadata: Metadata =
        serde_json::from_str(&stored).map_err(|error| format!("not a billow table: {error}"))?;
    if metadata.format != FORMAT {
        return Err(format!("format {:?} is not {FORMAT:?}", metadata.format));
    }
    Ok(metadata)
}

/// Reads a table from the bytes of its file; `path` names it in errors.
///
/// # Errors
/// [`Error::Disk`] for bytes that are damaged, not a billow table, or of another version.
pub fn decode(path: &Path, bytes: &[u8]) -> Result<Table> {
    let broken = |problem: String| Error::Disk {
        path: path.to_owned(),
        problem: format!(
            "{problem}\n  next: run `billow run` of its study: it writes the table again"
        ),
    };
    let mut reader = ParquetReader::new(Cursor::new(bytes)).read_parallel(ParallelStrategy::None);
    let metadata = metadata(&mut reader).map_err(broken)?;
    if metadata.version != VERSION {
        return Err(Error::Disk {
            path: path.to_owned(),
            problem: format!(
                "table of version {}, this program reads version {VERSION}\n  next: use the \
                 billow that wrote it",
                metadata.version
            ),
        });
    }
    let frame = reader.finish().map_err(|error| broken(format!("damaged table: {error}")))?;
    let mut columns = Vec::with_capacity(frame.width());
    for column in frame.columns() {
        let label = metadata.columns.iter().find(|label| label.name == column.name().as_str());
        columns.push(
            from_polars(column, label)
                .map_err(|error| broken(format!("column {:?}: {error}", column.name())))?,
        );
    }
    let table = Table { columns };
    if metadata.checksum != checksum(&table) {
        return Err(broken("it does not have the contents of its checksum".to_owned()));
    }
    Ok(table)
}

fn from_polars(
    column: &PolarsColumn,
    label: Option<&ColumnMetadata>,
) -> std::result::Result<Column, String> {
    let cell_type = match column.dtype() {
        DataType::Boolean => CellType::Bool,
        DataType::Int64 => CellType::Integer,
        DataType::Float64 => CellType::Number,
        DataType::String => CellType::Text,
        other => {
            return Err(format!(
                "type {other} is not a type of a billow table (Boolean, Int64, Float64, String)"
            ));
        }
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
    let unit = label.map_or("", |label| label.unit.as_str());
    let meaning = label.map_or("", |label| label.meaning.as_str());
    let cells = cells.collect::<std::result::Result<_, String>>()?;
    Ok(Column::new(column.name().as_str(), (cell_type, unit), meaning, cells))
}
