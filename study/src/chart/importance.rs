//! Which input makes the spread of a measure: one row per input, its first-order and total index with their intervals,
//! or its part of the ranks. One panel per point of a study with samples.

use super::names::{self, Name};
use super::{Source, invalid_option};
use crate::analysis::answer::{Answer, Importance};
use crate::input::keys;
use crate::platform::error::Result;
use crate::render::figure::legend::{Legend, Sample};
use crate::render::figure::plot::{Axis, Line, Panel, Plots};
use crate::render::figure::scale::Spread;
use crate::render::figure::style::{Fill, Series};
use crate::render::figure::{Sheet, columns};

/// Distance of the two indices of an input, mm.
const SHIFT: f64 = 1.6;

/// What the answer says of a measure: the point, and what its inputs make.
pub fn of_measure<'a>(answer: &'a Answer, measure: &str) -> Vec<(String, &'a Importance)> {
    let of_samples = answer.tolerances.iter().filter_map(|point| {
        let spread = point.measures.iter().find(|spread| spread.measure == measure)?;
        let title = point.parameters.iter().map(|(name, value, unit)| {
            format!("{} {}", names::capital(&name.replace('_', " ")), unit.quantity(value))
        });
        Some((title.collect::<Vec<_>>().join(", "), &spread.inputs))
    });
    let of_grid = answer.importance.iter().filter(|(name, _)| name == measure);
    let of_grid = of_grid.map(|(_, found)| (String::new(), found));
    of_samples.chain(of_grid).filter(|(_, found)| !found.parts.is_empty()).collect()
}

/// The measures of which the answer says what makes their spread.
pub fn measures(answer: &Answer) -> Vec<String> {
    let of_samples = answer.tolerances.iter().flat_map(|point| &point.measures);
    let of_samples = of_samples.map(|spread| &spread.measure);
    let mut names: Vec<String> = Vec::new();
    for name in of_samples.chain(answer.importance.iter().map(|(name, _)| name)) {
        if !names.contains(name) && !of_measure(answer, name).is_empty() {
            names.push(name.clone());
        }
    }
    names
}

/// Draws what the inputs make of a measure.
///
/// # Errors
/// A measure of which the answer says nothing.
pub fn svg(source: &Source<'_>, measure: &str) -> Result<String> {
    let column = source.measure("--measure", measure)?;
    let points = source.answer.map_or_else(Vec::new, |answer| of_measure(answer, measure));
    let Some((_, first)) = points.first() else {
        let problem = "has no parts of its spread";
        return Err(invalid_option("--measure", measure, problem, "a measure of the answer", ""));
    };
    // The input that makes most in all points together on top.
    let total = |found: &Importance, name: &str| {
        let part = found.parts.iter().find(|part| part.name == name);
        part.map_or(0.0, |part| part.total.map_or(part.part, |(total, _)| total))
    };
    let inputs = first.parts.iter().filter(|part| part.between.is_some());
    let mut inputs: Vec<&str> = inputs.map(|part| part.name.as_str()).collect();
    let sum = |name: &str| points.iter().map(|(_, found)| total(found, name)).sum::<f64>();
    inputs.sort_by(|a, b| sum(a).total_cmp(&sum(b)));
    let position = |name: &str| inputs.iter().position(|input| *input == name);
    let panel = |(title, found): &(String, &Importance)| {
        let mut lines = [Line::new(Series::nth(0)), Line::new(Series::nth(1))];
        let with_total = found.parts.iter().any(|part| part.total.is_some());
        if with_total {
            lines[0].shift = -SHIFT;
            lines[1].shift = SHIFT;
        }
        for part in &found.parts {
            let (Some(at), Some(between)) = (position(&part.name), part.between) else { continue };
            let at = at as f64;
            let percent = |ends: [f64; 2]| [at, 100.0 * ends[0], 100.0 * ends[1]];
            lines[0].marks.push(([at, 100.0 * part.part], Fill::Filled));
            lines[0].bars.push(percent(between));
            if let Some((total, between)) = part.total {
                lines[1].marks.push(([at, 100.0 * total], Fill::Filled));
                lines[1].bars.push(percent(between));
            }
        }
        let seen =
            found.seen.map(|seen| format!("surrogate foresees {:.0} %", 100.0 * seen.max(0.0)));
        let what =
            if found.indices { seen.unwrap_or_default() } else { "parts of ranks".to_owned() };
        Panel {
            title: if title.is_empty() {
                names::capital(&what)
            } else {
                format!("{title}: {what}")
            },
            range: [-0.5, inputs.len() as f64 - 0.5],
            names: inputs.iter().enumerate().map(|(k, name)| (k as f64, input(name))).collect(),
            lines: lines.to_vec(),
            ..Panel::default()
        }
    };
    let panels: Vec<Panel> = points.iter().map(panel).collect();
    let name = Name::of_quantity(&column.name, &column.meaning);
    let mut entries = vec![(Sample::Point(Series::nth(0)), "alone (first-order index)".to_owned())];
    if points.iter().any(|(_, found)| found.indices) {
        entries.push((
            Sample::Point(Series::nth(1)),
            "alone and with others (total index)".to_owned(),
        ));
    }
    entries.push((Sample::Bar, "its interval, 95 %".to_owned()));
    let legends = vec![Legend { heading: String::new(), entries }];
    let title = source.title_or(&format!("what makes the spread of the {}", name.plain));
    let sheet = Sheet { title, subtitle: source.subtitle(), legends, notes: Vec::new() };
    let x = Axis {
        label: format!("Part of the variance of {measure} (%)"),
        spread: Spread::Linear,
        range: [0.0, 100.0],
        ticks: Vec::new(),
        names: false,
    };
    Ok(Plots { sheet, x, across: columns(panels.len()), panels }.svg())
}

/// The name of an input beside its row.
fn input(name: &str) -> String {
    names::capital(&keys::shortened(name).replace('_', " "))
}
