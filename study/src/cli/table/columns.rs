//! The columns of a table: those asked for, or those that fit on a line.

use super::{Args, MAX_LINE_WIDTH, MAX_WIDE_LINE_WIDTH, sorting};
use crate::analysis::compare::values;
use crate::cli::Format;
use crate::input::keys;
use crate::job::row::{ColumnId, DerivedColumn};
use crate::platform::error::{Error, Result};
use crate::print::points::{DEPLOYED, RUNS, SAFE};
use crate::print::{is_part, width};
use crate::store::table::select;
use crate::store::table::{Column, Table};

/// The parameter whose values are compared for how gentle they are.
const STRATEGY: &str = "strategy";
/// Start of the name of the margin to the limit of a measure.
const MARGIN: &str = "margin_";
/// Measures shown by default, as far as they fit.
const MAIN_MEASURES: [ColumnId; 8] = [
    ColumnId::T90ZRim,
    ColumnId::PeakKineticEnergy,
    ColumnId::PeakVz,
    ColumnId::FinalPressure,
    ColumnId::TDeployed,
    ColumnId::VolumeRatio,
    ColumnId::HeightRatio,
    ColumnId::Overshoot,
];

/// The columns to print of the rows that are listed, which are runs or points of several. A person sees to which point a
/// row belongs: the parameters that vary come first, unless a parameter is named.
///
/// # Errors
/// An unknown column, or one of single runs.
pub fn chosen<'a>(
    listed: &'a Table,
    (runs, minimised): (&Table, &[ColumnId]),
    (args, format): (&Args, Format),
    rows: &[usize],
) -> Result<Vec<&'a Column>> {
    let names = match args.columns.as_slice() {
        [] if format == Format::Table => return Ok(main_columns(listed, minimised, &args.sort)),
        names if !names.is_empty() && names != ["all"] => names.iter().map(|name| name.trim()),
        _ if format == Format::Table => return Ok(all(listed)),
        _ => return Ok(in_order(listed)),
    };
    let named = names.clone().map(|name| find(listed, runs, "--columns", name));
    let named = named.collect::<Result<Vec<_>>>()?;
    let is_parameter =
        |name: &str| listed.parameters().any(|known| known.name == keys::shortened(name));
    if format != Format::Table || names.clone().any(is_parameter) {
        return Ok(named);
    }
    let varies = |column: &&Column| values(column, rows).len() > 1;
    Ok(listed.parameters().filter(varies).chain(named).collect())
}

/// The column with that name of the rows that are listed, for which `option` asks.
///
/// # Errors
/// When there is none, also when only single runs have it.
pub fn find<'a>(listed: &'a Table, runs: &Table, option: &str, name: &str) -> Result<&'a Column> {
    if runs.column(name).is_some() && listed.column(name).is_none() {
        let problem = "is a column of single runs, and each row is a point of several runs";
        let hint = "--runs prints the single runs";
        let allowed = "a column of `--columns all`";
        return Err(Error::invalid_option(option, name, problem, allowed, hint));
    }
    select::find(listed, option, name)
}

/// Every column, for points the parameters first.
fn in_order(table: &Table) -> Vec<&Column> {
    let mut columns: Vec<&Column> = table.columns.iter().collect();
    if is_of_points(table) {
        columns[..=table.parameters().count()].rotate_left(1);
    }
    columns
}

/// Every column that a reader does not see in the cell of another one.
pub fn all(table: &Table) -> Vec<&Column> {
    let is_count = |column: &Column| is_of_points(table) && column.name.starts_with("runs_");
    let mut columns = in_order(table);
    columns.retain(|column| !is_part(table, column) && !is_count(column));
    columns
}

fn is_of_points(table: &Table) -> bool {
    table.columns.first().is_some_and(|column| column.name == RUNS)
}

/// Parameters, the columns that sort the rows, how the runs ended, what a search makes small, what the limits say, then the
/// measures that fit on a line.
fn main_columns<'a>(table: &'a Table, minimised: &[ColumnId], sort: &[String]) -> Vec<&'a Column> {
    let of_points = is_of_points(table);
    let mut columns: Vec<&Column> = table.columns.iter().take(usize::from(!of_points)).collect();
    columns.extend(table.parameters());
    for column in sorting(sort).filter_map(|name| table.column(name)) {
        if columns.iter().all(|known| known.name != column.name) {
            columns.push(column);
        }
    }
    let has_strategies = table.parameters().any(|column| column.name == STRATEGY);
    let loads = [ColumnId::PeakKineticEnergy, ColumnId::PeakVz];
    let limits = table.columns.iter().filter_map(|column| column.name.strip_prefix(MARGIN));
    let limits =
        limits.filter(|name| ColumnId::from_name(name).is_some_and(|id| id != ColumnId::Verdict));
    // The columns in their order, each with whether it is shown however long the line is. Where strategies are compared,
    // both measures of the impact are, although the speed is noisy; elsewhere the speed has no place.
    let mut names: Vec<(&str, bool)> = vec![
        (RUNS, true),
        (DEPLOYED, true),
        (ColumnId::Status.name(), true),
        (ColumnId::Verdict.name(), false),
        (DerivedColumn::Safety.name(), true),
        (SAFE, true),
        (DerivedColumn::SmallestMargin.name(), true),
        (DerivedColumn::SmallestMarginOf.name(), false),
        (DerivedColumn::VerdictDependsOn.name(), true),
    ];
    if of_points {
        let of_run = [ColumnId::Status.name(), ColumnId::Verdict.name()];
        names.retain(|(name, _)| !of_run.contains(name));
    }
    let minimised = minimised.iter().map(|id| id.name());
    names.extend(minimised.chain(limits).map(|name| (name, true)));
    let measures = MAIN_MEASURES.iter().filter(|id| has_strategies || **id != ColumnId::PeakVz);
    names.extend(
        measures.map(|id| (table.of_any_film(*id).name(), has_strategies && loads.contains(id))),
    );
    let mut shown: Vec<(&Column, bool)> = Vec::new();
    for (name, always) in names {
        let new = columns.iter().chain(shown.iter().map(|(column, _)| column));
        if let Some(column) = table.column(name).filter(|_| new.clone().all(|c| c.name != name))
            && column.cells.iter().any(|cell| *cell != crate::input::value::Value::Null)
        {
            shown.push((column, always));
        }
    }
    // What the limits say, ranges and proportions take more room.
    let judged = of_points || table.column(DerivedColumn::Safety.name()).is_some();
    let most = if judged { MAX_WIDE_LINE_WIDTH } else { MAX_LINE_WIDTH };
    let always = shown.iter().filter(|(_, always)| *always).map(|(column, _)| column);
    let mut used: usize = columns.iter().chain(always).map(|column| width(table, column) + 2).sum();
    shown.retain(|(column, always)| {
        let width = if *always { 0 } else { width(table, column) };
        let fits = *always || used + width <= most;
        used += if fits && !always { width + 2 } else { 0 };
        fits
    });
    columns.into_iter().chain(shown.into_iter().map(|(column, _)| column)).collect()
}
