//! The parameters of a chart: those with more than one value, without those that change together with
//! another one.

use std::collections::BTreeMap;

use super::number;
use crate::analysis::compare::{self, canonical};
use crate::input::value::{Value, short_number};
use crate::job::row::CellType;
use crate::render::figure::ticks::minus;
use crate::render::figure::unit::Unit;
use crate::store::table::{Column, Table};

/// A parameter and the unit in which it is shown.
#[derive(Debug, Clone, PartialEq)]
pub struct Parameter<'a> {
    /// Column of the table.
    pub column: &'a Column,
    /// Unit in which it is shown.
    pub unit: Unit,
}

impl<'a> Parameter<'a> {
    /// The parameter of a column; its unit fits the values of these rows.
    pub fn new(column: &'a Column, rows: &[usize]) -> Self {
        let values = rows.iter().filter_map(|row| number(&column.cells[*row]));
        Self { column, unit: Unit::shown_in(&column.shown, &column.unit, values) }
    }

    /// Name.
    pub fn name(&self) -> &'a str {
        &self.column.name
    }

    /// A value with its unit. A number in a column of texts is SI.
    pub fn text(&self, value: &Value) -> String {
        let text = self.without_unit(value);
        match value {
            Value::Integer(_) | Value::Number(_) => self.unit.after(&text),
            Value::Text(number) if number.parse::<f64>().is_ok() => {
                Unit::si(&self.column.unit).after(&text)
            }
            _ => text,
        }
    }

    /// The value of a row, with its unit.
    pub fn of_row(&self, row: usize) -> String {
        self.text(&self.column.cells[row])
    }

    /// Label of an axis of this parameter, and the texts of its values. The unit of numbers stands in the
    /// label; texts have their units themselves.
    pub fn along(&self, values: &[Value], rows: &[usize]) -> (String, Vec<String>) {
        if self.is_number(rows) {
            let shown: Vec<f64> =
                values.iter().filter_map(number).map(|si| self.unit.shown(si)).collect();
            (self.unit.label(self.name()), distinct(&shown))
        } else {
            (self.name().to_owned(), values.iter().map(|value| self.text(value)).collect())
        }
    }

    /// A value without its unit.
    pub fn without_unit(&self, value: &Value) -> String {
        match value {
            Value::Null => "–".to_owned(),
            Value::Integer(_) | Value::Number(_) => number(value)
                .map_or_else(|| value.to_string(), |si| short_number(self.unit.shown(si))),
            other => other.to_string(),
        }
    }

    /// Distinct values in some rows: numbers in increasing order, other values in plan order.
    pub fn values(&self, rows: &[usize]) -> Vec<Value> {
        let mut found = compare::values(self.column, rows);
        if self.is_number(rows) {
            found.sort_by(|a, b| {
                let key = |value| number(value).unwrap_or(f64::INFINITY);
                key(a).total_cmp(&key(b))
            });
        }
        found
    }

    /// Whether every row has a number.
    pub fn is_number(&self, rows: &[usize]) -> bool {
        matches!(self.column.cell_type, CellType::Integer | CellType::Number)
            && rows.iter().all(|row| number(&self.column.cells[*row]).is_some())
    }

    /// Whether it has a unit.
    pub fn is_quantity(&self) -> bool {
        !matches!(self.column.unit.as_str(), "" | "1")
    }
}

/// Numbers with four significant digits; with six if four make two of them equal.
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

/// Parameters with more than one value in the rows, in the order of the study, and notes about those that
/// change together with another one: "`residual_gas_mass` changes with `strategy`". `axes` are not
/// returned, but other parameters can change with them.
pub fn varying<'a>(
    table: &'a Table,
    rows: &[usize],
    axes: &[&'a Column],
) -> (Vec<Parameter<'a>>, Vec<String>) {
    let mut kept: Vec<&Column> = Vec::new();
    let mut notes = Vec::new();
    for column in table.parameters() {
        let axis = axes.iter().any(|axis| axis.name == column.name);
        if axis || determines(None, column, rows) {
            continue;
        }
        let mut others = axes.iter().chain(&kept);
        match others.find(|other| determines(Some(other), column, rows)) {
            Some(other) => notes.push(format!("{} changes with {}.", column.name, other.name)),
            None => kept.push(column),
        }
    }
    (kept.into_iter().map(|column| Parameter::new(column, rows)).collect(), notes)
}

/// Whether equal values of `cause` always have equal values of `effect`; without `cause`, whether `effect`
/// has one value.
fn determines(cause: Option<&Column>, effect: &Column, rows: &[usize]) -> bool {
    let mut pairs: BTreeMap<Option<String>, &Value> = BTreeMap::new();
    rows.iter().all(|row| {
        let key = cause.map(|column| canonical(&column.cells[*row]));
        let value = &effect.cells[*row];
        *pairs.entry(key).or_insert(value) == value
    })
}

/// Rows with equal values of some parameters.
#[derive(Debug, Clone, PartialEq)]
pub struct Group {
    /// The values: "5, 1 g/s".
    pub values: String,
    /// Names and values: `N 5, mass_flow_rate 1 g/s`.
    pub named: String,
    /// The rows.
    pub rows: Vec<usize>,
}

/// Rows grouped by the values of some parameters, in order of value, the first parameter outermost.
pub fn groups(parameters: &[Parameter<'_>], rows: &[usize]) -> Vec<Group> {
    let orders: Vec<Vec<Value>> =
        parameters.iter().map(|parameter| parameter.values(rows)).collect();
    let key = |row: usize| -> Vec<usize> {
        let pairs = parameters.iter().zip(&orders);
        pairs
            .map(|(parameter, order)| {
                let value = &parameter.column.cells[row];
                order.iter().position(|known| known == value).unwrap_or(usize::MAX)
            })
            .collect()
    };
    let mut keyed: Vec<(Vec<usize>, usize)> = rows.iter().map(|row| (key(*row), *row)).collect();
    keyed.sort();
    keyed
        .chunk_by(|a, b| a.0 == b.0)
        .map(|group| {
            let row = group[0].1;
            let texts: Vec<String> =
                parameters.iter().map(|parameter| parameter.of_row(row)).collect();
            let named: Vec<String> = parameters
                .iter()
                .zip(&texts)
                .map(|(parameter, text)| format!("{} {text}", parameter.name()))
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
    /// Names of the parameters if the titles give only their values; else empty.
    pub heading: String,
    /// Titles and rows of the panels.
    pub panels: Vec<(String, Vec<usize>)>,
    /// The parameters.
    pub parameters: Vec<Parameter<'a>>,
}

/// Most characters of a panel title, approximately.
const MAX_TITLE_LENGTH: usize = 26;

/// One panel per combination of some parameters. The titles name the parameters if there is space.
pub fn facets<'a>(parameters: Vec<Parameter<'a>>, rows: &[usize]) -> Facets<'a> {
    let groups = groups(&parameters, rows);
    let short = groups.iter().all(|group| group.named.chars().count() <= MAX_TITLE_LENGTH);
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
    fn axis_numbers_are_short_and_distinct() {
        assert_eq!(distinct(&[0.1, 0.215_443, 100.0]), ["0.1", "0.2154", "100"]);
        assert_eq!(distinct(&[-1.000_01, 1.0, 1.000_02]), ["−1.00001", "1", "1.00002"]);
        assert!(distinct(&[]).is_empty());
    }
}
