//! The order of the rows (`--sort`).

use std::cmp::Ordering;
use std::collections::BTreeMap;

use crate::input::value::Value;
use crate::platform::error::{Error, Result};
use crate::store::table::select::find;
use crate::store::table::{Column, Table};
use crate::study::Study;

/// Rows in the order of a search, where the study has one: points that are equal in all but its parameter and the
/// replicates together, its values ascending. A search plans its values in generations.
pub fn by_search(table: &Table, rows: Vec<usize>, study: Option<&Study>) -> Vec<usize> {
    let Some((searched, _)) = study.and_then(Study::searched) else { return rows };
    let Some(values) = table.parameters().find(|column| column.name == searched) else {
        return rows;
    };
    let replicates = study.map(Study::replicates).unwrap_or_default();
    let others: Vec<&Column> = table
        .parameters()
        .filter(|column| column.name != searched && !replicates.contains(&column.name))
        .collect();
    let mut known: BTreeMap<String, usize> = BTreeMap::new();
    let mut keyed: Vec<(usize, usize)> = Vec::with_capacity(rows.len());
    for row in rows {
        let key: Vec<String> = others.iter().map(|column| column.cells[row].to_string()).collect();
        let next = known.len();
        keyed.push((*known.entry(key.join("\n")).or_insert(next), row));
    }
    keyed.sort_by(|(a, row_a), (b, row_b)| {
        a.cmp(b).then(compare(&values.cells[*row_a], &values.cells[*row_b], false))
    });
    keyed.into_iter().map(|(_, row)| row).collect()
}

/// Rows in the order asked for; equal rows stay in the order given, empty cells come last.
///
/// # Errors
/// An unknown column or direction.
pub fn sorted(table: &Table, mut rows: Vec<usize>, sort: &[String]) -> Result<Vec<usize>> {
    let mut keys = Vec::with_capacity(sort.len());
    for key in sort {
        let (name, descending) = match key.trim().split_once(':') {
            None => (key.trim(), false),
            Some((name, "asc")) => (name, false),
            Some((name, "desc")) => (name, true),
            Some(_) => {
                let allowed = "NAME, NAME:asc, NAME:desc";
                return Err(Error::invalid_option("--sort", key, "unknown direction", allowed, ""));
            }
        };
        keys.push((find(table, "--sort", name)?, descending));
    }
    rows.sort_by(|a, b| {
        let compare = |(column, descending): &(&Column, bool)| {
            compare(&column.cells[*a], &column.cells[*b], *descending)
        };
        keys.iter().map(compare).find(|order| order.is_ne()).unwrap_or(Ordering::Equal)
    });
    Ok(rows)
}

fn compare(a: &Value, b: &Value, descending: bool) -> Ordering {
    let order = match (a, b) {
        (Value::Null, Value::Null) => return Ordering::Equal,
        (Value::Null, _) => return Ordering::Greater,
        (_, Value::Null) => return Ordering::Less,
        (Value::Bool(a), Value::Bool(b)) => a.cmp(b),
        (Value::Integer(a), Value::Integer(b)) => a.cmp(b),
        (Value::Number(a), Value::Number(b)) => a.total_cmp(b),
        // Cells of one column have one type: these are texts.
        (a, b) => a.to_string().cmp(&b.to_string()),
    };
    if descending { order.reverse() } else { order }
}
