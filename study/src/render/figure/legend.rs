//! The legend, below the plots, so that it never covers data.

use super::map::Cell;
use super::plot::frame::Frame;
use super::plot::panel;
use super::plot::{Direction, Line};
use super::scale::{Scale, Spread};
use super::style::{self, Fill, MEDIUM, SMALL, Series};
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
    /// A cell of a map.
    Cell(Cell),
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
    let [x, y] = left;
    let corner = [x, y - 1.9];
    let mut line = Line::default();
    let wide = LINE_SAMPLE - 2.0;
    // Coordinates of the sample: both from 0 to 1.
    match sample {
        Sample::Line(series) => {
            line.series = *series;
            line.pieces = vec![vec![[0.0, 0.5], [wide / 4.0, 0.5]]];
            let middle = [0.5 * wide / 4.0, 0.5];
            line.marks.extend(series.marker.map(|_| (middle, Fill::Filled)));
        }
        Sample::Point(series) => {
            line.series = *series;
            line.marks.push(([0.5, 0.5], Fill::Filled));
        }
        Sample::Marker(fill) => line.marks.push(([0.5, 0.5], *fill)),
        Sample::Cross => line.crosses.push([0.5, 0.5]),
        Sample::Area => line.columns.push([0.5, 0.0, 1.0]),
        Sample::Band => {
            line.bands.push(vec![[0.0, 0.0, 1.0], [wide / 4.0, 0.0, 1.0]]);
            line.pieces = vec![vec![[0.0, 0.5], [wide / 4.0, 0.5]]];
        }
        Sample::Bar => line.bars.push([0.5, 0.0, 1.0]),
        Sample::Error => line.errors.push([0.5, 0.0, 1.0]),
        Sample::Arrow(direction) => {
            let start = if *direction == Direction::Up { 0.0 } else { 1.0 };
            line.arrows.push(([0.5, start], *direction));
        }
        Sample::Faint(fill) => line.faint.push(([0.5, 0.5], *fill)),
        Sample::Letter(letter) => {
            let letters = Letters::new(MEDIUM).at(Anchor::Middle);
            page.text([x + 2.0, y + 0.36 * MEDIUM], &letters, letter);
        }
        Sample::Cell(cell) => {
            cell.draw(page, (corner, [4.0, 3.8]), [true, false], None);
            page.frame(corner, [4.0, 3.8], &style::HATCH);
        }
        Sample::Closed => panel::draw_closed(page, corner, [4.0, 3.8], 1.2),
        Sample::End => page.line(left, [x + 4.2, y], &panel::END),
    }
    if matches!(sample, Sample::Bar | Sample::Error) {
        line.faint.push(([0.5, 0.5], Fill::Filled));
    }
    let scale = |start: f64, end: f64| Scale::new(Spread::Linear, [0.0, 1.0], [start, end]);
    let frame = Frame { x: scale(x, x + 4.0), y: scale(y + 1.7, y - 1.7), ..Frame::default() };
    line.draw_bands(page, &frame);
    line.draw_pieces(page, &frame);
    line.draw_points(page, &frame, (0, 1));
}

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
