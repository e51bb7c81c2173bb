//! How the parameters of a chart are shown: one by colour and marker, one by dashes, the others by panels.

use std::collections::BTreeMap;

use super::names;
use super::parameters::{self, Facets, Parameter};
use super::{Source, invalid_option};
use crate::input::value::Value;
use crate::platform::error::Result;
use crate::render::figure::legend::{Legend, Sample};
use crate::render::figure::style::{MAX_DASHES, Series};

/// Most lines in a panel while panels can take the others. Chosen: legible at a glance.
pub const PREFERRED_LINES: usize = 8;
/// Most lines in a panel. Chosen: more cannot be distinguished.
const MAX_LINES: usize = 20;
/// Most panels in a figure. Chosen: more do not fit on a page.
const MAX_PANELS: usize = 12;
/// Number of values up to which a parameter is preferred for the colours.
const PREFERRED_COLOURS: usize = 12;

/// The encoding of a chart.
#[derive(Debug, Clone, PartialEq)]
pub struct Encoding<'a> {
    /// The parameters of the lines and their values: the first by colour and marker, the second by dashes.
    lines: Vec<(Parameter<'a>, Vec<Value>)>,
    /// The panels.
    pub panels: Facets<'a>,
}

impl<'a> Encoding<'a> {
    /// Divides parameters into lines and panels. With `by` these parameters give the lines; without it the
    /// first one gives colours, the next one dashes while at most `preferred` lines are in a panel, and the
    /// others panels. `points` are markers without lines, so that nothing has dashes.
    ///
    /// # Errors
    /// Too many lines or panels: `asked` is the option and its value.
    pub fn new(
        source: &Source<'a>,
        others: &[Parameter<'a>],
        by: &[String],
        preferred: usize,
        points: bool,
        (option, value): (&str, &str),
    ) -> Result<Self> {
        for name in by {
            source.parameter("--by", name)?;
        }
        let dashes = if points { 0 } else { MAX_DASHES };
        let divided = |preferred: usize| {
            let mut panels = others.to_vec();
            let count = |parameter: &Parameter<'a>| parameter.values(&source.rows).len();
            let mut lines = Vec::new();
            // Takes the first parameter that `by` names, or any if it is empty, with at most this number of values.
            let mut take = |most: usize| {
                let named = |parameter: &Parameter<'a>| match by.get(lines.len()) {
                    Some(name) => parameter.name() == name,
                    None => by.is_empty(),
                };
                let fits = |parameter: &Parameter<'a>| named(parameter) && count(parameter) <= most;
                let found = panels.iter().position(fits)?;
                let parameter = panels.remove(found);
                let values = parameter.values(&source.rows);
                let count = values.len();
                lines.push((parameter, values));
                Some(count)
            };
            let most = if by.is_empty() { PREFERRED_COLOURS } else { usize::MAX };
            if let Some(colours) = take(most).or_else(|| take(MAX_LINES)) {
                let lines = if by.is_empty() { preferred / colours } else { MAX_DASHES };
                take(dashes.min(lines));
            }
            Self { lines, panels: parameters::facets(panels, &source.rows) }
        };
        let mut found = divided(preferred);
        if by.is_empty() && found.panels.panels.len() > MAX_PANELS {
            found = divided(MAX_LINES);
        }
        let (panels, lines) = (found.panels.panels.len(), found.count());
        let (number, noun, limit) = match (panels, lines) {
            (panels, _) if panels > MAX_PANELS => (panels, "panels", MAX_PANELS),
            (_, lines) if lines > MAX_LINES => (lines, "lines", MAX_LINES),
            _ => return Ok(found),
        };
        let of_lines = found.lines.iter().map(|(parameter, _)| parameter);
        Err(invalid_option(
            option,
            value,
            format!("the chart needs {number} {noun}; nothing is averaged"),
            format!("{limit} {noun} at most"),
            parameters::fix(found.panels.parameters.iter().chain(of_lines)),
        ))
    }

    /// Number of lines in a panel, at most.
    pub fn count(&self) -> usize {
        self.lines.iter().map(|(_, values)| values.len()).product()
    }

    /// The style of value `colour` of the first parameter and value `dash` of the second one.
    fn style(&self, colour: usize, dash: usize) -> Series {
        match self.lines.as_slice() {
            [] => Series::nth(0),
            // Of one parameter each part of the style alone is sufficient.
            [(_, colours)] if colours.len() <= PREFERRED_LINES => Series::nth(colour),
            [(_, colours), ..] => Series::of_values((colour, colours.len()), dash),
        }
    }

    /// Index of the line of a row, and its style.
    pub fn line(&self, row: usize) -> (usize, Series) {
        let index = |(parameter, values): &(Parameter<'_>, Vec<Value>)| {
            values.iter().position(|known| *known == parameter.column.cells[row]).unwrap_or(0)
        };
        let colour = self.lines.first().map_or(0, index);
        let dash = self.lines.get(1).map_or(0, index);
        let dashes = self.lines.get(1).map_or(1, |(_, values)| values.len());
        (colour * dashes + dash, self.style(colour, dash))
    }

    /// Some rows by line, in the order of the lines.
    pub fn rows_by_line(&self, rows: &[usize]) -> BTreeMap<usize, (Series, Vec<usize>)> {
        let mut lines: BTreeMap<usize, (Series, Vec<usize>)> = BTreeMap::new();
        for row in rows {
            let (index, series) = self.line(*row);
            lines.entry(index).or_insert((series, Vec::new())).1.push(*row);
        }
        lines
    }

    /// The legends of the lines; with `points` the samples are markers without lines.
    pub fn legends(&self, points: bool) -> Vec<Legend> {
        let legend = |(place, (parameter, values)): (usize, &(Parameter<'_>, Vec<Value>))| {
            let heading = match (self.lines.len(), place) {
                (1, _) => names::capital(&parameter.heading()),
                (_, 0) => format!("Colour and marker: {}", parameter.heading()),
                _ => format!("Line: {}", parameter.heading()),
            };
            let sample = |number: usize| match place {
                0 if points => Sample::Point(self.style(number, 0)),
                0 => Sample::Line(self.style(number, 0)),
                _ => Sample::Line(Series::dashes_only(number)),
            };
            let entry = |(number, value)| (sample(number), parameter.text(value));
            Legend { heading, entries: values.iter().enumerate().map(entry).collect() }
        };
        self.lines.iter().enumerate().map(legend).collect()
    }
}
