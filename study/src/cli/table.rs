//! `billow table`: prints the summary table of a study's results.

use std::cmp::Ordering;
use std::io::Write;
use std::path::PathBuf;

use super::print::print_rows;
use super::target::{self, filtered, find};
use super::{Format, Global};
use crate::input::value::{Value, short_number};
use crate::platform::error::{InputError, Result};
use crate::store::table::{Column, Table};

/// Measures shown after the parameters, in this order, as far as they fit.
const MAIN: [&str; 10] = [
    "status",
    "verdict",
    "t_90_z_rim",
    "peak_vz",
    "final_pressure",
    "t_deployed",
    "peak_kinetic_energy",
    "volume_ratio",
    "height_ratio",
    "overshoot",
];
/// Characters a line of the default table may have.
const WIDTH: usize = 120;

/// Arguments of `billow table`.
#[derive(Debug, clap::Args)]
pub struct Args {
    /// Study file, or folder of its results [default: the only one under results].
    pub study: Option<PathBuf>,
    /// Only rows of which this holds, as in `N == 6 and final_pressure > '40 Pa'`.
    #[arg(long = "where", value_name = "CONDITION")]
    pub condition: Option<String>,
    /// Columns, comma-separated, or "all" [default: parameters and main measures; all for csv and
    /// json].
    #[arg(long, value_name = "NAMES", value_delimiter = ',')]
    pub columns: Vec<String>,
    /// Sort by these columns, comma-separated; ":desc" turns one round. Empty cells come last.
    #[arg(long, value_name = "NAMES", value_delimiter = ',')]
    pub sort: Vec<String>,
}

/// Runs `billow table`.
pub fn run(args: &Args, global: &Global, out: &mut dyn Write) -> Result<()> {
    let table = target::open(args.study.as_deref(), global)?.table;
    let rows = sorted(&table, filtered(&table, args.condition.as_deref())?, &args.sort)?;
    let format = global.format();
    let columns = chosen(&table, &args.columns, format)?;
    let names: Vec<&str> = columns.iter().map(|column| column.name.as_str()).collect();
    let cells: Vec<Vec<Value>> = rows
        .iter()
        .map(|row| columns.iter().map(|column| shown(column, *row, format)).collect())
        .collect();
    print_rows(&names, &cells, format, out)?;
    if format == Format::Table && !global.quiet {
        if rows.is_empty() && args.condition.is_some() {
            eprintln!(
                "billow: --where holds of no row; numbers are SI unless they carry a unit, as in \
                 mass_flow_rate == '5 g/s'"
            );
        }
        eprintln!("{}", legend(&columns, table.columns.len()));
    }
    Ok(())
}

/// Units of the columns printed, and how many there are beside them.
fn legend(shown: &[&Column], all: usize) -> String {
    let units: Vec<String> = shown
        .iter()
        .filter(|column| !matches!(column.unit.as_str(), "" | "1"))
        .map(|column| format!("{} {}", column.name, column.unit))
        .collect();
    let units =
        if units.is_empty() { String::new() } else { format!("units: {}; ", units.join(", ")) };
    format!("{units}{} of {all} columns (--columns all)", shown.len())
}

/// Rows in the order asked for; equal ones stay in plan order.
fn sorted(table: &Table, mut rows: Vec<usize>, sort: &[String]) -> Result<Vec<usize>> {
    let mut keys = Vec::with_capacity(sort.len());
    for key in sort {
        let (name, down) = match key.trim().split_once(':') {
            None => (key.trim(), false),
            Some((name, "asc")) => (name, false),
            Some((name, "desc")) => (name, true),
            Some(_) => {
                return Err(InputError {
                    file: "--sort".to_owned(),
                    key: String::new(),
                    value: key.clone(),
                    problem: "unknown direction".to_owned(),
                    allowed: "NAME, NAME:asc, NAME:desc".to_owned(),
                    hint: String::new(),
                }
                .into());
            }
        };
        keys.push((find(table, "--sort", name)?, down));
    }
    rows.sort_by(|one, other| {
        let compare = |(column, down): &(&Column, bool)| {
            compare(&column.cells[*one], &column.cells[*other], *down)
        };
        keys.iter().map(compare).find(|order| order.is_ne()).unwrap_or(Ordering::Equal)
    });
    Ok(rows)
}

fn compare(one: &Value, other: &Value, down: bool) -> Ordering {
    let order = match (one, other) {
        (Value::Null, Value::Null) => return Ordering::Equal,
        (Value::Null, _) => return Ordering::Greater,
        (_, Value::Null) => return Ordering::Less,
        (Value::Bool(one), Value::Bool(other)) => one.cmp(other),
        (Value::Integer(one), Value::Integer(other)) => one.cmp(other),
        (Value::Number(one), Value::Number(other)) => one.total_cmp(other),
        // Cells of one column are of one type.
        (one, other) => one.to_string().cmp(&other.to_string()),
    };
    if down { order.reverse() } else { order }
}

fn chosen<'a>(table: &'a Table, names: &[String], format: Format) -> Result<Vec<&'a Column>> {
    match names {
        [] if format == Format::Table => Ok(main_columns(table)),
        [] => Ok(table.columns.iter().collect()),
        [all] if all == "all" => Ok(table.columns.iter().collect()),
        names => names.iter().map(|name| find(table, "--columns", name.trim())).collect(),
    }
}

/// Job, parameters, and the main measures that fit a line.
fn main_columns(table: &Table) -> Vec<&Column> {
    let mut columns: Vec<&Column> = table.columns.iter().take(1).collect();
    columns.extend(table.parameters());
    let mut width: usize = columns.iter().map(|column| width(column) + 2).sum();
    for column in MAIN.iter().filter_map(|name| table.column(name)) {
        let answers = column.cells.iter().any(|cell| *cell != Value::Null);
        // How a job ended is shown however wide the parameters are.
        if column.name == "status" || (answers && width + self::width(column) <= WIDTH) {
            width += self::width(column) + 2;
            columns.push(column);
        }
    }
    columns
}

/// Characters a column takes.
fn width(column: &Column) -> usize {
    let rows = 0..column.cells.len();
    let widest = rows.map(|row| match shown(column, row, Format::Table) {
        Value::Number(number) => short_number(number).len(),
        other => other.to_string().chars().count(),
    });
    widest.max().unwrap_or(0).max(column.name.chars().count())
}

/// A cell as printed: job ids short where people read them.
fn shown(column: &Column, row: usize, format: Format) -> Value {
    match &column.cells[row] {
        Value::Text(id) if format == Format::Table && column.name == "job" => {
            Value::Text(id.chars().take(8).collect())
        }
        value => value.clone(),
    }
}
