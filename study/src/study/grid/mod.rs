//! The grid of a study: axes (single or zipped), single points, a filter.

mod read;

use super::column::Column;
use super::filter::Filter;
use super::optimise::Optimise;
use super::search::Search;
use super::{OPTIMISE, REPLICATES, SAMPLES};
use crate::accuracy::AssumedRanges;
use crate::input::settings::Settings;
use crate::input::source::Source;
use crate::input::value::Value;
use crate::job::result_limit::ResultLimit;
use crate::platform::error::InputError;

/// What the values of a grid are read with.
#[derive(Clone, Copy)]
pub(super) struct Context<'a> {
    /// The keys outside the grid, and their values.
    pub settings: &'a Settings,
    /// What results must meet to be safe.
    pub limits: &'a [ResultLimit],
    /// The ranges of what is assumed.
    pub assumed: &'a AssumedRanges,
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
    /// The search of an optimum.
    pub optimise: Option<Optimise>,
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
    /// The points with which the search of an optimum begins.
    Optimise,
    /// Repetitions of each point.
    Replicates,
    /// Samples of inputs at each point.
    Samples,
    /// Meshes from which values are extrapolated.
    Meshes,
}

impl AxisKind {
    /// Whether its values repeat a point: they make no point of their own.
    pub fn repeats(self) -> bool {
        matches!(self, Self::Replicates | Self::Samples | Self::Meshes)
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
                AxisKind::Optimise => {
                    (OPTIMISE, format!("{OPTIMISE}.over={{\"{}\": [low, high], …}}", name(column)))
                }
                AxisKind::Samples => (SAMPLES, format!("{SAMPLES}.of={{\"{}\": …}}", name(column))),
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

    fn samples(&self) -> Option<&Axis> {
        self.axes.iter().find(|axis| axis.kind == AxisKind::Samples)
    }

    /// The columns of the inputs that are sampled.
    pub fn columns_sampled(&self) -> impl Iterator<Item = &Column> {
        let columns = self.samples().into_iter().flat_map(|axis| &axis.columns);
        columns.map(|column| &self.columns[*column])
    }

    /// Names of the inputs that are sampled.
    pub fn sampled(&self) -> Vec<String> {
        self.columns_sampled().map(|column| column.name.clone()).collect()
    }

    /// Whether a column is that of an input that is sampled.
    pub fn is_sampled(&self, column: usize) -> bool {
        self.samples().is_some_and(|axis| axis.columns.contains(&column))
    }

    /// Number of samples of each point: 1 without.
    pub fn sample_count(&self) -> usize {
        self.samples().map_or(1, |axis| axis.rows.len())
    }

    /// Names of the columns whose values repeat a point.
    pub fn repeated(&self) -> Vec<String> {
        let columns = self.replicates().flat_map(|axis| &axis.columns);
        columns.map(|column| self.columns[*column].name.clone()).collect()
    }
}
