//! Keys of a study as columns of its table: `film.loss_factor`, `design.N`. A key that the study does not
//! vary has one value in every row.

use crate::input::expression;
use crate::input::units::DisplayUnits;
use crate::input::value::Value;
use crate::job::row::CellType;
use crate::platform::error::Result;
use crate::store::results::Results;
use crate::store::table::{Column, Table};
use crate::study::{Study, StudyKey};

/// Adds a column for every key of the study that `names` name and the table does not have. Other names
/// are left to the reader of the name. The study of the results is read only if a name asks for it.
///
/// # Errors
/// A study.json that cannot be read.
pub fn add_from(
    results: &Results<'_>,
    table: &mut Table,
    units: &DisplayUnits,
    names: &[String],
) -> Result<()> {
    let missing = |name: &&String| table.column(name).is_none() && Study::may_be_key(name);
    let missing: Vec<String> = names.iter().filter(missing).cloned().collect();
    if missing.is_empty() || results.owner()?.is_none() {
        return Ok(());
    }
    add(&Study::load(&results.study_path(), &[])?, table, units, &missing);
    Ok(())
}

/// Adds a column for every key of the study that `names` name and the table does not have.
pub fn add(study: &Study, table: &mut Table, units: &DisplayUnits, names: &[String]) {
    for name in names {
        if table.column(name).is_some() {
            continue;
        }
        let Some(key) = study.key(name) else { continue };
        let column = match table.parameters().find(|column| column.name == key.name) {
            Some(parameter) => Column { name: name.clone(), ..parameter.clone() },
            None => constant(name, key, table.rows(), units),
        };
        table.columns.push(column);
    }
}

/// A column with the same value in every row.
fn constant(name: &str, key: StudyKey, rows: usize, units: &DisplayUnits) -> Column {
    let unit = key.key.unit();
    Column {
        name: name.to_owned(),
        cell_type: match key.value {
            Value::Bool(_) => CellType::Bool,
            Value::Integer(_) => CellType::Integer,
            Value::Number(_) => CellType::Number,
            Value::Null if !unit.is_empty() => CellType::Number,
            Value::Null | Value::Text(_) => CellType::Text,
        },
        unit: unit.to_owned(),
        shown: units.of(&key.name, unit),
        meaning: key.key.doc.to_owned(),
        cells: vec![key.value; rows],
    }
}

/// The names in a condition.
pub fn names_in(condition: Option<&str>) -> Vec<String> {
    condition.map(expression::names).unwrap_or_default()
}
