//! Pictures: the outcome of each cell of a map.
//!
//! Grounds are those of Okabe and Ito, which colour-blind readers can distinguish; signs distinguish statuses in black
//! and white.

use std::collections::{BTreeMap, BTreeSet};

use billow_solver::output::audit_kind::AuditKind;
use billow_study::input::value::{brief_number, short_number};
use billow_study::render::figure::Sheet;
use billow_study::render::figure::legend::{Legend, Sample};
use billow_study::render::figure::map::{Cell, Ground, Maps, Panel};
use billow_study::render::figure::style::Sign;

use super::cell::Cell as Found;
use super::file::{Map, failure_expected};
use super::map::{FinishedMap, Placed};
use super::{Method, names};

/// Names of statuses, ground, whether it is dark, sign. The last one is that of any other status.
const LOOKS: [(&str, &str, bool, Sign); 11] = [
    ("done", "#f3f3f3", false, Sign::Dot),
    ("unstable", "#d55e00", false, Sign::Cross),
    ("overstretched", "#009e73", false, Sign::Marker(1)),
    ("energy_drift", "#e69f00", false, Sign::Marker(2)),
    ("inverted_volume", "#cc79a7", false, Sign::Marker(4)),
    ("step_limit", "#56b4e9", false, Sign::Marker(6)),
    ("interpenetrated", "#0072b2", true, Sign::Marker(3)),
    ("inconsistent", "#8c510a", true, Sign::Marker(0)),
    ("no_equilibrium", "#f0e442", false, Sign::Marker(5)),
    ("invalid", "#b0b0b0", false, Sign::Bar),
    ("", "#000000", true, Sign::Cross),
];

/// The place of a status in the order of statuses.
fn order(status: &str) -> usize {
    LOOKS.iter().position(|(name, ..)| *name == status).unwrap_or(LOOKS.len() - 1)
}

/// A cell of a status, without texts.
fn look(status: &str) -> Cell {
    let (_, ground, dark, sign) = LOOKS[order(status)];
    let ground = Ground::Colour(ground, if dark { "#ffffff" } else { "#000000" });
    Cell { ground, sign: Some(sign), ..Cell::default() }
}

/// The letters of the audits, in the order of [`AuditKind::ALL`].
const AUDIT_LETTERS: &str = "MSXLGVNWAUCPI";
/// The letters of what ends a run beside them.
const OTHER_LETTERS: [(&str, &str); 5] = [
    ("scene_check", "R"),
    ("panic", "!"),
    ("iteration_limit", "K"),
    ("stalled", "T"),
    ("not_finite", "Q"),
];

/// The letter of an audit; empty for one without a letter.
fn letter(audit: &str) -> &'static str {
    match AuditKind::ALL.iter().position(|kind| kind.name() == audit) {
        Some(place) => AUDIT_LETTERS.get(place..=place).unwrap_or(""),
        None => OTHER_LETTERS.iter().find(|(name, _)| *name == audit).map_or("", |(_, l)| l),
    }
}

/// A time with two digits and its unit.
fn short_time(seconds: f64) -> String {
    let units = [(1.0, "s"), (1e3, "ms"), (1e6, "µs"), (1e9, "ns")];
    let rounded = |factor: f64| format!("{:.1e}", seconds * factor).parse().unwrap_or(f64::NAN);
    match units.iter().find(|(factor, _)| rounded(*factor) >= 1.0) {
        Some((factor, unit)) => format!("{} {unit}", short_number(rounded(*factor))),
        None => "0 s".to_owned(),
    }
}

/// A number with one digit.
fn rough(number: f64) -> String {
    let rounded: f64 = format!("{number:.0e}").parse().unwrap_or(f64::NAN);
    if rounded == 0.0 { "0".to_owned() } else { format!("{rounded:e}") }
}

/// What stands below the shape of a cell: time of the failure, residual of a run that is done, Newton steps.
fn below(cell: &Found, method: Method) -> String {
    match method {
        Method::Statics => cell.steps.to_string(),
        _ if cell.is_done() => cell.residual.map_or(String::new(), rough),
        _ => short_time(cell.time),
    }
}

/// The map as SVG. Methods whose panels are equal share one.
pub(super) fn of_map(finished: &FinishedMap<'_>) -> String {
    let map = finished.map;
    let texts = |axis: usize| map.axes[axis].1.iter().map(|value| brief_number(*value)).collect();
    let x = map.horizontal();
    let y = match map.axes.get(1 - x) {
        Some(_) => (map.parameter(1 - x).label(), texts(1 - x)),
        None => (String::new(), vec![String::new()]),
    };
    let with_theory = finished.borders.iter().any(|border| border.of_theory.is_some());
    let headings: &[&str] = match map.search {
        None => &[],
        Some(_) if with_theory => &["border", "of 2/ω"],
        Some(_) => &["border"],
    };
    let mut panels: Vec<Panel> = Vec::new();
    for (method, cells) in map.methods.iter().zip(finished.cells.chunks(map.places().len())) {
        // Along the horizontal axis, the lowest value of the other axis first.
        let cells: Vec<&Placed> = if x == 0 {
            cells.iter().collect()
        } else {
            let first = map.axes[0].1.len();
            (0..first).flat_map(|row| cells[row..].iter().step_by(first)).collect()
        };
        let rows = cells.chunks(map.axes[x].1.len());
        let new = Panel {
            title: method.name().to_owned(),
            beside: rows.map(|row| beside(finished, row, headings.len())).collect(),
            cells: cells.into_iter().map(drawn).collect(),
        };
        match panels.iter_mut().find(|panel| panel.cells == new.cells && panel.beside == new.beside)
        {
            Some(panel) => panel.title = format!("{}, {}", panel.title, new.title),
            None => panels.push(new),
        }
    }
    let subtitle = Some(map.description.clone()).filter(|text| !text.is_empty());
    Maps {
        sheet: Sheet {
            title: format!("Where methods fail: {}", map.name),
            subtitle: subtitle.into_iter().collect(),
            legends: legends(&finished.cells),
            notes: notes(map, &finished.cells),
        },
        x: (map.parameter(x).label(), texts(x)),
        y,
        headings: headings.iter().map(|&heading| heading.to_owned()).collect(),
        scale: None,
        panels,
    }
    .svg()
}

fn drawn(placed: &Placed) -> Cell {
    Cell {
        text: letter(&placed.cell.audit).to_owned(),
        below: below(&placed.cell, placed.method),
        corner: failure_expected(&placed.expected),
        framed: placed.is_wrong(),
        ..look(&placed.cell.status)
    }
}

/// Border, and border over the limit of theory, of a row of cells: as many texts as there are columns.
fn beside(finished: &FinishedMap<'_>, row: &[&Placed], columns: usize) -> Vec<String> {
    let at = row[0].at.get(1 - finished.map.horizontal()).copied();
    let mut borders = finished.borders.iter();
    let border = borders.find(|border| border.method == row[0].method && border.at == at);
    let value = match border.and_then(|border| border.value) {
        Some(value) => brief_number(value),
        None if row.iter().any(|placed| placed.cell.is_done()) => "none".to_owned(),
        None => "all fail".to_owned(),
    };
    let theory = border.and_then(|border| border.of_theory);
    let theory = theory.map_or(String::new(), |ratio| format!("{ratio:.4}"));
    [value, theory][..columns].to_vec()
}

fn legends(cells: &[Placed]) -> Vec<Legend> {
    let statuses: BTreeMap<usize, &str> = cells
        .iter()
        .map(|placed| (order(&placed.cell.status), placed.cell.status.as_str()))
        .collect();
    let mut entries: Vec<(Sample, String)> = statuses
        .into_values()
        .map(|status| (Sample::Cell(look(status)), status.to_owned()))
        .collect();
    if cells.iter().any(|placed| failure_expected(&placed.expected)) {
        let sample = Cell { corner: true, ..Cell::default() };
        entries.push((Sample::Cell(sample), "a failure is expected".to_owned()));
    }
    if cells.iter().any(Placed::is_wrong) {
        let sample = Cell { framed: true, ..Cell::default() };
        entries.push((Sample::Cell(sample), "not as expected".to_owned()));
    }
    let audits: BTreeSet<&str> = cells.iter().map(|placed| placed.cell.audit.as_str()).collect();
    let audits = audits.into_iter().filter(|audit| !letter(audit).is_empty());
    let audits =
        audits.map(|audit| (Sample::Letter(letter(audit).to_owned()), audit.to_owned())).collect();
    vec![
        Legend { heading: "status".to_owned(), entries },
        Legend { heading: "audit that ended the run".to_owned(), entries: audits },
    ]
}

fn notes(map: &Map, cells: &[Placed]) -> Vec<String> {
    let values = map.values(&[]);
    let is_axis = |name: &str| map.axes.iter().any(|(axis, _)| axis == name);
    let others = values.0.iter().filter(|(name, _)| !is_axis(name));
    let others: Vec<String> =
        others.map(|(name, value)| format!("{name} {}", brief_number(*value))).collect();
    let axes = (0..map.axes.len()).map(|axis| map.parameter(axis));
    let mut notes = vec![format!("scene {}: {}", map.scene.name, map.scene.meaning)];
    notes.extend(axes.map(|parameter| format!("{}: {}", parameter.name, parameter.meaning)));
    notes.push(format!("everywhere: {}", others.join(", ")));
    let below = if map.methods.contains(&Method::Statics) {
        "below the shape: Newton steps"
    } else {
        "below the shape: the time of a failure; of a done run its largest ledger residual"
    };
    notes.push(below.to_owned());
    if map.scene.name == "sheet" && map.search.is_some() {
        let theory = "of 2/ω: the border over 2/ω_max, the limit of the undamped linear film";
        notes.push(theory.to_owned());
    }
    for (methods, why) in map.reasons() {
        notes.push(format!("failures expected of {}: {why}", names(&methods)));
    }
    let as_expected = cells.iter().filter(|placed| !placed.is_wrong());
    notes.push(format!("{} of {} cells as expected", as_expected.count(), cells.len()));
    notes
}

#[cfg(test)]
mod tests {
    use billow_solver::output::outcome::FailureKind;
    use billow_study::job::Status;

    use super::*;

    #[test]
    fn every_status_has_a_look_and_every_audit_a_letter_of_its_own() {
        let failures = FailureKind::ALL.iter().map(|kind| kind.name());
        let others = [Status::Done, Status::NoEquilibrium, Status::Invalid];
        let places: Vec<usize> = failures.chain(others.map(Status::name)).map(order).collect();
        let distinct: BTreeSet<&usize> = places.iter().collect();
        assert!(distinct.len() == places.len() && !places.contains(&(LOOKS.len() - 1)));
        let letters: BTreeSet<&str> =
            AuditKind::ALL.iter().map(|kind| letter(kind.name())).collect();
        assert!(letters.len() == AuditKind::ALL.len() && !letters.contains(""));
    }

    #[test]
    fn times_have_two_digits_and_a_unit() {
        let times = [(0.0, "0 s"), (3.433e-6, "3.4 µs"), (9.99e-4, "1 ms"), (1.5, "1.5 s")];
        for (seconds, text) in times {
            assert_eq!(short_time(seconds), text);
        }
        assert_eq!([rough(2.4e-5), rough(0.0), rough(0.16)], ["2e-5", "0", "2e-1"]);
    }
}
