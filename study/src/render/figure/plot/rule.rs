//! Horizontal lines across a plot: limits, with the side that is not allowed, and ends of a range.

use super::frame::Frame;
use super::line::Direction;
use super::words::Words;
use crate::render::figure::style::SMALL;
use crate::render::font;
use crate::render::page::{Anchor, Letters, Page, Stroke};

/// A horizontal line.
#[derive(Debug, Clone, PartialEq)]
pub struct Rule {
    /// Its value on the y axis.
    pub value: f64,
    /// Text beside it; empty for none.
    pub text: String,
    /// The side that is not allowed; `None` for a line alone, which is dashed.
    pub closed: Option<Direction>,
}

/// The line of a limit.
pub const LIMIT: Stroke = Stroke::solid("#000000", 0.5);
/// The line of an end of a range.
pub const END: Stroke = Stroke { colour: "#555555", width: 0.3, dashes: &[1.6, 1.0] };
/// Most points of data that a text may cover; with more it is left out, and the legend has it.
const MAX_COVERED: usize = 4;
/// Hatch of the side that is not allowed.
const CLOSED: Stroke = Stroke::solid("#d8c6ba", 0.2);
/// Ground of the side that is not allowed.
const CLOSED_GROUND: &str = "#f7efe9";

impl Rule {
    /// Hatches the side that is not allowed.
    pub(super) fn draw_closed_side(&self, page: &mut Page, frame: &Frame) {
        let y = frame.y.position(self.value).clamp(frame.top, frame.bottom());
        let (top, bottom) = match self.closed {
            None => return,
            Some(Direction::Up) => (frame.top, y),
            Some(Direction::Down) => (y, frame.bottom()),
        };
        draw_closed(page, [frame.left, top], [frame.width, bottom - top], 2.6);
    }

    /// Draws the line and its text.
    pub(super) fn draw(&self, page: &mut Page, frame: &Frame, words: &mut Words) {
        let y = frame.y.position(self.value);
        if !(frame.top..=frame.bottom()).contains(&y) {
            return;
        }
        let stroke = if self.closed.is_some() { &LIMIT } else { &END };
        page.line([frame.left, y], [frame.right(), y], stroke);
        let width = font::width(&self.text, SMALL) + 1.0;
        if self.text.is_empty() || width > frame.width {
            return;
        }
        // Beside the line, at the end where the text covers the least.
        let first = frame.left + 0.6;
        let space = frame.width - width - 1.2;
        let lefts = [1.0, 0.0, 0.5, 0.75, 0.25].map(|fraction| first + fraction * space);
        let (above, below) = (y - 0.5 - SMALL * 1.1, y + 0.5);
        // The allowed side first: it is not hatched.
        let tops =
            if self.closed == Some(Direction::Down) { [above, below] } else { [below, above] };
        let corners = tops.iter().flat_map(|top| lefts.iter().map(move |left| [*left, *top]));
        let corners: Vec<[f64; 2]> = corners.collect();
        if let Some([left, top]) = words.best(&corners, [width, 1.1 * SMALL], MAX_COVERED) {
            page.fill([left, top], [width, 1.1 * SMALL], "#ffffff");
            let letters = Letters::new(SMALL).at(Anchor::Start);
            page.text([left + 0.5, top + 0.88 * SMALL], &letters, &self.text);
        }
    }
}

/// A tinted and hatched rectangle: not allowed.
pub fn draw_closed(page: &mut Page, corner: [f64; 2], size: [f64; 2], gap: f64) {
    if size[0] > 0.0 && size[1] > 0.0 {
        page.fill(corner, size, CLOSED_GROUND);
        page.hatch(corner, size, gap, &CLOSED);
    }
}
