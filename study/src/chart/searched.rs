//! A searched parameter in a map: a search has its first values in common with every other, those near its
//! border alone.

use std::collections::BTreeMap;

use super::parameters::Parameter;
use super::{Source, number};
use crate::input::value::Value;

impl Source<'_> {
    /// The rows at the values that every search has, where one of these parameters is the searched one; `None`
    /// where these are all rows.
    pub(super) fn common_values(&self, axes: &[&str]) -> Option<Self> {
        let search = self.search.filter(|search| axes.contains(&search.parameter))?;
        let column = self.table.parameters().find(|column| column.name == search.parameter)?;
        let mut searches: BTreeMap<u64, usize> = BTreeMap::new();
        for level in search.borders.iter().flat_map(|border| &border.levels) {
            *searches.entry(key(level.value)).or_default() += 1;
        }
        let is_common = |row: &&usize| {
            let value = value(&column.cells[**row]);
            let searches = value.and_then(|value| searches.get(&key(value)));
            searches == Some(&search.borders.len())
        };
        let rows: Vec<usize> = self.rows.iter().filter(is_common).copied().collect();
        if rows.is_empty() || rows.len() == self.rows.len() {
            return None;
        }
        let parameter = Parameter::new(column, &self.rows);
        let count = |rows: &[usize]| parameter.values(rows).len();
        let choice = format!(
            "{} at the {} of {} values of {} that every search has",
            self.choice,
            count(&rows),
            count(&self.rows),
            parameter.plain().plain
        );
        Some(Self { rows, choice: choice.trim().to_owned(), ..self.clone() })
    }
}

/// The number of a cell. A column of texts stores numbers as text.
fn value(cell: &Value) -> Option<f64> {
    match cell {
        Value::Text(text) => text.parse().ok(),
        cell => number(cell),
    }
}

/// A number as a key; −0 is 0.
fn key(value: f64) -> u64 {
    (value + 0.0).to_bits()
}
