//! Places of texts inside a plot: no text covers another one, and as little data as possible is covered.

use super::frame::Frame;
use super::{Line, Panel, Rule};
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
    /// Points of lines and rules.
    points: Vec<Position>,
}

impl Words {
    pub(super) fn new(panel: &Panel, frame: &Frame) -> Self {
        let marks = |line: &Line| -> Vec<Position> {
            line.marks.iter().map(|(point, _)| line.place(frame, *point)).collect()
        };
        let points = |line: &Line| -> Vec<Position> {
            let bands = line.bands.iter().flatten().chain(&line.bars).chain(&line.errors);
            let bands = bands.flat_map(|[x, low, high]| [[*x, *low], [*x, *high]]);
            let faint = line.faint.iter().map(|(point, _)| *point);
            let arrows = line.arrows.iter().map(|(point, _)| *point);
            let points = bands.chain(faint).chain(arrows).map(|point| line.place(frame, point));
            points.chain(line.along(frame, frame.left, 1.0)).collect()
        };
        let rule = |rule: &Rule| -> Vec<Position> {
            let along = if frame.lying { frame.height } else { frame.width };
            let start = if frame.lying { frame.top } else { frame.left };
            let steps = (0..).map(f64::from).take_while(|step| *step < along);
            steps.map(|step| frame.on_rule(frame.of_value(rule.value), start + step)).collect()
        };
        let lines = panel.lines.iter().flat_map(points);
        Self {
            frame: [frame.left, frame.top, frame.right(), frame.bottom()],
            texts: Vec::new(),
            markers: panel.lines.iter().flat_map(marks).collect(),
            points: lines.chain(panel.rules.iter().flat_map(rule)).collect(),
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
                let [x, y] = line.place(frame, *point);
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

fn apart(a: Bounds, b: Bounds) -> bool {
    let clear = |low: f64, high: f64| low >= high + MIN_SPACE;
    clear(a[0], b[2]) || clear(b[0], a[2]) || clear(a[1], b[3]) || clear(b[1], a[3])
}

/// Whether a position lies in bounds, or less than `margin` beside them.
fn near([x, y]: Position, bounds: Bounds, margin: f64) -> bool {
    (bounds[0] - margin..=bounds[2] + margin).contains(&x)
        && (bounds[1] - margin..=bounds[3] + margin).contains(&y)
}
