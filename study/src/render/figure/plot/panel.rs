//! One panel of a plot: grid, limits, lines, markers, lane, message.

use super::frame::Frame;
use super::words::Words;
use super::{LABEL_LINE, Panel, Rule, TITLE_LINE, lane};
use crate::render::figure::plot::Direction;
use crate::render::figure::scale::Spread;
use crate::render::figure::style::{AXIS, GRID, MARGIN, MEDIUM, SMALL};
use crate::render::font;
use crate::render::page::{Anchor, Letters, Page, Position, Stroke, cut, wrapped};

/// The line of zero in a plot of both signs.
const ZERO: Stroke = Stroke::solid("#888888", 0.25);
/// The line of a limit.
const LIMIT: Stroke = Stroke::solid("#000000", 0.5);
/// The line of an end of a range.
pub const END: Stroke = Stroke { colour: "#555555", width: 0.3, dashes: &[1.6, 1.0] };
/// Most points of data that the text of a limit may cover; with more it is left out, and the legend has it.
const MAX_COVERED: usize = 4;

impl Panel {
    /// Draws the panel, with the y axis if it is the first one of its row. Returns whether a text beside a point had
    /// no space.
    pub(super) fn draw(&self, page: &mut Page, frame: &Frame, title: &[String]) -> bool {
        for (number, line) in title.iter().rev().enumerate() {
            let y = frame.top - 1.6 - number as f64 * TITLE_LINE;
            page.text([frame.left, y], &Letters::new(SMALL), &cut(line, SMALL, frame.width));
        }
        let (corner, size) = ([frame.left, frame.top], [frame.width, frame.height]);
        for rule in &self.rules {
            rule.draw_closed_side(page, frame);
        }
        self.draw_grid(page, frame);
        page.clip(corner, size);
        self.lines.iter().for_each(|line| line.draw_bands(page, frame));
        self.lines.iter().for_each(|line| line.draw_pieces(page, frame));
        page.close();
        page.frame(corner, size, &AXIS);
        for (number, line) in self.lines.iter().enumerate() {
            line.draw_points(page, frame, (number, self.lines.len()));
        }
        if frame.lane_rows > 0 {
            lane::draw(page, &self.lane, frame);
        }
        // The message of an empty plot takes the place of other texts.
        if !self.message.is_empty() {
            self.draw_message(page, frame);
            return false;
        }
        let mut words = Words::new(self, frame);
        for rule in &self.rules {
            rule.draw(page, frame, &mut words);
        }
        words.draw_texts(page, &self.lines, frame)
    }

    /// Grid lines, and the y axis with its label.
    fn draw_grid(&self, page: &mut Page, frame: &Frame) {
        let (left, right) = (frame.left, frame.right());
        let (top, bottom) = (frame.top, frame.bottom());
        for (value, text) in self.y_ticks(frame.height) {
            let y = frame.y.position(value);
            page.line([left, y], [right, y], &GRID);
            if frame.first && !text.is_empty() {
                page.line([left - 1.0, y], [left, y], &AXIS);
                let position = [left - 1.6, y + 0.36 * SMALL];
                page.text(position, &Letters::new(SMALL).at(Anchor::End), &text);
            }
        }
        for (value, _) in &frame.x_ticks {
            let x = frame.x.position(*value);
            page.line([x, top], [x, bottom], &GRID);
        }
        let both_signs = self.range[0] < 0.0 && self.range[1] > 0.0;
        if both_signs && self.spread == Spread::Linear && !frame.lying {
            let y = frame.y.position(0.0);
            page.line([left, y], [right, y], &ZERO);
        }
        if frame.first {
            let letters = Letters { turn: -90.0, ..Letters::new(MEDIUM).at(Anchor::Middle) };
            for (number, line) in self.label_lines(frame.height).iter().enumerate() {
                let x = MARGIN + (1.0 + LABEL_LINE * number as f64) * MEDIUM;
                let line = cut(line, MEDIUM, frame.height + 4.0);
                page.text([x, 0.5 * (top + bottom)], &letters, &line);
            }
        }
    }

    /// The message of an empty plot, in its middle.
    fn draw_message(&self, page: &mut Page, frame: &Frame) {
        let lines = wrapped(&self.message, SMALL, frame.width - 6.0);
        for (number, line) in lines.iter().enumerate() {
            let below = number as f64 - 0.5 * (lines.len() - 1) as f64;
            let middle = frame.left + 0.5 * frame.width;
            let position = [middle, frame.top + 0.5 * frame.height + 1.4 * SMALL * below];
            page.text(position, &Letters::new(SMALL).at(Anchor::Middle), line);
        }
    }
}

impl Rule {
    /// Hatches the side that is not allowed.
    fn draw_closed_side(&self, page: &mut Page, frame: &Frame) {
        let Some(closed) = self.closed else { return };
        let [mut left, mut right] = [frame.left, frame.right()];
        let [mut top, mut bottom] = [frame.top, frame.bottom()];
        let end = match (frame.lying, closed) {
            (true, Direction::Up) => &mut left,
            (true, Direction::Down) => &mut right,
            (false, Direction::Up) => &mut bottom,
            (false, Direction::Down) => &mut top,
        };
        let at = frame.of_value(self.value);
        *end = if frame.lying {
            at.clamp(frame.left, frame.right())
        } else {
            at.clamp(frame.top, frame.bottom())
        };
        draw_closed(page, [left, top], [right - left, bottom - top], 2.6);
    }

    /// Draws the line, and its text where it covers the least.
    fn draw(&self, page: &mut Page, frame: &Frame, words: &mut Words) {
        let [x, y] = [[frame.left, frame.right()], [frame.top, frame.bottom()]];
        let ([low, high], [from, to]) = if frame.lying { (x, y) } else { (y, x) };
        let at = frame.of_value(self.value);
        if !(low..=high).contains(&at) {
            return;
        }
        let stroke = if self.closed.is_some() { &LIMIT } else { &END };
        page.line(frame.on_rule(at, from), frame.on_rule(at, to), stroke);
        let size = [font::width(&self.text, SMALL) + 1.0, 1.1 * SMALL];
        let (width, length) = if frame.lying { (size[0], size[1]) } else { (size[1], size[0]) };
        let space = to - from - length - 1.2;
        if self.text.is_empty() || space < 0.0 {
            return;
        }
        let alongs = [1.0, 0.0, 0.5, 0.75, 0.25].map(|part| from + 0.6 + part * space);
        // The allowed side first: it is not hatched.
        let mut sides = [at + 0.5, at - 0.5 - width];
        if (self.closed == Some(Direction::Down)) != frame.lying {
            sides.reverse();
        }
        let corners =
            sides.iter().flat_map(|side| alongs.iter().map(|along| frame.on_rule(*side, *along)));
        let corners: Vec<Position> = corners.collect();
        if let Some([left, top]) = words.best(&corners, size, MAX_COVERED) {
            page.fill([left, top], size, "#ffffff");
            page.text([left + 0.5, top + 0.88 * SMALL], &Letters::new(SMALL), &self.text);
        }
    }
}

/// A tinted and hatched rectangle: not allowed.
pub fn draw_closed(page: &mut Page, corner: Position, size: [f64; 2], gap: f64) {
    if size[0] > 0.0 && size[1] > 0.0 {
        page.fill(corner, size, "#f7efe9");
        page.hatch(corner, size, gap, &Stroke::solid("#d8c6ba", 0.2));
    }
}
