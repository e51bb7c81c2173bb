//! A line of a plot: what belongs to one series; sparse markers along it, and thinning.

use crate::render::figure::scale::Scale;
use crate::render::figure::style::{Fill, Series};
use crate::render::page::Position;

/// One series of a plot.
#[derive(Debug, Clone, PartialEq)]
pub struct Line {
    /// Colour, dashes, marker.
    pub series: Series,
    /// Pieces of the line, each a list of joined points; all finite.
    pub pieces: Vec<Vec<[f64; 2]>>,
    /// Markers at given points.
    pub marks: Vec<([f64; 2], Fill)>,
    /// Whether a few markers stand along the line, which identify it in black and white.
    pub sparse_markers: bool,
    /// Crosses at the ends of failed runs.
    pub crosses: Vec<[f64; 2]>,
    /// Whether the line is thin, and a band where it turns too often to be read.
    pub rings: bool,
    /// Shaded ranges along the line, each a list of x, lower and upper value; all finite.
    pub bands: Vec<Vec<[f64; 3]>>,
    /// Shaded columns: x, lower and upper value, all finite, and width, mm.
    pub columns: Vec<([f64; 3], f64)>,
    /// Error bars: x, lower and upper value; all finite.
    pub bars: Vec<[f64; 3]>,
    /// Thin error bars of the method: x, lower and upper value; all finite.
    pub errors: Vec<[f64; 3]>,
    /// Faint points behind the line.
    pub faint: Vec<([f64; 2], Fill)>,
    /// Short texts beside points.
    pub texts: Vec<([f64; 2], String)>,
    /// Arrows at points that lie at the end of what was searched; up or down.
    pub arrows: Vec<([f64; 2], Direction)>,
    /// Displacement along x, mm: lines with equal x stand side by side.
    pub shift: f64,
}

impl Line {
    /// A line of this series, without points.
    pub fn new(series: Series) -> Self {
        Self {
            series,
            pieces: Vec::new(),
            marks: Vec::new(),
            sparse_markers: false,
            crosses: Vec::new(),
            rings: false,
            bands: Vec::new(),
            columns: Vec::new(),
            bars: Vec::new(),
            errors: Vec::new(),
            faint: Vec::new(),
            texts: Vec::new(),
            arrows: Vec::new(),
            shift: 0.0,
        }
    }
}

/// A direction on the page.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
pub enum Direction {
    /// Upwards.
    Up,
    /// Downwards.
    Down,
}

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
