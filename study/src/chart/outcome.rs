//! How the job of a point ended, in a chart: a marker if it has a value, a letter if not.

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

/// The markers of points with a value, and their names in a legend: of several runs, then of one run.
pub const MARKERS: [(Fill, &str); 7] = [
    (Fill::Filled, "all runs deployed"),
    (Fill::Half, "k/n: k of n runs deployed"),
    (Fill::Crossed, "no run deployed"),
    (Fill::Filled, "deployed"),
    (Fill::Open, "partial"),
    (Fill::Crossed, "stalled"),
    (Fill::Filled, "done, no verdict"),
];

/// The marker of a row, as an index of [`MARKERS`].
pub fn marker(source: &Source<'_>, row: usize) -> usize {
    match source.runs_of(row).filter(|_| source.has_replicates()).map(|runs| runs.deployed) {
        None => match verdict(source, row) {
            Some(Verdict::Deployed) => 3,
            Some(Verdict::Partial) => 4,
            Some(Verdict::Stalled) => 5,
            None => 6,
        },
        Some(Proportion { of: 0, .. }) => 6,
        Some(Proportion { met: 0, .. }) => 2,
        Some(deployed) => usize::from(deployed.is_mixed()),
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
    marked: [usize; MARKERS.len()],
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
        // A letter I looks like a line; infeasible has the sign of the empty set.
        let fixed = [(NOT_OCCURRED, "–"), (Status::Infeasible.name(), "∅")];
        let mut letters: BTreeMap<String, String> =
            fixed.map(|(kind, letter)| (kind.to_owned(), letter.to_owned())).into();
        for kind in kinds {
            let free = |letter: &char| !letters.values().any(|used| used.starts_with(*letter));
            let of_name = kind.chars().filter(char::is_ascii_alphabetic);
            let of_name = of_name.map(|letter| letter.to_ascii_uppercase());
            let letter = of_name.chain('A'..='Z').find(free).unwrap_or('?');
            letters.insert(kind.to_owned(), letter.to_string());
        }
        Self { source, letters, marked: [0; MARKERS.len()], lettered: BTreeMap::new() }
    }

    /// The marker of a job that is done, with a value.
    pub fn mark(&mut self, row: usize) -> Fill {
        let marker = marker(self.source, row);
        self.marked[marker] += 1;
        MARKERS[marker].0
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
        let marked = MARKERS.iter().zip(self.marked).filter(|(_, count)| *count > 0);
        let marks = marked
            .map(|((fill, name), count)| (Sample::Marker(*fill), format!("{name} ({count})")));
        let letters = self.lettered.iter().map(|(kind, count)| {
            let letter = self.letters.get(kind).cloned().unwrap_or_default();
            let failed = Status::from_name(kind).is_some_and(Status::is_failure);
            let text = format!("{}{kind} ({count})", if failed { "failed: " } else { "" });
            let sample =
                if cells { Sample::Cell(Cell::letter(letter)) } else { Sample::Letter(letter) };
            (sample, text)
        });
        let heading = "Outcome (number of points)".to_owned();
        Legend { heading, entries: marks.chain(letters).collect() }
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

/// The verdict of a row.
pub fn verdict(source: &Source<'_>, row: usize) -> Option<Verdict> {
    let name = text(source, "verdict", row);
    let all = [Verdict::Deployed, Verdict::Partial, Verdict::Stalled];
    all.into_iter().find(|verdict| verdict.name() == name)
}
