//! One measure over two parameters: one cell per point, one panel per combination of the other
//! parameters.

use super::Source;
use super::grid::Grid;
use super::names::Name;
use super::outcome::{self, Outcomes};
use super::parameters;
use super::share::{self, Judged};
use crate::platform::error::Result;
use crate::render::figure::legend::Sample;
use crate::render::figure::map::Cell;

/// Draws a measure over the parameters `axes[0]` (to the right) and `axes[1]` (upwards). For `safe` and
/// `verdict` see [`share`]. A searched parameter has the values that every search has.
///
/// # Errors
/// Unknown names, a measure that is not a number, one parameter on both axes, too many panels or cells.
pub fn svg(source: &Source<'_>, measure: &str, axes: [&str; 2]) -> Result<String> {
    let common = source.common_values(&axes);
    let source = common.as_ref().unwrap_or(source);
    if let Some(judged) = Judged::of_name(measure) {
        return share::svg(source, judged, axes);
    }
    let measure = source.measure("--measure", measure)?;
    let mut grid = Grid::new(source, axes)?;
    let values = source.rows.iter().filter_map(|row| outcome::value(source, measure, *row));
    let unit = parameters::shown_unit(measure, values.clone());
    let range = values.fold(None, |range: Option<[f64; 2]>, value| {
        let value = unit.shown(value);
        Some(range.map_or([value, value], |[low, high]| [low.min(value), high.max(value)]))
    });
    let bound = source.bound(measure);
    let mut outcomes = Outcomes::new(source);
    let panels = grid.panels(&mut |row, shared| match outcome::value(source, measure, row) {
        None => Cell::Letter(outcomes.letter(row)),
        Some(value) => Cell::Value {
            value: unit.shown(value),
            outcome: outcomes.mark(row),
            shared,
            text: String::new(),
            below: outcome::mixed_text(source, row),
            missed: bound.as_ref().is_some_and(|bound| bound.is_missed(source, row, value)),
        },
    })?;
    if range.is_none() {
        grid.notes.push(format!("No job here has a value of {}.", measure.name));
    }
    let mut legend = outcomes.legend(true);
    let missed = |cell: &Cell| matches!(cell, Cell::Value { missed: true, .. });
    if let Some(bound) = bound.filter(|_| panels.iter().flat_map(|panel| &panel.cells).any(missed))
    {
        legend.entries.push((Sample::Missed, bound.legend()));
    }
    let name = Name::of_measure(&measure.name, &measure.meaning);
    if source.has_replicates() {
        grid.notes.insert(0, "Numbers are medians of the runs of a point.".to_owned());
    }
    grid.notes.extend(source.runs_notes(Some(measure)));
    Ok(grid.figure(&name.plain, &name.label(&unit), range, panels, legend))
}
