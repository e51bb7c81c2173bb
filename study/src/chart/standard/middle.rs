//! A chart of some points in the place of all: the middle values of parameters that do not fit.

use std::collections::BTreeSet;

use super::ChartKind;
use crate::analysis::compare::canonical;
use crate::chart::Source;
use crate::chart::parameters::{self, Parameter, STRATEGY};
use crate::input::value::Value;
use crate::store::table::Column;

/// The same chart at the middle values of the parameters that are neither its axes nor the inflation strategy;
/// `None` where there are none.
pub fn reduced(source: &Source<'_>, kind: &ChartKind) -> Option<ChartKind> {
    let keep: Vec<&str> = match kind {
        ChartKind::History(_) => Vec::new(),
        ChartKind::Over(_, over, _) => vec![over],
        ChartKind::Map(_, [x, y]) => vec![x, y],
        // The searches are chosen, not their values.
        ChartKind::Borders(..) | ChartKind::At(..) => return None,
    };
    let (rows, choice) = middle(source, &keep)?;
    Some(ChartKind::At(Box::new(kind.clone()), rows, choice))
}

/// The rows at the middle values of each parameter but these and the strategy, and a text that names them.
pub(super) fn middle(source: &Source<'_>, keep: &[&str]) -> Option<(Vec<usize>, String)> {
    let kept: Vec<&Column> = source
        .table
        .parameters()
        .filter(|column| keep.contains(&column.name.as_str()) || column.name == STRATEGY)
        .collect();
    let mut rows = source.rows.clone();
    let mut texts = Vec::new();
    let (others, _) = parameters::varying(source.table, &source.rows, &kept);
    for parameter in others {
        let values = parameter.values(&rows);
        if values.len() < 2 {
            continue;
        }
        let value = middle_value(&parameter, &values, &rows, &kept);
        rows.retain(|row| parameter.column.cells[*row] == value);
        texts.extend(rows.first().map(|row| parameter.named(*row)));
    }
    (!texts.is_empty()).then(|| (rows, format!("at {}", texts.join(", "))))
}

/// The middle of the values at which most combinations of the kept parameters have a row.
fn middle_value(
    parameter: &Parameter<'_>,
    values: &[Value],
    rows: &[usize],
    kept: &[&Column],
) -> Value {
    let combinations = |value: &Value| {
        let here = rows.iter().filter(|row| parameter.column.cells[**row] == *value);
        let key = |row: &usize| -> Vec<String> {
            kept.iter().map(|column| canonical(&column.cells[*row])).collect()
        };
        here.map(key).collect::<BTreeSet<_>>().len()
    };
    let most = values.iter().map(combinations).max().unwrap_or(0);
    let common: Vec<&Value> = values.iter().filter(|value| combinations(value) == most).collect();
    common[common.len() / 2].clone()
}
