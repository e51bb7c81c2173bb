//! One measure over a parameter: one line per combination of the other parameters.

use std::collections::BTreeMap;

use super::encoding::{Encoding, PREFERRED_LINES};
use super::names::{self, Name};
use super::outcome::{self, Outcomes};
use super::parameters::{self, Parameter};
use super::{Source, number};
use crate::job::row::CellType;
use crate::platform::error::Result;
use crate::render::figure::plot::lane::Mark;
use crate::render::figure::plot::{Axis, Line, Panel, Plots};
use crate::render::figure::scale::Spread;
use crate::render::figure::style::Series;
use crate::render::figure::{Sheet, columns, ticks};
use crate::store::table::Column;

/// Space at both ends of the x axis, as a fraction of its length.
const PADDING: f64 = 0.06;
/// Most values of a parameter for which every value is a tick of the axis.
const MAX_MARKED_VALUES: usize = 9;

/// Draws a measure over a parameter. The parameters in `by` give the lines; the other parameters that vary
/// give the panels. With an empty `by` see `Encoding`.
///
/// # Errors
/// Unknown names, a measure that is not a number, too many lines or panels.
pub fn svg(source: &Source<'_>, measure: &str, over: &str, by: &[String]) -> Result<String> {
    let measure = source.measure("--measure", measure)?;
    let x = Parameter::new(source.parameter("--over", over)?, &source.rows);
    let (others, mut notes) = parameters::varying(source.table, &source.rows, &[x.column]);
    let positions = Positions::new(&x, &source.rows);
    let encoding =
        Encoding::new(source, others, by, PREFERRED_LINES, positions.names, ("--over", over))?;

    let values = source.rows.iter().filter_map(|row| outcome::value(source, measure, *row));
    let unit = parameters::shown_unit(measure, values.clone());
    let extent = values.fold([f64::INFINITY, f64::NEG_INFINITY], |[low, high], value| {
        [low.min(unit.shown(value)), high.max(unit.shown(value))]
    });
    let no_values = extent[0] > extent[1];
    let (low, high) = if no_values { (0.0, 1.0) } else { ticks::padded(extent[0], extent[1]) };
    if !no_values && low > 0.0 {
        notes.push("The vertical axis does not start at zero.".to_owned());
    }
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
            let value = |row| outcome::value(source, measure, row).map(|value| unit.shown(value));
            add_lines(&mut panel, rows, &encoding, &value, &positions, &mut outcomes);
            if panel.lines.iter().all(|line| line.marks.is_empty()) {
                panel.message = nothing_to_draw(source, measure);
            }
            panel
        })
        .collect();
    let mut legends = encoding.legends(positions.names);
    legends.push(outcomes.legend(false));
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

/// Adds the lines of a panel, and the letters of the jobs without a value.
fn add_lines(
    panel: &mut Panel,
    rows: &[usize],
    encoding: &Encoding<'_>,
    value: &dyn Fn(usize) -> Option<f64>,
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
    value: &dyn Fn(usize) -> Option<f64>,
    positions: &Positions,
    outcomes: &mut Outcomes<'_>,
) -> (Line, Vec<Mark>) {
    let mut line = Line {
        series,
        pieces: Vec::new(),
        marks: Vec::new(),
        sparse_markers: false,
        crosses: Vec::new(),
        rings: false,
    };
    let mut lane = Vec::new();
    let mut piece: Vec<[f64; 2]> = Vec::new();
    for row in rows {
        let Some(value) = value(*row) else {
            lane.push(Mark { x: positions.of(*row), series, letter: outcomes.letter(*row) });
            line.pieces.push(std::mem::take(&mut piece));
            continue;
        };
        let point = [positions.of(*row) + shift, value];
        line.marks.push((point, outcomes.mark(*row)));
        piece.push(point);
        if positions.names {
            line.pieces.push(std::mem::take(&mut piece));
        }
    }
    line.pieces.push(piece);
    line.pieces.retain(|piece| !piece.is_empty());
    (line, lane)
}

/// Positions of the rows on the x axis, in its unit.
struct Positions {
    /// By row.
    of_rows: BTreeMap<usize, f64>,
    /// Distinct positions and their texts, from left to right.
    marks: Vec<(f64, String)>,
    /// Label of the axis.
    label: String,
    /// Whether the values are names, at positions 0, 1, 2, …
    names: bool,
}

impl Positions {
    fn new(x: &Parameter<'_>, rows: &[usize]) -> Self {
        let values = x.values(rows);
        let names = !x.is_number(rows) || x.column.cell_type == CellType::Bool;
        let position = |index: usize| {
            let si = if names { None } else { number(&values[index]) };
            si.map_or(index as f64, |si| x.unit.shown(si))
        };
        let index = |row: &usize| values.iter().position(|known| *known == x.column.cells[*row]);
        let (label, texts) = x.along(&values, rows);
        Self {
            of_rows: rows.iter().map(|row| (*row, position(index(row).unwrap_or(0)))).collect(),
            marks: texts
                .into_iter()
                .enumerate()
                .map(|(index, text)| (position(index), text))
                .collect(),
            label,
            names,
        }
    }

    fn of(&self, row: usize) -> f64 {
        self.of_rows.get(&row).copied().unwrap_or(0.0)
    }

    fn axis(self) -> Axis {
        let values: Vec<f64> = self.marks.iter().map(|(position, _)| *position).collect();
        let spread = if self.names { Spread::Linear } else { Spread::of_values(&values) };
        let (low, high) = match values.as_slice() {
            [] => (0.0, 1.0),
            [first, .., last] => (*first, *last),
            [only] => (*only, *only),
        };
        let range = if self.names {
            [-0.5, values.len().max(1) as f64 - 0.5]
        } else if spread == Spread::Logarithmic {
            let padding = libm::pow(high / low, PADDING);
            [low / padding, high * padding]
        } else if high > low {
            let padding = PADDING * (high - low);
            [low - padding, high + padding]
        } else {
            let padding = if low == 0.0 { 1.0 } else { 0.1 * low.abs() };
            [low - padding, high + padding]
        };
        let ticks =
            if self.names || values.len() <= MAX_MARKED_VALUES { self.marks } else { Vec::new() };
        Axis { label: self.label, spread, range, ticks, names: self.names }
    }
}
