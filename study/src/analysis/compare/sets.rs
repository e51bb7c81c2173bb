//! Sets of rows that are equal in all parameters except one, and the pairs in them.

use std::collections::{BTreeMap, BTreeSet};

use super::canonical;
use crate::input::value::Value;
use crate::store::table::{Column, Table};
use crate::study::Zipped;

/// Sets of rows that are equal in all parameters except one.
#[derive(Debug, Clone, PartialEq, Eq, Default)]
pub struct Sets {
    /// The matched parameters.
    pub matched: Vec<String>,
    /// Parameters that change with the compared one and are not matched.
    pub carried: Vec<String>,
    /// Rows of each set, in table order; sets in the order of their first row.
    pub sets: Vec<Vec<usize>>,
}

impl Sets {
    /// Puts rows of a table into sets. `zipped` are the parameters on the axis of `by`. Where one of
    /// them is a function of `by` on the axis, a row that follows the axis is not matched in it; a
    /// single point that leaves the axis is.
    pub fn new(table: &Table, rows: &[usize], by: &str, zipped: &[Zipped]) -> Self {
        Self::with_free(table, rows, by, &[], zipped)
    }

    /// As [`Self::new`], with further parameters that a set leaves free.
    pub fn with_free(
        table: &Table,
        rows: &[usize],
        by: &str,
        free: &[String],
        zipped: &[Zipped],
    ) -> Self {
        let Some(compared) = table.parameters().find(|column| column.name == by) else {
            return Self::default();
        };
        let others: Vec<(&Column, Option<BTreeMap<String, String>>)> = table
            .parameters()
            .filter(|column| column.name != by && !free.contains(&column.name))
            .map(|column| {
                let axis = zipped.iter().find(|zipped| zipped.name == column.name);
                (column, axis.and_then(|axis| function(axis, column, compared, rows)))
            })
            .collect();
        let mut set_of: BTreeMap<Vec<Option<String>>, usize> = BTreeMap::new();
        let mut sets: Vec<Vec<usize>> = Vec::new();
        for row in rows {
            let key = others.iter().map(|(column, axis)| {
                let on_axis = axis.as_ref().and_then(|axis| axis.get(&text(compared, *row)));
                let follows = on_axis.is_some_and(|value| *value == text(column, *row));
                (!follows).then(|| canonical(&column.cells[*row]))
            });
            let index = *set_of.entry(key.collect()).or_insert(sets.len());
            if index == sets.len() {
                sets.push(Vec::new());
            }
            sets[index].push(*row);
        }
        let names = |carried: bool| -> Vec<String> {
            let chosen = others.iter().filter(|(_, axis)| axis.is_some() == carried);
            chosen.map(|(column, _)| column.name.clone()).collect()
        };
        Self { matched: names(false), carried: names(true), sets }
    }
}

/// A cell as text. A column of texts and numbers stores its numbers as text.
fn text(column: &Column, row: usize) -> String {
    column.cells[row].to_string()
}

/// The value of a zipped parameter by value of the compared one, over the steps of the axis that the rows
/// have; `None` unless it is a function.
fn function(
    axis: &Zipped,
    column: &Column,
    compared: &Column,
    rows: &[usize],
) -> Option<BTreeMap<String, String>> {
    let present: BTreeSet<(String, String)> =
        rows.iter().map(|row| (text(compared, *row), text(column, *row))).collect();
    let mut function: BTreeMap<String, String> = BTreeMap::new();
    for (by, value) in &axis.steps {
        let step = (by.to_string(), value.to_string());
        if present.contains(&step) {
            let known = function.entry(step.0).or_insert_with(|| step.1.clone());
            if *known != step.1 {
                return None;
            }
        }
    }
    (!function.is_empty()).then_some(function)
}

/// The rows of a set, one for each value of a parameter.
pub type Set = Vec<Option<usize>>;

/// The values and the sets with the most independent comparisons, of those sets in which every one of these
/// values has a row, as `(values − 1) · sets` counts them; `None` when no set has two values.
pub fn block(sets: &[Set], values: usize) -> Option<(Vec<usize>, Vec<&Set>)> {
    let number = |index: &usize| sets.iter().filter(|set| set[*index].is_some()).count();
    let mut order: Vec<usize> = (0..values).collect();
    // The sort is stable: values of equally many sets stay in plan order.
    order.sort_by_key(|index| std::cmp::Reverse(number(index)));
    let mut complete: Vec<&Set> = sets.iter().collect();
    let mut best: Option<(usize, usize)> = None;
    for (others, index) in order.iter().enumerate() {
        complete.retain(|set| set[*index].is_some());
        let comparisons = others * complete.len();
        if comparisons > 0 && best.is_none_or(|(_, most)| comparisons >= most) {
            best = Some((others + 1, comparisons));
        }
    }
    let (number, _) = best?;
    let chosen = order[..number].to_vec();
    let block = sets.iter().filter(|set| chosen.iter().all(|index| set[*index].is_some()));
    Some((chosen.clone(), block.collect()))
}

/// Two rows of one set: positions in the table.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Pair {
    /// The row with the base value.
    pub base: usize,
    /// The row with another value.
    pub other: usize,
}

/// The pairs of some sets, and the rows without a partner.
pub fn pairs(table: &Table, sets: &Sets, by: &str, base: &Value) -> (Vec<Pair>, Vec<usize>) {
    let Some(column) = table.column(by) else { return (Vec::new(), Vec::new()) };
    let is_base = |row: &usize| canonical(&column.cells[*row]) == canonical(base);
    let mut pairs = Vec::new();
    let mut alone = Vec::new();
    for set in &sets.sets {
        let (bases, others): (Vec<usize>, Vec<usize>) = set.iter().copied().partition(is_base);
        match (bases.split_first(), others.as_slice()) {
            (Some((base, more)), [_, ..]) => {
                pairs.extend(others.iter().map(|other| Pair { base: *base, other: *other }));
                alone.extend(more);
            }
            _ => alone.extend(set),
        }
    }
    alone.sort_unstable();
    (pairs, alone)
}
