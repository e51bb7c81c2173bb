//! Positions of the rows of a chart along an axis of one parameter.

use std::collections::BTreeMap;

use super::number;
use super::parameters::Parameter;
use crate::job::row::CellType;
use crate::render::figure::plot::Axis;
use crate::render::figure::scale::Spread;

/// Space at both ends of the axis, as a fraction of its length.
const PADDING: f64 = 0.06;
/// Most values of a parameter for which every value is a tick of the axis.
const MAX_MARKED_VALUES: usize = 9;

/// Positions of the rows on the x axis, in its unit.
pub struct Positions {
    /// By row.
    of_rows: BTreeMap<usize, f64>,
    /// Distinct positions and their texts, from left to right.
    marks: Vec<(f64, String)>,
    /// Label of the axis.
    label: String,
    /// Whether the values are names, at positions 0, 1, 2, …
    pub names: bool,
}

impl Positions {
    /// The positions of the values of a parameter in some rows.
    pub fn new(x: &Parameter<'_>, rows: &[usize]) -> Self {
        let values = x.values(rows);
        let names = !x.is_number(rows) || x.column.cell_type == CellType::Bool;
        let position = |index: usize| {
            let si = if names { None } else { number(&values[index]) };
            si.map_or(index as f64, |si| x.unit.shown(si))
        };
        let index = |row: &usize| values.iter().position(|known| *known == x.column.cells[*row]);
        let (label, texts) = x.along(&values, rows);
        Self {
            of_rows: rows.iter().map(|row| (*row, position(index(row).unwrap_or(0)))).collect(),
            marks: texts
                .into_iter()
                .enumerate()
                .map(|(index, text)| (position(index), text))
                .collect(),
            label,
            names,
        }
    }

    /// The position of a row.
    pub fn of(&self, row: usize) -> f64 {
        self.of_rows.get(&row).copied().unwrap_or(0.0)
    }

    /// The axis.
    pub fn axis(self) -> Axis {
        let values: Vec<f64> = self.marks.iter().map(|(position, _)| *position).collect();
        let spread = if self.names { Spread::Linear } else { Spread::of_values(&values) };
        let (low, high) = match values.as_slice() {
            [] => (0.0, 1.0),
            [first, .., last] => (*first, *last),
            [only] => (*only, *only),
        };
        let range = if self.names {
            [-0.5, values.len().max(1) as f64 - 0.5]
        } else if spread == Spread::Logarithmic {
            let padding = libm::pow(high / low, PADDING);
            [low / padding, high * padding]
        } else if high > low {
            let padding = PADDING * (high - low);
            [low - padding, high + padding]
        } else {
            let padding = if low == 0.0 { 1.0 } else { 0.1 * low.abs() };
            [low - padding, high + padding]
        };
        let ticks =
            if self.names || values.len() <= MAX_MARKED_VALUES { self.marks } else { Vec::new() };
        Axis { label: self.label, spread, range, ticks, names: self.names }
    }
}
