//! `billow borders`: lists what the searches of a study found.

use std::io::Write;

use super::Format;
use super::options::{OutputOptions, QuietOption, SetOption, UnitsOption};
use super::print::{Heading, count, print_quantities};
use super::results::{self, StudyArgs};
use crate::analysis::answer::{Found, Searches};
use crate::input::units::DisplayUnit;
use crate::input::value::Value;
use crate::job::Status;
use crate::job::row::{CellType, ColumnId};
use crate::platform::error::{Error, Result};
use crate::store::table::select::filtered;
use crate::store::table::{Column, Table};
use crate::study::SearchResult;

/// Arguments of `billow borders`.
#[derive(Debug, clap::Args)]
pub struct Args {
    #[command(flatten)]
    study: StudyArgs,
    /// Only searches for which this condition holds, as in `strategy == 'rapid' and outcome == 'border'`.
    #[arg(long = "where", value_name = "CONDITION")]
    condition: Option<String>,
    #[command(flatten)]
    units: UnitsOption,
    #[command(flatten)]
    set: SetOption,
    #[command(flatten)]
    quiet: QuietOption,
    #[command(flatten)]
    output: OutputOptions,
}

/// Runs `billow borders`: one row per search.
///
/// # Errors
/// Results that cannot be read; a study without a search; an invalid condition.
pub fn run(args: &Args, out: &mut dyn Write) -> Result<()> {
    let results::Opened { stored, table } = results::open(&args.study, &args.set.set, &args.units)?;
    let units = &stored.units;
    let Some(searches) = Searches::of(&stored, &table) else {
        let name = stored.study.name.as_str();
        let allowed = "an axis of the grid as {\"bisect\": [low, high], \"on\": \"verdict\", \"safe\" or a limit}";
        return Err(Error::invalid_option("study", name, "searches no border", allowed, ""));
    };
    let mut borders = borders(&searches, &table);
    results::add_keys(&stored.study, &mut borders, units, &[], args.condition.as_deref());
    let rows = filtered(&borders, args.condition.as_deref())?;
    let format = args.output.format();
    let columns: Vec<&Column> =
        borders.columns.iter().filter(|column| is_printed(column, &searches, format)).collect();
    let headings: Vec<Heading> = columns
        .iter()
        .map(|column| Heading { name: column.name.clone(), unit: column.shown.clone() })
        .collect();
    let cells: Vec<Vec<Value>> = rows
        .iter()
        .map(|row| columns.iter().map(|column| column.cells[*row].clone()).collect())
        .collect();
    print_quantities(&headings, &cells, format, out)?;
    if format == Format::Table && !args.quiet.quiet {
        eprintln!(
            "{}: {}; low, high: nearest values at which the outcome is decided",
            searches.parameter, searches.criterion
        );
        let wide = |found: &&Found| found.undecided_inside(searches.replicates) > 0;
        let wide = searches.found.iter().filter(wide).count();
        if wide > 0 {
            eprintln!(
                "{}: runs disagree between low and high (not_decided), so the border is wider than the tolerance; more \
                 replicates make it narrower",
                count(wide, "search")
            );
        }
    }
    Ok(())
}

/// A table without columns that are empty in every row, and without those that only a condition needs.
fn is_printed(column: &Column, searches: &Searches, format: Format) -> bool {
    let is_parameter = searches
        .found
        .iter()
        .any(|found| found.parameters.iter().any(|(name, _, _)| *name == column.name));
    let is_fixed = COLUMNS.contains(&column.name.as_str());
    let is_full = column.cells.iter().any(|cell| !matches!(cell, Value::Null | Value::Integer(0)));
    let optional =
        ["changes", "limit", "not_decided", "not_judged", "open"].contains(&column.name.as_str());
    is_parameter || (is_fixed && (is_full || !optional || format != Format::Table))
}

/// The printed columns after the parameters.
const COLUMNS: [&str; 13] = [
    "outcome",
    "low",
    "high",
    "below",
    "limit",
    "from",
    "to",
    "changes",
    "values",
    "not_decided",
    "runs",
    "not_judged",
    "open",
];

/// The searches as a table: an outcome first, then the parameters, then what was found.
fn borders(searches: &Searches, table: &Table) -> Table {
    let found = &searches.found;
    let column = |name: &str, cell_type, of: &dyn Fn(&Found) -> Value| {
        Column::plain(name, cell_type, found.iter().map(of).collect())
    };
    let text = |text: &str| Value::Text(text.to_owned());
    let number = |number: usize| Value::Integer(i64::try_from(number).unwrap_or(i64::MAX));
    let value = |name: &str, of: &dyn Fn(&Found) -> Option<f64>| Column {
        unit: searches.unit.clone(),
        shown: searches.shown.clone(),
        ..column(name, CellType::Number, &|found| of(found).map_or(Value::Null, Value::Number))
    };
    let border = |found: &Found| match found.border.outcome {
        SearchResult::Border { low, high, .. } => Some([low, high]),
        _ => None,
    };
    let mut columns = vec![column("search", CellType::Text, &|_| Value::Null)];
    columns.extend(parameters(searches, table));
    // A column with this name ends the parameters of a table.
    columns.push(column(ColumnId::Status.name(), CellType::Text, &|found| {
        let open = found.border.outcome == SearchResult::Open;
        text(if open { Status::Pending.name() } else { Status::Done.name() })
    }));
    columns.extend([
        column("outcome", CellType::Text, &|found| text(found.outcome())),
        value("low", &|found| border(found).map(|ends| ends[0])),
        value("high", &|found| border(found).map(|ends| ends[1])),
        column("below", CellType::Text, &|found| {
            found.met_below().map_or(Value::Null, |met| text(if met { "met" } else { "not met" }))
        }),
        column("limit", CellType::Text, &|found| {
            found.limit.as_ref().map_or(Value::Null, |limit| text(limit))
        }),
        value("from", &|found| found.decided(searches.replicates).map(|ends| ends[0])),
        value("to", &|found| found.decided(searches.replicates).map(|ends| ends[1])),
        column("changes", CellType::Text, &|found| changes_text(searches, found)),
        column("values", CellType::Integer, &|found| number(found.border.levels.len())),
        column("not_decided", CellType::Integer, &|found| {
            number(found.undecided(searches.replicates).len())
        }),
        column("runs", CellType::Integer, &|found| {
            number(found.sum(|level| level.met.of + level.not_judged))
        }),
        column("not_judged", CellType::Integer, &|found| {
            number(found.sum(|level| level.not_judged))
        }),
        column("open", CellType::Integer, &|found| number(found.sum(|level| level.open))),
    ]);
    Table { columns }
}

/// The other parameters, as columns, with type and unit of the study's table.
fn parameters(searches: &Searches, table: &Table) -> Vec<Column> {
    let parameters = searches.found.first().map_or(&[][..], |first| first.parameters.as_slice());
    let column = |(index, (name, _, _)): (usize, &(String, Value, DisplayUnit))| {
        let known = table.parameters().find(|column| column.name == *name)?;
        let cells = searches.found.iter().map(|found| found.parameters[index].1.clone());
        Some(Column { cells: cells.collect(), ..known.clone() })
    };
    parameters.iter().enumerate().filter_map(column).collect()
}

/// The intervals in which the outcome changes, where there are several.
fn changes_text(searches: &Searches, found: &Found) -> Value {
    let SearchResult::NotMonotone(changes) = &found.border.outcome else { return Value::Null };
    let text = |[low, high]: &[f64; 2]| {
        let high = searches.shown.quantity(&Value::Number(*high));
        format!("{} to {high}", searches.shown.text(&Value::Number(*low)))
    };
    Value::Text(changes.iter().map(text).collect::<Vec<_>>().join("; "))
}
