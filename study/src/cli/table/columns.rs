//! The columns of the single runs: those asked for, or those that fit on a line.

use super::{MAX_LINE_WIDTH, MAX_WIDE_LINE_WIDTH};
use crate::accuracy::error_column;
use crate::cli::print::Heading;
use crate::cli::{Format, range};
use crate::input::value::Value;
use crate::job::row::{ColumnId, DerivedColumn};
use crate::platform::error::Result;
use crate::store::table::select::find;
use crate::store::table::{Column, Table};

/// The parameter whose values are compared for how gentle they are.
const STRATEGY: &str = "strategy";

/// Start of the name of the margin to the limit of a measure.
pub const MARGIN: &str = "margin_";

/// Columns shown after the parameters by default, in this order, as far as they fit. Where strategies are
/// compared, the speed stands beside the energy, although it is noisy: both measure the impact.
pub fn main_names(table: &Table) -> Vec<&str> {
    let mut names: Vec<&str> = vec![
        ColumnId::Status.name(),
        ColumnId::Verdict.name(),
        DerivedColumn::Safe.name(),
        DerivedColumn::SmallestMargin.name(),
        DerivedColumn::SmallestMarginOf.name(),
        DerivedColumn::VerdictDependsOn.name(),
    ];
    let measures = limited(table).into_iter().chain(main_measures(table));
    for name in measures {
        if !names.contains(&name) {
            names.push(name);
        }
    }
    names
}

/// The measures among them.
pub fn main_measures(table: &Table) -> Vec<&'static str> {
    let with_speed = compares_strategies(table);
    let measures = any_main_measures();
    let shown = measures.filter(|column| with_speed || *column != ColumnId::PeakVz);
    shown.map(ColumnId::name).collect()
}

/// The measures among them, whatever the study compares.
pub fn any_main_measures() -> impl Iterator<Item = ColumnId> {
    let measures = [
        ColumnId::T90ZRim,
        ColumnId::PeakKineticEnergy,
        ColumnId::PeakVz,
        ColumnId::FinalPressure,
        ColumnId::TDeployed,
        ColumnId::VolumeRatio,
        ColumnId::HeightRatio,
        ColumnId::Overshoot,
    ];
    measures.into_iter()
}

/// The measures that have a limit.
pub fn limited(table: &Table) -> Vec<&str> {
    let names = table.columns.iter().filter_map(|column| column.name.strip_prefix(MARGIN));
    names.filter(|name| ColumnId::from_name(name).is_some()).collect()
}

/// Whether a study compares strategies.
pub fn compares_strategies(table: &Table) -> bool {
    table.parameters().any(|column| column.name == STRATEGY)
}

/// The columns to print.
///
/// # Errors
/// An unknown column.
pub fn chosen<'a>(
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

/// The columns that sort the rows and are not among these.
pub fn sorting<'a>(table: &'a Table, sort: &[String], known: &[&Column]) -> Vec<&'a Column> {
    let mut columns: Vec<&Column> = Vec::new();
    for name in sort.iter().map(|key| key.split(':').next().unwrap_or_default().trim()) {
        let column = table.column(name);
        let is_new =
            |column: &&Column| known.iter().chain(&columns).all(|known| known.name != column.name);
        columns.extend(column.filter(is_new));
    }
    columns
}

/// Job, parameters, the columns that sort the rows, and the main columns that fit on a line.
fn main_columns<'a>(table: &'a Table, sort: &[String]) -> Vec<&'a Column> {
    let mut columns: Vec<&Column> = table.columns.iter().take(1).collect();
    columns.extend(table.parameters());
    columns.extend(sorting(table, sort, &columns));
    let mut width: usize = columns.iter().map(|column| width(table, column) + 2).sum();
    let shown: Vec<&str> = columns.iter().map(|column| column.name.as_str()).collect();
    let limited = limited(table);
    let names = main_names(table);
    let mains = names.iter().filter(|name| !shown.contains(name));
    // What the limits say takes the room of three columns.
    let judged = table.column(DerivedColumn::Safe.name()).is_some();
    let most = if judged { MAX_WIDE_LINE_WIDTH } else { MAX_LINE_WIDTH };
    for column in mains.filter_map(|name| table.column(name)).collect::<Vec<_>>() {
        let has_values = column.cells.iter().any(|cell| *cell != Value::Null);
        let always =
            is_always_shown(&column.name, has_values) || limited.contains(&column.name.as_str());
        let fits = width + self::width(table, column) <= most;
        // The speed does not take the place of the energy.
        let partner = ColumnId::PeakKineticEnergy.name();
        let alone = column.name == ColumnId::PeakVz.name()
            && columns.iter().all(|known| known.name != partner);
        if always || (has_values && fits && !alone) {
            width += self::width(table, column) + 2;
            columns.push(column);
        }
    }
    columns
}

/// Whether a column is shown even if it makes the line too long: the status, and what the limits say.
fn is_always_shown(name: &str, has_values: bool) -> bool {
    let judged =
        [DerivedColumn::Safe, DerivedColumn::SmallestMargin, DerivedColumn::VerdictDependsOn];
    name == ColumnId::Status.name()
        || (has_values && judged.iter().any(|column| column.name() == name))
}

/// A column as the head of a table has it.
pub fn heading(column: &Column) -> Heading {
    Heading { name: column.name.clone(), unit: column.shown.clone() }
}

/// Width of a column, characters.
fn width(table: &Table, column: &Column) -> usize {
    let rows = 0..column.cells.len();
    let widest = rows.map(|row| match shown(table, column, row, Format::Table) {
        Value::Null => 1,
        value => column.shown.text(&value).chars().count(),
    });
    widest.max().unwrap_or(0).max(heading(column).width())
}

/// A cell as printed: a table has short job ids, and values with their mesh error.
pub fn shown(table: &Table, column: &Column, row: usize, format: Format) -> Value {
    match &column.cells[row] {
        value if format != Format::Table => value.clone(),
        Value::Text(id) if column.name == "job" => Value::Text(id.chars().take(8).collect()),
        Value::Number(value) => match mesh_error(table, &column.name, row) {
            Some(error) => Value::Text(range::with_error(*value, error, &column.shown)),
            None => Value::Number(*value),
        },
        value => value.clone(),
    }
}

/// The mesh error of a measure at a row.
pub fn mesh_error(table: &Table, measure: &str, row: usize) -> Option<f64> {
    match table.column(error_column(measure)?)?.cells[row] {
        Value::Number(error) => Some(error),
        _ => None,
    }
}
