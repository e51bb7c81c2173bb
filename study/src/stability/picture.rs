//! Pictures of a map: the outcome of each cell, and the shapes of a failing run.

use billow_solver::models::run::Model as _;

use super::cell;
use super::file::{Axis, Map};
use super::map::{Border, Placed};
use crate::cases::Rig;
use crate::input::value::brief_number;
use crate::render::figure::Sheet;
use crate::render::figure::legend::{Legend, Sample};
use crate::render::figure::map::{Cell, Maps, Panel};
use crate::render::figure::style::Fill;
use crate::render::filmstrip::{Colour, Filmstrip};
use crate::render::projection::View;

/// Shapes of a strip.
const SHAPES: u64 = 6;

/// The map as SVG: per cell the outcome mark, the status, and the share of its time that the run reached.
pub fn map(map: &Map, cells: &[Placed], borders: &[Border]) -> String {
    let per_panel = map.places().len();
    let panels = map.methods.iter().zip(cells.chunks(per_panel)).map(|(method, cells)| Panel {
        title: method.name().to_owned(),
        cells: cells.iter().map(drawn).collect(),
    });
    let texts = |values: &[f64]| values.iter().map(|value| brief_number(*value)).collect();
    let meaning = |axis: &Axis| format!("{}: {}", axis.parameter.name, axis.parameter.meaning);
    let (y_label, y_texts) = match map.axes.get(1) {
        Some(axis) => (axis.parameter.name.to_owned(), texts(&axis.values)),
        None => (String::new(), vec![String::new()]),
    };
    let entry = |fill: Fill, text: &str| (Sample::Marker(fill), text.to_owned());
    let legend = Legend {
        heading: "status".to_owned(),
        entries: vec![
            entry(Fill::Filled, "done"),
            entry(Fill::Crossed, "failed, as the text says"),
            (Sample::Missed, "not as expected".to_owned()),
        ],
    };
    let mut notes = vec![format!("scene {}: {}", map.scene.name, map.scene.meaning)];
    notes.extend(map.axes.iter().map(meaning));
    notes.extend(borders.iter().filter_map(|border| border_text(map, border)));
    Maps {
        sheet: Sheet {
            title: format!("Where methods fail: {}", map.name),
            subtitle: Vec::new(),
            legends: vec![legend],
            notes,
        },
        x: (map.axes[0].parameter.name.to_owned(), texts(&map.axes[0].values)),
        y: (y_label, y_texts),
        label: "share of its time that the run reached".to_owned(),
        range: Some([0.0, 1.0]),
        panels: panels.collect(),
    }
    .svg()
}

fn drawn(placed: &Placed) -> Cell {
    let Some(cell) = &placed.cell else { return Cell::Absent };
    let share = if cell.end_time > 0.0 { cell.time / cell.end_time } else { 0.0 };
    Cell::Value {
        value: share.clamp(0.0, 1.0),
        outcome: if cell.is_done() { Fill::Filled } else { Fill::Crossed },
        shared: false,
        text: short(&cell.status).to_owned(),
        below: String::new(),
        missed: placed.is_wrong(),
    }
}

/// The status as a word that fits a cell.
fn short(status: &str) -> &str {
    match status {
        "energy_drift" => "drift",
        "interpenetrated" => "passage",
        "inverted_volume" => "inverted",
        "overstretched" => "stretched",
        "step_limit" => "steps",
        other => other,
    }
}

/// A border in words; `None` where the outcome does not change.
pub fn border_text(map: &Map, border: &Border) -> Option<String> {
    let search = map.search?;
    let name = map.axes[search.axis].parameter.name;
    let value = border.value?;
    let at = border.at.map_or(String::new(), |at| {
        format!(", {} {}", map.axes[1 - search.axis].parameter.name, brief_number(at))
    });
    let theory =
        border.of_theory.map_or(String::new(), |ratio| format!(", {ratio:.4} of 2/omega_max"));
    let method = border.method.name();
    Some(format!("border {method}{at}: {name} {} ({}){theory}", brief_number(value), border.status))
}

/// The strip of the failing run of a map with the fewest steps, as SVG; `None` without one that has shapes.
pub fn strip(rig: &Rig, map: &Map, cells: &[Placed]) -> Option<String> {
    let failing = |placed: &&Placed| {
        placed.cell.as_ref().is_some_and(|cell| !cell.is_done() && cell.steps > 0)
    };
    let steps = |placed: &&Placed| placed.cell.as_ref().map_or(0, |cell| cell.steps);
    let chosen = cells.iter().filter(failing).min_by_key(steps)?;
    let found = chosen.cell.as_ref()?;
    let (film, frames) = cell::shapes(rig, &chosen.question, found, SHAPES)?;
    if frames.is_empty() {
        return None;
    }
    let values: Vec<Vec<String>> =
        frames.iter().map(|frame| vec![format!("{} s", brief_number(frame.time))]).collect();
    let at = map.axes.iter().zip(&chosen.at);
    let at: Vec<String> = at
        .map(|(axis, value)| format!("{} {}", axis.parameter.name, brief_number(*value)))
        .collect();
    let method = chosen.question.method.name();
    let title = format!("{}: {method}, {}: {}", map.name, at.join(", "), found.status);
    let (triangles, storeys) = film.surface();
    let strip = Filmstrip {
        title: &title,
        triangles: &triangles,
        storeys: &storeys,
        frames: &frames,
        view: View::new(30.0_f64.to_radians(), 20.0_f64.to_radians()),
        colour: Colour::Regime,
        values: &values,
        notes: &[format!("ended at {} s: {}", brief_number(found.time), found.place)],
    };
    Some(strip.svg())
}
