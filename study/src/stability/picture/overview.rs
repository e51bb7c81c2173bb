//! All maps beside each other: how many cells of each fail, by method.

use super::words::outcome;
use crate::render::figure::Sheet;
use crate::render::figure::legend::{Legend, Sample};
use crate::render::figure::outcome::{Cell, Outcomes, Panel};
use crate::render::figure::style::Outcome;
use crate::stability::Method;
use crate::stability::file::{Map, failure_expected};
use crate::stability::map::Placed;

/// The overview as SVG, for maps with their cells.
pub fn overview(maps: &[(&Map, Vec<Placed>)]) -> String {
    let used = |method: &Method| maps.iter().any(|(map, _)| map.methods.contains(method));
    let methods: Vec<Method> = Method::all().into_iter().filter(used).collect();
    // The first map is the highest row.
    let rows = || maps.iter().rev();
    let cells: Vec<Option<Cell>> = rows()
        .flat_map(|(_, cells)| methods.iter().map(|method| summary(cells, *method)))
        .collect();
    let mut shown: Vec<Outcome> = cells.iter().flatten().map(|cell| cell.outcome).collect();
    shown.sort_unstable();
    shown.dedup();
    let name = |outcome: Outcome| {
        let all =
            maps.iter().flat_map(|(_, cells)| cells).filter_map(|placed| placed.cell.as_ref());
        let mut statuses = all.map(|cell| cell.status.clone());
        statuses.find(|status| super::words::outcome(status) == outcome).unwrap_or_default()
    };
    let mut entries: Vec<(Sample, String)> =
        shown.into_iter().map(|outcome| (Sample::Outcome(outcome), name(outcome))).collect();
    if cells.iter().flatten().any(|cell| cell.missed) {
        entries.push((Sample::Missed, "not as expected".to_owned()));
    }
    let heading = "most frequent failure, or done".to_owned();
    Outcomes {
        sheet: Sheet {
            title: "Where methods fail: all maps".to_owned(),
            subtitle: vec!["Number of runs that fail, and of all, by map and method".to_owned()],
            legends: vec![Legend { heading, entries }],
            notes: vec!["hatched: no run of this method in the map".to_owned()],
        },
        x: ("method".to_owned(), methods.iter().map(|method| method.name().to_owned()).collect()),
        y: ("map".to_owned(), rows().map(|(map, _)| map.name.clone()).collect()),
        headings: Vec::new(),
        borders: false,
        panels: vec![Panel { title: String::new(), cells, beside: Vec::new() }],
    }
    .svg()
}

/// The cells of a method in a map as one cell.
fn summary(cells: &[Placed], method: Method) -> Option<Cell> {
    let ran = |placed: &&Placed| placed.question.method == method && placed.cell.is_some();
    let of: Vec<&Placed> = cells.iter().filter(ran).collect();
    let failed = of.iter().filter_map(|placed| placed.cell.as_ref()).filter(|cell| !cell.is_done());
    let failed: Vec<Outcome> = failed.map(|cell| outcome(&cell.status)).collect();
    let number = |outcome: Outcome| failed.iter().filter(|other| **other == outcome).count();
    // Of equally frequent ones the first.
    let frequent = Outcome::ALL.into_iter().rev().max_by_key(|outcome| number(*outcome));
    let outcome = frequent.filter(|_| !failed.is_empty()).unwrap_or(Outcome::Done);
    (!of.is_empty()).then(|| Cell {
        outcome,
        letter: String::new(),
        below: format!("{} of {}", failed.len(), of.len()),
        failure_expected: of.iter().any(|placed| failure_expected(&placed.expected)),
        missed: of.iter().any(|placed| placed.is_wrong()),
    })
}
