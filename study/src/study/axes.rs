//! The axes of a study's grid, for readers that arrange its results as an array.

use super::Study;
use crate::input::value::Value;

/// One axis: the values of its parameters, which change together.
#[derive(Debug, Clone, PartialEq)]
pub struct GridAxis {
    /// Names of its parameters: one, or several of a group of `zip`.
    pub names: Vec<String>,
    /// Its steps: one value (SI) for each parameter.
    pub steps: Vec<Vec<Value>>,
}

/// Why the points of a study are no product of axes.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum NoProduct {
    /// It varies nothing.
    NoAxes,
    /// A search chooses its points.
    Search,
    /// It has single points (`grid.points`).
    SinglePoints,
}

impl NoProduct {
    /// The reason, as the end of a sentence that begins with "the study".
    pub fn text(self) -> &'static str {
        match self {
            Self::NoAxes => "varies nothing",
            Self::Search => "has a search, which chooses its points",
            Self::SinglePoints => "has single points (grid.points)",
        }
    }
}

impl Study {
    /// The axes of its grid in the order of the plan, the slowest first; replicates and meshes are the
    /// last ones.
    ///
    /// # Errors
    /// Why its points are no product of axes.
    pub fn grid_axes(&self) -> Result<Vec<GridAxis>, NoProduct> {
        if self.grid.search.is_some() {
            return Err(NoProduct::Search);
        }
        if !self.grid.points.is_empty() {
            return Err(NoProduct::SinglePoints);
        }
        if self.grid.axes.is_empty() {
            return Err(NoProduct::NoAxes);
        }
        let name = |column: &usize| self.grid.columns[*column].name.clone();
        let axes = self.grid.axes.iter().map(|axis| GridAxis {
            names: axis.columns.iter().map(name).collect(),
            steps: axis.rows.clone(),
        });
        Ok(axes.collect())
    }

    /// Meaning of a varied parameter; empty for an unknown one.
    pub fn meaning(&self, parameter: &str) -> &'static str {
        let column = self.grid.columns.iter().find(|column| column.name == parameter);
        column.map_or("", |column| column.key.doc)
    }
}
