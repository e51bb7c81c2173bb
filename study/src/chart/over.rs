//! One measure over a parameter: one line per combination of the other parameters. Of several runs of a
//! point the line is the median, a band or an error bar the range.

use super::Source;
use super::encoding::{Encoding, PREFERRED_LINES};
use super::limits::Bound;
use super::names::{self, Name};
use super::outcome::{self, Outcomes};
use super::parameters::{self, Parameter};
use super::positions::Positions;
use crate::platform::error::Result;
use crate::render::figure::legend::Sample;
use crate::render::figure::plot::{Line, Mark, Panel, Plots};
use crate::render::figure::style::Series;
use crate::render::figure::unit::Unit;
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
        Encoding::new(source, &others, by, PREFERRED_LINES, positions.names, ("--over", over))?;

    let (unit, ends, bound) = extent(source, measure, &mut notes);
    let (low, high) = ends.map_or((0.0, 1.0), |[low, high]| ticks::padded(low, high));
    if low > 0.0 {
        notes.push("The vertical axis does not start at zero.".to_owned());
    }
    notes.extend(source.runs_notes(Some(measure)));
    let name = Name::of_quantity(&measure.name, &measure.meaning);
    let mut drawing = Drawing {
        source,
        measure,
        unit: &unit,
        positions: &positions,
        outcomes: Outcomes::new(source),
    };
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
            drawing.add_lines(&mut panel, rows, &encoding);
            if panel.lines.iter().all(|line| line.marks.is_empty()) {
                panel.message = if source.rows.is_empty() {
                    "nothing to draw: no point is chosen".to_owned()
                } else {
                    format!("nothing to draw: no job here has a value of {}", measure.name)
                };
            } else {
                panel.rules.extend(bound.iter().map(|bound| bound.rule(&unit)));
            }
            panel
        })
        .collect();
    let mut legends = encoding.legends(positions.names);
    let range = if positions.names { Sample::Bar } else { Sample::Band };
    legends.extend(source.runs_legend(&measure.name, range, &panels));
    legends.extend(source.uncertainty_legend(measure));
    legends.push(drawing.outcomes.legend(false));
    legends.extend(bound.map(|bound| bound.legend()));
    let title = source.title_or(&format!("{} over {}", name.plain, x.plain().plain));
    let sheet = Sheet { title, subtitle: source.subtitle(), legends, notes };
    Ok(Plots { sheet, x: positions.axis(), across: columns(panels.len()), panels }.svg())
}

/// The unit of a measure, the ends of its values in it, with their ranges, mesh errors and limit, and this limit. Adds
/// the notes on the limit.
pub(super) fn extent(
    source: &Source<'_>,
    measure: &Column,
    notes: &mut Vec<String>,
) -> (Unit, Option<[f64; 2]>, Option<Bound>) {
    let of_row = |row: &usize| {
        let ends = [source.range(measure, *row), source.uncertainty(measure, *row)];
        let ends = ends.into_iter().flatten().flatten();
        ends.chain(outcome::value(source, measure, *row)).collect::<Vec<f64>>()
    };
    let values: Vec<f64> = source.rows.iter().flat_map(of_row).collect();
    let unit = parameters::shown_unit(measure, values.iter().copied());
    let ends = values.iter().map(|value| [unit.shown(*value); 2]);
    let ends = ends.reduce(|[low, high], [value, _]| [low.min(value), high.max(value)]);
    let (Some(values), Some(bound)) = (ends, source.bound(measure)) else {
        return (unit, ends, None);
    };
    let (ends, note) = bound.extended(values, &unit);
    notes.extend(note);
    notes.extend(bound.note(source));
    (unit, Some(ends), Some(bound))
}

struct Drawing<'d, 'a> {
    source: &'d Source<'a>,
    measure: &'d Column,
    unit: &'d Unit,
    positions: &'d Positions,
    outcomes: Outcomes<'d>,
}

impl Drawing<'_, '_> {
    /// Adds the lines of a panel, and the letters of the jobs without a value.
    fn add_lines(&mut self, panel: &mut Panel, rows: &[usize], encoding: &Encoding<'_>) {
        let count = encoding.count() as f64;
        for (index, (series, mut rows)) in encoding.rows_by_line(rows) {
            // Markers over names are not joined by lines and stand side by side.
            let place = (index as f64 + 0.5) / count - 0.5;
            let shift = if self.positions.names { 0.6 * place } else { 0.0 };
            rows.sort_by(|a, b| self.positions.of(*a).total_cmp(&self.positions.of(*b)));
            let line = self.line(series, &rows, shift, &mut panel.lane);
            panel.lines.push(line);
        }
    }

    /// A line; `shift` moves its markers along the axis.
    fn line(&mut self, series: Series, rows: &[usize], shift: f64, lane: &mut Vec<Mark>) -> Line {
        let (source, measure) = (self.source, self.measure);
        let mut line = Line::new(series);
        let mut piece: Vec<[f64; 2]> = Vec::new();
        let mut band: Vec<[f64; 3]> = Vec::new();
        for row in rows {
            let x = self.positions.of(*row);
            let Some(value) = outcome::value(source, measure, *row) else {
                lane.push(Mark { x, series, letter: self.outcomes.letter(*row) });
                line.pieces.push(std::mem::take(&mut piece));
                line.bands.push(std::mem::take(&mut band));
                continue;
            };
            let x = x + shift;
            let ends = |[low, high]: [f64; 2]| [x, self.unit.shown(low), self.unit.shown(high)];
            let point = [x, self.unit.shown(value)];
            line.marks.push((point, self.outcomes.mark(*row)));
            let text = outcome::mixed_text(source, *row);
            line.texts.extend((!text.is_empty()).then_some((point, text)));
            line.errors.extend(source.uncertainty(measure, *row).map(ends));
            let range = source.range(measure, *row);
            if self.positions.names {
                line.bars.extend(range.map(ends));
            } else {
                piece.push(point);
                band.push(ends(range.unwrap_or([value; 2])));
            }
        }
        line.pieces.push(piece);
        line.bands.push(band);
        // A band of points whose runs are equal is a line.
        line.bands.retain(|band| band.iter().any(|[_, low, high]| low < high));
        line
    }
}
