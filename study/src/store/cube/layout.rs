//! Where the points of a study are in its cube: dimensions, coordinates, and the position of each row.

use std::collections::HashMap;
use std::collections::hash_map::Entry;

use super::values::{Values, link_name};
use crate::input::value::Value;
use crate::platform::error::{Error, Result};
use crate::store::table::Table;
use crate::study::{GridAxis, NoProduct, Study};

/// Name of the dimension of a study whose points are no product of axes.
const POINT: &str = "point";

/// Values along a dimension.
#[derive(Debug, Clone, PartialEq)]
pub struct Coordinate {
    /// Name: that of the dimension, for its scale.
    pub name: String,
    /// SI unit; "1" for a pure number, empty for a text.
    pub unit: String,
    /// Meaning, one line.
    pub meaning: String,
    /// Number of its dimension.
    pub dimension: usize,
    /// One value for each step.
    pub values: Values,
}

/// The arrangement of the rows of a table.
#[derive(Debug, Clone, PartialEq)]
pub struct Layout {
    /// Name and length of each dimension; the last one is fastest.
    pub dimensions: Vec<(String, usize)>,
    /// The coordinates; each dimension has one with its name, its scale.
    pub coordinates: Vec<Coordinate>,
    /// The position of each row of the table.
    pub positions: Vec<usize>,
    /// Why there is one dimension `point`; `None` for a grid.
    pub no_product: Option<NoProduct>,
}

impl Layout {
    /// The layout of a study's table.
    ///
    /// # Errors
    /// [`Error::Disk`] for a row that is not on the grid: study and table do not belong together.
    pub fn of(study: &Study, table: &Table) -> Result<Self> {
        match study.grid_axes() {
            Ok(axes) => Self::product(study, table, &axes),
            Err(reason) => Ok(Self::list(study, table, reason)),
        }
    }

    /// Number of positions.
    pub fn size(&self) -> usize {
        self.dimensions.iter().map(|(_, length)| length).product()
    }

    fn product(study: &Study, table: &Table, axes: &[GridAxis]) -> Result<Self> {
        let mut layout = Self {
            dimensions: Vec::with_capacity(axes.len()),
            coordinates: Vec::new(),
            positions: vec![0; table.rows()],
            no_product: None,
        };
        for axis in axes {
            let (steps, numbers) = distinct(axis);
            let columns: Option<Vec<&[Value]>> = axis
                .names
                .iter()
                .map(|name| table.column(name).map(|column| column.cells.as_slice()))
                .collect();
            for (row, position) in layout.positions.iter_mut().enumerate() {
                let key = columns.as_ref().map(|columns| {
                    key(&columns.iter().map(|cells| &cells[row]).collect::<Vec<_>>())
                });
                let step = key.and_then(|key| numbers.get(&key)).ok_or_else(|| Error::Disk {
                    path: "summary table".into(),
                    problem: format!(
                        "row {row} has no value on the axis {}\n  next: run `billow run` of the study: it writes \
                         the table again",
                        axis.names.join(", ")
                    ),
                })?;
                *position = *position * steps.len() + step;
            }
            layout.add(study, axis, &steps);
        }
        Ok(layout)
    }

    /// Adds the dimension of an axis with these different steps, and its coordinates.
    fn add(&mut self, study: &Study, axis: &GridAxis, steps: &[&Vec<Value>]) {
        let dimension = self.dimensions.len();
        let cells =
            |column: usize| -> Vec<&Value> { steps.iter().map(|step| &step[column]).collect() };
        // The scale of a group of zip is its first parameter with different values.
        let differ = |column: usize| {
            let mut keys: Vec<String> = cells(column).iter().map(|cell| key(&[cell])).collect();
            keys.sort_unstable();
            keys.windows(2).all(|pair| pair[0] != pair[1])
        };
        let scale = (0..axis.names.len()).find(|column| differ(*column));
        let name = scale.map_or_else(|| axis.names.join("_"), |column| axis.names[column].clone());
        let name = link_name(&name);
        if scale.is_none() {
            self.coordinates.push(Coordinate {
                name: name.clone(),
                unit: "1".to_owned(),
                meaning: "step of the axis".to_owned(),
                dimension,
                values: Values::Integers((0..).take(steps.len()).collect()),
            });
        }
        for (column, parameter) in axis.names.iter().enumerate() {
            self.coordinates.push(Coordinate {
                name: link_name(parameter),
                unit: study.unit(parameter).to_owned(),
                meaning: study.meaning(parameter).to_owned(),
                dimension,
                values: Values::of_parameter(&cells(column)),
            });
        }
        self.dimensions.push((name, steps.len()));
    }

    fn list(study: &Study, table: &Table, reason: NoProduct) -> Self {
        let rows = table.rows();
        let mut coordinates = vec![Coordinate {
            name: POINT.to_owned(),
            unit: "1".to_owned(),
            meaning: "row of the summary table".to_owned(),
            dimension: 0,
            values: Values::Integers((0..).take(rows).collect()),
        }];
        coordinates.extend(table.parameters().map(|column| {
            let meaning = study.meaning(&column.name);
            Coordinate {
                name: link_name(&column.name),
                unit: column.unit.clone(),
                meaning: if meaning.is_empty() { &column.meaning } else { meaning }.to_owned(),
                dimension: 0,
                values: Values::of_parameter(&column.cells.iter().collect::<Vec<_>>()),
            }
        }));
        Self {
            dimensions: vec![(POINT.to_owned(), rows)],
            coordinates,
            positions: (0..rows).collect(),
            no_product: Some(reason),
        }
    }
}

/// The different steps of an axis, and the number of each by its key.
fn distinct(axis: &GridAxis) -> (Vec<&Vec<Value>>, HashMap<String, usize>) {
    let mut steps: Vec<&Vec<Value>> = Vec::with_capacity(axis.steps.len());
    let mut numbers = HashMap::new();
    for step in &axis.steps {
        let key = key(&step.iter().collect::<Vec<_>>());
        if let Entry::Vacant(entry) = numbers.entry(key) {
            entry.insert(steps.len());
            steps.push(step);
        }
    }
    (steps, numbers)
}

/// Values as one text that is the same for equal values: 5 and 5.0 are equal.
fn key(values: &[&Value]) -> String {
    let texts = values.iter().map(|value| match value {
        Value::Integer(value) => (*value as f64).to_string(),
        other => other.to_string(),
    });
    texts.collect::<Vec<_>>().join("\n")
}
