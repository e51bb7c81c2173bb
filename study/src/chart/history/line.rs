//! The line of one job over time.

use billow_solver::output::measures::Verdict;

use super::Run;
use super::quantity::Drawn;
use crate::chart::time_axis::TimeAxis;
use crate::chart::{Source, outcome};
use crate::render::figure::plot::Line;
use crate::render::figure::style::{Fill, Series};

/// The line of one job. Non-finite values interrupt it. A cross marks its last point if the job failed, a
/// marker its last visible point if the capsule did not deploy.
pub(super) fn history_line(
    source: &Source<'_>,
    series: Series,
    run: &Run,
    drawn: &Drawn<'_>,
) -> Line {
    let Drawn { quantity, unit, time, thin, .. } = drawn;
    let points: Vec<[f64; 2]> = run
        .times()
        .iter()
        .zip(run.values(&quantity.symbol))
        .map(|(t, value)| [time.unit.shown(*t), unit.shown(*value)])
        .collect();
    let last = last_visible(&points, time);
    let is_end = points.iter().rfind(|point| finite(point)).copied();
    let crosses = last.filter(|_| outcome::has_failed(source, run.row));
    let crosses = crosses.filter(|last| is_end.is_some_and(|end| same(*last, end)));
    let marker = not_deployed(source, run.row);
    Line {
        pieces: pieces(&points, time),
        marks: marker.and_then(|fill| last.map(|point| (point, fill))).into_iter().collect(),
        sparse_markers: true,
        crosses: crosses.into_iter().collect(),
        thin: *thin,
        ..Line::new(series)
    }
}

fn finite(point: &[f64; 2]) -> bool {
    point[1].is_finite()
}

fn same(a: [f64; 2], b: [f64; 2]) -> bool {
    a.map(f64::to_bits) == b.map(f64::to_bits)
}

/// The last finite point within the time axis.
pub(super) fn last_visible(points: &[[f64; 2]], time: &TimeAxis) -> Option<[f64; 2]> {
    let [start, end] = time.ends.map(|end| time.unit.shown(end));
    let visible = |point: &&[f64; 2]| finite(point) && (start..=end).contains(&point[0]);
    points.iter().rfind(visible).copied()
}

/// The finite pieces of a line; of the points beyond the time axis only the next ones are needed.
pub(super) fn pieces(points: &[[f64; 2]], time: &TimeAxis) -> Vec<Vec<[f64; 2]>> {
    let [start, end] = time.ends.map(|end| time.unit.shown(end));
    let first = points.partition_point(|point| point[0] < start).saturating_sub(1);
    let past = (points.partition_point(|point| point[0] <= end) + 1).min(points.len());
    points[first.min(past)..past]
        .chunk_by(|a, b| finite(a) == finite(b))
        .filter(|piece| finite(&piece[0]))
        .map(<[_]>::to_vec)
        .collect()
}

/// The marker at the end of a line: of a done job that is not deployed.
fn not_deployed(source: &Source<'_>, row: usize) -> Option<Fill> {
    let verdict = outcome::verdict(source, row).filter(|verdict| *verdict != Verdict::Deployed)?;
    Some(outcome::fill(Some(verdict)))
}
