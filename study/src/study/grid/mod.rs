//! The grid of a study: axes (single or zipped), single points, a filter.

mod read;

use super::REPLICATES;
use super::column::Column;
use super::filter::Filter;
use super::search::Search;
use crate::input::json::Json;
use crate::input::settings::Settings;
use crate::input::source::Source;
use crate::input::value::{Value, json_value};
use crate::job::result_limit::ResultLimit;
use crate::platform::error::InputError;

/// What the values of a grid are read with.
#[derive(Clone, Copy)]
pub(super) struct Context<'a> {
    /// The keys outside the grid, and their values.
    pub settings: &'a Settings,
    /// What results must meet to be safe.
    pub limits: &'a [ResultLimit],
    pub source: &'a Source,
    pub max_points: usize,
}

#[derive(Debug, Clone, Default, PartialEq)]
pub(super) struct Grid {
    /// Every key varied on an axis or by a point, in the order of the file.
    pub columns: Vec<Column>,
    /// The axes; the first varies slowest.
    pub axes: Vec<Axis>,
    /// Single points, after the product: positions in `columns`, and values.
    pub points: Vec<Vec<(usize, Value)>>,
    /// Which points the study keeps.
    pub filter: Option<Filter>,
    /// The search of a border along one of the axes.
    pub search: Option<Search>,
    /// Names of the measures with a limit.
    limit_names: Vec<String>,
}

/// One axis: keys that vary together.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct Axis {
    /// Positions in [`Grid::columns`].
    pub columns: Vec<usize>,
    /// Values: one row for each step of the axis, one value for each column.
    pub rows: Vec<Vec<Value>>,
    /// What its values are.
    pub kind: AxisKind,
}

#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum AxisKind {
    /// Those of the file.
    Values,
    /// Those with which a search begins.
    Search,
    /// Repetitions of each point.
    Replicates,
    /// Meshes from which values are extrapolated.
    Meshes,
}

impl AxisKind {
    /// Whether its values repeat a point: they make no point of their own.
    pub fn repeats(self) -> bool {
        matches!(self, Self::Replicates | Self::Meshes)
    }
}

impl Grid {
    /// Refuses an override of a key that the grid varies together with others, or that repeats points: it
    /// has no effect.
    pub fn refuse_varied(&self, source: &Source) -> Result<(), InputError> {
        for axis in &self.axes {
            let name = |column: &usize| &self.columns[*column].name;
            let is_set = |column: &&usize| {
                let path = self.columns[**column].key.path;
                source.sets.iter().any(|(set, _)| set == path)
            };
            let Some(column) = axis.columns.iter().find(is_set) else { continue };
            let (by, allowed) = match axis.kind {
                AxisKind::Meshes => ("solver.meshes", "solver.meshes=[4, 8]".to_owned()),
                AxisKind::Replicates => (REPLICATES, format!("replicates.{}=[…]", name(column))),
                AxisKind::Values | AxisKind::Search => {
                    ("grid.zip", format!("grid.zip=[{{\"{}\": […], …}}]", name(column)))
                }
            };
            let problem = format!("varies by {by}, so the override has no effect");
            let path = self.columns[*column].key.path;
            return Err(source.error(path, "", problem, format!("--set '{allowed}'")));
        }
        Ok(())
    }

    /// Number of single points, without replicates.
    pub fn single_points(&self) -> usize {
        let Some(search) = &self.search else { return self.points.len() };
        let gives =
            |point: &&Vec<(usize, Value)>| point.iter().any(|(column, _)| *column == search.column);
        let given = self.points.iter().filter(gives).count();
        given + (self.points.len() - given) * search.scan().len()
    }

    /// Names of the columns whose values repeat a point.
    pub fn repeated(&self) -> Vec<String> {
        let columns = self.replicates().flat_map(|axis| &axis.columns);
        columns.map(|column| self.columns[*column].name.clone()).collect()
    }

    /// The replicates as JSON; empty without any.
    pub fn resolved_replicates(&self) -> Vec<(String, Json)> {
        let member = |axis: &Axis| {
            let values = axis.rows.iter().map(|row| Json::from(json_value(&row[0]))).collect();
            (self.columns[axis.columns[0]].name.clone(), Json::List(values))
        };
        let replicates = self.axes.iter().filter(|axis| axis.kind == AxisKind::Replicates);
        replicates.map(member).collect()
    }

    /// The grid as JSON: each axis is a group of `zip`, since a list keeps the order of the axes and an
    /// object may not.
    pub fn resolved(&self) -> Json {
        let name = |column: usize| self.columns[column].name.clone();
        let json = |value: &Value| Json::from(json_value(value));
        let mut grid = Vec::new();
        let grouped: Vec<&Axis> = self.axes.iter().filter(|axis| !axis.kind.repeats()).collect();
        let groups = grouped.iter().map(|axis| {
            if let (AxisKind::Search, Some(search)) = (axis.kind, &self.search) {
                let json = search.to_json(&|limit| self.limit_names[limit].clone());
                return Json::Object(vec![(name(axis.columns[0]), json)]);
            }
            let columns = axis.columns.iter().enumerate().map(|(index, column)| {
                let values = axis.rows.iter().map(|row| json(&row[index])).collect();
                (name(*column), Json::List(values))
            });
            Json::Object(columns.collect())
        });
        if !grouped.is_empty() {
            grid.push(("zip".to_owned(), Json::List(groups.collect())));
        }
        let points = self.points.iter().map(|point| {
            let members = point.iter().map(|(column, value)| (name(*column), json(value)));
            Json::Object(members.collect())
        });
        if !self.points.is_empty() {
            grid.push(("points".to_owned(), Json::List(points.collect())));
        }
        if let Some(filter) = &self.filter {
            grid.push(("filter".to_owned(), Json::Text(filter.text().to_owned())));
        }
        Json::Object(grid)
    }
}
