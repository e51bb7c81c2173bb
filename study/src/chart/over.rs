//! One measure over a parameter: a line for every combination of the others.

use std::collections::BTreeMap;

use super::outcome::{self, Outcomes};
use super::vary::{self, Group, Parameter};
use super::{Source, number, refused, titled};
use crate::job::row::CellType;
use crate::platform::error::Result;
use crate::render::figure::legend::{Legend, Sample};
use crate::render::figure::plot::lane::Mark;
use crate::render::figure::plot::{Axis, Line, Panel, Plots};
use crate::render::figure::scale::Spread;
use crate::render::figure::unit::Unit;
use crate::render::figure::{Sheet, columns, ticks};

/// Lines in one panel, as long as further panels can take them.
const LINES: usize = 8;
/// Lines in one panel, at most.
const MOST_LINES: usize = 20;
/// Panels in one figure, at most.
const PANELS: usize = 12;
/// Values of a parameter that are marks of the axis themselves, at most.
const MARKED: usize = 9;

/// Draws a measure over a parameter. `by` names the parameters that tell lines apart; the others that
/// vary tell panels apart. Where it is empty all tell lines apart, as far as they stay legible, and the
/// first of them panels.
///
/// # Errors
/// Unknown names, a measure that is no number, more lines or panels than are legible.
pub fn svg(source: &Source<'_>, measure: &str, over: &str, by: &[String]) -> Result<String> {
    let measure = source.measure("--measure", measure)?;
    let x = Parameter::new(source.parameter("--over", over)?, &source.rows);
    let (others, mut notes) = vary::varying(source.table, &source.rows, &[x.column]);
    let (panels, lines) = divided(source, others, by)?;
    if !panels.is_empty() && !by.is_empty() {
        let names = vary::heading(&panels);
        notes.push(format!("One panel for each of {names}: nothing is averaged."));
    }
    let series = vary::groups(&lines, &source.rows);
    let facets = vary::facets(panels, &source.rows);
    if facets.panels.len() > PANELS || series.len() > MOST_LINES {
        let (count, what, most) = if facets.panels.len() > PANELS {
            (facets.panels.len(), "panels", PANELS)
        } else {
            (series.len(), "lines", MOST_LINES)
        };
        let free: Vec<&str> = facets.parameters.iter().chain(&lines).map(Parameter::name).collect();
        return Err(refused(
            "--over",
            over,
            format!("{count} {what} would be needed; nothing is averaged"),
            format!("{most} {what} at most"),
            format!("fix some of {} with --where CONDITION", free.join(", ")),
        ));
    }
    let values = source.rows.iter().filter_map(|row| outcome::value(source, measure, *row));
    let unit = Unit::fit(&measure.unit, values.clone());
    let reach = values.fold([f64::INFINITY, f64::NEG_INFINITY], |[low, high], value| {
        [low.min(unit.shown(value)), high.max(unit.shown(value))]
    });
    let none = reach[0] > reach[1];
    let (low, high) = if none { (0.0, 1.0) } else { ticks::roomy(reach[0], reach[1]) };

    let places = Places::new(&x, &source.rows);
    let mut outcomes = Outcomes::new(source);
    let mut figure = Vec::with_capacity(facets.panels.len());
    for (title, rows) in &facets.panels {
        let mut panel = Panel {
            title: title.clone(),
            label: unit.label(&measure.name),
            range: [low, high],
            ..Panel::default()
        };
        for (number, group) in series.iter().enumerate() {
            let (line, lane) = one_line(
                (number, series.len()),
                &in_order(rows, group, &places),
                |row| outcome::value(source, measure, row).map(|value| unit.shown(value)),
                &places,
                &mut outcomes,
            );
            panel.lines.push(line);
            panel.lane.extend(lane);
        }
        if panel.lines.iter().all(|line| line.marks.is_empty()) {
            let column = &measure.name;
            panel.words = if source.rows.is_empty() {
                "nothing to draw: no point is chosen".to_owned()
            } else {
                format!("nothing to draw: no job here has a value of {column}")
            };
        }
        figure.push(panel);
    }
    let entries = series
        .iter()
        .enumerate()
        .filter(|(_, group)| !group.values.is_empty())
        .map(|(number, group)| {
            let sample = if places.names { Sample::Point(number) } else { Sample::Series(number) };
            (sample, group.values.clone())
        })
        .collect();
    let legends = vec![Legend { heading: vary::heading(&lines), entries }, outcomes.legend(false)];
    let plots = Plots {
        sheet: Sheet {
            title: titled(&measure.meaning, &measure.name),
            subtitle: source.subtitle_by(&facets),
            legends,
            notes,
        },
        x: places.axis(),
        across: columns(figure.len()),
        panels: figure,
    };
    Ok(plots.svg())
}

/// Parameters that tell panels apart, and those that tell lines apart.
fn divided<'a>(
    source: &Source<'_>,
    mut others: Vec<Parameter<'a>>,
    by: &[String],
) -> Result<(Vec<Parameter<'a>>, Vec<Parameter<'a>>)> {
    if by.is_empty() {
        let mut panels = Vec::new();
        while others.len() > 1 && vary::groups(&others, &source.rows).len() > LINES {
            panels.push(others.remove(0));
        }
        return Ok((panels, others));
    }
    for name in by {
        source.parameter("--by", name.trim())?;
    }
    Ok(others.into_iter().partition(|each| by.iter().all(|name| name.trim() != each.name())))
}

/// Rows of one line in one panel, from left to right.
fn in_order(panel: &[usize], group: &Group, places: &Places) -> Vec<usize> {
    let mut rows: Vec<usize> =
        panel.iter().copied().filter(|row| group.rows.contains(row)).collect();
    rows.sort_by(|one, other| places.of(*one).total_cmp(&places.of(*other)));
    rows
}

/// A line, and the letters of its jobs without a value.
fn one_line(
    (series, of): (usize, usize),
    rows: &[usize],
    value: impl Fn(usize) -> Option<f64>,
    places: &Places,
    outcomes: &mut Outcomes<'_>,
) -> (Line, Vec<Mark>) {
    let mut line = Line { series, ..Line::default() };
    let mut lane = Vec::new();
    let mut run: Vec<[f64; 2]> = Vec::new();
    for row in rows {
        // Markers over names stand side by side, since no line leads from one to the next.
        let shift = if places.names && of > 1 {
            0.6 * ((series as f64 + 0.5) / of as f64 - 0.5)
        } else {
            0.0
        };
        let x = places.of(*row) + shift;
        let Some(value) = value(*row) else {
            lane.push(Mark { x: places.of(*row), series, letter: outcomes.letter(*row) });
            line.runs.push(std::mem::take(&mut run));
            continue;
        };
        line.marks.push(([x, value], outcomes.mark(*row)));
        run.push([x, value]);
        if places.names {
            line.runs.push(std::mem::take(&mut run));
        }
    }
    line.runs.push(run);
    line.runs.retain(|run| !run.is_empty());
    (line, lane)
}

/// Where the rows lie on the axis, in its unit.
struct Places {
    /// By row.
    of_rows: BTreeMap<usize, f64>,
    /// Different places and their texts, from left to right.
    marks: Vec<(f64, String)>,
    /// Of the axis.
    label: String,
    names: bool,
}

impl Places {
    fn new(x: &Parameter<'_>, rows: &[usize]) -> Self {
        let values = x.values(rows);
        let names = !x.is_number(rows) || x.column.cell_type == CellType::Bool;
        let at = |position: usize| {
            let si = if names { None } else { number(&values[position]) };
            si.map_or(position as f64, |si| x.unit.shown(si))
        };
        let position = |row: &usize| values.iter().position(|known| *known == x.column.cells[*row]);
        let (label, texts) = x.along(&values, rows);
        Self {
            of_rows: rows.iter().map(|row| (*row, at(position(row).unwrap_or(0)))).collect(),
            marks: texts.into_iter().enumerate().map(|(number, text)| (at(number), text)).collect(),
            label,
            names,
        }
    }

    fn of(&self, row: usize) -> f64 {
        self.of_rows.get(&row).copied().unwrap_or(0.0)
    }

    fn axis(self) -> Axis {
        let values: Vec<f64> = self.marks.iter().map(|(place, _)| *place).collect();
        let spread = if self.names { Spread::Linear } else { Spread::of_values(&values) };
        let (low, high) = match values.as_slice() {
            [] => (0.0, 1.0),
            [first, .., last] => (*first, *last),
            [one] => (*one, *one),
        };
        let range = if self.names {
            [-0.5, values.len().max(1) as f64 - 0.5]
        } else if spread == Spread::Logarithmic {
            let room = libm::pow(high / low, 0.06);
            [low / room, high * room]
        } else if high > low {
            let room = 0.06 * (high - low);
            [low - room, high + room]
        } else {
            let room = if low == 0.0 { 1.0 } else { 0.1 * low.abs() };
            [low - room, high + room]
        };
        let ticks = if self.names || values.len() <= MARKED { self.marks } else { Vec::new() };
        Axis { label: self.label, spread, range, ticks, names: self.names }
    }
}
