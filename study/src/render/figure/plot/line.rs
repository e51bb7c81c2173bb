//! Points of a line: sparse markers along it, and thinning.

use super::Line;
use crate::render::figure::scale::Scale;
use crate::render::page::Position;

/// Positions on a line at x = start + k · step, mm, for every k ≥ 0.
pub(super) fn along(line: &Line, (x, y): (&Scale, &Scale), start: f64, step: f64) -> Vec<Position> {
    let mut found = Vec::new();
    for piece in &line.pieces {
        let mut next = 0;
        for pair in piece.windows(2) {
            let ends = [x.position(pair[0][0]), x.position(pair[1][0])];
            while start + f64::from(next) * step <= ends[1] {
                let marker_x = start + f64::from(next) * step;
                next += 1;
                if marker_x < ends[0] {
                    continue;
                }
                let fraction = if ends[1] > ends[0] {
                    (marker_x - ends[0]) / (ends[1] - ends[0])
                } else {
                    0.0
                };
                found.push([
                    marker_x,
                    y.position(pair[0][1] + fraction * (pair[1][1] - pair[0][1])),
                ]);
            }
        }
    }
    found
}

/// A line without points that make no visible difference: of the points in one bin of x only the first,
/// the lowest, the highest and the last.
pub(super) fn thinned(positions: &[Position]) -> Vec<Position> {
    /// Width of a bin, mm. Chosen: below the width of a line.
    const BIN: f64 = 0.1;
    let bin = |position: &Position| libm::floor(position[0] / BIN);
    let mut kept = Vec::new();
    for group in positions.chunk_by(|a, b| bin(a).total_cmp(&bin(b)).is_eq()) {
        if group.len() < 4 {
            kept.extend_from_slice(group);
            continue;
        }
        let extreme = |better: fn(f64, f64) -> bool| {
            (0..group.len())
                .fold(0, |best, i| if better(group[i][1], group[best][1]) { i } else { best })
        };
        let (low, high) = (extreme(|a, b| a < b), extreme(|a, b| a > b));
        let mut picked = vec![0, low.min(high), low.max(high), group.len() - 1];
        picked.dedup();
        kept.extend(picked.into_iter().map(|i| group[i]));
    }
    kept
}
