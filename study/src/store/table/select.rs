//! Rows and columns of a table that options name: `--columns`, `--where`, `--jobs`.

use std::collections::BTreeSet;

use super::{Column, Table};
use crate::input::expression::{Expression, Type, Variable};
use crate::input::units::Dimension;
use crate::input::value::Value;
use crate::job::id::common_prefix_length;
use crate::job::row::CellType;
use crate::job::status::Status;
use crate::platform::error::{Error, InputError, Result};
use crate::platform::nearest::did_you_mean;

/// The column with that name, which `option` asks for.
///
/// # Errors
/// When there is none; the error gives the nearest name.
pub fn find<'a>(table: &'a Table, option: &str, name: &str) -> Result<&'a Column> {
    let names = || table.columns.iter().map(|column| column.name.as_str());
    table.column(name).ok_or_else(|| {
        let hint = did_you_mean(name, names());
        let allowed = match &hint {
            Some(_) => "a column of `billow table --columns all`".to_owned(),
            None => names().collect::<Vec<_>>().join(", "),
        };
        Error::invalid_option(option, name, "no such column", allowed, hint.unwrap_or_default())
    })
}

/// Rows for which the condition (`--where`) holds, in plan order.
///
/// # Errors
/// An invalid condition, or an unknown column in it.
pub fn filtered(table: &Table, condition: Option<&str>) -> Result<Vec<usize>> {
    let Some(text) = condition else { return Ok((0..table.rows()).collect()) };
    let variables: Vec<Variable> = table
        .columns
        .iter()
        .map(|column| Variable { name: column.name.clone(), kind: variable_type(table, column) })
        .collect();
    let condition = Expression::condition(text, &variables).map_err(|error| InputError {
        file: "--where".to_owned(),
        key: String::new(),
        value: String::new(),
        problem: error.to_string(),
        allowed: error.allowed,
        hint: String::new(),
    })?;
    let holds = |row: &usize| {
        let values: Vec<Value> =
            table.columns.iter().map(|column| column.cells[*row].clone()).collect();
        condition.holds(&values)
    };
    Ok((0..table.rows()).filter(holds).collect())
}

/// The type of a column in an expression.
fn variable_type(table: &Table, column: &Column) -> Type {
    match column.cell_type {
        CellType::Bool => Type::Bool,
        // A parameter holds the words of its study; another text may be one that no row has yet.
        CellType::Text if table.parameters().any(|known| known.name == column.name) => {
            let texts = column.cells.iter().filter_map(|cell| match cell {
                Value::Text(text) => Some(text.clone()),
                _ => None,
            });
            let words: BTreeSet<String> = texts.collect();
            Type::Text((!words.is_empty()).then(|| words.into_iter().collect()))
        }
        CellType::Text if column.name == "status" => {
            Type::Text(Some(Status::all().map(|status| status.name().to_owned()).collect()))
        }
        CellType::Text => Type::Text(None),
        CellType::Integer | CellType::Number => {
            let known = Dimension::all().find(|known| known.si() == column.unit);
            Type::Quantity(known.unwrap_or(Dimension::Number), &[])
        }
    }
}

/// Rows of the jobs whose ids start with these prefixes (`--jobs`), in the order given: every point of
/// each job.
///
/// # Errors
/// A prefix of no job, or of several; the error gives the nearest ids.
pub fn jobs(table: &Table, prefixes: &[String]) -> Result<Vec<usize>> {
    let ids: Vec<&str> = table
        .column("job")
        .into_iter()
        .flat_map(|column| column.cells.iter())
        .map(|cell| if let Value::Text(id) = cell { id.as_str() } else { "" })
        .collect();
    let mut rows = Vec::with_capacity(prefixes.len());
    for prefix in prefixes.iter().map(|prefix| prefix.trim()) {
        let found: Vec<usize> =
            (0..ids.len()).filter(|row| ids[*row].starts_with(prefix)).collect();
        match table.one_row_per_job(&found).len() {
            1 => {
                let new: Vec<usize> = found.into_iter().filter(|row| !rows.contains(row)).collect();
                rows.extend(new);
            }
            several => {
                let problem = if several == 0 {
                    "no job id starts with this".to_owned()
                } else {
                    format!("{several} job ids start with this")
                };
                let hint = "billow table --runs --columns job,status lists them";
                let allowed = nearest_ids(&ids, prefix);
                return Err(Error::invalid_option("--jobs", prefix, problem, allowed, hint));
            }
        }
    }
    Ok(rows)
}

/// Ids that share the longest prefix with this one, at most six.
fn nearest_ids(ids: &[&str], prefix: &str) -> String {
    const MAX_SHOWN: usize = 6;
    let shared = |id: &str| common_prefix_length(id, prefix);
    let longest = ids.iter().map(|id| shared(id)).max().unwrap_or(0);
    let mut nearest: Vec<&str> = ids
        .iter()
        .filter(|id| shared(id) == longest)
        .map(|id| id.get(..12).unwrap_or(id))
        .collect();
    nearest.sort_unstable();
    nearest.dedup();
    let more = if nearest.len() > MAX_SHOWN { ", …" } else { "" };
    format!("{}{more}", nearest[..nearest.len().min(MAX_SHOWN)].join(", "))
}
