//! How the parameters of a chart are shown: one by colour and marker, one by dashes, the others by panels.

use super::names;
use super::parameters::{self, Facets, Group, Parameter};
use super::{Source, invalid_option};
use crate::input::value::Value;
use crate::platform::error::Result;
use crate::render::figure::legend::{Legend, Sample};
use crate::render::figure::style::{MAX_COLOURS, MAX_DASHES, Series};

/// Most lines in a panel while panels can take the others. Chosen: legible at a glance.
pub const PREFERRED_LINES: usize = 8;
/// Most lines in a panel. Chosen: more cannot be distinguished.
pub const MAX_LINES: usize = 20;
/// Most panels in a figure. Chosen: more do not fit on a page.
const MAX_PANELS: usize = 12;
/// Number of values up to which a parameter is preferred for the colours.
const PREFERRED_COLOURS: usize = 12;

/// How the lines of a chart are distinguished.
#[derive(Debug, Clone, PartialEq)]
enum Lines<'a> {
    /// There is one line in a panel.
    One,
    /// One parameter: its values by colour, marker and dashes.
    Single(Parameter<'a>, Vec<Value>),
    /// Two parameters: the values of the first by colour and marker, those of the second by dashes.
    Two([Parameter<'a>; 2], [Vec<Value>; 2]),
    /// Combinations of several parameters, each with its own style.
    Combined(Vec<Parameter<'a>>, Vec<Group>),
}

/// The encoding of a chart.
#[derive(Debug, Clone, PartialEq)]
pub struct Encoding<'a> {
    lines: Lines<'a>,
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
        others: Vec<Parameter<'a>>,
        by: &[String],
        preferred: usize,
        points: bool,
        asked: (&str, &str),
    ) -> Result<Self> {
        let encoding = |lines: Vec<Parameter<'a>>, panels: Vec<Parameter<'a>>| Self {
            lines: Lines::new(lines, &source.rows, points),
            panels: parameters::facets(panels, &source.rows),
        };
        let found = if by.is_empty() {
            let first = divided(source, others.clone(), if points { 0 } else { preferred });
            let found = encoding(first.0, first.1);
            if found.panels.panels.len() > MAX_PANELS {
                let more = divided(source, others, MAX_LINES);
                encoding(more.0, more.1)
            } else {
                found
            }
        } else {
            for name in by {
                source.parameter("--by", name.trim())?;
            }
            let place = |parameter: &Parameter<'_>| {
                by.iter().position(|name| name.trim() == parameter.name())
            };
            let (mut lines, panels): (Vec<_>, Vec<_>) =
                others.into_iter().partition(|parameter| place(parameter).is_some());
            lines.sort_by_key(|parameter| place(parameter));
            encoding(lines, panels)
        };
        found.check_size(asked)?;
        Ok(found)
    }

    /// Refuses a figure with too many panels or lines.
    fn check_size(&self, (option, value): (&str, &str)) -> Result<()> {
        let (panels, lines) = (self.panels.panels.len(), self.lines.count());
        let (number, noun, limit) = if panels > MAX_PANELS {
            (panels, "panels", MAX_PANELS)
        } else if lines > MAX_LINES {
            (lines, "lines", MAX_LINES)
        } else {
            return Ok(());
        };
        let varying = self.panels.parameters.iter().chain(self.lines.parameters());
        Err(invalid_option(
            option,
            value,
            format!("the chart needs {number} {noun}; nothing is averaged"),
            format!("{limit} {noun} at most"),
            parameters::fix(varying),
        ))
    }

    /// Number of lines in a panel, at most.
    pub fn count(&self) -> usize {
        self.lines.count()
    }

    /// Index of the line of a row, and its style.
    pub fn line(&self, row: usize) -> (usize, Series) {
        let index = |parameter: &Parameter<'_>, values: &[Value]| {
            let value = &parameter.column.cells[row];
            values.iter().position(|known| known == value).unwrap_or(0)
        };
        match &self.lines {
            Lines::One => (0, Series::nth(0)),
            Lines::Single(parameter, values) => {
                let number = index(parameter, values);
                (number, single(number, values.len()))
            }
            Lines::Two([first, second], [colours, dashes]) => {
                let (colour, dash) = (index(first, colours), index(second, dashes));
                let series = Series::of_values((colour, colours.len()), dash);
                (colour * dashes.len() + dash, series)
            }
            Lines::Combined(_, groups) => {
                let number = groups.iter().position(|group| group.rows.contains(&row)).unwrap_or(0);
                (number, Series::nth(number))
            }
        }
    }

    /// The legends of the lines; with `points` the samples are markers without lines.
    pub fn legends(&self, points: bool) -> Vec<Legend> {
        let sample = |series| if points { Sample::Point(series) } else { Sample::Line(series) };
        match &self.lines {
            Lines::One => Vec::new(),
            Lines::Single(parameter, values) => {
                let entry = |(number, value): (usize, &Value)| {
                    (sample(single(number, values.len())), parameter.text(value))
                };
                let entries = values.iter().enumerate().map(entry).collect();
                vec![Legend { heading: names::capital(&parameter.heading()), entries }]
            }
            Lines::Two([first, second], [colours, dashes]) => {
                let colour = |(number, value): (usize, &Value)| {
                    let series = Series::of_values((number, colours.len()), 0);
                    (sample(series), first.text(value))
                };
                let dash = |(number, value): (usize, &Value)| {
                    (Sample::Line(Series::dashes_only(number)), second.text(value))
                };
                vec![
                    Legend {
                        heading: format!("Colour and marker: {}", first.heading()),
                        entries: colours.iter().enumerate().map(colour).collect(),
                    },
                    Legend {
                        heading: format!("Line: {}", second.heading()),
                        entries: dashes.iter().enumerate().map(dash).collect(),
                    },
                ]
            }
            Lines::Combined(parameters, groups) => {
                let entry = |(number, group): (usize, &Group)| {
                    (sample(Series::nth(number)), group.values.clone())
                };
                let entries = groups.iter().enumerate().map(entry).collect();
                vec![Legend { heading: names::capital(&parameters::heading(parameters)), entries }]
            }
        }
    }
}

/// The style of a value of the only parameter of the lines.
fn single(number: usize, count: usize) -> Series {
    if count <= PREFERRED_LINES {
        Series::nth(number)
    } else {
        Series::of_values((number, count), 0)
    }
}

impl<'a> Lines<'a> {
    fn new(parameters: Vec<Parameter<'a>>, rows: &[usize], points: bool) -> Self {
        let values: Vec<Vec<Value>> = parameters.iter().map(|p| p.values(rows)).collect();
        match (parameters.as_slice(), values.as_slice()) {
            ([], _) => Self::One,
            ([parameter], [values]) if values.len() <= MAX_COLOURS => {
                Self::Single(parameter.clone(), values.clone())
            }
            ([first, second], [colours, dashes])
                if !points && colours.len() <= MAX_COLOURS && dashes.len() <= MAX_DASHES =>
            {
                Self::Two([first.clone(), second.clone()], [colours.clone(), dashes.clone()])
            }
            _ => {
                let groups = parameters::groups(&parameters, rows);
                Self::Combined(parameters, groups)
            }
        }
    }

    fn parameters(&self) -> &[Parameter<'a>] {
        match self {
            Self::One => &[],
            Self::Single(parameter, _) => std::slice::from_ref(parameter),
            Self::Two(parameters, _) => parameters,
            Self::Combined(parameters, _) => parameters,
        }
    }

    fn count(&self) -> usize {
        match self {
            Self::One => 1,
            Self::Single(_, values) => values.len(),
            Self::Two(_, [colours, dashes]) => colours.len() * dashes.len(),
            Self::Combined(_, groups) => groups.len(),
        }
    }
}

/// Parameters that give lines, and parameters that give panels.
fn divided<'a>(
    source: &Source<'a>,
    mut others: Vec<Parameter<'a>>,
    preferred: usize,
) -> (Vec<Parameter<'a>>, Vec<Parameter<'a>>) {
    let counts = |others: &[Parameter<'a>]| -> Vec<usize> {
        others.iter().map(|parameter| parameter.values(&source.rows).len()).collect()
    };
    let found = counts(&others);
    let colour = found
        .iter()
        .position(|count| *count <= PREFERRED_COLOURS)
        .or_else(|| found.iter().position(|count| *count <= MAX_LINES));
    let Some(colour) = colour else { return (Vec::new(), others) };
    let mut lines = vec![others.remove(colour)];
    let fits = |count: &usize| *count <= MAX_DASHES && found[colour] * count <= preferred;
    if let Some(dashes) = counts(&others).iter().position(fits) {
        lines.push(others.remove(dashes));
    }
    (lines, others)
}
