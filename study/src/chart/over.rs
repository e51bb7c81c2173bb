//! One measure over a parameter: one line per combination of the other parameters.

use std::collections::BTreeMap;

use super::outcome::{self, Outcomes};
use super::parameters::{self, Facets, Group, Parameter};
use super::{Source, invalid_option, number, title};
use crate::job::row::CellType;
use crate::platform::error::Result;
use crate::render::figure::legend::{Legend, Sample};
use crate::render::figure::plot::lane::Mark;
use crate::render::figure::plot::{Axis, Line, Panel, Plots};
use crate::render::figure::scale::Spread;
use crate::render::figure::unit::Unit;
use crate::render::figure::{Sheet, columns, ticks};
use crate::store::table::Column;

/// Most lines in one panel while more panels can take the others. Chosen: legible at a glance.
const PREFERRED_LINES: usize = 8;
/// Most lines in one panel. Chosen: more cannot be distinguished.
const MAX_LINES: usize = 20;
/// Most panels in one figure. Chosen: more do not fit on a page.
const MAX_PANELS: usize = 12;
/// Space at both ends of the x axis, as a fraction of its length.
const PADDING: f64 = 0.06;
/// Most values of a parameter for which every value is a tick of the axis.
const MAX_MARKED_VALUES: usize = 9;

/// Draws a measure over a parameter. The parameters in `by` give the lines; the other parameters that vary
/// give the panels. With an empty `by` all parameters give lines while these are legible, and the first
/// ones give panels.
///
/// # Errors
/// Unknown names, a measure that is not a number, too many lines or panels.
pub fn svg(source: &Source<'_>, measure: &str, over: &str, by: &[String]) -> Result<String> {
    let measure = source.measure("--measure", measure)?;
    let x = Parameter::new(source.parameter("--over", over)?, &source.rows);
    let (others, mut notes) = parameters::varying(source.table, &source.rows, &[x.column]);
    let (panels, lines) = divided(source, others, by)?;
    if !panels.is_empty() && !by.is_empty() {
        let names = parameters::heading(&panels);
        notes.push(format!("One panel for each of {names}: nothing is averaged."));
    }
    let series = parameters::groups(&lines, &source.rows);
    let facets = parameters::facets(panels, &source.rows);
    check_size(over, &facets, &lines, &series)?;

    let values = source.rows.iter().filter_map(|row| outcome::value(source, measure, *row));
    let unit = Unit::shown_in(&measure.shown, &measure.unit, values.clone());
    let extent = values.fold([f64::INFINITY, f64::NEG_INFINITY], |[low, high], value| {
        [low.min(unit.shown(value)), high.max(unit.shown(value))]
    });
    let no_values = extent[0] > extent[1];
    let (low, high) = if no_values { (0.0, 1.0) } else { ticks::padded(extent[0], extent[1]) };
    let positions = Positions::new(&x, &source.rows);
    let mut outcomes = Outcomes::new(source);
    let panels: Vec<Panel> = facets
        .panels
        .iter()
        .map(|(title, rows)| {
            let mut panel = Panel {
                title: title.clone(),
                label: unit.label(&measure.name),
                range: [low, high],
                ..Panel::default()
            };
            let value = |row| outcome::value(source, measure, row).map(|value| unit.shown(value));
            add_lines(&mut panel, rows, &series, &value, &positions, &mut outcomes);
            if panel.lines.iter().all(|line| line.marks.is_empty()) {
                panel.message = nothing_to_draw(source, measure);
            }
            panel
        })
        .collect();
    let plots = Plots {
        sheet: Sheet {
            title: title(&measure.meaning, &measure.name),
            subtitle: source.subtitle_by(&facets),
            legends: vec![line_legend(&lines, &series, positions.names), outcomes.legend(false)],
            notes,
        },
        x: positions.axis(),
        across: columns(panels.len()),
        panels,
    };
    Ok(plots.svg())
}

/// Refuses a figure with too many panels or lines.
fn check_size(
    over: &str,
    facets: &Facets<'_>,
    lines: &[Parameter<'_>],
    series: &[Group],
) -> Result<()> {
    let (number, noun, limit) = if facets.panels.len() > MAX_PANELS {
        (facets.panels.len(), "panels", MAX_PANELS)
    } else if series.len() > MAX_LINES {
        (series.len(), "lines", MAX_LINES)
    } else {
        return Ok(());
    };
    let varying: Vec<&str> = facets.parameters.iter().chain(lines).map(Parameter::name).collect();
    Err(invalid_option(
        "--over",
        over,
        format!("the chart needs {number} {noun}; nothing is averaged"),
        format!("{limit} {noun} at most"),
        format!("fix some of {} with --where CONDITION", varying.join(", ")),
    ))
}

/// Adds a line per series, and the letters of the jobs without a value.
fn add_lines(
    panel: &mut Panel,
    rows: &[usize],
    series: &[Group],
    value: &dyn Fn(usize) -> Option<f64>,
    positions: &Positions,
    outcomes: &mut Outcomes<'_>,
) {
    for (index, group) in series.iter().enumerate() {
        // Markers over names are not joined by lines and stand side by side.
        let shift = if positions.names && series.len() > 1 {
            0.6 * ((index as f64 + 0.5) / series.len() as f64 - 0.5)
        } else {
            0.0
        };
        let rows = in_order(rows, group, positions);
        let (line, lane) = line(index, &rows, shift, value, positions, outcomes);
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

fn line_legend(lines: &[Parameter<'_>], series: &[Group], names: bool) -> Legend {
    let entries = series
        .iter()
        .enumerate()
        .filter(|(_, group)| !group.values.is_empty())
        .map(|(index, group)| {
            let sample = if names { Sample::Point(index) } else { Sample::Series(index) };
            (sample, group.values.clone())
        })
        .collect();
    Legend { heading: parameters::heading(lines), entries }
}

/// Parameters that give panels, and parameters that give lines.
fn divided<'a>(
    source: &Source<'_>,
    mut others: Vec<Parameter<'a>>,
    by: &[String],
) -> Result<(Vec<Parameter<'a>>, Vec<Parameter<'a>>)> {
    if by.is_empty() {
        let mut panels = Vec::new();
        while others.len() > 1 && parameters::groups(&others, &source.rows).len() > PREFERRED_LINES
        {
            panels.push(others.remove(0));
        }
        return Ok((panels, others));
    }
    for name in by {
        source.parameter("--by", name.trim())?;
    }
    Ok(others
        .into_iter()
        .partition(|parameter| by.iter().all(|name| name.trim() != parameter.name())))
}

/// Rows of one line in one panel, from left to right.
fn in_order(panel: &[usize], group: &Group, positions: &Positions) -> Vec<usize> {
    let mut rows: Vec<usize> =
        panel.iter().copied().filter(|row| group.rows.contains(row)).collect();
    rows.sort_by(|a, b| positions.of(*a).total_cmp(&positions.of(*b)));
    rows
}

/// A line, and the letters of its jobs without a value. `shift` moves its markers along the axis.
fn line(
    series: usize,
    rows: &[usize],
    shift: f64,
    value: &dyn Fn(usize) -> Option<f64>,
    positions: &Positions,
    outcomes: &mut Outcomes<'_>,
) -> (Line, Vec<Mark>) {
    let mut line = Line { series, ..Line::default() };
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
