//! Sets of points under equal conditions, with one point per candidate.

use std::collections::{BTreeMap, BTreeSet};

use super::RankingInput;
use crate::analysis::compare::{Set, Sets, block, canonical};
use crate::input::value::Value;
use crate::job::row::CellType;
use crate::store::table::{Column, Table};

/// The different values of the ranked parameters, in plan order.
pub(super) fn candidates(table: &Table, by: &[String]) -> Vec<Vec<Value>> {
    let mut known: Vec<Vec<Value>> = Vec::new();
    let mut seen = BTreeSet::new();
    for row in 0..table.rows() {
        if seen.insert(key(table, by, row)) {
            let columns = by.iter().filter_map(|name| table.column(name));
            known.push(columns.map(|column| column.cells[row].clone()).collect());
        }
    }
    known
}

/// The values of the ranked parameters in a row, as they are matched.
fn key(table: &Table, by: &[String], row: usize) -> String {
    let columns = by.iter().filter_map(|name| table.column(name));
    columns.map(|column| canonical(&column.cells[row])).collect::<Vec<_>>().join("\n")
}

/// Sets of points that are equal in all other parameters, with one point per candidate; the names of these
/// parameters, and of those that change with the ranked one.
pub(super) fn sets(
    table: &Table,
    rows: &[usize],
    input: &RankingInput<'_>,
    values: &[Vec<Value>],
) -> (Vec<Set>, Vec<String>, Vec<String>) {
    let by = input.by;
    let sets = if let [one] = by {
        Sets::new(table, rows, one, &(input.zipped)(one))
    } else {
        // The ranked parameters together are one.
        let joined = joined(table, by);
        Sets::new(&joined, rows, &joined.columns[1].name, &[])
    };
    let keys: Vec<String> = values
        .iter()
        .map(|values| values.iter().map(canonical).collect::<Vec<_>>().join("\n"))
        .collect();
    let set = |rows: &Vec<usize>| {
        let mut first: BTreeMap<String, usize> = BTreeMap::new();
        for row in rows {
            first.entry(key(table, by, *row)).or_insert(*row);
        }
        keys.iter().map(|key| first.get(key).copied()).collect()
    };
    (sets.sets.iter().map(set).collect(), sets.matched, sets.carried)
}

/// A table with the ranked parameters as one column of texts.
fn joined(table: &Table, by: &[String]) -> Table {
    let mut columns = table.columns.clone();
    let parameters = table.parameters().count();
    let cells = (0..table.rows()).map(|row| Value::Text(key(table, by, row))).collect();
    let first = by.iter().find_map(|name| table.column(name)).or(table.columns.first());
    let Some(first) = first else { return table.clone() };
    let joined = Column { name: by.join("\n"), cell_type: CellType::Text, cells, ..first.clone() };
    let mut index = 0;
    columns.retain(|column| {
        index += 1;
        index > parameters + 1 || !by.contains(&column.name)
    });
    columns.insert(1, joined);
    Table { columns }
}

/// The candidates and the sets in which each of them has a point. One candidate has all its sets.
pub(super) fn shared(sets: &[Set], candidates: usize) -> Option<(Vec<usize>, Vec<Set>)> {
    if candidates == 1 {
        return (!sets.is_empty()).then(|| (vec![0], sets.to_vec()));
    }
    let (chosen, kept) = block(sets, candidates)?;
    Some((chosen, kept.into_iter().cloned().collect()))
}
