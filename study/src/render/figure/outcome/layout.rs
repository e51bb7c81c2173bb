//! Sizes of a map of outcomes.

use super::{Cell, INNER, MARGIN, MEDIUM, Outcomes, SMALL};
use crate::render::font;
use crate::render::page::Position;

/// Height of a cell with two lines, one line and the shape alone, mm.
const HEIGHTS: [f64; 3] = [9.2, 6.4, 6.4];
/// Largest width of a cell, mm.
const MAX_CELL_WIDTH: f64 = 20.0;
/// Distance between panels side by side, mm.
const GAP: f64 = 5.0;
/// Distance of the texts at the right from the panel and from each other, mm.
const BESIDE: f64 = 2.5;

/// Sizes of the figure, mm.
pub(super) struct Layout {
    /// Left end of the first panel.
    start: f64,
    /// Width of the texts of the y axis.
    pub(super) gutter: f64,
    /// Number of panels side by side.
    pub(super) across: usize,
    /// Width and height of a cell.
    pub(super) cell: [f64; 2],
    columns: usize,
    rows: usize,
    /// Height of the title above a panel.
    pub(super) title: f64,
    /// Height of the texts of the x axis, and the number of their lines.
    pub(super) x_axis: f64,
    pub(super) x_lines: usize,
    /// Distance of each column of texts from the right end of a panel.
    pub(super) beside: Vec<f64>,
    /// Whether all cells have the space for their letter, and for the text below.
    pub(super) has_texts: bool,
    pub(super) has_below: bool,
}

/// Width of the widest of some small texts, mm.
fn widest<'a>(texts: impl IntoIterator<Item = &'a String>) -> f64 {
    texts.into_iter().map(|text| font::width(text, SMALL)).fold(0.0, f64::max)
}

impl Layout {
    pub(super) fn new(map: &Outcomes) -> Self {
        let (columns, rows) = (map.x.1.len().max(1), map.y.1.len().max(1));
        let gutter = widest(&map.y.1).min(0.3 * INNER);
        let start = MARGIN + 1.8 * MEDIUM + gutter + 2.5;
        let (mut beside, mut end) = (Vec::new(), 0.0);
        for (number, heading) in map.headings.iter().enumerate() {
            let texts = map.panels.iter().flat_map(|panel| &panel.beside);
            let texts = texts.filter_map(|row| row.get(number));
            beside.push(end + BESIDE);
            end += BESIDE + widest(texts.chain([heading]));
        }
        let inner = INNER + MARGIN - start - end;
        let cells = || map.panels.iter().flat_map(|panel| &panel.cells).flatten();
        let needed = cells().map(Cell::width).fold(0.0, f64::max);
        let letters = cells().map(|cell| Cell { below: String::new(), ..cell.clone() }.width());
        let letters = letters.fold(0.0, f64::max);
        let names = widest(&map.x.1) + 1.5;
        let titles = widest(map.panels.iter().map(|panel| &panel.title));
        let width_of = |across: usize| {
            let inner = inner - (across - 1) as f64 * GAP;
            (inner / (across * columns) as f64).min(MAX_CELL_WIDTH)
        };
        let most = if map.headings.is_empty() { map.panels.len().clamp(1, 3) } else { 1 };
        let fits = |across: &usize| {
            let width = width_of(*across);
            width >= needed.max(names) && width * columns as f64 >= titles
        };
        let across = (1..=most).rev().find(fits).unwrap_or(1);
        let width = width_of(across);
        let has_below = width >= needed && cells().any(|cell| !cell.below.is_empty());
        let has_texts = width >= letters;
        let height = HEIGHTS[if has_below { 0 } else { 1 + usize::from(!has_texts) }];
        let x_lines = if names > width { 2 } else { 1 };
        Self {
            start,
            gutter,
            across,
            cell: [width, height],
            columns,
            rows,
            title: 1.5 + 1.5 * SMALL,
            x_axis: 1.6 + x_lines as f64 * 1.25 * SMALL,
            x_lines,
            beside,
            has_texts,
            has_below,
        }
    }

    /// Width of a panel.
    pub(super) fn width(&self) -> f64 {
        self.cell[0] * self.columns as f64
    }

    /// Height of a panel.
    pub(super) fn height(&self) -> f64 {
        self.cell[1] * self.rows as f64
    }

    /// Width of a full row of panels.
    pub(super) fn row_width(&self) -> f64 {
        self.across as f64 * (self.width() + GAP) - GAP
    }

    /// Left end of a panel.
    pub(super) fn left(&self, column: usize) -> f64 {
        self.start + column as f64 * (self.width() + GAP)
    }

    /// Upper left corner of a cell; rows count from the lowest.
    pub(super) fn place(&self, corner: Position, column: usize, row: usize) -> Position {
        let down = (self.rows - 1 - row) as f64;
        [corner[0] + column as f64 * self.cell[0], corner[1] + down * self.cell[1]]
    }
}
