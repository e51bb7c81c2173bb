//! Whether a stored table says what the journal says.

use std::collections::BTreeMap;

use super::extrapolated::is_extrapolated;
use super::{Column, Table};
use crate::accuracy::{NO_ERROR_REASON, is_error_column};
use crate::input::value::Value;
use crate::job::row::{COLUMNS, ColumnId};
use crate::job::{JobId, Status};
use crate::platform::provenance::PHYSICS_VERSION;
use crate::store::journal::Record;

/// Whether every row has the cells of its job's record, and no row without a record has results. Columns that
/// the table does not have are not compared: it may be one of an older version.
pub fn agrees(table: &Table, records: &BTreeMap<JobId, Record>) -> bool {
    let Some(jobs) = table.column("job") else { return false };
    jobs.cells.iter().enumerate().all(|(row, job)| {
        let Value::Text(job) = job else { return false };
        let record = JobId::from_digits(job).and_then(|id| records.get(&id));
        match (table.status(row), record) {
            (Some(Status::Infeasible | Status::Pending), None) => true,
            (Some(_), Some(record)) => COLUMNS.iter().all(|column| {
                let stored = table.value(column.id, row);
                stored.is_none_or(|stored| same(stored, record.cells.get(column.id)))
            }),
            (None, _) | (_, None) => false,
        }
    })
}

/// Whether a table says what the journal says, of another physics version than that of today: its jobs are in no
/// plan of today.
pub fn is_of_other_physics(table: &Table, records: &BTreeMap<JobId, Record>) -> bool {
    let versions =
        (0..table.rows()).filter_map(|row| match table.value(ColumnId::PhysicsVersion, row) {
            Some(Value::Integer(version)) => Some(*version),
            _ => None,
        });
    let versions: Vec<i64> = versions.collect();
    let other = |version: &i64| *version != i64::from(PHYSICS_VERSION);
    !versions.is_empty() && versions.iter().all(other) && agrees(table, records)
}

/// Number of rows in which two tables differ; all rows when their columns differ. Mesh errors do not count: a
/// table of an older version has none, or others.
pub fn different_rows(a: &Table, b: &Table) -> usize {
    let compared = |table: &Table| -> Vec<usize> {
        let columns = table.columns.iter().enumerate();
        columns.filter(|(_, column)| !is_mesh_error(&column.name)).map(|(index, _)| index).collect()
    };
    let pairs: Vec<[&Column; 2]> = compared(a)
        .into_iter()
        .zip(compared(b))
        .map(|(in_a, in_b)| [&a.columns[in_a], &b.columns[in_b]])
        .collect();
    let rows = a.rows().max(b.rows());
    let same_columns =
        compared(a).len() == compared(b).len() && pairs.iter().all(|[a, b]| a.name == b.name);
    if a.rows() != b.rows() || !same_columns {
        return rows;
    }
    let differs = |row: &usize| pairs.iter().any(|[a, b]| !same(&a.cells[*row], &b.cells[*row]));
    (0..rows).filter(differs).count()
}

/// Whether a column holds what the table of mesh errors says, and not what a run gave.
fn is_mesh_error(name: &str) -> bool {
    is_error_column(name) || name == NO_ERROR_REASON || is_extrapolated(name)
}

/// Whether two values are the same; NaN is the same as NaN.
pub fn same(a: &Value, b: &Value) -> bool {
    match (a, b) {
        (Value::Number(a), Value::Number(b)) => {
            a.to_bits() == b.to_bits() || (a.is_nan() && b.is_nan())
        }
        _ => a == b,
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::job::row::Cells;
    use crate::run::fixture;

    #[test]
    fn a_table_agrees_until_a_cell_or_a_record_changes() {
        let points = fixture::generation(4).points;
        let mut records = BTreeMap::new();
        for (number, point) in points.iter().enumerate().filter(|(number, _)| *number != 2) {
            let mut cells = Cells::new(Status::Done);
            cells.set(ColumnId::FinalVolume, if number == 3 { f64::NAN } else { 0.1 });
            let job = point.job.id.clone();
            let record = Record { job: job.clone(), cells, file_hash: None, file_stamp: None };
            records.insert(job, record);
        }
        let table = Table::build(&points, &records, &|_| String::new());
        assert!(agrees(&table, &records));
        let mut changed = table.clone();
        let name = ColumnId::FinalVolume.name();
        let column = changed.columns.iter_mut().find(|column| column.name == name).unwrap();
        column.cells[0] = Value::Number(0.2);
        assert!(!agrees(&changed, &records));
        records.remove(&points[1].job.id);
        assert!(!agrees(&table, &records), "a result without a record");
    }
}
