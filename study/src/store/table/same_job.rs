//! The rows of a table: one per point, also for points that are one job.

use std::collections::BTreeSet;

use super::{Column, Table};
use crate::input::value::Value;
use crate::job::Parameters;
use crate::job::point::{self, Point};
use crate::job::row::{CellType, SAME_JOB_AS, SAME_JOB_AS_MEANING};

/// Most points that a cell names. Chosen: more cannot be read, and a table stays small.
const MAX_NAMED: usize = 8;

/// One row: its point, and its own parameters.
pub(super) struct PointRow<'a> {
    pub point: &'a Point,
    pub parameters: &'a Parameters,
}

/// One row per point. Points of one job follow the first of them. Points that are equal in every
/// parameter are one row.
pub(super) fn point_rows(points: &[Point]) -> Vec<PointRow<'_>> {
    let mut rows = Vec::with_capacity(points.len());
    for point in points {
        let first = &point.job.parameters;
        rows.push(PointRow { point, parameters: first });
        let mut seen = BTreeSet::new();
        for parameters in &point.merged {
            if parameters != first && seen.insert(format!("{parameters:?}")) {
                rows.push(PointRow { point, parameters });
            }
        }
    }
    rows
}

/// The column [`SAME_JOB_AS`] of these rows.
pub(super) fn column(rows: &[PointRow<'_>]) -> Column {
    let mut cells = Vec::with_capacity(rows.len());
    for job in rows.chunk_by(|a, b| std::ptr::eq(a.point, b.point)) {
        cells.extend((0..job.len()).map(|row| cell(job, row)));
    }
    Column::new(SAME_JOB_AS, (CellType::Text, ""), SAME_JOB_AS_MEANING, cells)
}

/// The other rows of a job, as seen from one of them.
fn cell(job: &[PointRow<'_>], row: usize) -> Value {
    if job.len() == 1 {
        return Value::Null;
    }
    let here = job[row].parameters;
    let others = (0..job.len()).filter(|other| *other != row).take(MAX_NAMED);
    let mut texts: Vec<String> = others
        .map(|other| {
            let parameters = job[other].parameters.iter();
            let differing = parameters.filter(|pair| !here.contains(pair)).cloned().collect();
            point::label(&differing)
        })
        .collect();
    let more = job.len() - 1 - texts.len();
    if more > 0 {
        texts.push(format!("and {more} more"));
    }
    Value::Text(texts.join("; "))
}

impl Table {
    /// The first of these rows of each job: the other rows of a job are further points, but no further
    /// evidence.
    pub fn one_row_per_job(&self, rows: &[usize]) -> Vec<usize> {
        let Some(ids) = self.column("job") else { return rows.to_vec() };
        let mut seen = BTreeSet::new();
        let is_new = |row: &&usize| match &ids.cells[**row] {
            Value::Text(id) => seen.insert(id.as_str()),
            _ => true,
        };
        rows.iter().filter(is_new).copied().collect()
    }
}
