//! How the search of an optimum went on: of one measure its value over the points in their order, and the smallest so far;
//! of two measures the one over the other, with the front between them.

use super::names::Name;
use super::{Source, invalid_option, parameters};
use crate::analysis::answer::{Optimum, Tried};
use crate::platform::error::Result;
use crate::render::figure::legend::{Legend, Sample};
use crate::render::figure::plot::{Axis, Line, Panel, Plots};
use crate::render::figure::scale::Spread;
use crate::render::figure::style::{Fill, Series};
use crate::render::figure::{Sheet, ticks};

/// Draws the search of a study.
///
/// # Errors
/// A study without one.
pub fn svg(source: &Source<'_>) -> Result<String> {
    let Some(found) = source.answer.and_then(|answer| answer.optimum.as_ref()) else {
        let problem = "the study searches no optimum";
        return Err(invalid_option("--measure", "", problem, "a study with optimise", ""));
    };
    let measures = found.minimise.iter().map(|name| source.measure("--measure", name));
    let measures = measures.collect::<Result<Vec<_>>>()?;
    let values = |k: usize| found.tried.iter().filter_map(move |tried| tried.measures[k]);
    let units: Vec<_> = measures
        .iter()
        .enumerate()
        .map(|(k, column)| parameters::shown_unit(column, values(k)))
        .collect();
    let range = |k: usize| {
        let shown = values(k).map(|value| units[k].shown(value));
        let ends = shown.map(|value| [value; 2]).reduce(|a, b| [a[0].min(b[0]), a[1].max(b[1])]);
        ends.map_or([0.0, 1.0], |[low, high]| <[f64; 2]>::from(ticks::padded(low, high)))
    };
    let names: Vec<Name> =
        measures.iter().map(|column| Name::of_quantity(&column.name, &column.meaning)).collect();
    let two = measures.len() > 1;
    let point = |(k, tried): (usize, &Tried)| -> Option<[f64; 2]> {
        let first = units[0].shown(tried.measures[0]?);
        if !two {
            return Some([(k + 1) as f64, first]);
        }
        Some([first, units[1].shown(tried.measures[1]?)])
    };
    let (mut tried, mut best) = (Line::new(Series::nth(0)), Line::new(Series::nth(1)));
    for (k, one) in found.tried.iter().enumerate() {
        let fill = if one.keeps_limits { Fill::Filled } else { Fill::Open };
        let line = if one.is_best { &mut best } else { &mut tried };
        line.marks.extend(point((k, one)).map(|place| (place, fill)));
    }
    best.pieces.push(if two { front(found, &units) } else { course(found, &units[0]) });
    let y = usize::from(two);
    let panel = Panel {
        label: names[y].label(&units[y]),
        range: range(y),
        lines: vec![tried, best],
        ..Panel::default()
    };
    let (label, across) = if two {
        (names[0].label(&units[0]), range(0))
    } else {
        ("Points in the order of the search".to_owned(), [0.0, found.points[1] as f64 + 1.0])
    };
    let line = if two { "the front" } else { "the smallest so far, and the best point" };
    let entries = vec![
        (Sample::Marker(Fill::Filled), "keeps every limit, as far as is known".to_owned()),
        (Sample::Marker(Fill::Open), "does not".to_owned()),
        (Sample::Line(Series::nth(1)), line.to_owned()),
    ];
    let title = match names.as_slice() {
        [first, second] => format!("{} against {}", first.plain, second.plain),
        _ => format!("search of the smallest {}", names[0].plain),
    };
    let legends = vec![Legend { heading: String::new(), entries }];
    let notes =
        vec!["Values are medians of the runs of a point on the mesh of the search.".to_owned()];
    let sheet =
        Sheet { title: source.title_or(&title), subtitle: source.subtitle(), legends, notes };
    let x = Axis { label, spread: Spread::Linear, range: across, ticks: Vec::new(), names: false };
    Ok(Plots { sheet, x, panels: vec![panel], across: 1 }.svg())
}

/// The smallest value after each generation, as a stair.
fn course(found: &Optimum, unit: &crate::render::figure::unit::Unit) -> Vec<[f64; 2]> {
    let mut stair: Vec<[f64; 2]> = Vec::new();
    for (points, smallest) in &found.course {
        let Some(value) = smallest[0].map(|value| unit.shown(value)) else { continue };
        stair.extend(stair.last().map(|[_, before]| [*points as f64, *before]));
        stair.push([*points as f64, value]);
    }
    stair
}

/// The points of the front.
fn front(found: &Optimum, units: &[crate::render::figure::unit::Unit]) -> Vec<[f64; 2]> {
    let point = |tried: &&Tried| {
        let shown = |k: usize| Some(units[k].shown(tried.measures[k]?));
        Some([shown(0)?, shown(1)?])
    };
    let mut points: Vec<[f64; 2]> = found
        .tried
        .iter()
        .filter(|tried| tried.is_best)
        .filter_map(|tried| point(&tried))
        .collect();
    points.sort_by(|a, b| a[0].total_cmp(&b[0]));
    points
}
