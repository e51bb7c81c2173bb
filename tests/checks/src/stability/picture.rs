//! Pictures: the outcome of each cell of a map.
//!
//! Grounds are those of Okabe and Ito, which colour-blind readers can distinguish; signs distinguish statuses in black
//! and white.

use std::collections::BTreeMap;

use billow_study::input::value::brief_number;
use billow_study::job::Status;
use billow_study::render::figure::Sheet;
use billow_study::render::figure::legend::{Legend, Sample};
use billow_study::render::figure::map::{Cell, Ground, Maps, Panel};
use billow_study::render::figure::style::Sign;

use super::file::Map;
use super::map::{FinishedMap, Placed};

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
fn order(status: Status) -> usize {
    LOOKS.iter().position(|(name, ..)| *name == status.name()).unwrap_or(LOOKS.len() - 1)
}

/// A cell of a status.
fn look(status: Status) -> Cell {
    let (_, ground, dark, sign) = LOOKS[order(status)];
    let ground = Ground::Colour(ground, if dark { "#ffffff" } else { "#000000" });
    Cell { ground, sign: Some(sign), ..Cell::default() }
}

/// The map as SVG. Methods whose panels are equal share one.
pub(super) fn of_map(finished: &FinishedMap<'_>) -> String {
    let map = finished.map;
    let axis = |axis: usize| match map.axes.get(axis) {
        Some((_, values)) => {
            (map.parameter(axis).label(), values.iter().map(|value| brief_number(*value)).collect())
        }
        None => (String::new(), vec![String::new()]),
    };
    let mut panels: Vec<Panel> = Vec::new();
    for (method, cells) in map.methods.iter().zip(finished.cells.chunks(map.places().len())) {
        let cells: Vec<Cell> = cells
            .iter()
            .map(|placed| Cell { framed: placed.is_wrong(), ..look(placed.cell.status) })
            .collect();
        match panels.iter_mut().find(|panel| panel.cells == cells) {
            Some(panel) => panel.title = format!("{}, {}", panel.title, method.name()),
            None => panels.push(Panel { title: method.name().to_owned(), cells }),
        }
    }
    let subtitle = Some(map.description.clone()).filter(|text| !text.is_empty());
    Maps {
        sheet: Sheet {
            title: format!("Where methods fail: {}", map.name),
            subtitle: subtitle.into_iter().collect(),
            legends: vec![legend(&finished.cells)],
            notes: notes(map, &finished.cells),
        },
        x: axis(0),
        y: axis(1),
        scale: None,
        panels,
    }
    .svg()
}

fn legend(cells: &[Placed]) -> Legend {
    let statuses: BTreeMap<usize, Status> =
        cells.iter().map(|placed| (order(placed.cell.status), placed.cell.status)).collect();
    let mut entries: Vec<(Sample, String)> = statuses
        .into_values()
        .map(|status| (Sample::Cell(look(status)), status.to_string()))
        .collect();
    if cells.iter().any(Placed::is_wrong) {
        let sample = Cell { framed: true, ..Cell::default() };
        entries.push((Sample::Cell(sample), "not as expected".to_owned()));
    }
    Legend { heading: "status".to_owned(), entries }
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
    notes.extend(map.reasons().into_iter().map(|why| format!("expected: {why}")));
    let as_expected = cells.iter().filter(|placed| !placed.is_wrong());
    notes.push(format!("{} of {} cells as expected", as_expected.count(), cells.len()));
    notes
}

#[cfg(test)]
mod tests {
    use std::collections::BTreeSet;

    use billow_solver::output::outcome::FailureKind;

    use super::*;

    #[test]
    fn every_status_has_a_look_of_its_own() {
        let failures = FailureKind::ALL.map(Status::Failed);
        let others = [Status::Done, Status::NoEquilibrium, Status::Invalid];
        let places: Vec<usize> = failures.into_iter().chain(others).map(order).collect();
        let distinct: BTreeSet<&usize> = places.iter().collect();
        assert!(distinct.len() == places.len() && !places.contains(&(LOOKS.len() - 1)));
    }
}
