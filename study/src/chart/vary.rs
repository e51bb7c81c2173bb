//! What tells the points of a chart apart: the parameters that take more than one value, less those that
//! go with another.

use std::collections::BTreeMap;

use super::number;
use crate::analysis::compare::{self, canonical};
use crate::input::value::{Value, short_number};
use crate::job::row::CellType;
use crate::render::figure::ticks::minus;
use crate::render::figure::unit::Unit;
use crate::store::table::{Column, Table};

/// A parameter and the unit it is shown in.
#[derive(Debug, Clone, PartialEq)]
pub struct Parameter<'a> {
    /// Its column.
    pub column: &'a Column,
    /// Its unit.
    pub unit: Unit,
}

impl<'a> Parameter<'a> {
    /// Of these rows.
    pub fn new(column: &'a Column, rows: &[usize]) -> Self {
        let values = rows.iter().filter_map(|row| number(&column.cells[*row]));
        Self { column, unit: Unit::fit(&column.unit, values) }
    }

    /// Its name.
    pub fn name(&self) -> &'a str {
        &self.column.name
    }

    /// A value as people write it, with its unit. A number among names is SI.
    pub fn text(&self, value: &Value) -> String {
        let text = self.bare(value);
        match value {
            Value::Integer(_) | Value::Number(_) => self.unit.behind(&text),
            Value::Text(number) if number.parse::<f64>().is_ok() => {
                Unit::si(&self.column.unit).behind(&text)
            }
            _ => text,
        }
    }

    /// The value of a row, so written.
    pub fn of_row(&self, row: usize) -> String {
        self.text(&self.column.cells[row])
    }

    /// Its values along an axis: the label of the axis and their texts. Numbers share the unit of the
    /// label, names bear their own.
    pub fn along(&self, values: &[Value], rows: &[usize]) -> (String, Vec<String>) {
        if self.is_number(rows) {
            let shown: Vec<f64> =
                values.iter().filter_map(number).map(|si| self.unit.shown(si)).collect();
            (self.unit.label(self.name()), distinct(&shown))
        } else {
            (self.name().to_owned(), values.iter().map(|value| self.text(value)).collect())
        }
    }

    /// The same without the unit.
    pub fn bare(&self, value: &Value) -> String {
        match value {
            Value::Null => "–".to_owned(),
            Value::Integer(_) | Value::Number(_) => number(value)
                .map_or_else(|| value.to_string(), |si| short_number(self.unit.shown(si))),
            other => other.to_string(),
        }
    }

    /// Its different values over some rows: numbers from the smallest up, what is no number in the
    /// order of the plan.
    pub fn values(&self, rows: &[usize]) -> Vec<Value> {
        let mut found = compare::values(self.column, rows);
        if self.is_number(rows) {
            found.sort_by(|one, other| {
                let key = |value| number(value).unwrap_or(f64::INFINITY);
                key(one).total_cmp(&key(other))
            });
        }
        found
    }

    /// Whether every row has a number of it.
    pub fn is_number(&self, rows: &[usize]) -> bool {
        matches!(self.column.cell_type, CellType::Integer | CellType::Number)
            && rows.iter().all(|row| number(&self.column.cells[*row]).is_some())
    }

    /// Whether it has a unit.
    pub fn is_quantity(&self) -> bool {
        !matches!(self.column.unit.as_str(), "" | "1")
    }
}

/// Numbers to four significant digits, to six where that would make two of them the same.
fn distinct(numbers: &[f64]) -> Vec<String> {
    let short = |number: &f64| {
        let rounded = format!("{number:.3e}").parse().unwrap_or(*number);
        minus(&short_number(rounded))
    };
    let texts: Vec<String> = numbers.iter().map(short).collect();
    if texts.windows(2).all(|pair| pair[0] != pair[1]) {
        texts
    } else {
        numbers.iter().map(|number| minus(&short_number(*number))).collect()
    }
}

/// Parameters that take more than one value over the rows, in the order of the study, and those that go
/// with another of them: "`residual_gas_mass` goes with `strategy`". `axes` are not among the first, but
/// others may go with them.
pub fn varying<'a>(
    table: &'a Table,
    rows: &[usize],
    axes: &[&'a Column],
) -> (Vec<Parameter<'a>>, Vec<String>) {
    let mut kept: Vec<&Column> = Vec::new();
    let mut notes = Vec::new();
    for column in table.parameters() {
        let axis = axes.iter().any(|axis| axis.name == column.name);
        if axis || decides(None, column, rows) {
            continue;
        }
        let mut others = axes.iter().chain(&kept);
        match others.find(|other| decides(Some(other), column, rows)) {
            Some(other) => notes.push(format!("{} goes with {}.", column.name, other.name)),
            None => kept.push(column),
        }
    }
    (kept.into_iter().map(|column| Parameter::new(column, rows)).collect(), notes)
}

/// Whether one value of `one` always comes with the same value of `other`; without `one`, whether
/// `other` is the same everywhere.
fn decides(one: Option<&Column>, other: &Column, rows: &[usize]) -> bool {
    let mut pairs: BTreeMap<Option<String>, &Value> = BTreeMap::new();
    rows.iter().all(|row| {
        let key = one.map(|column| canonical(&column.cells[*row]));
        let value = &other.cells[*row];
        *pairs.entry(key).or_insert(value) == value
    })
}

/// Rows with the same values of some parameters.
#[derive(Debug, Clone, PartialEq)]
pub struct Group {
    /// Those values: "5, 1 g/s".
    pub values: String,
    /// Names and values: `N 5, mass_flow_rate 1 g/s`.
    pub named: String,
    /// Its rows.
    pub rows: Vec<usize>,
}

/// Rows grouped by the values of some parameters, in order of value, the first parameter outermost.
pub fn groups(parameters: &[Parameter<'_>], rows: &[usize]) -> Vec<Group> {
    let orders: Vec<Vec<Value>> = parameters.iter().map(|each| each.values(rows)).collect();
    let key = |row: usize| -> Vec<usize> {
        let pairs = parameters.iter().zip(&orders);
        pairs
            .map(|(each, order)| {
                let value = &each.column.cells[row];
                order.iter().position(|known| known == value).unwrap_or(usize::MAX)
            })
            .collect()
    };
    let mut keyed: Vec<(Vec<usize>, usize)> = rows.iter().map(|row| (key(*row), *row)).collect();
    keyed.sort();
    keyed
        .chunk_by(|one, other| one.0 == other.0)
        .map(|group| {
            let row = group[0].1;
            let texts: Vec<String> = parameters.iter().map(|each| each.of_row(row)).collect();
            let named: Vec<String> = parameters
                .iter()
                .zip(&texts)
                .map(|(each, text)| format!("{} {text}", each.name()))
                .collect();
            Group {
                values: texts.join(", "),
                named: named.join(", "),
                rows: group.iter().map(|(_, row)| *row).collect(),
            }
        })
        .collect()
}

/// Rows by panel.
#[derive(Debug, Clone, PartialEq)]
pub struct Facets<'a> {
    /// What tells the panels apart, where their titles give values alone; else empty.
    pub heading: String,
    /// Titles and rows of the panels.
    pub panels: Vec<(String, Vec<usize>)>,
    /// The parameters.
    pub parameters: Vec<Parameter<'a>>,
}

/// Letters the title of a panel has room for, about.
const TITLE: usize = 26;

/// A panel for every combination of some parameters. Titles name the parameters where there is room.
pub fn facets<'a>(parameters: Vec<Parameter<'a>>, rows: &[usize]) -> Facets<'a> {
    let groups = groups(&parameters, rows);
    let short = groups.iter().all(|group| group.named.chars().count() <= TITLE);
    let named = short || parameters.len() == 1;
    let title = |group: &Group| if named { group.named.clone() } else { group.values.clone() };
    Facets {
        heading: if named { String::new() } else { heading(&parameters) },
        panels: groups.iter().map(|group| (title(group), group.rows.clone())).collect(),
        parameters,
    }
}

/// Names of parameters, as a heading.
pub fn heading(parameters: &[Parameter<'_>]) -> String {
    parameters.iter().map(Parameter::name).collect::<Vec<_>>().join(", ")
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn numbers_along_an_axis_are_short_and_stay_apart() {
        assert_eq!(distinct(&[0.1, 0.215_443, 100.0]), ["0.1", "0.2154", "100"]);
        assert_eq!(distinct(&[-1.000_01, 1.0, 1.000_02]), ["−1.00001", "1", "1.00002"]);
        assert!(distinct(&[]).is_empty());
    }
}
