//! One panel of a plot: grid, limits, lines, markers, lane, message.

use super::frame::Frame;
use super::line::{along, thinned};
use super::words::Words;
use super::{LABEL_LINE, Line, Panel, TITLE_LINE, band, lane, range, y_ticks};
use crate::render::figure::legend;
use crate::render::figure::scale::Spread;
use crate::render::figure::style::{self, AXIS, Fill, GRID, MARGIN, MEDIUM, SMALL};
use crate::render::page::{Anchor, Letters, Page, Position, Stroke, cut, wrapped};

/// The line of zero in a plot of both signs.
const ZERO: Stroke = Stroke::solid("#888888", 0.25);
/// Number of markers along a line with sparse markers, at most.
const SPARSE_MARKERS: f64 = 6.0;
/// Distance of these markers along x, mm, at least. Chosen: with several lines they do not hide the data.
const MARKER_DISTANCE: f64 = 20.0;

/// What a panel drew.
#[derive(Debug, Clone, Copy, Default)]
pub(super) struct Drawn {
    /// Whether a line became a band.
    pub(super) bands: bool,
    /// Whether a text had no space.
    pub(super) omitted: bool,
}

impl Panel {
    /// Draws the panel, with the y axis if it is the first one of its row.
    pub(super) fn draw(&self, page: &mut Page, frame: &Frame, title: &[String]) -> Drawn {
        for (number, line) in title.iter().rev().enumerate() {
            let y = frame.top - 1.6 - number as f64 * TITLE_LINE;
            page.text([frame.left, y], &Letters::new(SMALL), &cut(line, SMALL, frame.width));
        }
        let size = [frame.width, frame.height];
        for rule in &self.rules {
            rule.draw_closed_side(page, frame);
        }
        self.draw_grid(page, frame);
        page.clip([frame.left, frame.top], size);
        range::draw_bands(page, &self.lines, frame);
        let mut bands = false;
        for line in &self.lines {
            bands |= draw_line(page, line, frame);
        }
        page.unclip();
        page.frame([frame.left, frame.top], size, &AXIS);
        range::draw_points(page, &self.lines, frame);
        self.draw_markers(page, frame);
        let mut omitted = false;
        // The message of an empty plot takes the place of other texts.
        if self.message.is_empty() {
            let mut words = Words::new(self, frame);
            for rule in &self.rules {
                rule.draw(page, frame, &mut words);
            }
            omitted = words.draw_texts(page, &self.lines, frame);
        }
        if frame.lane_rows > 0 {
            let area = ([frame.left, frame.bottom()], [frame.width, lane::height(frame.lane_rows)]);
            lane::draw(page, &self.lane, area, &frame.x, frame.first);
        }
        self.draw_message(page, frame);
        Drawn { bands, omitted }
    }

    /// Grid lines, and the y axis with its label.
    fn draw_grid(&self, page: &mut Page, frame: &Frame) {
        let (left, right) = (frame.left, frame.right());
        let (top, bottom) = (frame.top, frame.bottom());
        for (value, text) in y_ticks(self.spread, self.range, frame.height) {
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
        if self.range[0] < 0.0 && self.range[1] > 0.0 && self.spread == Spread::Linear {
            let y = frame.y.position(0.0);
            page.line([left, y], [right, y], &ZERO);
        }
        if frame.first {
            let letters = Letters { upwards: true, ..Letters::new(MEDIUM).at(Anchor::Middle) };
            for (number, line) in self.label_lines(frame.height).iter().enumerate() {
                let x = MARGIN + (1.0 + LABEL_LINE * number as f64) * MEDIUM;
                let line = cut(line, MEDIUM, frame.height + 4.0);
                page.text([x, 0.5 * (top + bottom)], &letters, &line);
            }
        }
    }

    /// Sparse markers, markers of points, crosses.
    fn draw_markers(&self, page: &mut Page, frame: &Frame) {
        let sparse = self.lines.iter().filter(|line| line.sparse_markers).count();
        for (number, line) in self.lines.iter().enumerate() {
            if line.sparse_markers {
                let step = (frame.width / SPARSE_MARKERS).max(MARKER_DISTANCE);
                let shift = (number as f64 + 0.5) / sparse as f64;
                let start = frame.left + shift * step;
                let positions = along(line, (&frame.x, &frame.y), start, step);
                // A marker at an end would be half outside.
                let inside =
                    |[x, y]: Position| frame.contains([x - 1.0, y]) && frame.contains([x + 1.0, y]);
                for position in positions.into_iter().filter(|position| inside(*position)) {
                    style::marker(page, position, line.series, Fill::Filled, 1.7);
                }
            }
            for (point, fill) in &line.marks {
                let position = range::shifted(frame.position(*point), line);
                style::marker(page, position, line.series, *fill, legend::MARKER);
            }
            for point in &line.crosses {
                style::cross(page, frame.position(*point), line.series.colour, 2.6);
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

/// Draws a line. Where one that rings turns too often to be read, it is a band. Returns whether it has one.
fn draw_line(page: &mut Page, line: &Line, frame: &Frame) -> bool {
    let mut bands = false;
    let stroke = if line.rings { line.series.thin_line() } else { line.series.line() };
    for piece in &line.pieces {
        let place = |point: &[f64; 2]| range::shifted(frame.position(*point), line);
        let positions: Vec<Position> = piece.iter().map(place).collect();
        if !line.rings {
            page.polyline(&thinned(&positions), &stroke);
            continue;
        }
        for part in band::parts(&positions) {
            match part {
                band::Part::Line(positions) => page.polyline(&thinned(&positions), &stroke),
                band::Part::Band { upper, lower } => {
                    let around: Vec<Position> =
                        upper.iter().chain(lower.iter().rev()).copied().collect();
                    page.area(&around, line.series.colour);
                    let border = Stroke { dashes: &[], ..stroke };
                    page.polyline(&upper, &border);
                    page.polyline(&lower, &border);
                    bands = true;
                }
            }
        }
    }
    bands
}
