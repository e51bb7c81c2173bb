//! A tornado: how much each factor changes a measure, of points that vary one factor at a time. One row per factor, the
//! largest change on top: a column from the value of the base point to that of each other point.

use std::cmp::Reverse;
use std::collections::BTreeMap;
use std::fmt::Write as _;

use super::names::{self, Name};
use super::outcome::{self, Outcomes};
use super::parameters::{self, Parameter};
use super::{Source, importance, invalid_option, over};
use crate::analysis::compare::{self, canonical};
use crate::input::value::short_number;
use crate::platform::error::Result;
use crate::render::figure::Sheet;
use crate::render::figure::legend::{Legend, Sample};
use crate::render::figure::plot::{Axis, Line, Panel, Plots, Rule};
use crate::render::figure::scale::Spread;
use crate::render::figure::style::Series;
use crate::render::figure::ticks::minus;

/// Space at both ends of the axis, as a fraction of its length: texts stand there.
const PADDING: f64 = 0.15;

/// Points that vary one factor at a time.
pub struct OneFactor<'a> {
    /// The factors.
    pub factors: Vec<Parameter<'a>>,
    /// The row of the base point.
    pub base: usize,
    /// The factor in which a row differs from the base; `None` for the base.
    pub of_rows: BTreeMap<usize, Option<usize>>,
}

impl<'a> OneFactor<'a> {
    /// The points of a chart. `None` unless at least this number of factors varies, and each point differs from the most frequent
    /// values in one of them at most.
    pub fn of(points: &Source<'a>, least_factors: usize) -> Option<Self> {
        let (factors, _) = parameters::varying(points.table, &points.rows, &[]);
        let value = |factor: &Parameter<'_>, row: usize| canonical(&factor.column.cells[row]);
        let most_frequent = |factor: &Parameter<'_>| {
            let mut counts: BTreeMap<String, (usize, Reverse<usize>)> = BTreeMap::new();
            for row in &points.rows {
                // Of values that are equally frequent the first.
                counts.entry(value(factor, *row)).or_insert((0, Reverse(*row))).0 += 1;
            }
            counts.into_iter().max_by_key(|(_, count)| *count).map(|(text, _)| text)
        };
        let base: Vec<Option<String>> = factors.iter().map(most_frequent).collect();
        let mut of_rows = BTreeMap::new();
        for row in &points.rows {
            let differs = |index: &usize| Some(value(&factors[*index], *row)) != base[*index];
            let mut differing = (0..factors.len()).filter(differs);
            of_rows.insert(*row, differing.next());
            if differing.next().is_some() {
                return None;
            }
        }
        let base = of_rows.iter().find(|(_, factor)| factor.is_none()).map(|(row, _)| *row)?;
        (factors.len() >= least_factors).then_some(Self { factors, base, of_rows })
    }

    /// The values of the base point: "Base: N 6, mass flow rate 5 g/s".
    pub fn base_text(&self) -> String {
        let values: Vec<String> = self.factors.iter().map(|f| f.named(self.base)).collect();
        format!("Base: {}", values.join(", "))
    }
}

/// Draws the effects of the factors on a measure.
///
/// # Errors
/// A measure that is not a number; points that vary several factors at a time.
pub fn svg(source: &Source<'_>, measure: &str) -> Result<String> {
    let column = source.measure("--measure", measure)?;
    let one = OneFactor::of(source, 2).ok_or_else(|| {
        let problem = "needs a parameter to be drawn over";
        let mut allowed =
            "--over PARAMETER, --map X,Y, or points that vary one factor at a time".to_owned();
        let alone = source.answer.map(importance::measures).unwrap_or_default();
        if !alone.is_empty() {
            let _ = write!(
                allowed,
                "; alone {}, of which the answer says what makes the spread",
                alone.join(", ")
            );
        }
        let hint = if alone.is_empty() { "" } else { "a limit on a measure adds it to them" };
        invalid_option("--measure", measure, problem, allowed, hint)
    })?;
    let value = |row: usize| outcome::value(source, column, row);
    let mut notes = source.runs_notes(Some(column));
    let (unit, ends, bound) = over::extent(source, column, &mut notes);
    let ends = ends.unwrap_or([0.0, 1.0]);
    let length = if ends[0] < ends[1] { ends[1] - ends[0] } else { ends[1].abs().max(1.0) };
    let padding = PADDING * length;
    let base = value(one.base);
    let is_signed = compare::is_signed(measure);
    // The largest change on top, the base point at the bottom.
    let change = |factor: usize| {
        let rows = one.of_rows.iter().filter(|(_, of)| **of == Some(factor));
        let changes = rows.filter_map(|(row, _)| Some((value(*row)? - base?).abs()));
        changes.fold(0.0, f64::max)
    };
    let mut order: Vec<usize> = (0..one.factors.len()).collect();
    order.sort_by(|a, b| change(*a).total_cmp(&change(*b)));
    let position = |factor: usize| 1 + order.iter().position(|of| *of == factor).unwrap_or(0);
    let name = |factor: &usize| {
        (position(*factor) as f64, names::capital(&one.factors[*factor].heading()))
    };
    let mut outcomes = Outcomes::new(source);
    let mut line = Line::new(Series::nth(0));
    for (row, factor) in &one.of_rows {
        let at = factor.map_or(0, position) as f64;
        let text = factor.map_or_else(String::new, |factor| one.factors[factor].of_row(*row));
        let Some(value) = value(*row) else {
            let letter = outcomes.letter(*row);
            line.texts
                .push(([at, unit.shown(base.unwrap_or_default())], format!("{text} {letter}")));
            continue;
        };
        let ends = |[low, high]: [f64; 2]| [at, unit.shown(low), unit.shown(high)];
        line.marks.push(([at, unit.shown(value)], outcomes.mark(*row)));
        line.texts
            .push(([at, unit.shown(value)], relative(&text, base.filter(|_| !is_signed), value)));
        line.errors.extend(source.uncertainty(column, *row).map(ends));
        line.bars.extend(source.range(column, *row).map(ends));
        line.columns.extend(base.map(|base| ends([base, value])));
    }
    line.texts.retain(|(_, text)| !text.is_empty());
    let mut panel = Panel {
        range: [-0.5, one.factors.len() as f64 + 0.5],
        names: order.iter().map(name).chain([(0.0, "Base".to_owned())]).collect(),
        lines: vec![line],
        ..Panel::default()
    };
    match base {
        Some(base) => {
            panel.rules.push(Rule { value: unit.shown(base), text: String::new(), closed: None });
            panel.rules.extend(bound.iter().map(|bound| bound.rule(&unit)));
        }
        None => panel.message = format!("nothing to draw: the base has no value of {measure}"),
    }
    let name = Name::of_quantity(&column.name, &column.meaning);
    let panels = vec![panel];
    let mut legends: Vec<Legend> =
        source.runs_legend(&column.name, Sample::Bar, &panels).into_iter().collect();
    legends.extend(source.uncertainty_legend(column));
    legends.push(outcomes.legend(false));
    legends.extend(bound.map(|bound| bound.legend()));
    let mut subtitle = source.subtitle();
    subtitle.push(one.base_text());
    let title = source.title_or(&format!("{}, one factor at a time", name.plain));
    let sheet = Sheet { title, subtitle, legends, notes };
    let x = Axis {
        label: name.label(&unit),
        spread: Spread::Linear,
        range: [ends[0] - padding, ends[1] + padding],
        ticks: Vec::new(),
        names: false,
    };
    Ok(Plots { sheet, x, panels, across: 1 }.svg())
}

/// The value of a factor, with what it changes: "2 g/s −28 %"; without a base the value alone.
fn relative(text: &str, base: Option<f64>, value: f64) -> String {
    match base {
        Some(base) if base != 0.0 && !text.is_empty() => {
            let change = 100.0 * (value / base - 1.0);
            let sign = if change > 0.0 { "+" } else { "" };
            format!("{text} {sign}{} %", minus(&short_number(change.round())))
        }
        _ => text.to_owned(),
    }
}
