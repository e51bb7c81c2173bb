//! Charts of stored results: histories of several jobs, one measure over an axis, one measure over two.
//!
//! A chart reads the table and the history files and nothing else. No job is dropped in silence: one
//! without a value is a letter in the figure, one without a history is named below it. Nothing is
//! averaged: every parameter is an axis, tells lines apart, tells panels apart, or is the same for all.

use crate::input::keys;
use crate::input::value::Value;
use crate::job::row::CellType;
use crate::platform::error::{Error, InputError, Result};
use crate::render::figure::legend::Sample;
use crate::store::table::{Column, Table};

use self::vary::Facets;

pub mod history;
pub mod map;
mod outcome;
pub mod over;
pub mod standard;
mod vary;

/// The rows a chart is drawn from.
#[derive(Debug, Clone, PartialEq)]
pub struct Source<'a> {
    /// Name of the study.
    pub study: &'a str,
    /// Its table.
    pub table: &'a Table,
    /// Rows of it, in plan order.
    pub rows: Vec<usize>,
    /// How they were chosen, as in "where N == 6"; empty for all.
    pub choice: String,
}

impl Source<'_> {
    /// The line below the title: which study, which rows.
    fn subtitle(&self) -> Vec<String> {
        let rows = self.rows.len();
        let noun = if rows == 1 { "point" } else { "points" };
        let choice = if self.choice.is_empty() { "" } else { " " };
        vec![format!("study {}: {rows} {noun}{choice}{}", self.study, self.choice)]
    }

    /// The same, and what tells panels apart.
    fn subtitle_by(&self, panels: &Facets<'_>) -> Vec<String> {
        let mut lines = self.subtitle();
        if !panels.heading.is_empty() {
            lines.push(format!("panels by {}", panels.heading));
        }
        lines
    }

    /// A column of numbers.
    fn measure(&self, flag: &str, name: &str) -> Result<&Column> {
        let numbers = || {
            let columns = self.table.columns.iter();
            columns
                .filter(|column| matches!(column.cell_type, CellType::Integer | CellType::Number))
        };
        let found = numbers().find(|column| column.name == name);
        found.ok_or_else(|| {
            let there = self.table.column(name).is_some();
            let problem = if there { "not a column of numbers" } else { "no such column" };
            let names: Vec<&str> = numbers().map(|column| column.name.as_str()).collect();
            unknown(flag, name, problem, &names)
        })
    }

    /// A parameter of the study.
    fn parameter(&self, flag: &str, name: &str) -> Result<&Column> {
        let found = self.table.parameters().find(|column| column.name == name);
        found.ok_or_else(|| {
            let names: Vec<&str> =
                self.table.parameters().map(|column| column.name.as_str()).collect();
            unknown(flag, name, "not a parameter this study varies", &names)
        })
    }
}

/// A name that is none of those there are.
fn unknown(flag: &str, name: &str, problem: &str, known: &[&str]) -> Error {
    let near = keys::nearest(name, known.iter().copied());
    let hint = near.map(|near| format!("did you mean {near}?")).unwrap_or_default();
    refused(flag, name, problem, known.join(", "), hint)
}

fn refused(
    flag: &str,
    value: &str,
    problem: impl Into<String>,
    allowed: impl Into<String>,
    hint: impl Into<String>,
) -> Error {
    Error::from(InputError {
        file: flag.to_owned(),
        key: String::new(),
        value: value.to_owned(),
        problem: problem.into(),
        allowed: allowed.into(),
        hint: hint.into(),
    })
}

/// A cell as a number; `None` for what is none or not finite.
fn number(value: &Value) -> Option<f64> {
    match value {
        Value::Integer(value) => Some(*value as f64),
        Value::Number(value) if value.is_finite() => Some(*value),
        _ => None,
    }
}

/// A title: the meaning of a quantity first, its name behind.
fn titled(meaning: &str, name: &str) -> String {
    let mut letters = meaning.chars();
    match letters.next() {
        Some(first) => format!("{}{} ({name})", first.to_uppercase(), letters.as_str()),
        None => name.to_owned(),
    }
}

#[cfg(test)]
mod tests;
