//! Which input makes the spread of a measure: sensitivity indices of a [surrogate](crate::surrogate), or parts of ranks
//! where the surrogate foresees less than half of what it does not know.

use serde::Serialize;

use super::parts::{self, Part};
use crate::analysis::values::canonical;
use crate::store::table::Column;
use crate::surrogate::{self, Coordinate, Index, Surrogate};

/// Points for each input below which there are no parts. Chosen: the intervals are then wider than the parts.
const POINTS_PER_INPUT: usize = 5;
/// Points that are used at most.
const MAX_POINTS: usize = 4096;
/// Part of the variance that a surrogate must foresee at points left out. Chosen: below, it misses more than it sees.
pub const MIN_SEEN: f64 = 0.5;
/// What the inputs do not make.
const CHANCE: &str = "chance and what the surrogate does not see";

/// What makes the spread of a measure.
#[derive(Debug, Clone, PartialEq, Serialize, Default)]
pub struct Importance {
    /// The part of its variance that a surrogate foresees at points left out in turn; `None` without a surrogate.
    pub seen: Option<f64>,
    /// Whether the parts are indices of that surrogate; otherwise they are of ranks.
    pub indices: bool,
    /// The part of each input, and the rest, the largest first: as parts of the variance of the measure, or of its ranks.
    pub parts: Vec<Part>,
}

/// Samples that these many inputs need, so that it can be said what each makes.
pub fn samples_needed(inputs: usize) -> usize {
    POINTS_PER_INPUT * inputs.max(2)
}

impl Importance {
    /// What the inputs make: `values` of a measure, one at each row. With `independent` inputs each takes its values
    /// whatever the others are.
    ///
    /// # Errors
    /// Why nothing can be said.
    pub(super) fn of(
        inputs: &[&Column],
        rows: &[usize],
        values: &[f64],
        independent: bool,
    ) -> Result<Self, String> {
        let needed = samples_needed(inputs.len());
        if rows.len() < needed {
            return Err(format!("what each input makes: {} samples, {needed} needed", rows.len()));
        }
        // Of many some: more change no digit that is shown.
        let chosen = surrogate::chosen(rows.len(), MAX_POINTS);
        let rows: Vec<usize> = chosen.iter().map(|k| rows[*k]).collect();
        let values: Vec<f64> = chosen.iter().map(|k| values[*k]).collect();
        let (rows, values) = (rows.as_slice(), values.as_slice());
        let surrogate = if independent { Self::of_surrogate(inputs, rows, values) } else { None };
        if let Some(found) = surrogate.clone().filter(|found| !found.parts.is_empty()) {
            return Ok(found);
        }
        let numbers: Vec<(String, Vec<f64>)> =
            inputs.iter().map(|input| (input.name.clone(), numbers(input, rows))).collect();
        let parts = parts::of_ranks(&numbers, values)
            .ok_or("what each input makes: the ranks do not separate them")?;
        let seen = surrogate.and_then(|found| found.seen);
        Ok(Self { seen, indices: false, parts: parts::largest_first(parts) })
    }

    /// The indices of a surrogate; without parts where it is bad.
    fn of_surrogate(inputs: &[&Column], rows: &[usize], values: &[f64]) -> Option<Self> {
        let coordinates: Vec<Coordinate> = inputs
            .iter()
            .map(|input| Coordinate::of_values(rows.iter().map(|row| &input.cells[*row])))
            .collect();
        let place = |row: &usize| -> Vec<f64> {
            let places = inputs.iter().zip(&coordinates);
            places.map(|(input, coordinate)| coordinate.place(&input.cells[*row])).collect()
        };
        let points: Vec<Vec<f64>> = rows.iter().map(place).collect();
        let words: Vec<bool> = coordinates.iter().map(Coordinate::is_word).collect();
        let surrogate = Surrogate::fit(&points, values, &words)?;
        let seen = surrogate.foresees();
        let mut found = Self { seen: Some(seen), indices: true, parts: Vec::new() };
        if seen < MIN_SEEN {
            return Some(found);
        }
        let of_input = |input: usize| points.iter().map(|point| point[input]).collect();
        let indices = surrogate.indices(&(0..inputs.len()).map(of_input).collect::<Vec<_>>())?;
        let part = |(input, index): (&&Column, &Index)| Part {
            between: Some(index.first.1),
            total: Some(index.total),
            ..Part::new(&input.name, index.first.0)
        };
        found.parts = inputs.iter().zip(&indices.inputs).map(part).collect();
        found.parts.sort_by(|a, b| {
            let total = |part: &Part| part.total.map_or(0.0, |(total, _)| total);
            total(b).total_cmp(&total(a))
        });
        found.parts.push(Part::new(CHANCE, indices.chance));
        Some(found)
    }
}

/// The values of an input as numbers; words by their order.
fn numbers(input: &Column, rows: &[usize]) -> Vec<f64> {
    let mut words: Vec<String> = rows.iter().map(|row| canonical(&input.cells[*row])).collect();
    words.sort();
    words.dedup();
    let number = |row: &usize| {
        let cell = &input.cells[*row];
        let word = || words.binary_search(&canonical(cell)).unwrap_or(0) as f64;
        cell.any_number().unwrap_or_else(word)
    };
    rows.iter().map(number).collect()
}
