//! The outcome of a job in a chart: a marker if it has a value, a letter if not.

use std::collections::BTreeMap;

use billow_solver::output::measures::Verdict;

use super::Source;
use crate::input::value::Value;
use crate::job::Status;
use crate::job::proportion::Proportion;
use crate::render::figure::legend::{Legend, Sample};
use crate::render::figure::map::Cell;
use crate::render::figure::style::Fill;
use crate::store::table::Column;

/// Legend text of a done job without a value: the event that the measure describes did not occur.
const NOT_OCCURRED: &str = "done, event did not occur";

/// What a marker says of a point.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Outcome {
    /// The verdict of its job.
    Verdict(Option<Verdict>),
    /// Each of its runs deployed.
    All,
    /// Some of its runs deployed.
    Mixed,
    /// None of its runs deployed.
    None,
}

/// Every outcome with a marker, the best one first.
pub const OUTCOMES: [Outcome; 7] = [
    Outcome::All,
    Outcome::Mixed,
    Outcome::None,
    Outcome::Verdict(Some(Verdict::Deployed)),
    Outcome::Verdict(Some(Verdict::Partial)),
    Outcome::Verdict(Some(Verdict::Stalled)),
    Outcome::Verdict(None),
];

impl Outcome {
    /// The outcome of a row.
    pub fn of(source: &Source<'_>, row: usize) -> Self {
        let runs = source.runs_of(row).filter(|_| source.has_replicates());
        match runs.map(|runs| runs.deployed) {
            None => Self::Verdict(verdict(source, row)),
            Some(Proportion { of: 0, .. }) => Self::Verdict(None),
            Some(deployed) if deployed.is_mixed() => Self::Mixed,
            Some(Proportion { met: 0, .. }) => Self::None,
            Some(_) => Self::All,
        }
    }

    /// Its marker.
    pub fn fill(self) -> Fill {
        match self {
            Self::Verdict(verdict) => fill(verdict),
            Self::All => Fill::Filled,
            Self::Mixed => Fill::Half,
            Self::None => Fill::Crossed,
        }
    }

    /// Its name in a legend.
    pub fn name(self) -> &'static str {
        match self {
            Self::Verdict(verdict) => verdict.map_or("done, no verdict", Verdict::name),
            Self::All => "all runs deployed",
            Self::Mixed => "k/n: k of n runs deployed",
            Self::None => "no run deployed",
        }
    }
}

/// "3/5" where some of the runs of a row deployed; empty otherwise.
pub fn mixed_text(source: &Source<'_>, row: usize) -> String {
    match source.runs_of(row).map(|runs| runs.deployed) {
        Some(deployed) if deployed.is_mixed() => format!("{}/{}", deployed.met, deployed.of),
        _ => String::new(),
    }
}

/// Letters and markers of the rows of a chart, and how often each is used.
pub struct Outcomes<'a> {
    source: &'a Source<'a>,
    letters: BTreeMap<String, String>,
    marked: Vec<(Outcome, usize)>,
    lettered: BTreeMap<String, usize>,
}

impl<'a> Outcomes<'a> {
    /// Gives each status its letter.
    pub fn new(source: &'a Source<'a>) -> Self {
        let mut kinds: Vec<&str> = source.rows.iter().map(|row| status(source, *row)).collect();
        kinds.retain(|kind| *kind != Status::Done.name() && *kind != Status::Infeasible.name());
        // Pending comes first, so that its letter is always P.
        kinds.sort_by_key(|kind| (*kind != Status::Pending.name(), *kind));
        kinds.dedup();
        let mut letters: BTreeMap<String, String> = BTreeMap::new();
        // A letter I looks like a line; infeasible has the sign of the empty set.
        letters.insert(NOT_OCCURRED.to_owned(), "–".to_owned());
        letters.insert(Status::Infeasible.name().to_owned(), "∅".to_owned());
        for kind in kinds {
            let free = |letter: &char| !letters.values().any(|used| used.starts_with(*letter));
            let letters_of_name =
                kind.chars().filter(char::is_ascii_alphabetic).map(|c| c.to_ascii_uppercase());
            let letter = letters_of_name.chain('A'..='Z').find(free).unwrap_or('?');
            letters.insert(kind.to_owned(), letter.to_string());
        }
        Self { source, letters, marked: Vec::new(), lettered: BTreeMap::new() }
    }

    /// The marker of a job that is done, with a value.
    pub fn mark(&mut self, row: usize) -> Fill {
        let outcome = Outcome::of(self.source, row);
        match self.marked.iter_mut().find(|(known, _)| *known == outcome) {
            Some((_, count)) => *count += 1,
            None => self.marked.push((outcome, 1)),
        }
        outcome.fill()
    }

    /// The letter of a job without a value.
    pub fn letter(&mut self, row: usize) -> String {
        let status = status(self.source, row);
        let kind = if status == Status::Done.name() { NOT_OCCURRED } else { status };
        *self.lettered.entry(kind.to_owned()).or_default() += 1;
        self.letters.get(kind).cloned().unwrap_or_else(|| "?".to_owned())
    }

    /// The legend of the markers and letters in use. With `cells` the letters stand in cells, as in a map.
    pub fn legend(&self, cells: bool) -> Legend {
        let marked = OUTCOMES
            .into_iter()
            .filter_map(|outcome| self.marked.iter().find(|(known, _)| *known == outcome));
        let marks = marked.map(|(outcome, count)| {
            (Sample::Marker(outcome.fill()), format!("{} ({count})", outcome.name()))
        });
        let letters = self.lettered.iter().map(|(kind, count)| {
            let letter = self.letters.get(kind).cloned().unwrap_or_default();
            let text = if Status::from_name(kind).is_some_and(Status::is_failure) {
                format!("failed: {kind} ({count})")
            } else {
                format!("{kind} ({count})")
            };
            let sample =
                if cells { Sample::Cell(Cell::letter(letter)) } else { Sample::Letter(letter) };
            (sample, text)
        });
        Legend {
            heading: "Outcome (number of points)".to_owned(),
            entries: marks.chain(letters).collect(),
        }
    }
}

/// Every verdict, the best one first.
const VERDICTS: [Verdict; 3] = [Verdict::Deployed, Verdict::Partial, Verdict::Stalled];

/// The marker of a verdict.
pub fn fill(verdict: Option<Verdict>) -> Fill {
    match verdict {
        None | Some(Verdict::Deployed) => Fill::Filled,
        Some(Verdict::Partial) => Fill::Open,
        Some(Verdict::Stalled) => Fill::Crossed,
    }
}

fn text<'a>(source: &Source<'a>, name: &str, row: usize) -> &'a str {
    match source.table.column(name).map(|column| &column.cells[row]) {
        Some(Value::Text(text)) => text,
        _ => "",
    }
}

/// The measure of a job; `None` also for a job that stopped before its end, because its peak so far is not
/// the peak of the run. Of several runs the median, once one of them is done.
pub fn value(source: &Source<'_>, measure: &Column, row: usize) -> Option<f64> {
    let done = source.runs_of(row).is_some_and(|runs| !runs.measured.is_empty());
    let done = done || source.table.status(row) == Some(Status::Done);
    super::number(&measure.cells[row]).filter(|_| done)
}

/// The status of a row.
pub fn status<'a>(source: &Source<'a>, row: usize) -> &'a str {
    text(source, "status", row)
}

/// Whether the job of a row failed.
pub fn has_failed(source: &Source<'_>, row: usize) -> bool {
    source.table.status(row).is_some_and(Status::is_failure)
}

/// The verdict of a row.
pub fn verdict(source: &Source<'_>, row: usize) -> Option<Verdict> {
    let name = text(source, "verdict", row);
    VERDICTS.into_iter().find(|verdict| verdict.name() == name)
}
