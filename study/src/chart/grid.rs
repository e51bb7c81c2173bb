//! The axes, panels and cells of a map.

use super::names;
use super::parameters::{self, Facets, Parameter};
use super::{Source, invalid_option};
use crate::input::value::Value;
use crate::platform::error::{Error, Result};
use crate::render::figure::Sheet;
use crate::render::figure::legend::{Legend, Sample};
use crate::render::figure::map::{Cell, Maps, Panel, SAME_JOB};
use crate::store::table::Column;

/// Most panels in one figure. Chosen: more do not fit on a page.
const MAX_PANELS: usize = 18;
/// Most values along an axis. Chosen: the numbers in narrower cells are not legible.
pub(super) const MAX_VALUES: usize = 16;

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

/// The axes and panels of a map.
pub(super) struct Grid<'s, 'a> {
    source: &'s Source<'a>,
    asked: String,
    x: Axis<'a>,
    y: Axis<'a>,
    facets: Facets<'a>,
    /// Notes below the figure.
    pub(super) notes: Vec<String>,
}

impl<'s, 'a> Grid<'s, 'a> {
    /// The grid over the parameters `axes[0]` (to the right) and `axes[1]` (upwards).
    ///
    /// # Errors
    /// Unknown names, one parameter on both axes, too many panels or values.
    pub(super) fn new(source: &'s Source<'a>, axes: [&str; 2]) -> Result<Self> {
        let asked = axes.join(",");
        if axes[0] == axes[1] {
            let problem = "one parameter on both axes";
            return Err(invalid_option(
                "--map",
                &asked,
                problem,
                "two different parameters: X,Y",
                "",
            ));
        }
        let [x, y] = [source.parameter("--map", axes[0])?, source.parameter("--map", axes[1])?];
        let (others, notes) = parameters::varying(source.table, &source.rows, &[x, y]);
        let facets = parameters::facets(others, &source.rows);
        if facets.panels.len() > MAX_PANELS {
            return Err(too_many_panels(&asked, &facets));
        }
        let [x, y] = [Axis::new(x, &source.rows)?, Axis::new(y, &source.rows)?];
        Ok(Self { source, asked, x, y, facets, notes })
    }

    /// The panels; `cell` gives the cell of a row, and whether another row is the same job.
    ///
    /// # Errors
    /// Several points in one cell.
    pub(super) fn panels(&self, cell: &mut dyn FnMut(usize, bool) -> Cell) -> Result<Vec<Panel>> {
        let shared: Vec<usize> = self.source.shared_jobs().into_iter().flatten().collect();
        let mut panels = Vec::with_capacity(self.facets.panels.len());
        for (title, rows) in &self.facets.panels {
            let mut cells = Vec::with_capacity(self.x.values.len() * self.y.values.len());
            for up in &self.y.values {
                for right in &self.x.values {
                    let here = |row: &usize| self.x.cell(*row) == right && self.y.cell(*row) == up;
                    let here: Vec<usize> = rows.iter().copied().filter(here).collect();
                    cells.push(match here.as_slice() {
                        [] => Cell::Absent,
                        [row] => cell(*row, shared.contains(row)),
                        several => return Err(several_points(&self.asked, several.len())),
                    });
                }
            }
            panels.push(Panel { title: names::capital(title), cells });
        }
        Ok(panels)
    }

    /// The figure of a quantity, with its plain name, its label and the ends of its colour scale.
    pub(super) fn figure(
        self,
        plain: &str,
        label: &str,
        range: Option<[f64; 2]>,
        panels: Vec<Panel>,
        mut legend: Legend,
    ) -> String {
        if panels.iter().any(|panel| panel.cells.contains(&Cell::Absent)) {
            legend.entries.push((Sample::Absent, "no such point in the study".to_owned()));
        }
        let has_shared = |cell: &Cell| matches!(cell, Cell::Value { shared: true, .. });
        if panels.iter().flat_map(|panel| &panel.cells).any(has_shared) {
            let sample = Sample::Letter(SAME_JOB.to_owned());
            legend.entries.push((sample, "same job as another cell".to_owned()));
        }
        let mut notes = self.notes;
        notes.extend(self.source.shared_job_note());
        let title = format!(
            "{plain} over {} and {}",
            self.x.parameter.plain().plain,
            self.y.parameter.plain().plain
        );
        let maps = Maps {
            sheet: Sheet {
                title: self.source.title_or(&title),
                subtitle: self.source.subtitle(),
                legends: vec![legend],
                notes,
            },
            x: self.x.texts(&self.source.rows),
            y: self.y.texts(&self.source.rows),
            label: label.to_owned(),
            range,
            panels,
        };
        maps.svg()
    }
}

fn too_many_panels(asked: &str, facets: &Facets<'_>) -> Error {
    invalid_option(
        "--map",
        asked,
        format!("the map needs {} panels; nothing is averaged", facets.panels.len()),
        format!("{MAX_PANELS} panels at most"),
        parameters::fix(facets.parameters.iter()),
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
