//! Charts of stored results: histories of several jobs, one measure over one parameter, one measure over
//! two parameters.
//!
//! A chart reads only the table and the history files. It shows every job: a job without a value is a
//! letter in the figure, jobs without a history are counted below it. Nothing is averaged: every parameter
//! is an axis, gives lines, gives panels, or has one value. The runs that repeat a point (replicates) are its
//! median and range ([`runs`]).

use crate::analysis::answer::Answer;
use crate::input::keys;
use crate::input::value::Value;
use crate::job::result_limit::ResultLimit;
use crate::job::row::CellType;
use crate::platform::error::{Error, Result};
use crate::store::table::{Column, Table};

pub use self::limits::series_of;

use self::borders::Searched;
use self::parameters::Parameter;
use self::runs::Replicated;

pub mod borders;
mod encoding;
pub mod history;
mod importance;
pub mod kinds;
mod limits;
pub mod map;
mod names;
mod outcome;
pub mod over;
pub mod parameters;
mod positions;
pub mod runs;
mod search;
mod time_axis;
mod tornado;
pub mod work_precision;

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
    /// Title of the figure; empty for that of the chart.
    pub title: String,
    /// What the results must meet to be safe.
    pub limits: &'a [ResultLimit],
    /// The runs of each row, where the table is condensed.
    pub runs: Option<Replicated<'a>>,
    /// The search of the study.
    pub search: Option<Searched<'a>>,
    /// Its answer, where that says what makes the spread of a measure, or has an optimum.
    pub answer: Option<&'a Answer>,
}

impl<'a> Source<'a> {
    /// The lines below the title: study and rows, and the parameters that have one value in all of them.
    fn subtitle(&self) -> Vec<String> {
        let rows = self.rows.len();
        let noun = if rows == 1 { "point" } else { "points" };
        let choice = if self.choice.is_empty() { "" } else { " " };
        let runs = self.runs_text();
        let mut lines =
            vec![format!("study {}: {rows} {noun}{runs}{choice}{}", self.study, self.choice)];
        if let Some(first) = self.rows.first() {
            let fixed: Vec<String> = self
                .table
                .parameters()
                .filter(|column| parameters::is_fixed(column, &self.rows))
                .map(|column| Parameter::new(column, &self.rows).named(*first))
                .collect();
            if !fixed.is_empty() {
                lines.push(format!("Every point: {}", fixed.join(", ")));
            }
        }
        lines
    }

    /// The title: the given one, or that of the chart.
    fn title_or(&self, title: &str) -> String {
        if self.title.is_empty() { names::capital(title) } else { self.title.clone() }
    }

    /// The job id of a row.
    fn job(&self, row: usize) -> &'a str {
        match self.table.column("job").map(|column| &column.cells[row]) {
            Some(Value::Text(id)) => id,
            _ => "",
        }
    }

    /// The column of numbers with this name, which `option` asks for.
    fn measure(&self, option: &str, name: &str) -> Result<&'a Column> {
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
    fn parameter(&self, option: &str, name: &str) -> Result<&'a Column> {
        let found = self.table.parameters().find(|column| column.name == name);
        found.ok_or_else(|| {
            let replicates = self.runs.map_or(&[][..], |runs| runs.names);
            let names = self.table.parameters().map(|column| &column.name).chain(replicates);
            let names: Vec<&str> = names.map(String::as_str).collect();
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
    value.any_number().filter(|number| number.is_finite())
}

#[cfg(test)]
mod tests;
