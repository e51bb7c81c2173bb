//! One panel of a plot: grid, lines, markers, lane, message.

use super::lane;
use super::line::{along, thinned};
use super::{Panel, y_ticks};
use crate::render::figure::legend;
use crate::render::figure::scale::Scale;
use crate::render::figure::style::{self, AXIS, Fill, GRID, MARGIN, MEDIUM, SMALL};
use crate::render::figure::ticks::Tick;
use crate::render::page::{Anchor, Letters, Page, Position, cut, wrapped};

/// Number of markers along a line with sparse markers.
const SPARSE_MARKERS: f64 = 6.0;

/// Where a panel lies on the page, mm, and its scales.
pub(super) struct Frame {
    pub(super) left: f64,
    pub(super) top: f64,
    pub(super) width: f64,
    pub(super) height: f64,
    pub(super) x: Scale,
    pub(super) y: Scale,
    pub(super) x_ticks: Vec<Tick>,
    /// Number of rows of letters in the lane below.
    pub(super) lane_rows: usize,
    /// Whether the panel is the first one of its row and has the y axis.
    pub(super) first: bool,
}

impl Frame {
    fn right(&self) -> f64 {
        self.left + self.width
    }

    fn bottom(&self) -> f64 {
        self.top + self.height
    }

    fn position(&self, [x, y]: [f64; 2]) -> Position {
        [self.x.position(x), self.y.position(y)]
    }

    fn contains(&self, [x, y]: Position) -> bool {
        (self.left..=self.right()).contains(&x) && (self.top..=self.bottom()).contains(&y)
    }
}

impl Panel {
    /// Draws the panel, with the y axis if it is the first one of its row.
    pub(super) fn draw(&self, page: &mut Page, frame: &Frame) {
        let title = cut(&self.title, SMALL, frame.width);
        page.text([frame.left, frame.top - 1.6], &Letters::new(SMALL), &title);
        self.draw_grid(page, frame);
        let size = [frame.width, frame.height];
        page.clip([frame.left, frame.top], size);
        for line in &self.lines {
            for piece in &line.pieces {
                let positions: Vec<Position> =
                    piece.iter().map(|point| frame.position(*point)).collect();
                page.polyline(&thinned(&positions), &style::line(line.series));
            }
        }
        page.unclip();
        page.frame([frame.left, frame.top], size, &AXIS);
        self.draw_markers(page, frame);
        if frame.lane_rows > 0 {
            let area = ([frame.left, frame.bottom()], [frame.width, lane::height(frame.lane_rows)]);
            lane::draw(page, &self.lane, area, &frame.x, frame.first);
        }
        self.draw_message(page, frame);
    }

    /// Grid lines, and the y axis with its label.
    fn draw_grid(&self, page: &mut Page, frame: &Frame) {
        let (left, right) = (frame.left, frame.right());
        let (top, bottom) = (frame.top, frame.bottom());
        for (value, text) in y_ticks(self.range, frame.height) {
            let y = frame.y.position(value);
            page.line([left, y], [right, y], &GRID);
            if frame.first {
                page.line([left - 1.0, y], [left, y], &AXIS);
                let position = [left - 1.6, y + 0.36 * SMALL];
                page.text(position, &Letters::new(SMALL).at(Anchor::End), &text);
            }
        }
        for (value, _) in &frame.x_ticks {
            let x = frame.x.position(*value);
            page.line([x, top], [x, bottom], &GRID);
        }
        if frame.first {
            let letters = Letters { upwards: true, ..Letters::new(MEDIUM).at(Anchor::Middle) };
            let label = cut(&self.label, MEDIUM, frame.height + 4.0);
            page.text([MARGIN + MEDIUM, 0.5 * (top + bottom)], &letters, &label);
        }
    }

    /// Sparse markers, markers of points, crosses.
    fn draw_markers(&self, page: &mut Page, frame: &Frame) {
        let sparse = self.lines.iter().filter(|line| line.sparse_markers).count();
        for (number, line) in self.lines.iter().enumerate() {
            if line.sparse_markers {
                let step = frame.width / SPARSE_MARKERS;
                let shift = (number as f64 + 0.5) / sparse as f64;
                let start = frame.left + shift * step;
                let positions = along(line, (&frame.x, &frame.y), start, step);
                for position in positions.into_iter().filter(|position| frame.contains(*position)) {
                    style::marker(page, position, line.series, Fill::Filled, 1.7);
                }
            }
            for (point, fill) in &line.marks {
                let position = frame.position(*point);
                style::marker(page, position, line.series, *fill, legend::MARKER);
            }
            for point in &line.crosses {
                style::cross(page, frame.position(*point), style::colour(line.series), 2.6);
            }
        }
    }

    /// The message of an empty plot, in its middle.
    fn draw_message(&self, page: &mut Page, frame: &Frame) {
        if self.message.is_empty() {
            return;
        }
        let lines = wrapped(&self.message, SMALL, frame.width - 6.0);
        for (number, line) in lines.iter().enumerate() {
            let below = number as f64 - 0.5 * (lines.len() - 1) as f64;
            let middle = frame.left + 0.5 * frame.width;
            let position = [middle, frame.top + 0.5 * frame.height + 1.4 * SMALL * below];
            page.text(position, &Letters::new(SMALL).at(Anchor::Middle), line);
        }
    }
}
