//! Places of texts inside a plot: no text covers another one, and as little data as possible is covered.

use super::frame::Frame;
use super::line::Line;
use super::{Panel, range};
use crate::render::figure::style::SMALL;
use crate::render::font;
use crate::render::page::{Letters, Page, Position};

/// Left, top, right, bottom, mm.
type Bounds = [f64; 4];

/// Half the size of what a marker covers, mm.
const MARKER: f64 = 1.3;
/// Smallest space between two texts, mm: a figure has rounded positions.
const MIN_SPACE: f64 = 0.02;

/// The places in use in a plot.
pub(super) struct Words {
    frame: Bounds,
    /// Texts.
    texts: Vec<Bounds>,
    /// Markers.
    markers: Vec<Position>,
    /// Points of lines.
    points: Vec<Position>,
}

impl Words {
    pub(super) fn new(panel: &Panel, frame: &Frame) -> Self {
        let marks = |line: &Line| -> Vec<Position> {
            let place = |point: [f64; 2]| range::shifted(frame.position(point), line);
            line.marks.iter().map(|(point, _)| place(*point)).collect()
        };
        let points = |line: &Line| -> Vec<Position> {
            let bands = line.bands.iter().flatten().chain(&line.bars).chain(&line.errors);
            let bands = bands.flat_map(|[x, low, high]| [[*x, *low], [*x, *high]]);
            let faint = line.faint.iter().map(|(point, _)| *point);
            let arrows = line.arrows.iter().map(|(point, _)| *point);
            let place = |point: [f64; 2]| range::shifted(frame.position(point), line);
            let points = bands.chain(faint).chain(arrows).map(place);
            let pieces = line.pieces.iter().flat_map(|piece| {
                let positions: Vec<Position> = piece.iter().copied().map(place).collect();
                along(&positions)
            });
            points.chain(pieces).collect()
        };
        Self {
            frame: [frame.left, frame.top, frame.right(), frame.bottom()],
            texts: Vec::new(),
            markers: panel.lines.iter().flat_map(marks).collect(),
            points: panel.lines.iter().flat_map(points).collect(),
        }
    }

    /// The corner, of these, at which a text of this size covers the least; `None` where each of them covers
    /// another text, leaves the plot, or covers more than `most` points. The place is then in use.
    pub(super) fn best(
        &mut self,
        corners: &[Position],
        size: [f64; 2],
        most: usize,
    ) -> Option<Position> {
        let covered = |[left, top]: Position| {
            let bounds = [left, top, left + size[0], top + size[1]];
            let inside = left >= self.frame[0]
                && top >= self.frame[1]
                && bounds[2] <= self.frame[2]
                && bounds[3] <= self.frame[3];
            let free = self.texts.iter().all(|text| apart(*text, bounds));
            (inside && free).then(|| {
                let marks = self.markers.iter().filter(|at| near(**at, bounds, MARKER)).count();
                let points = self.points.iter().filter(|at| near(**at, bounds, 0.3)).count();
                3 * marks + points
            })
        };
        let found = corners.iter().filter_map(|corner| Some((covered(*corner)?, *corner)));
        let (_, [left, top]) =
            found.filter(|(covered, _)| *covered <= most).min_by_key(|(covered, _)| *covered)?;
        self.texts.push([left, top, left + size[0], top + size[1]]);
        Some([left, top])
    }

    /// Draws the texts beside points. Returns whether one had no space.
    pub(super) fn draw_texts(&mut self, page: &mut Page, lines: &[Line], frame: &Frame) -> bool {
        let mut omitted = false;
        for line in lines {
            for (point, text) in &line.texts {
                let [x, y] = range::shifted(frame.position(*point), line);
                let (width, height) = (font::width(text, SMALL), 0.9 * SMALL);
                let (right, left) = (x + MARKER + 0.3, x - MARKER - 0.3 - width);
                let (above, below) = (y - height - 0.9, y + 0.9);
                let middle = y - 0.5 * height;
                let corners = [
                    [right, above],
                    [left, above],
                    [right, below],
                    [left, below],
                    [right, middle],
                    [left, middle],
                    [x - 0.5 * width, y - height - MARKER - 0.3],
                    [x - 0.5 * width, y + MARKER + 0.3],
                ];
                let free = self.best(&corners, [width, height], usize::MAX);
                omitted |= free.is_none();
                if let Some([left, top]) = free {
                    let letters = Letters { colour: line.series.colour, ..Letters::new(SMALL) };
                    page.text([left, top + 0.75 * SMALL], &letters, text);
                }
            }
        }
        omitted
    }
}

/// Positions on a line, at most 1 mm apart.
fn along(line: &[Position]) -> Vec<Position> {
    let between = |pair: &[Position]| -> Vec<Position> {
        let step = [pair[1][0] - pair[0][0], pair[1][1] - pair[0][1]];
        let length = libm::hypot(step[0], step[1]);
        #[expect(clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "mm")]
        let count = length.clamp(1.0, 500.0) as usize;
        let at = |number: usize| {
            let fraction = number as f64 / count as f64;
            [pair[0][0] + fraction * step[0], pair[0][1] + fraction * step[1]]
        };
        (0..count).map(at).collect()
    };
    line.windows(2).flat_map(between).chain(line.last().copied()).collect()
}

fn apart(a: Bounds, b: Bounds) -> bool {
    let clear = |low: f64, high: f64| low >= high + MIN_SPACE;
    clear(a[0], b[2]) || clear(b[0], a[2]) || clear(a[1], b[3]) || clear(b[1], a[3])
}

/// Whether a position lies in bounds, or less than `margin` beside them.
fn near([x, y]: Position, bounds: Bounds, margin: f64) -> bool {
    (bounds[0] - margin..=bounds[2] + margin).contains(&x)
        && (bounds[1] - margin..=bounds[3] + margin).contains(&y)
}
