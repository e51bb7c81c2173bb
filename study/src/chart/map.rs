//! One measure over two parameters: a cell a point, a panel for every combination of the others.

use super::outcome::{self, Outcomes};
use super::vary::{self, Parameter};
use super::{Source, refused, titled};
use crate::platform::error::Result;
use crate::render::figure::Sheet;
use crate::render::figure::map::{Cell, Maps, Panel};
use crate::render::figure::unit::Unit;

/// Panels in one figure, at most.
const PANELS: usize = 18;
/// Values along an axis, at most: the numbers in narrower cells could not be read.
const VALUES: usize = 16;

/// Draws a measure over the parameters `axes[0]` (to the right) and `axes[1]` (upwards).
///
/// # Errors
/// Unknown names, a measure that is no number, one parameter on both axes, more panels or cells than
/// are legible.
pub fn svg(source: &Source<'_>, measure: &str, axes: [&str; 2]) -> Result<String> {
    let measure = source.measure("--measure", measure)?;
    if axes[0] == axes[1] {
        let problem = "one parameter on both axes";
        return Err(refused(
            "--map",
            &axes.join(","),
            problem,
            "two different parameters: X,Y",
            "",
        ));
    }
    let [x, y] = [source.parameter("--map", axes[0])?, source.parameter("--map", axes[1])?];
    let (others, mut notes) = vary::varying(source.table, &source.rows, &[x, y]);
    let facets = vary::facets(others, &source.rows);
    if facets.panels.len() > PANELS {
        return Err(refused(
            "--map",
            &axes.join(","),
            format!("{} panels would be needed; nothing is averaged", facets.panels.len()),
            format!("{PANELS} panels at most"),
            format!("fix some of {} with --where CONDITION", vary::heading(&facets.parameters)),
        ));
    }
    let [x, y] = [x, y].map(|column| Parameter::new(column, &source.rows));
    let (columns, rows) = (x.values(&source.rows), y.values(&source.rows));
    for (axis, values) in [(&x, &columns), (&y, &rows)] {
        if values.len() > VALUES {
            return Err(refused(
                "--map",
                axis.name(),
                format!("{} values along one axis", values.len()),
                format!("{VALUES} values at most"),
                "choose some with --where CONDITION, or draw it with --over",
            ));
        }
    }
    let mut outcomes = Outcomes::new(source);
    let values = source.rows.iter().filter_map(|row| outcome::value(source, measure, *row));
    let unit = Unit::fit(&measure.unit, values.clone());
    let reach = values.fold(None, |reach: Option<[f64; 2]>, value| {
        let value = unit.shown(value);
        Some(reach.map_or([value, value], |[low, high]| [low.min(value), high.max(value)]))
    });
    let mut panels = Vec::with_capacity(facets.panels.len());
    for (title, inside) in &facets.panels {
        let mut cells = Vec::with_capacity(columns.len() * rows.len());
        for up in &rows {
            for right in &columns {
                let at =
                    |row: &usize| x.column.cells[*row] == *right && y.column.cells[*row] == *up;
                let here: Vec<usize> = inside.iter().copied().filter(at).collect();
                cells.push(match here.as_slice() {
                    [] => Cell::Absent,
                    [row] => match outcome::value(source, measure, *row) {
                        Some(value) => Cell::Value(unit.shown(value), outcomes.mark(*row)),
                        None => Cell::Letter(outcomes.letter(*row)),
                    },
                    several => {
                        return Err(refused(
                            "--map",
                            &axes.join(","),
                            format!("{} points of the study share one cell", several.len()),
                            "one point a cell",
                            "choose some with --where CONDITION",
                        ));
                    }
                });
            }
        }
        panels.push(Panel { title: title.clone(), cells });
    }
    if reach.is_none() {
        notes.push(format!("No job here has a value of {}.", measure.name));
    }
    let mut legends = vec![outcomes.legend(true)];
    if panels.iter().any(|panel| panel.cells.contains(&Cell::Absent)) {
        let entry = (super::Sample::Absent, "no such point in the study".to_owned());
        legends[0].entries.push(entry);
    }
    let maps = Maps {
        sheet: Sheet {
            title: titled(&measure.meaning, &measure.name),
            subtitle: source.subtitle_by(&facets),
            legends,
            notes,
        },
        x: x.along(&columns, &source.rows),
        y: y.along(&rows, &source.rows),
        label: unit.label(&measure.name),
        range: reach,
        panels,
    };
    Ok(maps.svg())
}
