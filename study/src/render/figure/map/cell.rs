//! The cells of a map: colour, number, marker, letter, frame.

use super::{Cell, MARKER_WIDTH, Maps, Panel, SAME_JOB};
use crate::input::value::short_number;
use crate::render::figure::style::{self, AXIS, EMPTY, Fill, HATCH, MEDIUM, SMALL};
use crate::render::figure::ticks;
use crate::render::font;
use crate::render::page::{Anchor, Letters, Page, Position, Stroke};

/// Distance of the two lines of a cell, mm.
const LINE: f64 = 1.3 * SMALL;
/// Width of the frame of a cell that misses a limit, mm.
const MISSED: f64 = 0.8;

/// What a cell with a value shows.
struct Shown<'a> {
    value: f64,
    text: &'a str,
    below: &'a str,
    fill: Fill,
    missed: bool,
}

impl Maps {
    pub(super) fn draw_cells(
        &self,
        page: &mut Page,
        panel: &Panel,
        corner: Position,
        size: [f64; 2],
    ) {
        let (columns, rows) = (self.x.1.len(), self.y.1.len());
        let [width, height] = size;
        for (index, cell) in panel.cells.iter().enumerate() {
            let (column, row) = (index % columns, index / columns);
            let cell_corner =
                [corner[0] + column as f64 * width, corner[1] + (rows - 1 - row) as f64 * height];
            match cell {
                Cell::Value { value, outcome, shared, text, below, missed } => {
                    let text = &cell_text(*value, *shared, text);
                    let (value, fill, missed) = (*value, *outcome, *missed);
                    let shown = Shown { value, text, below, fill, missed };
                    self.draw_value(page, &shown, cell_corner, size);
                }
                Cell::Letter(letter) => draw_letter(page, letter, cell_corner, size),
                Cell::Absent => page.frame(cell_corner, size, &HATCH),
            }
        }
        page.frame(corner, [width * columns as f64, height * rows as f64], &AXIS);
    }

    /// A cell with its colour, number and outcome marker. The marker stands before the number, or in the
    /// corner of the cell if there is no space for both.
    fn draw_value(&self, page: &mut Page, shown: &Shown<'_>, corner: Position, size: [f64; 2]) {
        let [width, height] = size;
        let middle = [corner[0] + 0.5 * width, corner[1] + 0.5 * height];
        let (colour, ink) = style::map_colour(self.fraction(shown.value));
        page.fill(corner, size, &colour);
        if shown.missed {
            draw_missed(page, corner, size, ink);
        }
        let text_width = font::width(shown.text, SMALL);
        let both_fit = text_width + MARKER_WIDTH <= width;
        let shift = if both_fit { 1.6 } else { 0.0 };
        let up = if shown.below.is_empty() { 0.0 } else { 0.5 * LINE };
        let letters = Letters { colour: ink, ..Letters::new(SMALL).at(Anchor::Middle) };
        if text_width + 0.6 <= width {
            let position = [middle[0] + shift, middle[1] - up + 0.36 * SMALL];
            page.text(position, &letters, shown.text);
        }
        if font::width(shown.below, SMALL) + 0.6 <= width && !shown.below.is_empty() {
            page.text([middle[0], middle[1] + up + 0.36 * SMALL], &letters, shown.below);
        }
        let marker = if both_fit {
            [middle[0] + shift - 0.5 * text_width - 1.9, middle[1] - up]
        } else {
            [corner[0] + 1.3, corner[1] + 1.3]
        };
        style::map_marker(page, marker, ink, shown.fill, 2.0);
    }

    /// Position of a value on the colour scale, 0 to 1.
    fn fraction(&self, value: f64) -> f64 {
        match self.range {
            Some([low, high]) if high > low => (value - low) / (high - low),
            _ => 0.5,
        }
    }
}

/// The thick frame of a cell that misses a limit.
pub fn draw_missed(page: &mut Page, corner: Position, size: [f64; 2], ink: &'static str) {
    let inset = 0.5 * MISSED + 0.25;
    let corner = corner.map(|end| end + inset);
    page.frame(corner, size.map(|length| length - 2.0 * inset), &Stroke::solid(ink, MISSED));
}

/// A hatched cell with a letter on a plain ground.
fn draw_letter(page: &mut Page, letter: &str, corner: Position, size: [f64; 2]) {
    let middle = [corner[0] + 0.5 * size[0], corner[1] + 0.5 * size[1]];
    page.fill(corner, size, EMPTY);
    page.hatch(corner, size, 1.8, &HATCH);
    let ground = font::width(letter, MEDIUM) + 1.2;
    page.fill([middle[0] - 0.5 * ground, middle[1] - 2.0], [ground, 4.0], EMPTY);
    let letters = Letters::new(MEDIUM).at(Anchor::Middle);
    page.text([middle[0], middle[1] + 0.36 * MEDIUM], &letters, letter);
}

/// The text of a cell: its number, or the given text.
pub(super) fn cell_text(value: f64, shared: bool, text: &str) -> String {
    let number = if text.is_empty() { cell_number(value) } else { text.to_owned() };
    if shared { format!("{SAME_JOB} {number}") } else { number }
}

/// A number in a cell: three significant digits.
fn cell_number(value: f64) -> String {
    if value == 0.0 || !value.is_finite() {
        return ticks::minus(&short_number(value));
    }
    let exponent = libm::floor(libm::log10(value.abs()));
    let text = match exponent {
        exponent if !(-3.0..5.0).contains(&exponent) => format!("{value:.1e}"),
        exponent if exponent >= 2.0 => format!("{value:.0}"),
        exponent if exponent >= 1.0 => format!("{value:.1}"),
        exponent if exponent >= 0.0 => format!("{value:.2}"),
        _ => format!("{value:.3}"),
    };
    ticks::minus(&text)
}
