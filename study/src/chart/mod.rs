//! Charts of stored results: histories of several jobs, one measure over one parameter, one measure over
//! two parameters.
//!
//! A chart reads only the table and the history files. It shows every job: a job without a value is a
//! letter in the figure, jobs without a history are counted below it. Nothing is averaged: every parameter
//! is an axis, gives lines, gives panels, or has one value.

use crate::input::keys;
use crate::input::value::Value;
use crate::job::row::CellType;
use crate::platform::error::{Error, Result};
use crate::store::table::{Column, Table};

use self::parameters::Facets;

pub mod history;
pub mod map;
mod outcome;
pub mod over;
mod parameters;
pub mod standard;

/// The rows of a chart.
#[derive(Debug, Clone, PartialEq)]
pub struct Source<'a> {
    /// Name of the study.
    pub study: &'a str,
    /// The table of the study.
    pub table: &'a Table,
    /// Rows of the table, in plan order.
    pub rows: Vec<usize>,
    /// How the rows were chosen, as in "where N == 6"; empty for all rows.
    pub choice: String,
}

impl Source<'_> {
    /// The line below the title: study and rows.
    fn subtitle(&self) -> Vec<String> {
        let rows = self.rows.len();
        let noun = if rows == 1 { "point" } else { "points" };
        let choice = if self.choice.is_empty() { "" } else { " " };
        vec![format!("study {}: {rows} {noun}{choice}{}", self.study, self.choice)]
    }

    /// The same, and the parameters of the panels.
    fn subtitle_by(&self, panels: &Facets<'_>) -> Vec<String> {
        let mut lines = self.subtitle();
        if !panels.heading.is_empty() {
            lines.push(format!("panels by {}", panels.heading));
        }
        lines
    }

    /// The column of numbers with this name, which `option` asks for.
    fn measure(&self, option: &str, name: &str) -> Result<&Column> {
        let numbers = || {
            let columns = self.table.columns.iter();
            columns
                .filter(|column| matches!(column.cell_type, CellType::Integer | CellType::Number))
        };
        let found = numbers().find(|column| column.name == name);
        found.ok_or_else(|| {
            let exists = self.table.column(name).is_some();
            let problem = if exists { "not a column of numbers" } else { "no such column" };
            let names: Vec<&str> = numbers().map(|column| column.name.as_str()).collect();
            unknown_name(option, name, problem, &names)
        })
    }

    /// The parameter with this name, which `option` asks for.
    fn parameter(&self, option: &str, name: &str) -> Result<&Column> {
        let found = self.table.parameters().find(|column| column.name == name);
        found.ok_or_else(|| {
            let names: Vec<&str> =
                self.table.parameters().map(|column| column.name.as_str()).collect();
            unknown_name(option, name, "not a parameter that this study varies", &names)
        })
    }
}

/// The error of an unknown name; it gives the nearest known one.
fn unknown_name(option: &str, name: &str, problem: &str, known: &[&str]) -> Error {
    let near = keys::nearest(name, known.iter().copied());
    let hint = near.map(|near| format!("did you mean {near}?")).unwrap_or_default();
    invalid_option(option, name, problem, known.join(", "), hint)
}

/// The error of an invalid value of a command-line option.
fn invalid_option(
    option: &str,
    value: &str,
    problem: impl Into<String>,
    allowed: impl Into<String>,
    hint: impl Into<String>,
) -> Error {
    Error::invalid_option(option, value, problem, allowed, hint)
}

/// A cell as a finite number.
fn number(value: &Value) -> Option<f64> {
    match value {
        Value::Integer(value) => Some(*value as f64),
        Value::Number(value) if value.is_finite() => Some(*value),
        _ => None,
    }
}

/// A title: the meaning of a quantity, then its name in brackets.
fn title(meaning: &str, name: &str) -> String {
    let mut letters = meaning.chars();
    match letters.next() {
        Some(first) => format!("{}{} ({name})", first.to_uppercase(), letters.as_str()),
        None => name.to_owned(),
    }
}

#[cfg(test)]
mod tests;
