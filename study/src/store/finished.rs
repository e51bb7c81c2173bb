//! What planning knows of the jobs that have ended, from their records.

use std::collections::BTreeMap;

use crate::accuracy::AssumedRanges;
use crate::job::JobId;
use crate::job::point::Point;
use crate::job::result_limit::ResultLimit;
use crate::store::journal::{self, Record};
use crate::study::finished::FinishedRow;

/// The finished rows of some points, in their order, each under the id of its planned job.
pub fn rows(
    points: &[Point],
    records: &BTreeMap<JobId, Record>,
    limits: &[ResultLimit],
    assumed: &AssumedRanges,
) -> Vec<FinishedRow> {
    let row = |point: &Point| {
        let cells = journal::cells_of(point, records)?;
        Some(FinishedRow::of(&point.job, &cells, limits, assumed))
    };
    points.iter().filter_map(row).collect()
}
