//! The legend, below the plots, so that it never covers data.

use super::map;
use super::outcome;
use super::plot::line::Direction;
use super::plot::range::{self, FAINT, FAINT_OPACITY};
use super::plot::rule;
use super::style::{self, Fill, MEDIUM, Outcome, PLAIN, SMALL, Series};
use crate::render::font;
use crate::render::page::{Anchor, Letters, Page, Position, cut};

/// A part of the legend: a heading, and entries in columns.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct Legend {
    /// Heading, as `N, mass_flow_rate`; empty for none.
    pub heading: String,
    /// Samples and their texts.
    pub entries: Vec<(Sample, String)>,
}

/// The sample before the text of an entry.
#[derive(Debug, Clone, PartialEq)]
pub enum Sample {
    /// Line and marker of a series.
    Line(Series),
    /// Marker of a series without lines.
    Point(Series),
    /// A marker that stands for no series.
    Marker(Fill),
    /// The cross at the end of a run that failed.
    Cross,
    /// A letter that stands for a job without a value.
    Letter(String),
    /// A hatched cell with a letter.
    Cell(String),
    /// An empty cell.
    Absent,
    /// A cell with a thick frame: it misses a limit.
    Missed,
    /// A cell of an outcome.
    Outcome(Outcome),
    /// A cell with the corner of those in which a failure is expected.
    Expected,
    /// The line between runs that end well and those that fail.
    Border,
    /// A shaded area.
    Area,
    /// A line in a shaded range.
    Band,
    /// An error bar.
    Bar,
    /// A thin error bar.
    Error,
    /// The hatch of the side that is not allowed.
    Closed,
    /// A dashed line across the plot.
    End,
    /// An arrow.
    Arrow(Direction),
    /// A faint point.
    Faint(Fill),
}

/// Width of a line sample and the gap after it, mm.
const LINE_SAMPLE: f64 = 17.0;
/// Width of any other sample and the gap after it, mm.
const MARKER_SAMPLE: f64 = 5.5;
/// Height of a row, mm.
const ROW: f64 = 4.6;
/// Distance between columns, mm.
const GAP: f64 = 5.0;

impl Legend {
    /// Draws the part at `corner`, at most `width` mm wide. Returns its height, mm.
    pub fn draw(&self, page: &mut Page, corner: Position, width: f64) -> f64 {
        let mut below = corner[1];
        if self.entries.is_empty() {
            return 0.0;
        }
        if !self.heading.is_empty() {
            let heading = cut(&self.heading, SMALL, width);
            below += ROW;
            page.text([corner[0], below - 1.2], &Letters::new(SMALL), &heading);
        }
        let (indent, column) = (self.indent(), self.column().min(width));
        #[expect(
            clippy::cast_possible_truncation,
            clippy::cast_sign_loss,
            reason = "a few columns"
        )]
        let columns = (((width + GAP) / column) as usize).clamp(1, self.entries.len());
        let rows = self.entries.len().div_ceil(columns);
        for (number, (sample, text)) in self.entries.iter().enumerate() {
            // The first column is filled first.
            let x = corner[0] + (number / rows) as f64 * column;
            let y = below + (number % rows) as f64 * ROW + 0.5 * ROW;
            draw_sample(page, sample, [x, y]);
            let text = cut(text, SMALL, width - indent);
            page.text([x + indent, y + 0.36 * SMALL], &Letters::new(SMALL), &text);
        }
        below + rows as f64 * ROW - corner[1]
    }
}

impl Legend {
    /// Width of a sample and the gap after it, mm.
    fn indent(&self) -> f64 {
        let lines =
            self.entries.iter().any(|(sample, _)| matches!(sample, Sample::Line(_) | Sample::Band));
        if lines { LINE_SAMPLE } else { MARKER_SAMPLE }
    }

    /// Width of a column of entries, mm.
    fn column(&self) -> f64 {
        let widths = self.entries.iter().map(|(_, text)| font::width(text, SMALL));
        widths.fold(0.0, f64::max) + self.indent() + GAP
    }

    /// Width of the part with all entries in one row, mm.
    fn width_of_one_row(&self) -> f64 {
        (self.column() * self.entries.len() as f64).max(font::width(&self.heading, SMALL) + GAP)
    }
}

/// Draws a sample with its left end at `left`.
fn draw_sample(page: &mut Page, sample: &Sample, left: Position) {
    let middle = [left[0] + 2.0, left[1]];
    match sample {
        Sample::Line(series) => {
            page.line(left, [left[0] + LINE_SAMPLE - 2.0, left[1]], &series.line());
            let middle = [left[0] + 0.5 * (LINE_SAMPLE - 2.0), left[1]];
            if series.marker.is_some() {
                style::marker(page, middle, *series, Fill::Filled, MARKER);
            }
        }
        Sample::Point(series) => style::marker(page, middle, *series, Fill::Filled, MARKER),
        Sample::Marker(fill) => style::plain_marker(page, middle, PLAIN, *fill, MARKER),
        Sample::Cross => style::cross(page, middle, PLAIN, MARKER),
        Sample::Letter(letter) => {
            let letters = Letters::new(MEDIUM).at(Anchor::Middle);
            page.text([middle[0], middle[1] + 0.36 * MEDIUM], &letters, letter);
        }
        Sample::Cell(letter) => {
            let corner = [left[0], left[1] - 1.9];
            page.fill(corner, [4.0, 3.8], style::EMPTY);
            page.hatch(corner, [4.0, 3.8], 1.2, &style::HATCH);
            let letters = Letters::new(SMALL).at(Anchor::Middle);
            page.text([middle[0], middle[1] + 0.36 * SMALL], &letters, letter);
        }
        Sample::Absent => page.frame([left[0], left[1] - 1.9], [4.0, 3.8], &style::HATCH),
        Sample::Missed => {
            page.frame([left[0], left[1] - 1.9], [4.0, 3.8], &style::HATCH);
            map::draw_missed(page, [left[0], left[1] - 1.9], [4.0, 3.8], "#000000");
        }
        Sample::Outcome(outcome) => {
            let corner = [left[0], left[1] - 1.9];
            page.fill(corner, [4.0, 3.8], outcome.ground());
            page.frame(corner, [4.0, 3.8], &style::HATCH);
            outcome.draw(page, [middle[0], left[1]]);
        }
        Sample::Expected => {
            let corner = [left[0], left[1] - 1.9];
            page.frame(corner, [4.0, 3.8], &style::HATCH);
            outcome::draw_expected(page, [corner[0] + 4.0, corner[1]], "#000000");
        }
        Sample::Border => page.line(left, [left[0] + 4.2, left[1]], &outcome::BORDER),
        Sample::Area => area(page, left, 4.0),
        Sample::Band => {
            area(page, left, LINE_SAMPLE - 2.0);
            let line = Series::dashes_only(0).line();
            page.line(left, [left[0] + LINE_SAMPLE - 2.0, left[1]], &line);
        }
        Sample::Bar => {
            range::draw_bar(page, [[middle[0], left[1] + 1.7], [middle[0], left[1] - 1.7]], PLAIN);
            style::plain_marker(page, middle, PLAIN, Fill::Filled, range::FAINT);
        }
        Sample::Error => {
            range::draw_error(
                page,
                [[middle[0], left[1] + 1.7], [middle[0], left[1] - 1.7]],
                PLAIN,
            );
            style::plain_marker(page, middle, PLAIN, Fill::Filled, range::FAINT);
        }
        Sample::Closed => rule::draw_closed(page, [left[0], left[1] - 1.7], [4.2, 3.4], 1.2),
        Sample::End => page.line(left, [left[0] + 4.2, left[1]], &rule::END),
        Sample::Arrow(direction) => {
            let start = if *direction == Direction::Up { left[1] + 2.0 } else { left[1] - 2.0 };
            range::arrow(page, [middle[0], start], *direction, PLAIN);
        }
        Sample::Faint(fill) => {
            page.fade(FAINT_OPACITY);
            style::plain_marker(page, middle, PLAIN, *fill, FAINT);
            page.close();
        }
    }
}

/// A shaded area of this width, mm.
fn area(page: &mut Page, left: Position, width: f64) {
    let (top, bottom, right) = (left[1] - 1.5, left[1] + 1.5, left[0] + width);
    page.area(&[[left[0], top], [right, top], [right, bottom], [left[0], bottom]], PLAIN);
}

/// Size of a marker, mm.
pub const MARKER: f64 = 2.0;

/// Draws several parts: side by side where they fit with one row of entries each, else one below the other.
/// Returns their height, mm.
pub fn draw(parts: &[Legend], page: &mut Page, corner: Position, width: f64) -> f64 {
    let (mut height, mut row, mut x) = (0.0, 0.0_f64, 0.0);
    for part in parts.iter().filter(|part| !part.entries.is_empty()) {
        let needed = part.width_of_one_row();
        if x > 0.0 && x + needed > width {
            (height, row, x) = (height + row, 0.0, 0.0);
        }
        let position = [corner[0] + x, corner[1] + height];
        row = row.max(part.draw(page, position, width - x) + 1.0);
        x += needed + GAP;
    }
    height + row
}
