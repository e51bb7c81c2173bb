//! The parameters of a chart: those with more than one value, without those that change together with
//! another one.

use std::collections::BTreeMap;

use super::names::{self, Name};
use super::number;
use crate::analysis::compare::{self, canonical};
use crate::input::keys::numerical::SEED;
use crate::input::value::{Value, short_number};
use crate::job::row::CellType;
use crate::render::figure::ticks::minus;
use crate::render::figure::unit::Unit;
use crate::store::table::{Column, Table};

/// The parameter whose values a study compares.
pub const STRATEGY: &str = "strategy";

/// A parameter and the unit in which it is shown.
#[derive(Debug, Clone, PartialEq)]
pub struct Parameter<'a> {
    /// Column of the table.
    pub column: &'a Column,
    /// Unit in which it is shown.
    pub unit: Unit,
    /// Significant digits of its numbers.
    digits: usize,
}

impl<'a> Parameter<'a> {
    /// The parameter of a column; its unit fits the values of these rows.
    pub fn new(column: &'a Column, rows: &[usize]) -> Self {
        let values = || rows.iter().filter_map(|row| number(&column.cells[*row]));
        let unit = shown_unit(column, values());
        let digits = digits(&values().map(|si| unit.shown(si)).collect::<Vec<_>>());
        Self { column, unit, digits }
    }

    /// Its plain name and symbol.
    pub fn plain(&self) -> Name {
        Name::of_parameter(self.name())
    }

    /// Its name as the heading of a legend.
    pub fn heading(&self) -> String {
        self.plain().with_symbol()
    }

    /// Name and value: "N 5", "mass flow rate 1 g/s".
    pub fn named(&self, row: usize) -> String {
        format!("{} {}", self.plain().before_value(), self.of_row(row))
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
            let texts = values.iter().map(|value| self.without_unit(value)).collect();
            (self.plain().label(&self.unit), texts)
        } else {
            let label = names::capital(&self.heading());
            (label, values.iter().map(|value| self.text(value)).collect())
        }
    }

    /// A value without its unit.
    pub fn without_unit(&self, value: &Value) -> String {
        match value {
            Value::Null => "–".to_owned(),
            Value::Integer(_) | Value::Number(_) => number(value)
                .map_or_else(|| value.to_string(), |si| rounded(self.unit.shown(si), self.digits)),
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

/// The unit of a parameter or measure in a chart: the one that the study writes, else the readable one for
/// these values.
pub fn shown_unit(column: &Column, values: impl IntoIterator<Item = f64>) -> Unit {
    Unit::shown_in(&column.shown, &column.unit, values)
}

/// The significant digits, three to six, at which different numbers have different texts.
fn digits(numbers: &[f64]) -> usize {
    let mut sorted = numbers.to_vec();
    sorted.sort_by(f64::total_cmp);
    sorted.dedup();
    let distinct = |digits: &usize| {
        sorted.windows(2).all(|pair| rounded(pair[0], *digits) != rounded(pair[1], *digits))
    };
    (3..6).find(distinct).unwrap_or(6)
}

/// A number with some significant digits; a whole number keeps all.
fn rounded(number: f64, digits: usize) -> String {
    let digits = digits.saturating_sub(1);
    let near: f64 = format!("{number:.digits$e}").parse().unwrap_or(number);
    let whole = number.fract() == 0.0;
    minus(&short_number(if whole { number } else { near }))
}

/// Parameters with more than one value in the rows, in the order of the study, and notes about those that
/// change together with another one: "Residual gas mass changes with inflation strategy". `axes` are not
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
            Some(other) => {
                let name = |column: &Column| Name::of_parameter(&column.name).plain;
                let (name, other) = (names::capital(&name(column)), name(other));
                notes.push(format!("{name} changes with {other}."));
            }
            None => kept.push(column),
        }
    }
    (kept.into_iter().map(|column| Parameter::new(column, rows)).collect(), notes)
}

/// Parameters with the inflation strategy first: strategies are compared side by side, by colour.
pub fn strategy_first(mut parameters: Vec<Parameter<'_>>) -> Vec<Parameter<'_>> {
    parameters.sort_by_key(|parameter| parameter.name() != STRATEGY);
    parameters
}

/// Whether a column has one value in some rows.
pub fn is_fixed(column: &Column, rows: &[usize]) -> bool {
    determines(None, column, rows)
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

/// Rows by panel.
#[derive(Debug, Clone, PartialEq)]
pub struct Facets<'a> {
    /// Titles and rows of the panels. A title names every parameter of the panels: `N 5, mass_flow_rate 1 g/s`.
    pub panels: Vec<(String, Vec<usize>)>,
    /// The parameters.
    pub parameters: Vec<Parameter<'a>>,
}

/// One panel per combination of some parameters, in order of value, the first parameter outermost.
pub fn facets<'a>(parameters: Vec<Parameter<'a>>, rows: &[usize]) -> Facets<'a> {
    let orders: Vec<Vec<Value>> =
        parameters.iter().map(|parameter| parameter.values(rows)).collect();
    let mut by_key: BTreeMap<Vec<usize>, Vec<usize>> = BTreeMap::new();
    for row in rows {
        let place = |(parameter, order): (&Parameter<'_>, &Vec<Value>)| {
            let value = &parameter.column.cells[*row];
            order.iter().position(|known| known == value).unwrap_or(usize::MAX)
        };
        let key = parameters.iter().zip(&orders).map(place).collect();
        by_key.entry(key).or_default().push(*row);
    }
    if by_key.is_empty() {
        // A figure without points says so in an empty panel.
        by_key.insert(Vec::new(), Vec::new());
    }
    let title = |rows: &[usize]| {
        let names = rows.first().map(|row| parameters.iter().map(|p| p.named(*row)));
        names.into_iter().flatten().collect::<Vec<_>>().join(", ")
    };
    let panels = by_key.into_values().map(|rows| (title(&rows), rows)).collect();
    Facets { panels, parameters }
}

/// What to do about a chart in which too many values of these parameters need a line or a panel each.
pub fn fix<'a>(parameters: impl Iterator<Item = &'a Parameter<'a>>) -> String {
    let names: Vec<&str> = parameters.map(Parameter::name).collect();
    format!("fix some of {} with --where CONDITION{}", names.join(", "), fix_seeds(&names))
}

/// The same about seeds, where `names` has them: after a semicolon. Empty without seeds.
pub fn fix_seeds(names: &[&str]) -> &'static str {
    if !names.contains(&SEED) {
        return "";
    }
    "; to have runs that differ in seed alone as a median with a range, write seed under replicates instead of grid, \
     then `billow run`, which computes no job again (and leave out --runs)"
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn numbers_are_short_and_distinct() {
        let texts = |numbers: &[f64]| -> Vec<String> {
            numbers.iter().map(|number| rounded(*number, digits(numbers))).collect()
        };
        assert_eq!(texts(&[0.1, 0.215_443, 100.0]), ["0.1", "0.215", "100"]);
        assert_eq!(texts(&[-1.000_01, 1.0, 1.000_02]), ["−1.00001", "1", "1.00002"]);
        assert_eq!(texts(&[1234.0, 12_345.0]), ["1234", "12345"]);
        assert!(texts(&[]).is_empty());
    }
}
