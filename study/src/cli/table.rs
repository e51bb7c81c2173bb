//! `billow table`: prints the summary table of a study's results.

use std::cmp::Ordering;
use std::io::Write;

use super::options::{OutputOptions, QuietOption, SetOption, UnitsOption};
use super::print::{Heading, print_quantities};
use super::target::{self, StudyArgs, Target, filtered, find};
use super::{Format, best};
use crate::input::value::Value;
use crate::job::row::{ColumnId, SAME_JOB_AS, current_column_name};
use crate::platform::error::{Error, Result};
use crate::store::table::{Column, Table};

/// Columns shown after the parameters by default, in this order, as far as they fit. None is noisy.
const MAIN_COLUMNS: [ColumnId; 9] = [
    ColumnId::Status,
    ColumnId::Verdict,
    ColumnId::T90ZRim,
    ColumnId::PeakKineticEnergy,
    ColumnId::FinalPressure,
    ColumnId::TDeployed,
    ColumnId::VolumeRatio,
    ColumnId::HeightRatio,
    ColumnId::Overshoot,
];
/// Most characters in a line of the default table.
const MAX_LINE_WIDTH: usize = 120;

/// Arguments of `billow table`.
#[derive(Debug, clap::Args)]
pub struct Args {
    #[command(flatten)]
    study: StudyArgs,
    /// Only rows for which this condition holds, as in `N == 6 and final_pressure > '40 Pa'`.
    #[arg(long = "where", value_name = "CONDITION")]
    pub condition: Option<String>,
    /// Columns, comma-separated, or "all" [default: parameters and main measures; all for csv
    /// and json].
    #[arg(long, value_name = "NAMES", value_delimiter = ',')]
    pub columns: Vec<String>,
    /// Sort by these columns, comma-separated; NAME:desc sorts from the largest down. Empty cells
    /// come last.
    #[arg(long, value_name = "NAMES", value_delimiter = ',')]
    pub sort: Vec<String>,
    #[command(flatten)]
    units: UnitsOption,
    #[command(flatten)]
    set: SetOption,
    #[command(flatten)]
    output: OutputOptions,
    #[command(flatten)]
    quiet: QuietOption,
}

/// Runs `billow table`.
///
/// # Errors
/// Results that cannot be read; an unknown column; an invalid condition.
pub fn run(args: &Args, out: &mut dyn Write) -> Result<()> {
    let mut target = target::open(&args.study, &args.set.set, &args.units)?;
    let all_columns = target.table.columns.len();
    let sorts = args.sort.iter().map(|key| key.split(':').next().unwrap_or_default());
    let asked = args.columns.iter().map(String::as_str).chain(sorts);
    let asked: Vec<String> = asked.map(|name| name.trim().to_owned()).collect();
    target.add_keys(&asked, args.condition.as_deref())?;
    let Target { results, table, .. } = target;
    let rows = sorted(&table, filtered(&table, args.condition.as_deref())?, &args.sort)?;
    let format = args.output.format();
    let columns = chosen(&table, &args.columns, &args.sort, format)?;
    let headings: Vec<Heading> = columns.iter().map(|column| heading(column)).collect();
    let cells: Vec<Vec<Value>> = rows
        .iter()
        .map(|row| columns.iter().map(|column| shown(column, *row, format)).collect())
        .collect();
    print_quantities(&headings, &cells, format, out)?;
    if format == Format::Table && !args.quiet.quiet {
        if let Some(note) = noisy_note(&columns) {
            eprintln!("{note}");
        }
        if rows.is_empty() && args.condition.is_some() {
            eprintln!(
                "billow: no row fulfils --where; a number without a unit is SI, a unit is written as in \
                 mass_flow_rate == '5 g/s'"
            );
        }
        eprintln!("{} of {} columns (--columns all)", columns.len(), all_columns);
        let jobs = table.one_row_per_job(&rows).len();
        if jobs < rows.len() {
            eprintln!(
                "note: {} of these {} rows are the same job as another row ({SAME_JOB_AS})",
                rows.len() - jobs,
                rows.len()
            );
        }
        best::print(&results, &table, &rows)?;
    }
    Ok(())
}

/// A note when noisy measures are among the printed columns.
fn noisy_note(columns: &[&Column]) -> Option<String> {
    let noisy: Vec<&str> = columns
        .iter()
        .map(|column| column.name.as_str())
        .filter(|name| ColumnId::from_name(name).is_some_and(ColumnId::is_noisy))
        .collect();
    let measures = noisy.join(", ");
    (!noisy.is_empty()).then(|| {
        format!("note: noisy: {measures}; the seed alone changes them by more than 3 %, use several seeds")
    })
}

/// A column as the head of a table has it.
fn heading(column: &Column) -> Heading {
    Heading { name: column.name.clone(), unit: column.shown.clone() }
}

/// Rows in the order asked for; equal rows stay in plan order.
fn sorted(table: &Table, mut rows: Vec<usize>, sort: &[String]) -> Result<Vec<usize>> {
    let mut keys = Vec::with_capacity(sort.len());
    for key in sort {
        let (name, descending) = match key.trim().split_once(':') {
            None => (key.trim(), false),
            Some((name, "asc")) => (name, false),
            Some((name, "desc")) => (name, true),
            Some(_) => {
                let allowed = "NAME, NAME:asc, NAME:desc";
                return Err(Error::invalid_option("--sort", key, "unknown direction", allowed, ""));
            }
        };
        keys.push((find(table, "--sort", name)?, descending));
    }
    rows.sort_by(|a, b| {
        let compare = |(column, descending): &(&Column, bool)| {
            compare(&column.cells[*a], &column.cells[*b], *descending)
        };
        keys.iter().map(compare).find(|order| order.is_ne()).unwrap_or(Ordering::Equal)
    });
    Ok(rows)
}

fn compare(a: &Value, b: &Value, descending: bool) -> Ordering {
    let order = match (a, b) {
        (Value::Null, Value::Null) => return Ordering::Equal,
        (Value::Null, _) => return Ordering::Greater,
        (_, Value::Null) => return Ordering::Less,
        (Value::Bool(a), Value::Bool(b)) => a.cmp(b),
        (Value::Integer(a), Value::Integer(b)) => a.cmp(b),
        (Value::Number(a), Value::Number(b)) => a.total_cmp(b),
        // Cells of one column have one type: these are texts.
        (a, b) => a.to_string().cmp(&b.to_string()),
    };
    if descending { order.reverse() } else { order }
}

fn chosen<'a>(
    table: &'a Table,
    names: &[String],
    sort: &[String],
    format: Format,
) -> Result<Vec<&'a Column>> {
    match names {
        [] if format == Format::Table => Ok(main_columns(table, sort)),
        [] => Ok(table.columns.iter().collect()),
        [all] if all == "all" => Ok(table.columns.iter().collect()),
        names => names.iter().map(|name| find(table, "--columns", name.trim())).collect(),
    }
}

/// Job, parameters, the columns that sort the rows, and the main columns that fit on a line.
fn main_columns<'a>(table: &'a Table, sort: &[String]) -> Vec<&'a Column> {
    let mut columns: Vec<&Column> = table.columns.iter().take(1).collect();
    columns.extend(table.parameters());
    for name in sort.iter().map(|key| key.split(':').next().unwrap_or_default().trim()) {
        let column = table.column(current_column_name(name).0);
        let is_new = |column: &&Column| columns.iter().all(|known| known.name != column.name);
        columns.extend(column.filter(is_new));
    }
    let mut width: usize = columns.iter().map(|column| width(column) + 2).sum();
    let mains = MAIN_COLUMNS.iter().filter_map(|column| table.column(column.name()));
    let sorting: Vec<&str> = columns.iter().map(|column| column.name.as_str()).collect();
    for column in
        mains.filter(|column| !sorting.contains(&column.name.as_str())).collect::<Vec<_>>()
    {
        let has_values = column.cells.iter().any(|cell| *cell != Value::Null);
        // The status is always shown.
        if column.name == "status" || (has_values && width + self::width(column) <= MAX_LINE_WIDTH)
        {
            width += self::width(column) + 2;
            columns.push(column);
        }
    }
    columns
}

/// Width of a column, characters.
fn width(column: &Column) -> usize {
    let rows = 0..column.cells.len();
    let widest = rows.map(|row| match shown(column, row, Format::Table) {
        Value::Null => 1,
        value => column.shown.text(&value).chars().count(),
    });
    widest.max().unwrap_or(0).max(heading(column).width())
}

/// A cell as printed: a table has short job ids.
fn shown(column: &Column, row: usize, format: Format) -> Value {
    match &column.cells[row] {
        Value::Text(id) if format == Format::Table && column.name == "job" => {
            Value::Text(id.chars().take(8).collect())
        }
        value => value.clone(),
    }
}
