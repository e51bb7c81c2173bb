//! All maps beside each other: how many cells of each fail, by method.

use std::collections::BTreeMap;

use super::look;
use crate::stability::Method;
use crate::stability::file::{Map, failure_expected};
use crate::stability::map::Placed;
use billow_study::render::figure::Sheet;
use billow_study::render::figure::legend::{Legend, Sample};
use billow_study::render::figure::map::{Cell, Maps, Panel};

/// The overview as SVG, for maps with their cells.
pub fn overview(maps: &[(&Map, Vec<Placed>)]) -> String {
    let used = |method: &Method| maps.iter().any(|(map, _)| map.methods.contains(method));
    let methods: Vec<Method> = Method::all().into_iter().filter(used).collect();
    // The first map is the highest row.
    let rows = || maps.iter().rev();
    let (mut cells, mut shown) = (Vec::new(), BTreeMap::new());
    for (_, of_map) in rows() {
        for method in &methods {
            let (status, cell) = summary(of_map, *method);
            shown.extend(status.map(|status| (look::place(&status), status)));
            cells.push(cell);
        }
    }
    let sample = |status: String| (Sample::Cell(look::cell(&status)), status);
    let mut entries: Vec<(Sample, String)> = shown.into_values().map(sample).collect();
    if cells.iter().any(|cell: &Cell| cell.framed) {
        let sample = Cell { framed: true, ..Cell::default() };
        entries.push((Sample::Cell(sample), "not as expected".to_owned()));
    }
    let heading = "most frequent failure, or done".to_owned();
    Maps {
        sheet: Sheet {
            title: "Where methods fail: all maps".to_owned(),
            subtitle: vec!["Number of runs that fail, and of all, by map and method".to_owned()],
            legends: vec![Legend { heading, entries }],
            notes: vec!["hatched: no run of this method in the map".to_owned()],
        },
        x: ("method".to_owned(), methods.iter().map(|method| method.name().to_owned()).collect()),
        y: ("map".to_owned(), rows().map(|(map, _)| map.name.clone()).collect()),
        headings: Vec::new(),
        scale: None,
        panels: vec![Panel { title: String::new(), cells, beside: Vec::new() }],
    }
    .svg()
}

/// The most frequent status of the failures of a method in a map, or done, and a cell that counts them.
fn summary(cells: &[Placed], method: Method) -> (Option<String>, Cell) {
    let ran = |placed: &&Placed| placed.question.method == method && placed.cell.is_some();
    let of: Vec<&Placed> = cells.iter().filter(ran).collect();
    let found = || of.iter().filter_map(|placed| placed.cell.as_ref());
    let failed: Vec<&str> =
        found().filter(|cell| !cell.is_done()).map(|cell| cell.status.as_str()).collect();
    // Of equally frequent ones the first in the order of statuses.
    let frequency = |status: &&str| {
        let equal = failed.iter().filter(|other| *other == status).count();
        (equal, std::cmp::Reverse(look::place(status)))
    };
    let frequent = failed.iter().copied().max_by_key(frequency);
    let Some(status) = frequent.or_else(|| found().next().map(|cell| cell.status.as_str())) else {
        return (None, Cell::letter(""));
    };
    let cell = Cell {
        below: format!("{} of {}", failed.len(), of.len()),
        corner: of.iter().any(|placed| failure_expected(&placed.expected)),
        framed: of.iter().any(|placed| placed.is_wrong()),
        ..look::cell(status)
    };
    (Some(status.to_owned()), cell)
}
