//! The borders that a search found, over another parameter.
//!
//! A border is the interval between the last value at which the criterion is met and the first at which it is
//! not. Its middle is a marker, the interval an error bar; the side that meets the criterion is shaded.

use std::collections::BTreeMap;

mod drawing;
mod one_factor;
mod vertical;

use self::drawing::{Drawing, is_word};
use self::one_factor::OneFactor;
use self::vertical::Vertical;
use super::encoding::{Encoding, PREFERRED_LINES};
use super::names;
use super::parameters::{self, Parameter};
use super::positions::Positions;
use super::{Source, invalid_option};
use crate::analysis::compare::canonical;
use crate::analysis::replicates::Condensed;
use crate::input::value::Value;
use crate::job::row::CellType;
use crate::platform::error::Result;
use crate::render::figure::plot::{Panel, Plots};
use crate::render::figure::{Sheet, columns};
use crate::store::table::Column;
use crate::study::{Border, Outcome};

/// The search of a study.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Searched<'a> {
    /// The parameter along which it searches.
    pub parameter: &'a str,
    /// What changes at a border: "safe", "deployed", or a limit as `peak_vz < 25 m/s`.
    pub criterion: &'a str,
    /// The parameters whose values repeat a point.
    pub replicates: &'a [String],
    /// Number of runs of each value.
    pub replicate_count: usize,
    /// What it found.
    pub borders: &'a [Border],
}

/// Draws the borders over a parameter; without one over the first parameter with numbers that varies.
///
/// # Errors
/// A study without a search, an unknown parameter, too many lines or panels.
pub fn svg(source: &Source<'_>, over: Option<&str>, by: &[String]) -> Result<String> {
    let search = source.search.ok_or_else(|| {
        let problem = "the study has no search";
        let hint = "give an axis {\"bisect\": [low, high], \"on\": \"verdict\"}";
        invalid_option("--borders", "", problem, "a study with a search", hint)
    })?;
    if over == Some(search.parameter) {
        let problem = "is the parameter along which the study searches";
        return Err(invalid_option("--over", search.parameter, problem, "another parameter", ""));
    }
    // One row per search.
    let single = source.single();
    let mut free = search.replicates.to_vec();
    free.push(search.parameter.to_owned());
    let condensed = Condensed::of(single.table, &single.rows, &free);
    let table = &condensed.table;
    let rows = (0..table.rows()).collect();
    let points = Source { table, rows, runs: None, ..single.clone() };
    let found = found(&points, search.borders);

    let column = source.parameter("--borders", search.parameter)?;
    let values: Vec<f64> =
        found.iter().flatten().flat_map(|border| &border.levels).map(|level| level.value).collect();
    let unit = parameters::shown_unit(column, values.iter().copied());
    let shown: Vec<f64> = values.iter().map(|value| unit.shown(*value)).collect();
    let axis = Vertical::new(&shown, &found);

    let none = Column {
        cells: vec![Value::Text(String::new()); table.rows()],
        name: String::new(),
        ..column.clone()
    };
    let (varying, _) = parameters::varying(table, &points.rows, &[]);
    let first = varying.iter().find(|parameter| parameter.is_number(&points.rows));
    let one_factor = match over {
        None if by.is_empty() => OneFactor::of(&points, &varying),
        _ => None,
    };
    let x = match (over, &one_factor) {
        (Some(name), _) => points.parameter("--over", name)?,
        (None, Some(named)) => &named.column,
        (None, None) => first.or(varying.first()).map_or(&none, |parameter| parameter.column),
    };
    let x = Parameter::new(x, &points.rows);
    let (others, notes) = match one_factor {
        Some(_) => (Vec::new(), Vec::new()),
        None => parameters::varying(table, &points.rows, &[x.column]),
    };
    let others = parameters::strategy_first(others);
    let positions = Positions::new(&x, &points.rows);
    let asked = ("--borders", search.parameter);
    let encoding = Encoding::new(&points, others, by, PREFERRED_LINES, positions.names, asked)?;
    let mut drawing = Drawing::new(&axis, &unit, side(&found), search.replicate_count);
    let name = names::Name::of_parameter(search.parameter);
    let panels: Vec<Panel> = encoding
        .panels
        .panels
        .iter()
        .map(|(title, rows)| {
            let mut panel = Panel {
                title: names::capital(title),
                label: unit.label(&names::capital(&name.with_symbol())),
                range: axis.range,
                spread: axis.spread,
                rules: axis.rules(),
                ..Panel::default()
            };
            drawing.add(&mut panel, rows, &found, &encoding, &positions);
            if rows.iter().all(|row| found[*row].is_none()) {
                "nothing to draw: no search is chosen".clone_into(&mut panel.message);
                panel.rules.clear();
            }
            panel
        })
        .collect();
    let mut legends = encoding.legends(positions.names);
    legends.push(drawing.legend(search.criterion));
    let over =
        if x.name().is_empty() { String::new() } else { format!(" over {}", x.plain().plain) };
    let title = match drawing.side {
        Some(true) => format!("{}{over}", quality("largest", &name.plain, search.criterion)),
        Some(false) => format!("{}{over}", quality("smallest", &name.plain, search.criterion)),
        None if is_word(search.criterion) => {
            format!("{} at the border between {1} and not {1}{over}", name.plain, search.criterion)
        }
        None => format!("{} at the border of {}{over}", name.plain, search.criterion),
    };
    let plots = Plots {
        sheet: Sheet {
            title: source.title_or(&title),
            subtitle: subtitle(&points, &single, search.criterion)
                .into_iter()
                .chain(one_factor.map(|named| named.base))
                .collect(),
            legends,
            notes,
        },
        x: positions.axis(),
        across: columns(panels.len()),
        panels,
    };
    Ok(plots.svg())
}

/// The lines below the title: a row of the condensed table is a search.
fn subtitle(points: &Source<'_>, single: &Source<'_>, criterion: &str) -> Vec<String> {
    let mut lines = points.subtitle();
    let noun = |count: usize, noun: &str, many: &str| {
        format!("{count} {}", if count == 1 { noun } else { many })
    };
    let choice = if points.choice.is_empty() { "" } else { " " };
    if let Some(first) = lines.first_mut() {
        *first = format!(
            "study {}: {}, {}{choice}{}",
            points.study,
            noun(points.rows.len(), "search", "searches"),
            noun(single.rows.len(), "run", "runs"),
            points.choice
        );
    }
    if criterion == SAFE && !single.limits.is_empty() {
        let limits: Vec<String> = single.limits.iter().map(ToString::to_string).collect();
        lines.push(format!("Safe: {}", limits.join(", ")));
    }
    lines
}

/// The criterion of all limits.
const SAFE: &str = "safe";

/// "largest safe mass flow rate", or "largest mass flow rate with" a limit.
fn quality(most: &str, name: &str, criterion: &str) -> String {
    match criterion {
        SAFE => format!("{most} safe {name}"),
        "deployed" => format!("{most} {name} that deploys"),
        limit => format!("{most} {name} with {limit}"),
    }
}

/// The border of each row: the search whose parameters it has.
fn found<'b>(points: &Source<'_>, borders: &'b [Border]) -> Vec<Option<&'b Border>> {
    let is_of_search = |column: &&Column| {
        let names = borders.first().map_or(&[][..], |border| &border.parameters);
        names.iter().any(|(name, _)| *name == column.name)
    };
    let columns: Vec<&Column> = points.table.parameters().filter(is_of_search).collect();
    let mut known: BTreeMap<Vec<String>, &Border> = BTreeMap::new();
    for border in borders {
        let key = columns.iter().map(|column| {
            let value = border.parameters.iter().find(|(name, _)| *name == column.name);
            value.map_or_else(String::new, |(_, value)| key(column, value))
        });
        known.entry(key.collect()).or_insert(border);
    }
    let of_row = |row: &usize| {
        let key: Vec<String> =
            columns.iter().map(|column| key(column, &column.cells[*row])).collect();
        known.get(&key).copied()
    };
    points.rows.iter().map(of_row).collect()
}

/// A value as a key. A column of texts stores numbers as text.
fn key(column: &Column, value: &Value) -> String {
    match (column.cell_type, value) {
        (_, Value::Null) => canonical(value),
        (CellType::Text, value) => value.to_string(),
        _ => canonical(value),
    }
}

/// The side that meets the criterion, below or not, where all borders agree.
fn side(found: &[Option<&Border>]) -> Option<bool> {
    let mut sides = found.iter().flatten().filter_map(|border| match border.outcome {
        Outcome::Border { met_below, .. } => Some(met_below),
        _ => None,
    });
    let first = sides.next()?;
    sides.all(|side| side == first).then_some(first)
}
