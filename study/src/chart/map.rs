//! One measure over two parameters: one cell per point, one panel per combination of the other
//! parameters.

use super::outcome::{self, Outcomes};
use super::parameters::{self, Facets, Parameter};
use super::{Source, invalid_option, title};
use crate::input::value::Value;
use crate::platform::error::{Error, Result};
use crate::render::figure::Sheet;
use crate::render::figure::legend::Sample;
use crate::render::figure::map::{Cell, Maps, Panel};
use crate::render::figure::unit::Unit;
use crate::store::table::Column;

/// Most panels in one figure. Chosen: more do not fit on a page.
const MAX_PANELS: usize = 18;
/// Most values along an axis. Chosen: the numbers in narrower cells are not legible.
const MAX_VALUES: usize = 16;

/// An axis of the map: a parameter and its values.
struct Axis<'a> {
    parameter: Parameter<'a>,
    values: Vec<Value>,
}

impl<'a> Axis<'a> {
    fn new(column: &'a Column, rows: &[usize]) -> Result<Self> {
        let parameter = Parameter::new(column, rows);
        let values = parameter.values(rows);
        if values.len() > MAX_VALUES {
            return Err(invalid_option(
                "--map",
                parameter.name(),
                format!("{} values along one axis", values.len()),
                format!("{MAX_VALUES} values at most"),
                "choose some with --where CONDITION, or draw it with --over",
            ));
        }
        Ok(Self { parameter, values })
    }

    fn cell(&self, row: usize) -> &Value {
        &self.parameter.column.cells[row]
    }

    /// Label and texts of the axis.
    fn texts(&self, rows: &[usize]) -> (String, Vec<String>) {
        self.parameter.along(&self.values, rows)
    }
}

/// Draws a measure over the parameters `axes[0]` (to the right) and `axes[1]` (upwards).
///
/// # Errors
/// Unknown names, a measure that is not a number, one parameter on both axes, too many panels or cells.
pub fn svg(source: &Source<'_>, measure: &str, axes: [&str; 2]) -> Result<String> {
    let measure = source.measure("--measure", measure)?;
    let asked = axes.join(",");
    if axes[0] == axes[1] {
        let problem = "one parameter on both axes";
        return Err(invalid_option("--map", &asked, problem, "two different parameters: X,Y", ""));
    }
    let [x, y] = [source.parameter("--map", axes[0])?, source.parameter("--map", axes[1])?];
    let (others, mut notes) = parameters::varying(source.table, &source.rows, &[x, y]);
    let facets = parameters::facets(others, &source.rows);
    if facets.panels.len() > MAX_PANELS {
        return Err(too_many_panels(&asked, &facets));
    }
    let [x, y] = [Axis::new(x, &source.rows)?, Axis::new(y, &source.rows)?];
    let values = source.rows.iter().filter_map(|row| outcome::value(source, measure, *row));
    let unit = Unit::shown_in(&measure.shown, &measure.unit, values.clone());
    let range = values.fold(None, |range: Option<[f64; 2]>, value| {
        let value = unit.shown(value);
        Some(range.map_or([value, value], |[low, high]| [low.min(value), high.max(value)]))
    });
    let mut outcomes = Outcomes::new(source);
    let mut panels = Vec::with_capacity(facets.panels.len());
    for (title, rows) in &facets.panels {
        let mut cells = Vec::with_capacity(x.values.len() * y.values.len());
        for up in &y.values {
            for right in &x.values {
                let here = |row: &usize| x.cell(*row) == right && y.cell(*row) == up;
                let here: Vec<usize> = rows.iter().copied().filter(here).collect();
                cells.push(match here.as_slice() {
                    [] => Cell::Absent,
                    [row] => match outcome::value(source, measure, *row) {
                        Some(value) => Cell::Value(unit.shown(value), outcomes.mark(*row)),
                        None => Cell::Letter(outcomes.letter(*row)),
                    },
                    several => return Err(several_points(&asked, several.len())),
                });
            }
        }
        panels.push(Panel { title: title.clone(), cells });
    }
    if range.is_none() {
        notes.push(format!("No job here has a value of {}.", measure.name));
    }
    let mut legend = outcomes.legend(true);
    if panels.iter().any(|panel| panel.cells.contains(&Cell::Absent)) {
        legend.entries.push((Sample::Absent, "no such point in the study".to_owned()));
    }
    let maps = Maps {
        sheet: Sheet {
            title: title(&measure.meaning, &measure.name),
            subtitle: source.subtitle_by(&facets),
            legends: vec![legend],
            notes,
        },
        x: x.texts(&source.rows),
        y: y.texts(&source.rows),
        label: unit.label(&measure.name),
        range,
        panels,
    };
    Ok(maps.svg())
}

fn too_many_panels(asked: &str, facets: &Facets<'_>) -> Error {
    invalid_option(
        "--map",
        asked,
        format!("the map needs {} panels; nothing is averaged", facets.panels.len()),
        format!("{MAX_PANELS} panels at most"),
        format!("fix some of {} with --where CONDITION", parameters::heading(&facets.parameters)),
    )
}

fn several_points(asked: &str, number: usize) -> Error {
    invalid_option(
        "--map",
        asked,
        format!("{number} points of the study share one cell"),
        "one point per cell",
        "choose some with --where CONDITION",
    )
}
