//! The legend, below the plots: it never lies over data.

use super::style::{self, Fill, MEDIUM, SMALL};
use crate::render::font;
use crate::render::page::{Letters, Page, Place, cut};

/// A part of the legend: a heading, and its entries in columns.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct Legend {
    /// What the entries say, as `N, mass_flow_rate`; empty for none.
    pub heading: String,
    /// Samples and their texts.
    pub entries: Vec<(Sample, String)>,
}

/// What stands before the text of an entry.
#[derive(Debug, Clone, PartialEq)]
pub enum Sample {
    /// Line and marker of a series.
    Series(usize),
    /// Marker of a series whose points no line joins.
    Point(usize),
    /// A marker of no series in particular.
    Marker(Fill),
    /// The cross at the end of a run that failed.
    Cross,
    /// A letter that stands for a job without a value.
    Letter(String),
    /// A hatched cell with a letter.
    Cell(String),
    /// An empty cell.
    Absent,
}

/// Width of a sample and the gap behind it, mm.
const SAMPLE: f64 = 17.0;
/// Width of a sample that is no line, mm.
const NARROW: f64 = 5.5;
/// From one row to the next, mm.
const ROW: f64 = 4.6;
/// Between columns, mm.
const GAP: f64 = 5.0;

impl Legend {
    /// Draws at `corner`, at most `width` mm wide. Its height, mm.
    pub fn draw(&self, page: &mut Page, corner: Place, width: f64) -> f64 {
        let mut below = corner[1];
        if self.entries.is_empty() {
            return 0.0;
        }
        if !self.heading.is_empty() {
            let heading = cut(&self.heading, SMALL, width);
            below += ROW;
            page.text([corner[0], below - 1.2], &Letters::new(SMALL), &heading);
        }
        let lines = self.entries.iter().any(|(sample, _)| matches!(sample, Sample::Series(_)));
        let indent = if lines { SAMPLE } else { NARROW };
        let widest =
            self.entries.iter().map(|(_, text)| font::width(text, SMALL)).fold(0.0, f64::max);
        let column = (widest + indent + GAP).min(width);
        #[expect(
            clippy::cast_possible_truncation,
            clippy::cast_sign_loss,
            reason = "a few columns"
        )]
        let columns = (((width + GAP) / column) as usize).clamp(1, self.entries.len());
        let rows = self.entries.len().div_ceil(columns);
        for (number, (sample, text)) in self.entries.iter().enumerate() {
            // Down the first column, then the next.
            let x = corner[0] + (number / rows) as f64 * column;
            let y = below + (number % rows) as f64 * ROW + 0.5 * ROW;
            draw_sample(page, sample, [x, y]);
            let text = cut(text, SMALL, width - indent);
            page.text([x + indent, y + 0.36 * SMALL], &Letters::new(SMALL), &text);
        }
        below + rows as f64 * ROW - corner[1]
    }
}

/// Draws a sample whose left end is at `at`.
fn draw_sample(page: &mut Page, sample: &Sample, at: Place) {
    let middle = [at[0] + 2.0, at[1]];
    match sample {
        Sample::Series(series) => {
            page.line(at, [at[0] + SAMPLE - 2.0, at[1]], &style::line(*series));
            let middle = [at[0] + 0.5 * (SAMPLE - 2.0), at[1]];
            style::marker(page, middle, *series, Fill::Filled, MARKER);
        }
        Sample::Point(series) => style::marker(page, middle, *series, Fill::Filled, MARKER),
        Sample::Marker(fill) => style::plain_marker(page, middle, "#333333", *fill, MARKER),
        Sample::Cross => style::cross(page, middle, "#333333", MARKER),
        Sample::Letter(letter) => {
            let letters = Letters::new(MEDIUM).at(crate::render::page::Anchor::Middle);
            page.text([middle[0], middle[1] + 0.36 * MEDIUM], &letters, letter);
        }
        Sample::Cell(letter) => {
            let corner = [at[0], at[1] - 1.9];
            page.fill(corner, [4.0, 3.8], style::EMPTY);
            page.hatch(corner, [4.0, 3.8], 1.2, &style::HATCH);
            let letters = Letters::new(SMALL).at(crate::render::page::Anchor::Middle);
            page.text([middle[0], middle[1] + 0.36 * SMALL], &letters, letter);
        }
        Sample::Absent => page.frame([at[0], at[1] - 1.9], [4.0, 3.8], &style::HATCH),
    }
}

/// Size of a marker, mm.
pub const MARKER: f64 = 2.0;

/// Draws several parts one below the other. Their height, mm.
pub fn draw(parts: &[Legend], page: &mut Page, corner: Place, width: f64) -> f64 {
    let mut height = 0.0;
    for part in parts.iter().filter(|part| !part.entries.is_empty()) {
        height += part.draw(page, [corner[0], corner[1] + height], width) + 1.0;
    }
    height
}
