//! The outline of a history file: its times and its columns, without their values.

use std::path::Path;
use std::sync::PoisonError;

use billow_solver::output::history::COLUMNS;
use hdf5::Group;

use super::{HDF5_LOCK, damaged, open, read_text};
use crate::platform::error::Result;

/// A column of a history.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct ColumnOutline {
    /// Name.
    pub name: String,
    /// SI unit; "1" for a pure number.
    pub unit: String,
    /// Meaning, one line.
    pub meaning: String,
}

/// What a history file holds.
#[derive(Debug, Clone, PartialEq)]
pub struct Outline {
    /// Times of its samples, s.
    pub times: Vec<f64>,
    /// Its columns but `time`: those of every history in their order, then the others by name.
    pub columns: Vec<ColumnOutline>,
}

/// Reads the outline of a history file.
///
/// # Errors
/// As [`super::read()`].
pub fn outline(path: &Path) -> Result<Outline> {
    let _guard = HDF5_LOCK.lock().unwrap_or_else(PoisonError::into_inner);
    let file = open(path)?;
    let read = || -> hdf5::Result<Outline> {
        let group = file.group("history")?;
        let times = group.dataset("time")?.read_raw::<f64>()?;
        Ok(Outline { times, columns: columns(&group)? })
    };
    read().map_err(|error| damaged(path, &error))
}

fn columns(group: &Group) -> hdf5::Result<Vec<ColumnOutline>> {
    let mut columns = Vec::new();
    for name in group.member_names()? {
        if name == "time" {
            continue;
        }
        let dataset = group.dataset(&name)?;
        columns.push(ColumnOutline {
            unit: read_text(&dataset, "units")?,
            meaning: read_text(&dataset, "long_name")?,
            name,
        });
    }
    let place = |column: &ColumnOutline| {
        let known = COLUMNS.iter().position(|known| known.name == column.name);
        (known.unwrap_or(COLUMNS.len()), column.name.clone())
    };
    columns.sort_by_key(place);
    Ok(columns)
}
