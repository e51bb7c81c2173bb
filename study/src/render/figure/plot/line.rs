//! What belongs to one series of a plot, and how it is drawn: bands behind, the line, then points.

use super::frame::Frame;
use crate::render::figure::style::{self, Fill, Series};
use crate::render::page::{Page, Position, Stroke};

/// One series of a plot. All numbers are finite.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct Line {
    /// Colour, dashes, marker.
    pub series: Series,
    /// Pieces of the line, each a list of joined points.
    pub pieces: Vec<Vec<[f64; 2]>>,
    /// Whether the line is thin, for a quantity that oscillates.
    pub thin: bool,
    /// Markers at given points.
    pub marks: Vec<([f64; 2], Fill)>,
    /// Whether a few markers stand along the line, which identify it in black and white.
    pub sparse_markers: bool,
    /// Crosses, as at the ends of failed runs.
    pub crosses: Vec<[f64; 2]>,
    /// Shaded ranges along the line, each a list of x, lower and upper value.
    pub bands: Vec<Vec<[f64; 3]>>,
    /// Shaded columns: x, lower and upper value.
    pub columns: Vec<[f64; 3]>,
    /// Error bars: x, lower and upper value.
    pub bars: Vec<[f64; 3]>,
    /// Thin error bars, of the method: x, lower and upper value.
    pub errors: Vec<[f64; 3]>,
    /// Faint points.
    pub faint: Vec<([f64; 2], Fill)>,
    /// Short texts beside points.
    pub texts: Vec<([f64; 2], String)>,
    /// Arrows that start at points.
    pub arrows: Vec<([f64; 2], Direction)>,
    /// Displacement along x, mm: lines with equal x stand side by side.
    pub shift: f64,
}

/// A direction on the page.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
pub enum Direction {
    /// Upwards.
    Up,
    /// Downwards.
    Down,
}

/// Opacity of a band. Chosen: three bands on each other leave the lines visible.
const BAND_OPACITY: f64 = 0.2;
/// Opacity of a column, and its width, mm.
const COLUMN_OPACITY: f64 = 0.3;
const COLUMN: f64 = 2.4;
/// Width of an error bar and half the width of its ends, mm; the same of a thin one.
const BAR: [f64; 2] = [0.45, 1.0];
const THIN_BAR: [f64; 2] = [0.18, 0.7];
/// Size of a faint point, mm, and its opacity.
const FAINT: f64 = 1.3;
const FAINT_OPACITY: f64 = 0.55;
/// Length of an arrow, mm.
const ARROW: f64 = 4.2;
/// Size of a marker, mm.
const MARKER: f64 = 2.0;
/// Distance along both axes from the marker drawn last below which one of the same fill is left out, mm. Chosen: the two
/// look like one.
const LEAST_APART: f64 = 0.25;
/// Number of markers along a line with sparse markers, at most.
const SPARSE_MARKERS: f64 = 6.0;
/// Distance of these markers along x, mm, at least. Chosen: with several lines they do not hide the data.
const MARKER_DISTANCE: f64 = 20.0;

impl Line {
    /// A line of this series, without points.
    pub fn new(series: Series) -> Self {
        Self { series, ..Self::default() }
    }

    /// Position of a point on the page.
    pub(super) fn place(&self, frame: &Frame, [x, y]: [f64; 2]) -> Position {
        if frame.lying {
            return [frame.x.position(y), frame.y.position(x) + self.shift];
        }
        [frame.x.position(x) + self.shift, frame.y.position(y)]
    }

    fn ends(&self, frame: &Frame, [x, low, high]: [f64; 3]) -> [Position; 2] {
        [low, high].map(|y| self.place(frame, [x, y]))
    }

    /// Draws bands and columns, which stand behind all lines.
    pub fn draw_bands(&self, page: &mut Page, frame: &Frame) {
        for column in &self.columns {
            let [[a, b], [c, d]] =
                self.ends(frame, *column).map(|end| across(frame, end, 0.5 * COLUMN));
            page.shade(&[a, b, d, c], self.series.colour, COLUMN_OPACITY);
        }
        for band in self.bands.iter().filter(|band| band.len() > 1) {
            let side = |end: usize| band.iter().map(move |point| self.ends(frame, *point)[end]);
            let around: Vec<Position> = side(1).chain(side(0).rev()).collect();
            page.shade(&around, self.series.colour, BAND_OPACITY);
            let edge = Stroke::solid(self.series.colour, 0.1);
            for end in [0, 1] {
                page.polyline(&thinned(&side(end).collect::<Vec<_>>()), &edge);
            }
        }
    }

    /// Draws the line itself.
    pub fn draw_pieces(&self, page: &mut Page, frame: &Frame) {
        let stroke = if self.thin { self.series.thin_line() } else { self.series.line() };
        for piece in &self.pieces {
            let positions: Vec<Position> =
                piece.iter().map(|point| self.place(frame, *point)).collect();
            page.polyline(&thinned(&positions), &stroke);
        }
    }

    /// Draws error bars, faint points, arrows, markers and crosses. It is line `number` of `count` with sparse markers.
    pub fn draw_points(&self, page: &mut Page, frame: &Frame, (number, count): (usize, usize)) {
        let colour = self.series.colour;
        // The band of a single point is a bar.
        let lone = self.bands.iter().filter(|band| band.len() == 1).flatten();
        let bars = self.bars.iter().chain(lone).map(|bar| (bar, BAR));
        for (bar, [width, cap]) in bars.chain(self.errors.iter().map(|bar| (bar, THIN_BAR))) {
            let [low, high] = self.ends(frame, *bar);
            let stroke = Stroke::solid(colour, width);
            page.line(low, high, &stroke);
            for [from, to] in [low, high].map(|end| across(frame, end, cap)) {
                page.line(from, to, &stroke);
            }
        }
        for (point, fill) in &self.faint {
            let plain = Series { marker: Some(0), ..self.series };
            page.fade(FAINT_OPACITY);
            style::marker(page, self.place(frame, *point), plain, *fill, FAINT);
            page.close();
        }
        for (point, direction) in &self.arrows {
            let [x, y] = self.place(frame, *point);
            let sign = if *direction == Direction::Up { -1.0 } else { 1.0 };
            let (tip, stroke) = (y + sign * ARROW, Stroke::solid(colour, BAR[0]));
            page.line([x, y], [x, tip - sign * 1.2], &stroke);
            let back = tip - sign * 1.7;
            page.polygon(&[[x, tip], [x - 1.0, back], [x + 1.0, back]], colour, &stroke);
        }
        if self.sparse_markers {
            let step = (frame.width / SPARSE_MARKERS).max(MARKER_DISTANCE);
            let start = frame.left + (number as f64 + 0.5) / count as f64 * step;
            // A marker at an end would be half outside.
            let inside = |[x, y]: &Position| {
                frame.contains([*x - 1.0, *y]) && frame.contains([*x + 1.0, *y])
            };
            for position in self.along(frame, start, step).into_iter().filter(inside) {
                style::marker(page, position, self.series, Fill::Filled, 1.7);
            }
        }
        let mut last: Option<(Position, Fill)> = None;
        for (point, fill) in &self.marks {
            let at @ [x, y] = self.place(frame, *point);
            let is_hidden = last.is_some_and(|([last_x, last_y], like)| {
                like == *fill
                    && (x - last_x).abs() < LEAST_APART
                    && (y - last_y).abs() < LEAST_APART
            });
            if !is_hidden {
                style::marker(page, at, self.series, *fill, MARKER);
                last = Some((at, *fill));
            }
        }
        for point in &self.crosses {
            style::cross(page, self.place(frame, *point), &Stroke::solid(colour, 0.5), 2.6);
        }
    }

    /// Positions on the line at x = start + k · step, mm, for every k ≥ 0.
    pub(super) fn along(&self, frame: &Frame, start: f64, step: f64) -> Vec<Position> {
        let mut found = Vec::new();
        for piece in &self.pieces {
            let mut next = start;
            for pair in piece.windows(2) {
                let [[x, y], [end, high]] = [0, 1].map(|end| self.place(frame, pair[end]));
                while next <= end {
                    if next >= x && end > x {
                        found.push([next, y + (next - x) / (end - x) * (high - y)]);
                    }
                    next += step;
                }
            }
        }
        found
    }
}

/// The ends of a stroke of this half width (mm) across a bar.
fn across(frame: &Frame, [x, y]: Position, half: f64) -> [Position; 2] {
    let [dx, dy] = if frame.lying { [0.0, half] } else { [half, 0.0] };
    [[x - dx, y - dy], [x + dx, y + dy]]
}

/// A line without points that make no visible difference: of the points in one bin of x only the first,
/// the lowest, the highest and the last.
pub(super) fn thinned(positions: &[Position]) -> Vec<Position> {
    /// Width of a bin, mm. Chosen: below the width of a line.
    const BIN: f64 = 0.1;
    let bin = |position: &Position| libm::floor(position[0] / BIN);
    let mut kept = Vec::new();
    for group in positions.chunk_by(|a, b| bin(a).total_cmp(&bin(b)).is_eq()) {
        let by_height = |a: &usize, b: &usize| group[*a][1].total_cmp(&group[*b][1]);
        let ends = (0..group.len()).min_by(by_height).zip((0..group.len()).max_by(by_height));
        let (low, high) = ends.unwrap_or_default();
        let mut picked = vec![0, low.min(high), low.max(high), group.len() - 1];
        picked.dedup();
        kept.extend(picked.into_iter().map(|index| group[index]));
    }
    kept
}
