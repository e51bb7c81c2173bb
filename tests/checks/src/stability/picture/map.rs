//! The outcome of each cell of a map.

use std::collections::{BTreeMap, BTreeSet};

use super::look;
use super::words::{below, letter};
use crate::stability::Method;
use crate::stability::cell::Cell as Found;
use crate::stability::file::{Axis, Map, failure_expected};
use crate::stability::map::{Border, Placed};
use billow_study::input::value::brief_number;
use billow_study::render::figure::Sheet;
use billow_study::render::figure::legend::{Legend, Sample};
use billow_study::render::figure::map::{Cell, Maps, Panel};

/// The map as SVG. Methods whose panels are equal share one.
pub fn map(map: &Map, cells: &[Placed], borders: &[Border]) -> String {
    let texts = |axis: &Axis| axis.values.iter().map(|value| brief_number(*value)).collect();
    let horizontal = map.horizontal();
    let x = &map.axes[horizontal];
    let y = match map.axes.get(1 - horizontal) {
        Some(axis) => (axis.parameter.label(), texts(axis)),
        None => (String::new(), vec![String::new()]),
    };
    let with_theory = borders.iter().any(|border| border.of_theory.is_some());
    let headings: &[&str] = match map.search {
        None => &[],
        Some(_) if with_theory => &["border", "of 2/ω"],
        Some(_) => &["border"],
    };
    let per_method = map.places().len();
    let mut panels: Vec<Panel> = Vec::new();
    for (method, cells) in map.methods.iter().zip(cells.chunks(per_method)) {
        let cells = in_order(map, cells);
        let new = Panel {
            title: method.name().to_owned(),
            beside: beside(map, &cells, borders, headings.len()),
            cells: cells.into_iter().map(drawn).collect(),
        };
        match panels.iter_mut().find(|panel| panel.cells == new.cells && panel.beside == new.beside)
        {
            Some(panel) => panel.title = format!("{}, {}", panel.title, new.title),
            None => panels.push(new),
        }
    }
    Maps {
        sheet: Sheet {
            title: format!("Where methods fail: {}", map.name),
            subtitle: if map.description.is_empty() {
                vec![]
            } else {
                vec![map.description.clone()]
            },
            legends: legends(cells),
            notes: notes(map, cells),
        },
        x: (x.parameter.label(), texts(x)),
        y,
        headings: headings.iter().map(|&heading| heading.to_owned()).collect(),
        scale: None,
        panels,
    }
    .svg()
}

/// The cells of a method along the horizontal axis, the lowest value of the other axis first.
fn in_order<'a>(map: &Map, cells: &'a [Placed]) -> Vec<&'a Placed> {
    if map.horizontal() == 0 {
        return cells.iter().collect();
    }
    let first = map.axes[0].values.len();
    (0..first).flat_map(|row| cells[row..].iter().step_by(first)).collect()
}

fn drawn(placed: &Placed) -> Cell {
    let Some(cell) = &placed.cell else { return Cell::letter("") };
    Cell {
        text: letter(&cell.audit).to_owned(),
        below: below(cell, placed.question.method == Method::Statics),
        corner: failure_expected(&placed.expected),
        framed: placed.is_wrong(),
        ..look::cell(&cell.status)
    }
}

/// Border, and border over the limit of theory, of each row.
fn beside(map: &Map, cells: &[&Placed], borders: &[Border], columns: usize) -> Vec<Vec<String>> {
    let Some(search) = map.search else { return Vec::new() };
    let row = |cells: &[&Placed]| {
        let of_row = |border: &&Border| {
            let at = cells[0].at.get(1 - search.axis).copied();
            border.method == cells[0].question.method && border.at == at
        };
        let border = borders.iter().find(of_row);
        let done = |placed: &&Placed| placed.cell.as_ref().is_some_and(Found::is_done);
        let value = match border.and_then(|border| border.value) {
            Some(value) => brief_number(value),
            None if cells.iter().any(|placed| placed.cell.is_none()) => String::new(),
            None if cells.iter().any(done) => "none".to_owned(),
            None => "all fail".to_owned(),
        };
        let theory = border.and_then(|border| border.of_theory);
        let theory = theory.map_or(String::new(), |ratio| format!("{ratio:.4}"));
        [value, theory][..columns].to_vec()
    };
    cells.chunks(map.axes[search.axis].values.len()).map(row).collect()
}

fn legends(cells: &[Placed]) -> Vec<Legend> {
    let found = || cells.iter().filter_map(|placed| placed.cell.as_ref());
    let statuses: BTreeMap<usize, &str> =
        found().map(|cell| (look::place(&cell.status), cell.status.as_str())).collect();
    let mut entries: Vec<(Sample, String)> = statuses
        .into_values()
        .map(|status| (Sample::Cell(look::cell(status)), status.to_owned()))
        .collect();
    if cells.iter().any(|placed| failure_expected(&placed.expected)) {
        let sample = Cell { corner: true, ..Cell::default() };
        entries.push((Sample::Cell(sample), "a failure is expected".to_owned()));
    }
    if cells.iter().any(Placed::is_wrong) {
        let sample = Cell { framed: true, ..Cell::default() };
        entries.push((Sample::Cell(sample), "not as expected".to_owned()));
    }
    let audits: BTreeSet<&str> = found().map(|cell| cell.audit.as_str()).collect();
    let audits = audits.into_iter().filter(|audit| !letter(audit).is_empty());
    let audits =
        audits.map(|audit| (Sample::Letter(letter(audit).to_owned()), audit.to_owned())).collect();
    vec![
        Legend { heading: "status".to_owned(), entries },
        Legend { heading: "audit that ended the run".to_owned(), entries: audits },
    ]
}

fn notes(map: &Map, cells: &[Placed]) -> Vec<String> {
    let is_axis = |name: &str| map.axes.iter().any(|axis| axis.parameter.name == name);
    let others: Vec<String> = map
        .scene
        .parameters
        .iter()
        .filter(|parameter| !is_axis(parameter.name))
        .map(|parameter| {
            format!("{} {}", parameter.name, brief_number(map.values.get(parameter.name)))
        })
        .collect();
    let axes =
        map.axes.iter().map(|axis| format!("{}: {}", axis.parameter.name, axis.parameter.meaning));
    let is_static = map.methods.contains(&Method::Statics);
    let below = if is_static {
        "below the shape: Newton steps"
    } else {
        "below the shape: the time of a failure; of a done run its largest ledger residual"
    };
    let theory = "of 2/ω: the border over 2/ω_max, the limit of the undamped linear film";
    let mut notes = vec![format!("scene {}: {}", map.scene.name, map.scene.meaning)];
    notes.extend(axes);
    notes.push(format!("everywhere: {}", others.join(", ")));
    notes.push(below.to_owned());
    if map.scene.name == "sheet" && map.search.is_some() {
        notes.push(theory.to_owned());
    }
    for (methods, why) in map.reasons() {
        let methods: Vec<&str> = methods.into_iter().map(Method::name).collect();
        notes.push(format!("failures expected of {}: {why}", methods.join(", ")));
    }
    let as_expected = cells.iter().filter(|placed| placed.cell.is_some() && !placed.is_wrong());
    notes.push(format!("{} of {} cells as expected", as_expected.count(), cells.len()));
    notes
}
