//! Writes Parquet; no other module does, and nothing of the program reads it.
//!
//! The file-level key `billow` holds JSON: format, version, and the unit and meaning of every column.
//! Columns are written one after the other on the calling thread. So the bytes do not depend on the
//! machine, and polars starts no threads.

use polars::prelude::{
    AnyValue, Column as PolarsColumn, DataFrame, DataType, KeyValueMetadata, ParquetCompression,
    ParquetWriter, PolarsResult, Series,
};
use serde_json::json;

use super::{Column, ColumnCells, Table};
use crate::input::value::Value;
use crate::job::row::CellType;

/// Key of the file-level metadata.
const KEY: &str = "billow";
/// Name of the format.
const FORMAT: &str = "billow-table";
/// Version of the format.
const VERSION: u64 = 1;

/// The bytes of a table's file. A column is dropped once it is converted: the cells of a large table need the memory.
///
/// # Errors
/// The message of polars.
pub fn encode(table: Table) -> std::result::Result<Vec<u8>, String> {
    let label = |Column { name, unit, meaning, .. }: &Column| json!({ "name": name, "unit": unit, "meaning": meaning });
    let columns: Vec<_> = table.columns.iter().map(label).collect();
    let metadata = json!({ "format": FORMAT, "version": VERSION, "columns": columns });
    write(table, metadata.to_string()).map_err(|error| error.to_string())
}

fn write(table: Table, metadata: String) -> PolarsResult<Vec<u8>> {
    let rows = table.rows();
    let columns = table.columns.into_iter().map(|column| to_polars(&column));
    let mut frame = DataFrame::new(rows, columns.collect::<PolarsResult<_>>()?)?;
    let metadata = KeyValueMetadata::from_static(vec![(KEY.to_owned(), metadata)]);
    let mut bytes = Vec::new();
    ParquetWriter::new(&mut bytes)
        .with_compression(ParquetCompression::Snappy)
        .set_parallel(false)
        .with_key_value_metadata(Some(metadata))
        .finish(&mut frame)?;
    Ok(bytes)
}

fn to_polars(column: &Column) -> PolarsResult<PolarsColumn> {
    let kind = match column.cell_type {
        CellType::Bool => DataType::Boolean,
        CellType::Integer => DataType::Int64,
        CellType::Number => DataType::Float64,
        CellType::Text => DataType::String,
    };
    let of = |cells: &[AnyValue<'_>]| {
        let series =
            Series::from_any_values_and_dtype(column.name.as_str().into(), cells, &kind, true);
        series.map(PolarsColumn::from)
    };
    match &column.cells {
        // One cell until the column is written.
        ColumnCells::Same(cell, rows) => Ok(of(&[any(cell)])?.new_from_index(0, *rows)),
        cells => of(&cells.iter().map(any).collect::<Vec<_>>()),
    }
}

fn any(cell: &Value) -> AnyValue<'_> {
    match cell {
        Value::Null => AnyValue::Null,
        Value::Bool(value) => AnyValue::Boolean(*value),
        Value::Integer(value) => AnyValue::Int64(*value),
        Value::Number(value) => AnyValue::Float64(*value),
        Value::Text(value) => AnyValue::String(value),
    }
}
