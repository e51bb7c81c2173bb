//! Printing rows: as an aligned table, CSV or JSON. Every command that lists rows prints them here, so
//! that columns, rounding and empty cells look the same everywhere.

use std::io::{self, IsTerminal, Write};
use std::path::PathBuf;

use clap::ValueEnum;

use crate::accuracy::together;
use crate::analysis::compare::{columns_of_assumed, columns_of_error};
use crate::input::value::{Value, brief_number, json_value};
use crate::job::proportion::Proportion;
use crate::job::row::CellType;
use crate::platform::error::{Error, Result};
use crate::store::table::{Column, Table};
use crate::study::Study;

pub mod answer;
pub mod at_limit;
pub mod legend;
pub mod notes;
pub mod points;
mod range;

/// Format of the output.
#[derive(Debug, Clone, Copy, PartialEq, Eq, ValueEnum)]
pub enum Format {
    /// Aligned columns.
    Table,
    /// Comma-separated values (RFC 4180).
    Csv,
    /// JSON.
    Json,
}

/// The error of a failed write to stdout. A reader that closes it is no error: [`crate::platform::output::Output`].
#[expect(clippy::needless_pass_by_value, reason = "the signature that map_err takes")]
pub fn output_error(error: io::Error) -> Error {
    let next = "the output is not complete; free some space, or write it to another file";
    Error::Disk { path: PathBuf::from("stdout"), problem: format!("{error}\n  next: {next}") }
}

/// Most characters in a line.
const MAX_LINE_WIDTH: usize = 120;
/// Most values of a parameter that a line names. Chosen: more values need a chart.
pub const MAX_VALUES: usize = 6;

/// A line of an explanation: its topic and its text.
pub type TopicLine = (&'static str, String);

/// A number of points with several runs each: "30 points of 5 runs", or "57 points, 256 runs" where a filter leaves some
/// points fewer. `planned` counts every run, also those of `pilots`, which are named apart. A study without replicates has
/// points only, also one that gives a value twice.
pub fn points_of_runs(study: &Study, planned: usize, pilots: usize) -> String {
    if pilots > 0 {
        let points = points_of_runs(study, planned - pilots, 0);
        return format!("{points}, and {} of pilots", count(pilots, "run"));
    }
    if study.replicates().is_empty() {
        return count(planned, "point");
    }
    let runs = study.replicate_count();
    let points = if planned == study.points().len() {
        study.point_count()
    } else if planned.is_multiple_of(runs) {
        planned / runs
    } else {
        planned
    };
    if points == planned {
        count(planned, "point")
    } else if planned.is_multiple_of(points) {
        format!("{} of {}", count(points, "point"), count(planned / points, "run"))
    } else {
        format!("{}, {}", count(points, "point"), count(planned, "run"))
    }
}

/// A fraction as a program reads it, and in a table as a percentage.
pub fn fraction(value: f64, format: Format) -> Value {
    match format {
        Format::Table => Value::Text(format!("{:.1} %", 100.0 * value)),
        Format::Csv | Format::Json => Value::Number(value),
    }
}

/// Ends of the names of columns that a table for a reader shows in the cell of another column: the smallest and the
/// largest value, the number of all and the interval of a proportion, the mesh error.
const PARTS: [&str; 9] = [
    "_least",
    "_largest",
    "_of",
    "_low",
    "_high",
    "_error_below",
    "_error_above",
    "_assumed_below",
    "_assumed_above",
];

/// Whether a reader sees a column in the cell of another one.
pub fn is_part(table: &Table, column: &Column) -> bool {
    let is_number = matches!(column.cell_type, CellType::Integer | CellType::Number);
    let mut wholes = PARTS.iter().filter_map(|end| column.name.strip_suffix(end));
    is_number && wholes.any(|whole| table.column(whole).is_some())
}

/// The cells of a column as a reader sees them, in its unit: the first digits of a job id, a value with its range and
/// its uncertainty (mesh error and what is assumed), k of n with its interval.
pub fn shown_cells(table: &Table, column: &Column, rows: &[usize]) -> Vec<Value> {
    let part = |end: &str| table.column(&format!("{}{end}", column.name));
    let (least, largest, of) = (part("_least"), part("_largest"), part("_of"));
    let error = part("_error_below").zip(part("_error_above")).map(<[&Column; 2]>::from);
    let error = error.or_else(|| columns_of_error(table, &column.name));
    let assumed = columns_of_assumed(table, &column.name);
    let number = |part: Option<&Column>, row: usize| match part?.cells[row] {
        Value::Number(number) => Some(number),
        _ => None,
    };
    let cell = |row: &usize| match &column.cells[*row] {
        Value::Text(id) if column.name == "job" => Value::Text(id.chars().take(8).collect()),
        Value::Integer(met) if let Some(Value::Integer(of)) = of.map(|of| &of.cells[*row]) => {
            let [met, of] = [*met, *of].map(|number| usize::try_from(number).unwrap_or(0));
            if of == 0 { Value::Null } else { Value::Text(Proportion { met, of }.to_string()) }
        }
        Value::Number(value) => {
            let ends = number(least, *row).zip(number(largest, *row));
            let both = |[below, above]: [&Column; 2]| {
                Some([number(Some(below), *row)?, number(Some(above), *row)?])
            };
            let sides = error.and_then(both).map(|error| together(error, assumed.and_then(both)));
            match (ends, sides) {
                (None, None) => Value::Number(column.shown.number(*value)),
                (ends, error) => Value::Text(range::text(*value, ends, error, &column.shown)),
            }
        }
        other => column.shown.value(other),
    };
    rows.iter().map(cell).collect()
}

/// Characters that a column needs in a table.
pub fn width(table: &Table, column: &Column) -> usize {
    let rows: Vec<usize> = (0..column.cells.len()).collect();
    let cells = shown_cells(table, column, &rows);
    let widths = cells.iter().map(|value| cell(value).chars().count());
    let header = column.name.chars().count().max(symbol(column).chars().count());
    widths.max().unwrap_or(0).max(header)
}

/// The unit as the second line of the header has it; empty without a unit.
fn symbol(column: &Column) -> String {
    match column.shown.symbol() {
        "" => String::new(),
        symbol => format!("({symbol})"),
    }
}

/// Prints some columns and rows of a table. A reader sees them in the unit of each column, which stands below its name,
/// as [`shown_cells`]; csv and json have one SI number in each cell, as [`print_rows`].
///
/// # Errors
/// When the output cannot be written.
pub fn print_table(
    table: &Table,
    columns: &[&Column],
    rows: &[usize],
    format: Format,
    out: &mut dyn Write,
) -> Result<()> {
    let names: Vec<&str> = columns.iter().map(|column| column.name.as_str()).collect();
    let by_column: Vec<Vec<Value>> = match format {
        Format::Table => columns.iter().map(|column| shown_cells(table, column, rows)).collect(),
        Format::Csv | Format::Json => {
            let cells =
                |column: &&Column| rows.iter().map(|row| column.cells[*row].clone()).collect();
            columns.iter().map(cells).collect()
        }
    };
    let row = |row: usize| by_column.iter().map(|cells| cells[row].clone()).collect();
    let cells: Vec<Vec<Value>> = (0..rows.len()).map(row).collect();
    if format != Format::Table {
        return print_rows(&names, &cells, format, out);
    }
    let units: Vec<String> = columns.iter().map(|column| symbol(column)).collect();
    aligned(&names, &units, &cells, bold_headers(), out).map_err(output_error)
}

/// Prints rows under their columns.
///
/// - `table`: aligned columns; numbers have six significant digits and stand to the right; an empty cell
///   is `-`; the header is bold on a terminal, unless `NO_COLOR` is set.
/// - `csv`: quoted as in RFC 4180; lines end with a line feed; numbers in full precision; an empty cell
///   is an empty field, an empty text is `""`.
/// - `json`: an array of objects, keys in column order; numbers in full precision; an empty cell is
///   `null`.
///
/// Missing cells at the end of a row are empty.
///
/// # Errors
/// When the output cannot be written.
pub fn print_rows<C: AsRef<str>>(
    columns: &[C],
    rows: &[Vec<Value>],
    format: Format,
    out: &mut dyn Write,
) -> Result<()> {
    let columns: Vec<&str> = columns.iter().map(AsRef::as_ref).collect();
    let written = match format {
        Format::Table => aligned(&columns, &[], rows, bold_headers(), out),
        Format::Csv => csv(&columns, rows, out),
        Format::Json => json(&columns, rows, out),
    };
    written.map_err(output_error)
}

/// Whether stdout is a terminal and `NO_COLOR` is not set (<https://no-color.org>).
fn bold_headers() -> bool {
    io::stdout().is_terminal() && std::env::var_os("NO_COLOR").is_none_or(|value| value.is_empty())
}

/// `units` is the second line of the header, which is left out when it is empty.
fn aligned(
    columns: &[&str],
    units: &[String],
    rows: &[Vec<Value>],
    bold: bool,
    out: &mut dyn Write,
) -> io::Result<()> {
    let cells: Vec<Vec<String>> = rows
        .iter()
        .map(|row| {
            (0..columns.len()).map(|index| cell(row.get(index).unwrap_or(&Value::Null))).collect()
        })
        .collect();
    let widths: Vec<usize> = columns
        .iter()
        .enumerate()
        .map(|(index, name)| {
            let widest = cells.iter().map(|row| row[index].chars().count()).max().unwrap_or(0);
            let unit = units.get(index).map_or(0, |unit| unit.chars().count());
            widest.max(name.chars().count()).max(unit)
        })
        .collect();
    // A column of numbers and its header are aligned to the right.
    let right: Vec<bool> = (0..columns.len())
        .map(|index| {
            rows.iter()
                .any(|row| matches!(row.get(index), Some(Value::Integer(_) | Value::Number(_))))
        })
        .collect();
    let line = |texts: &mut dyn Iterator<Item = &str>| {
        let mut line = String::new();
        for (index, text) in texts.enumerate() {
            if index > 0 {
                line.push_str("  ");
            }
            let padding = " ".repeat(widths[index].saturating_sub(text.chars().count()));
            if right[index] {
                line.push_str(&padding);
                line.push_str(text);
            } else {
                line.push_str(text);
                line.push_str(&padding);
            }
        }
        line.truncate(line.trim_end().len());
        line
    };
    let mut headers = vec![line(&mut columns.iter().copied())];
    if units.iter().any(|unit| !unit.is_empty()) {
        headers.push(line(&mut units.iter().map(String::as_str)));
    }
    for header in headers {
        if bold {
            writeln!(out, "\x1b[1m{header}\x1b[0m")?;
        } else {
            writeln!(out, "{header}")?;
        }
    }
    for row in &cells {
        writeln!(out, "{}", line(&mut row.iter().map(String::as_str)))?;
    }
    Ok(())
}

/// A cell of the aligned table.
fn cell(value: &Value) -> String {
    match value {
        Value::Null => "-".to_owned(),
        Value::Text(text) => {
            text.chars().map(|c| if c.is_control() { ' ' } else { c }).collect::<String>()
        }
        other => other.short(),
    }
}

fn csv(columns: &[&str], rows: &[Vec<Value>], out: &mut dyn Write) -> io::Result<()> {
    let header: Vec<String> = columns.iter().map(|name| quoted(name)).collect();
    writeln!(out, "{}", header.join(","))?;
    for row in rows {
        let fields: Vec<String> = (0..columns.len())
            .map(|index| match row.get(index) {
                None | Some(Value::Null) => String::new(),
                Some(Value::Text(text)) => quoted(text),
                Some(other) => other.to_string(),
            })
            .collect();
        writeln!(out, "{}", fields.join(","))?;
    }
    Ok(())
}

/// A CSV field; in quotes when the text is empty or holds a separator.
fn quoted(text: &str) -> String {
    if text.is_empty() || text.contains(['"', ',', '\n', '\r']) {
        format!("\"{}\"", text.replace('"', "\"\""))
    } else {
        text.to_owned()
    }
}

fn json(columns: &[&str], rows: &[Vec<Value>], out: &mut dyn Write) -> io::Result<()> {
    write!(out, "[")?;
    for (number, row) in rows.iter().enumerate() {
        write!(out, "{}\n  {{", if number > 0 { "," } else { "" })?;
        for (index, name) in columns.iter().enumerate() {
            if index > 0 {
                write!(out, ", ")?;
            }
            let value = json_value(row.get(index).unwrap_or(&Value::Null));
            write!(out, "{}: {value}", serde_json::Value::from(*name))?;
        }
        write!(out, "}}")?;
    }
    writeln!(out, "{}]", if rows.is_empty() { "" } else { "\n" })
}

/// The rows of a table as JSON objects, SI.
pub fn json_objects(table: &Table) -> Vec<serde_json::Value> {
    let object = |row: usize| {
        let columns = table.columns.iter();
        let keys = columns.map(|column| (column.name.clone(), json_value(&column.cells[row])));
        serde_json::Value::Object(keys.collect())
    };
    (0..table.rows()).map(object).collect()
}

/// Breaks a line at its semicolons, and where they are too far apart at its commas, so that it fits beside `indent`
/// characters.
pub fn wrapped(line: &str, indent: usize) -> Vec<String> {
    let mut lines: Vec<String> = Vec::new();
    let is_long = |part: &str| indent + part.trim_end().chars().count() > MAX_LINE_WIDTH;
    let parts = line.split_inclusive("; ");
    for part in parts.flat_map(|part| part.split_inclusive(if is_long(part) { ", " } else { "; " }))
    {
        let length = part.trim_end().chars().count();
        match lines.last_mut() {
            Some(last) if indent + last.chars().count() + length <= MAX_LINE_WIDTH => {
                last.push_str(part);
            }
            _ => lines.push(part.to_owned()),
        }
    }
    lines.iter().map(|line| line.trim_end().to_owned()).collect()
}

/// A number with its noun: "1 job", "2 jobs", "2 searches".
pub fn count(number: usize, word: &str) -> String {
    let end = match number {
        1 => "",
        _ if word.ends_with("ch") => "es",
        _ => "s",
    };
    format!("{number} {word}{end}")
}

/// A duration in a readable unit: "12 s", "3.5 min", "2.0 h".
pub fn duration(seconds: f64) -> String {
    if seconds < 120.0 {
        return format!("{} s", brief_number(seconds));
    }
    let (value, unit) = match seconds {
        ..7200.0 => (seconds / 60.0, "min"),
        ..172_800.0 => (seconds / 3600.0, "h"),
        _ => (seconds / 86_400.0, "d"),
    };
    format!("{value:.1} {unit}")
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::input::units::DisplayUnit;

    fn rows() -> Vec<Vec<Value>> {
        vec![
            vec![Value::Integer(6), Value::Text("a, \"b\"".to_owned()), Value::Number(0.1 + 0.2)],
            vec![Value::Integer(12), Value::Null, Value::Number(f64::NAN)],
        ]
    }

    fn printed(format: Format) -> String {
        let mut out = Vec::new();
        print_rows(&["N", "note", "x"], &rows(), format, &mut out).unwrap();
        String::from_utf8(out).unwrap()
    }

    #[test]
    fn columns_are_aligned() {
        let mut out = Vec::new();
        aligned(&["N", "note", "x"], &[], &rows(), false, &mut out).unwrap();
        let expected = " N  note      x\n 6  a, \"b\"  0.3\n12  -       NaN\n";
        assert_eq!(String::from_utf8(out).unwrap(), expected);
    }

    #[test]
    fn a_table_has_units_below_the_names_and_ranges_errors_and_intervals_in_one_cell() {
        let column = |name: &str, cells: [f64; 2]| {
            Column::plain(name, CellType::Number, cells.map(Value::Number).to_vec())
        };
        let count = |name: &str, cells: [i64; 2]| {
            Column::plain(name, CellType::Integer, cells.map(Value::Integer).to_vec())
        };
        let milliseconds = DisplayUnit::new("ms", "s").unwrap();
        let table = Table {
            columns: vec![
                Column { shown: milliseconds, ..column("x", [0.3, 0.2]) },
                column("x_least", [0.3, 0.1]),
                column("x_largest", [0.3, 0.4]),
                column("x_error_below", [0.01, 0.02]),
                column("x_error_above", [0.01, 0.03]),
                count("deployed", [3, 0]),
                count("deployed_of", [4, 0]),
            ],
        };
        let parts: Vec<bool> = table.columns.iter().map(|column| is_part(&table, column)).collect();
        assert_eq!(parts, [false, true, true, true, true, false, true]);
        let printed = |format| {
            let mut out = Vec::new();
            let columns = [&table.columns[0], &table.columns[5]];
            print_table(&table, &columns, &[0, 1], format, &mut out).unwrap();
            String::from_utf8(out).unwrap()
        };
        let expected = [
            "x                         deployed",
            "(ms)",
            "300 ± 10                  3 of 4 (30 to 95 %)",
            "200 [100 to 400] −20 +30  -",
            "",
        ];
        assert_eq!(printed(Format::Table), expected.join("\n"));
        assert_eq!(printed(Format::Csv), "x,deployed\n0.3,3\n0.2,0\n", "csv is SI");
    }

    #[test]
    fn csv_quotes_separators_and_empty_texts() {
        assert_eq!(
            printed(Format::Csv),
            "N,note,x\n6,\"a, \"\"b\"\"\",0.30000000000000004\n12,,NaN\n"
        );
        assert_eq!(quoted(""), "\"\"");
    }

    #[test]
    fn json_is_an_array_of_rows_in_column_order() {
        let text = printed(Format::Json);
        let parsed: serde_json::Value = serde_json::from_str(&text).unwrap();
        assert_eq!(parsed[0]["x"].as_f64(), Some(0.1 + 0.2));
        assert_eq!(parsed[0]["note"], "a, \"b\"");
        assert!(parsed[1]["x"].is_null() && parsed[1]["note"].is_null());
        assert!(text.find("\"N\"") < text.find("\"note\""));

        let mut empty = Vec::new();
        print_rows(&["N"], &[], Format::Json, &mut empty).unwrap();
        assert_eq!(empty, b"[]\n");
    }
}
