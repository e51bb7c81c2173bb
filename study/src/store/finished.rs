//! What planning knows of the jobs that have ended, from their records.

use std::collections::BTreeMap;

use crate::job::JobId;
use crate::job::point::Point;
use crate::store::journal::{self, Record};
use crate::study::finished::{FinishedRow, Judging};

/// The finished rows of some points, in their order, each under the id of its planned job.
pub fn rows(
    points: &[Point],
    records: &BTreeMap<JobId, Record>,
    by: Judging<'_>,
) -> Vec<FinishedRow> {
    let row = |point: &Point| {
        let cells = journal::cells_of(point, records)?;
        Some(FinishedRow::of(&point.job, &cells, by))
    };
    points.iter().filter_map(row).collect()
}
