//! What became of a job, as a chart shows it: a marker where it has a value, a letter where not.

use std::collections::BTreeMap;

use super::Source;
use crate::input::value::Value;
use crate::job::Status;
use crate::render::figure::legend::{Legend, Sample};
use crate::render::figure::style::Fill;
use crate::store::table::Column;

/// What a done job without a value is called.
const NEVER: &str = "done, measure never happened";

/// Letters and marks of the rows of a chart, and how often each is used.
pub struct Outcomes<'a> {
    source: &'a Source<'a>,
    letters: BTreeMap<String, String>,
    marked: BTreeMap<String, usize>,
    lettered: BTreeMap<String, usize>,
}

impl<'a> Outcomes<'a> {
    /// Gives every way to end without a value a letter of its own.
    pub fn new(source: &'a Source<'a>) -> Self {
        let mut kinds: Vec<&str> = source.rows.iter().map(|row| status(source, *row)).collect();
        kinds.retain(|kind| *kind != Status::Done.name() && *kind != Status::Infeasible.name());
        // The common one first, so that its letter is always the same.
        kinds.sort_by_key(|kind| (*kind != Status::Pending.name(), *kind));
        kinds.dedup();
        let mut letters: BTreeMap<String, String> = BTreeMap::new();
        // An I would read as a line.
        letters.insert(NEVER.to_owned(), "–".to_owned());
        letters.insert(Status::Infeasible.name().to_owned(), "∅".to_owned());
        for kind in kinds {
            let free = |letter: &char| !letters.values().any(|used| used.starts_with(*letter));
            let own =
                kind.chars().filter(char::is_ascii_alphabetic).map(|c| c.to_ascii_uppercase());
            let letter = own.chain('A'..='Z').find(free).unwrap_or('?');
            letters.insert(kind.to_owned(), letter.to_string());
        }
        Self { source, letters, marked: BTreeMap::new(), lettered: BTreeMap::new() }
    }

    /// The marker of a job that is done, with a value.
    pub fn mark(&mut self, row: usize) -> Fill {
        let verdict = verdict(self.source, row);
        *self.marked.entry(verdict.to_owned()).or_default() += 1;
        fill(verdict)
    }

    /// The letter of a job without a value.
    pub fn letter(&mut self, row: usize) -> String {
        let status = status(self.source, row);
        let kind = if status == Status::Done.name() { NEVER } else { status };
        *self.lettered.entry(kind.to_owned()).or_default() += 1;
        self.letters.get(kind).cloned().unwrap_or_else(|| "?".to_owned())
    }

    /// The legend of what was used. A map's letters stand in cells.
    pub fn legend(&self, cells: bool) -> Legend {
        let marks = self.marked.iter().map(|(verdict, count)| {
            let name = if verdict.is_empty() { "done, no verdict" } else { verdict };
            (Sample::Marker(fill(verdict)), format!("{name} ({count})"))
        });
        let letters = self.lettered.iter().map(|(kind, count)| {
            let letter = self.letters.get(kind).cloned().unwrap_or_default();
            let text = if Status::from_name(kind).is_some_and(Status::is_failure) {
                format!("failed: {kind} ({count})")
            } else {
                format!("{kind} ({count})")
            };
            (if cells { Sample::Cell(letter) } else { Sample::Letter(letter) }, text)
        });
        Legend {
            heading: "Outcome (number of points)".to_owned(),
            entries: marks.chain(letters).collect(),
        }
    }
}

fn fill(verdict: &str) -> Fill {
    match verdict {
        "partial" => Fill::Open,
        "stalled" => Fill::Crossed,
        _ => Fill::Filled,
    }
}

fn text<'a>(source: &Source<'a>, name: &str, row: usize) -> &'a str {
    match source.table.column(name).map(|column| &column.cells[row]) {
        Some(Value::Text(text)) => text,
        _ => "",
    }
}

/// What a job measured; `None` too for one that did not run to its end: its peak so far is no peak.
pub fn value(source: &Source<'_>, measure: &Column, row: usize) -> Option<f64> {
    super::number(&measure.cells[row]).filter(|_| source.table.status(row) == Some(Status::Done))
}

/// How the job of a row ended.
pub fn status<'a>(source: &Source<'a>, row: usize) -> &'a str {
    text(source, "status", row)
}

/// Whether the job of a row failed.
pub fn has_failed(source: &Source<'_>, row: usize) -> bool {
    source.table.status(row).is_some_and(Status::is_failure)
}

/// The verdict of a row, empty for none.
pub fn verdict<'a>(source: &Source<'a>, row: usize) -> &'a str {
    text(source, "verdict", row)
}
