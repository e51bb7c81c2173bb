//! What can be done about jobs that failed, for a reader: what was tried, what can be applied, what is proposed.

use std::collections::BTreeMap;

use super::print::count;
use crate::input::value::Value;
use crate::job::point::Point;
use crate::job::remedy::{Failure, remedies};
use crate::job::row::{Cells, ColumnId};
use crate::job::{JobId, Status};
use crate::store::remedied::Attempt;
use crate::store::stored::Stored;
use crate::store::table::Table;

/// Remedies that one line names, at most.
const MAX_NAMED: usize = 3;

/// What is said where no remedy remains and none is proposed.
pub(super) const NONE: &str = "no further remedy is known";

/// A line: its topic and its text.
pub(super) type Line = (&'static str, String);

/// The note on a table with rows whose result a remedy gave.
pub(super) fn note(table: &Table) -> Option<String> {
    let column = table.column(ColumnId::Remedy.name())?;
    let rows = column.cells.iter().filter(|cell| **cell != Value::Null).count();
    (rows > 0).then(|| {
        let rows = count(rows, "row");
        format!("note: {rows} with other numerical settings than planned (column remedy)")
    })
}

/// What only the user can decide about the run of a point.
pub(super) fn proposed(cells: &Cells, point: &Point) -> Vec<&'static str> {
    remedies(&Failure::of(cells), &point.job.scene.solver).proposed
}

/// The next remedy of a job whose row is shown.
pub(super) fn next(stored: &Stored<'_>, id: &JobId) -> Option<Attempt> {
    stored.point(id).filter(|point| point.job.id == *id).and_then(|point| stored.remedy(point))
}

/// The lines about remedies of a job.
pub(super) fn lines(stored: &Stored<'_>, id: &JobId, cells: &Cells) -> Vec<Line> {
    let Some(point) = stored.point(id) else { return Vec::new() };
    let mut lines = runs(stored, point, id);
    if point.job.id != *id {
        return lines;
    }
    let proposed = proposed(cells, point);
    match stored.remedy(point) {
        Some(attempt) => lines.push(("remedy", format!("{}: {}", attempt.text, attempt.reason))),
        None if matches!(cells.status(), Status::Failed(_)) && proposed.is_empty() => {
            lines.push(("remedy", NONE.to_owned()));
        }
        None => {}
    }
    lines.extend(proposed.into_iter().map(|text| ("proposed", text.to_owned())));
    lines
}

/// How a job is linked to others by remedies.
fn runs(stored: &Stored<'_>, point: &Point, id: &JobId) -> Vec<Line> {
    let Some(remedied) = &point.remedied else { return Vec::new() };
    let (planned, is_planned) = (&remedied.planned, remedied.planned == *id);
    let mut lines = Vec::new();
    for (index, run) in remedied.runs.iter().enumerate() {
        let is_shown = remedied.shown == Some(index);
        let ended = run.status.map_or("not run", |status| status.name());
        if run.job == *id {
            let record = stored.record(planned).map(|record| record.cells.status());
            let failed = record.map_or("failed", |status| status.name());
            let text = format!(
                "{}, after the planned job {} ended as {failed}",
                run.text,
                planned.short()
            );
            lines.push(("remedy", text));
        } else if is_shown && is_planned {
            let text =
                format!("{} gives the result of the point: job {}", run.text, run.job.short());
            lines.push(("remedy", text));
        } else if !is_shown {
            lines.push(("tried", format!("{}: {ended}, job {}", run.text, run.job.short())));
        }
    }
    lines
}

/// The failed jobs of a study that can run with a remedy.
pub(super) struct Applicable {
    /// Number of jobs, by what would be changed.
    numbers: BTreeMap<String, usize>,
}

impl Applicable {
    /// Those of stored results.
    pub fn of(stored: &Stored<'_>) -> Self {
        let mut numbers = BTreeMap::new();
        for attempt in stored.points.iter().filter_map(|point| stored.remedy(point)) {
            *numbers.entry(attempt.text).or_default() += 1;
        }
        Self { numbers }
    }

    /// Number of jobs.
    pub fn jobs(&self) -> usize {
        self.numbers.values().sum()
    }

    /// The remedies and the numbers of their jobs, the first few; empty without one.
    pub fn named(&self) -> String {
        let named = self.numbers.iter().take(MAX_NAMED);
        let mut texts: Vec<String> =
            named.map(|(text, number)| format!("{text} ({})", count(*number, "job"))).collect();
        if self.numbers.len() > MAX_NAMED {
            texts.push(format!("and {} more", self.numbers.len() - MAX_NAMED));
        }
        texts.join(", ")
    }
}
