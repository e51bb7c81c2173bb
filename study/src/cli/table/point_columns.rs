//! The columns of the points of a study with replicates: those asked for, or those that fit on a line.

use super::MAX_WIDE_LINE_WIDTH;
use super::columns::{compares_strategies, limited, main_measures, sorting};
use crate::cli::Format;
use crate::cli::points::{DEPLOYED, Points, RANGE, RUNS};
use crate::cli::print::Heading;
use crate::input::value::Value;
use crate::job::row::{ColumnId, DerivedColumn};
use crate::platform::error::{Error, Result};
use crate::store::table::select::find;
use crate::store::table::{Column, Table};

/// A column with its cells as printed.
pub struct Printed {
    pub heading: Heading,
    pub cells: Vec<Value>,
}

impl Printed {
    /// A column of points. A table has a measure with its range in one cell; csv and json have one number.
    fn new(points: &Points<'_>, column: &Column, format: Format) -> Self {
        let rows = 0..points.table.rows();
        let cell = |row: usize| match format {
            Format::Table => points.cell(column, row),
            Format::Csv | Format::Json => column.cells[row].clone(),
        };
        let heading = Heading { name: column.name.clone(), unit: column.shown.clone() };
        Self { heading, cells: rows.map(cell).collect() }
    }

    /// Its width, characters.
    fn width(&self) -> usize {
        let width = |cell: &Value| match cell {
            Value::Null => 1,
            cell => self.heading.unit.text(cell).chars().count(),
        };
        self.cells.iter().map(width).max().unwrap_or(0).max(self.heading.width())
    }

    fn has_values(&self) -> bool {
        self.cells.iter().any(|cell| *cell != Value::Null)
    }
}

/// The columns to print. `runs` is the table of the single runs.
///
/// # Errors
/// An unknown column, or one of the single runs.
pub fn chosen(
    points: &Points<'_>,
    runs: &Table,
    names: &[String],
    sort: &[String],
    format: Format,
) -> Result<Vec<Printed>> {
    let printed = |column: &Column| Printed::new(points, column, format);
    match names {
        [] if format == Format::Table => Ok(main_columns(points, sort)),
        [] => Ok(all(&points.table, format).into_iter().map(printed).collect()),
        [name] if name == "all" => {
            Ok(all(&points.table, format).into_iter().map(printed).collect())
        }
        names => names
            .iter()
            .map(|name| Ok(printed(find_point(points, runs, "--columns", name.trim())?)))
            .collect(),
    }
}

/// The column of the points with that name, which `option` asks for.
///
/// # Errors
/// When there is none, also when only the single runs have it.
pub fn find_point<'a>(
    points: &'a Points<'_>,
    runs: &Table,
    option: &str,
    name: &str,
) -> Result<&'a Column> {
    let current = name;
    let known = |table: &Table| table.column(name).or(table.column(current)).is_some();
    if known(runs) && !known(&points.table) {
        let problem = "is a column of single runs, and each row is a point of several runs";
        let allowed = "a column of `--columns all`";
        let hint = "--runs prints the single runs";
        return Err(Error::invalid_option(option, name, problem, allowed, hint));
    }
    find(&points.table, option, name)
}

/// Every column, parameters first. A table has the range of a measure in the cell of the measure, and the
/// numbers of runs and the interval of a proportion in one cell each.
pub fn all(table: &Table, format: Format) -> Vec<&Column> {
    let mut columns: Vec<&Column> = table.parameters().collect();
    let rest = table.columns.iter().skip(1 + columns.len());
    columns.push(&table.columns[0]);
    let is_part = |column: &Column| {
        let ends = RANGE.iter().chain(&["_of", "_low", "_high"]);
        let whole = ends.filter_map(|end| column.name.strip_suffix(end));
        let safe = DerivedColumn::Safe.name();
        whole.into_iter().any(|whole| {
            let range = table.column(&format!("{whole}{}", RANGE[0])).is_some();
            range || [DEPLOYED, safe].contains(&whole)
        }) || column.name.starts_with("runs_")
    };
    columns.extend(rest.filter(|column| format != Format::Table || !is_part(column)));
    columns
}

/// Parameters, the columns that sort the rows, runs, proportions and smallest margin, then the main measures
/// that fit on a line. Where strategies are compared, both measures of the impact are always there.
fn main_columns(points: &Points<'_>, sort: &[String]) -> Vec<Printed> {
    let table = &points.table;
    let mut columns: Vec<&Column> = table.parameters().collect();
    columns.extend(sorting(table, sort, &columns));
    let first: Vec<&str> = columns.iter().map(|column| column.name.as_str()).collect();
    let of = DerivedColumn::SmallestMarginOf.name();
    let mut always = vec![
        RUNS,
        DEPLOYED,
        DerivedColumn::Safe.name(),
        DerivedColumn::SmallestMargin.name(),
        DerivedColumn::VerdictDependsOn.name(),
    ];
    if compares_strategies(table) {
        always.extend([ColumnId::PeakKineticEnergy.name(), ColumnId::PeakVz.name()]);
    }
    let limited = limited(table);
    for name in &limited {
        if !always.contains(name) && ColumnId::from_name(name) != Some(ColumnId::Verdict) {
            always.push(name);
        }
    }
    let measures = main_measures(table);
    let mut order = always[..4].to_vec();
    order.push(of);
    order.push(always[4]);
    order.extend(&limited);
    order.extend(&measures);
    let printed = |name: &&str| {
        let column = table.column(name).filter(|_| !first.contains(name))?;
        Some(Printed::new(points, column, Format::Table)).filter(Printed::has_values)
    };
    let mut chosen: Vec<(usize, Printed)> = Vec::new();
    let mut width: usize = 0;
    let start = columns.iter().map(|column| Printed::new(points, column, Format::Table));
    let start: Vec<Printed> = start.collect();
    width += start.iter().map(|column| column.width() + 2).sum::<usize>();
    let optional = measures.iter().take(2).chain([&of]).chain(measures.iter().skip(2));
    let optional = optional.filter(|name| !always.contains(name));
    for (name, is_optional) in
        always.iter().map(|name| (name, false)).chain(optional.map(|name| (name, true)))
    {
        let Some(column) = printed(name) else { continue };
        let position = order.iter().position(|known| known == name).unwrap_or(order.len());
        if !is_optional || width + column.width() <= MAX_WIDE_LINE_WIDTH {
            width += column.width() + 2;
            chosen.push((position, column));
        }
    }
    chosen.sort_by_key(|(position, _)| *position);
    start.into_iter().chain(chosen.into_iter().map(|(_, column)| column)).collect()
}
