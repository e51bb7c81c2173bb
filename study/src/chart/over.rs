//! One measure over a parameter: one line per combination of the other parameters. Of several runs of a
//! point the line is the median, a band or an error bar the range.

use std::collections::BTreeMap;

use super::Source;
use super::encoding::{Encoding, PREFERRED_LINES};
use super::names::{self, Name};
use super::outcome::{self, Outcomes};
use super::parameters::{self, Parameter};
use super::positions::Positions;
use crate::platform::error::Result;
use crate::render::figure::legend::{Legend, Sample};
use crate::render::figure::plot::{Line, Mark, Panel, Plots};
use crate::render::figure::style::Series;
use crate::render::figure::{Sheet, columns, ticks};
use crate::store::table::Column;

/// Draws a measure over a parameter. The parameters in `by` give the lines; the other parameters that vary
/// give the panels. With an empty `by` see `Encoding`.
///
/// # Errors
/// Unknown names, a measure that is not a number, too many lines or panels.
pub fn svg(source: &Source<'_>, measure: &str, over: &str, by: &[String]) -> Result<String> {
    let measure = source.measure("--measure", measure)?;
    let x = Parameter::new(source.parameter("--over", over)?, &source.rows);
    let (others, mut notes) = parameters::varying(source.table, &source.rows, &[x.column]);
    let others = parameters::strategy_first(others);
    let positions = Positions::new(&x, &source.rows);
    let encoding =
        Encoding::new(source, others, by, PREFERRED_LINES, positions.names, ("--over", over))?;

    let values = || {
        let ranges = source.rows.iter().filter_map(|row| source.range(measure, *row));
        let medians = source.rows.iter().filter_map(|row| outcome::value(source, measure, *row));
        let errors = source.rows.iter().filter_map(|row| source.mesh_error(measure, *row));
        medians.chain(ranges.flatten()).chain(errors.flatten())
    };
    let unit = parameters::shown_unit(measure, values());
    let mut extent = values().fold([f64::INFINITY, f64::NEG_INFINITY], |[low, high], value| {
        [low.min(unit.shown(value)), high.max(unit.shown(value))]
    });
    let no_values = extent[0] > extent[1];
    let bound = source.bound(measure).filter(|_| !no_values);
    if let Some(bound) = &bound {
        let (extended, note) = bound.extended(extent, &unit);
        extent = extended;
        notes.extend(note);
        notes.extend(bound.note(source));
    }
    let (low, high) = if no_values { (0.0, 1.0) } else { ticks::padded(extent[0], extent[1]) };
    if !no_values && low > 0.0 {
        notes.push("The vertical axis does not start at zero.".to_owned());
    }
    notes.extend(source.runs_notes(Some(measure)));
    notes.extend(source.shared_job_note());
    let name = Name::of_measure(&measure.name, &measure.meaning);
    let mut outcomes = Outcomes::new(source);
    let panels: Vec<Panel> = encoding
        .panels
        .panels
        .iter()
        .map(|(title, rows)| {
            let mut panel = Panel {
                title: names::capital(title),
                label: name.label(&unit),
                range: [low, high],
                ..Panel::default()
            };
            let value = |row| Shown {
                value: outcome::value(source, measure, row).map(|value| unit.shown(value)),
                range: source.range(measure, row).map(|range| range.map(|end| unit.shown(end))),
                error: source.mesh_error(measure, row).map(|ends| ends.map(|end| unit.shown(end))),
                text: outcome::mixed_text(source, row),
            };
            add_lines(&mut panel, rows, &encoding, &value, &positions, &mut outcomes);
            if panel.lines.iter().all(|line| line.marks.is_empty()) {
                panel.message = nothing_to_draw(source, measure);
            } else {
                panel.rules.extend(bound.iter().map(|bound| bound.rule(&unit)));
            }
            panel
        })
        .collect();
    let mut legends = encoding.legends(positions.names);
    let range = if positions.names { Sample::Bar } else { Sample::Band };
    legends.extend(source.runs_legend(range));
    legends.extend(source.mesh_error_legend(measure));
    legends.push(outcomes.legend(false));
    legends.extend(bound.map(|bound| Legend {
        heading: "Limit".to_owned(),
        entries: vec![(Sample::Closed, bound.legend())],
    }));
    let title = format!("{} over {}", name.plain, x.plain().plain);
    let plots = Plots {
        sheet: Sheet {
            title: source.title_or(&title),
            subtitle: source.subtitle(),
            legends,
            notes,
        },
        x: positions.axis(),
        across: columns(panels.len()),
        panels,
    };
    Ok(plots.svg())
}

/// What a point shows.
struct Shown {
    /// Its value, or the median of its runs.
    value: Option<f64>,
    /// Least and largest value of its runs.
    range: Option<[f64; 2]>,
    /// Value less and plus its mesh error.
    error: Option<[f64; 2]>,
    /// Text beside it.
    text: String,
}

/// Adds the lines of a panel, and the letters of the jobs without a value.
fn add_lines(
    panel: &mut Panel,
    rows: &[usize],
    encoding: &Encoding<'_>,
    value: &dyn Fn(usize) -> Shown,
    positions: &Positions,
    outcomes: &mut Outcomes<'_>,
) {
    let mut lines: BTreeMap<usize, (Series, Vec<usize>)> = BTreeMap::new();
    for row in rows {
        let (index, series) = encoding.line(*row);
        lines.entry(index).or_insert((series, Vec::new())).1.push(*row);
    }
    let count = encoding.count();
    for (index, (series, mut rows)) in lines {
        // Markers over names are not joined by lines and stand side by side.
        let shift = if positions.names && count > 1 {
            0.6 * ((index as f64 + 0.5) / count as f64 - 0.5)
        } else {
            0.0
        };
        rows.sort_by(|a, b| positions.of(*a).total_cmp(&positions.of(*b)));
        let (line, lane) = line(series, &rows, shift, value, positions, outcomes);
        panel.lines.push(line);
        panel.lane.extend(lane);
    }
}

fn nothing_to_draw(source: &Source<'_>, measure: &Column) -> String {
    if source.rows.is_empty() {
        "nothing to draw: no point is chosen".to_owned()
    } else {
        format!("nothing to draw: no job here has a value of {}", measure.name)
    }
}

/// A line, and the letters of its jobs without a value. `shift` moves its markers along the axis.
fn line(
    series: Series,
    rows: &[usize],
    shift: f64,
    value: &dyn Fn(usize) -> Shown,
    positions: &Positions,
    outcomes: &mut Outcomes<'_>,
) -> (Line, Vec<Mark>) {
    let mut line = Line::new(series);
    let mut lane = Vec::new();
    let mut piece: Vec<[f64; 2]> = Vec::new();
    let mut band: Vec<[f64; 3]> = Vec::new();
    for row in rows {
        let shown = value(*row);
        let Some(value) = shown.value else {
            lane.push(Mark { x: positions.of(*row), series, letter: outcomes.letter(*row) });
            line.pieces.push(std::mem::take(&mut piece));
            line.bands.push(std::mem::take(&mut band));
            continue;
        };
        let point = [positions.of(*row) + shift, value];
        line.marks.push((point, outcomes.mark(*row)));
        if !shown.text.is_empty() {
            line.texts.push((point, shown.text));
        }
        piece.push(point);
        line.errors.extend(shown.error.map(|[low, high]| [point[0], low, high]));
        let [low, high] = shown.range.unwrap_or([value; 2]);
        if positions.names {
            line.pieces.push(std::mem::take(&mut piece));
            line.bars.extend(shown.range.map(|[low, high]| [point[0], low, high]));
        } else {
            band.push([point[0], low, high]);
        }
    }
    line.pieces.push(piece);
    line.pieces.retain(|piece| !piece.is_empty());
    line.bands.push(band);
    // A band of points whose runs are equal is a line.
    line.bands.retain(|band| band.iter().any(|[_, low, high]| low < high));
    (line, lane)
}
