//! Searches that change one factor at a time: each differs from a base in one parameter at most. They stand side by
//! side under their names.

use std::collections::BTreeMap;

use crate::analysis::compare::canonical;
use crate::chart::Source;
use crate::chart::names::capital;
use crate::chart::parameters::Parameter;
use crate::input::value::Value;
use crate::job::row::CellType;
use crate::store::table::Column;

/// Fewest parameters that vary. Two are an axis and its lines.
const FEWEST: usize = 3;

/// Searches by name.
pub(super) struct OneFactor {
    /// The names, by row, as a parameter.
    pub column: Column,
    /// The base, for the lines below the title.
    pub base: String,
}

impl OneFactor {
    /// The searches as names; `None` unless each differs from the most frequent values in one parameter at most.
    pub(super) fn of(points: &Source<'_>, varying: &[Parameter<'_>]) -> Option<Self> {
        if varying.len() < FEWEST {
            return None;
        }
        let base: Vec<String> =
            varying.iter().map(|parameter| most_frequent(parameter, &points.rows)).collect();
        let differing = |row: usize| -> Vec<&Parameter<'_>> {
            let pairs = varying.iter().zip(&base);
            let other = pairs.filter(|(p, base)| canonical(&p.column.cells[row]) != **base);
            other.map(|(parameter, _)| parameter).collect()
        };
        let mut cells = vec![Value::Null; points.table.rows()];
        let mut base_row = None;
        for row in &points.rows {
            let name = match differing(*row).as_slice() {
                [] => {
                    base_row = Some(*row);
                    "base".to_owned()
                }
                [one] => one.named(*row),
                _ => return None,
            };
            cells[*row] = Value::Text(name);
        }
        let values = varying.iter().map(|parameter| parameter.named(base_row?).into());
        let values: Option<Vec<String>> = values.collect();
        let column = Column::plain("", CellType::Text, cells);
        Some(Self { column, base: format!("Base: {}", capital(&values?.join(", "))) })
    }
}

/// The canonical text of the value that most rows have; the first of those that are equally frequent.
fn most_frequent(parameter: &Parameter<'_>, rows: &[usize]) -> String {
    let mut counts: BTreeMap<String, (usize, std::cmp::Reverse<usize>)> = BTreeMap::new();
    for (index, row) in rows.iter().enumerate() {
        let count = counts
            .entry(canonical(&parameter.column.cells[*row]))
            .or_insert((0, std::cmp::Reverse(index)));
        count.0 += 1;
    }
    counts.into_iter().max_by_key(|(_, count)| *count).map_or_else(String::new, |(text, _)| text)
}
