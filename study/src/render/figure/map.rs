//! Maps: one quantity over two axes, one cell per point with its number.
//!
//! All cells have the same size, whatever the distances of the values along the axes. A cell without a
//! value is hatched and has a letter; a cell without a point of the study is an empty frame.

use super::style::{AXIS, Fill, MARGIN, MEDIUM, SMALL};
use super::{INNER, Sheet};
use crate::render::font;
use crate::render::page::{Anchor, Letters, Page, Position, cut, wrapped_at_commas};

mod bar;
mod cell;

use self::bar::MIN_BAR_HEIGHT;
use self::cell::cell_text;
pub use self::cell::draw_missed;

/// A figure of maps.
#[derive(Debug, Clone, PartialEq)]
pub struct Maps {
    /// Title, legends, notes.
    pub sheet: Sheet,
    /// Label of the x axis (quantity and unit), and the texts of its values.
    pub x: (String, Vec<String>),
    /// Label and texts of the y axis, the lowest value first.
    pub y: (String, Vec<String>),
    /// Quantity and unit of the cells.
    pub label: String,
    /// Values at both ends of the colour scale; `None` when no cell has a value.
    pub range: Option<[f64; 2]>,
    /// The maps, row by row.
    pub panels: Vec<Panel>,
}

/// One map.
#[derive(Debug, Clone, PartialEq)]
pub struct Panel {
    /// Title: the parameters that distinguish it from the other maps.
    pub title: String,
    /// Cells along x, those of the lowest y first.
    pub cells: Vec<Cell>,
}

/// One cell.
#[derive(Debug, Clone, PartialEq)]
pub enum Cell {
    /// A value.
    Value {
        /// The value.
        value: f64,
        /// The marker of the outcome.
        outcome: Fill,
        /// Whether another cell shows the same job; [`SAME_JOB`] says so.
        shared: bool,
        /// Text in the place of the number; empty for the number.
        text: String,
        /// Text below the number; empty for none.
        below: String,
        /// Whether the value misses a limit.
        missed: bool,
    },
    /// No value: the letter of the outcome.
    Letter(String),
    /// No such point in the study.
    Absent,
}

impl Cell {
    /// A cell with a value and its outcome.
    pub fn of(value: f64, outcome: Fill, shared: bool) -> Self {
        let (text, below) = (String::new(), String::new());
        Self::Value { value, outcome, shared, text, below, missed: false }
    }

    /// The text below its number.
    fn below(&self) -> &str {
        if let Self::Value { below, .. } = self { below } else { "" }
    }
}

/// Least height of a cell, mm.
const MIN_CELL_HEIGHT: f64 = 7.0;
/// Least height of a cell with two lines of text, mm.
const MIN_HEIGHT_OF_TWO_LINES: f64 = 9.0;
/// Largest height of a cell when there are several rows of maps, mm.
const MAX_CELL_HEIGHT: f64 = 11.0;
/// Largest height of a cell when all maps are in one row, mm.
const MAX_CELL_HEIGHT_OF_ONE_ROW: f64 = 16.0;
/// Height of a map that its cells fill within these limits, mm.
const MAP_HEIGHT: f64 = 60.0;
/// Largest width of a cell, mm.
const MAX_CELL_WIDTH: f64 = 26.0;
/// Distance between maps side by side, mm.
const GAP: f64 = 5.0;
/// Sign before the number in a cell of a job that another cell shows too.
pub const SAME_JOB: &str = "=";
/// Width of the outcome marker and its distance from the number, mm.
const MARKER_WIDTH: f64 = 4.5;

/// Sizes of the figure, mm.
struct Layout {
    /// Left end of the first map.
    left: f64,
    /// Width for maps and the gaps between them.
    inner_width: f64,
    /// Width of the texts of the y axis.
    gutter: f64,
    /// Number of maps side by side.
    across: usize,
    /// Width and height of a cell.
    cell: [f64; 2],
    /// Width and height of a map.
    map: [f64; 2],
    /// Titles of the maps, broken into lines.
    titles: Vec<Vec<String>>,
    /// Height of the title above a map.
    title: f64,
}

/// Height of a line of a title, mm.
const TITLE_LINE: f64 = 1.35 * SMALL;

impl Layout {
    fn new(maps: &Maps) -> Self {
        let (columns, rows) = (maps.x.1.len().max(1), maps.y.1.len().max(1));
        let gutter = widest(&maps.y.1).min(0.25 * INNER);
        let left = MARGIN + 1.8 * MEDIUM + gutter + 2.5;
        let inner_width = INNER + MARGIN - left - maps.bar_width();
        let across = maps.across(inner_width);
        let width = ((inner_width - (across - 1) as f64 * GAP) / across as f64)
            .min(columns as f64 * MAX_CELL_WIDTH);
        let max_height =
            if maps.panels.len() > across { MAX_CELL_HEIGHT } else { MAX_CELL_HEIGHT_OF_ONE_ROW };
        let cell_height = (MAP_HEIGHT / rows as f64).clamp(maps.min_cell_height(), max_height);
        let titles: Vec<Vec<String>> =
            maps.panels.iter().map(|panel| wrapped_at_commas(&panel.title, SMALL, width)).collect();
        let lines = titles.iter().map(Vec::len).max().unwrap_or(0);
        Self {
            left,
            inner_width,
            gutter,
            across,
            cell: [width / columns as f64, cell_height],
            map: [width, cell_height * rows as f64],
            titles,
            title: 1.5 + TITLE_LINE * lines as f64,
        }
    }

    /// Width of a full row of maps.
    fn row_width(&self) -> f64 {
        self.across as f64 * (self.map[0] + GAP) - GAP
    }
}

/// Vertical extent of the drawn maps, mm.
struct Extent {
    /// Upper end of the first row of maps.
    top: f64,
    /// Lower end of the last row of maps.
    bottom: f64,
    /// Lower end of the texts of the x axis.
    end: f64,
}

impl Maps {
    /// The SVG text.
    pub fn svg(&self) -> String {
        let layout = Layout::new(self);
        let mut page = Page::new();
        let top = self.sheet.head(&mut page);
        let extent = self.draw_maps(&mut page, &layout, top);
        let mut y = self.draw_labels(&mut page, &layout, &extent);
        if let Some(range) = self.range {
            let corner = [layout.left + layout.row_width() + 4.0, extent.top];
            self.draw_bar(&mut page, corner, layout.map[1].max(MIN_BAR_HEIGHT), range);
            y = y.max(extent.top + MIN_BAR_HEIGHT + 2.0);
        }
        self.sheet.foot(page, y)
    }

    /// Draws every map from `top` on, with the axes at the left and below the last ones.
    fn draw_maps(&self, page: &mut Page, layout: &Layout, top: f64) -> Extent {
        let [width, height] = layout.map;
        let last_row = self.panels.len().saturating_sub(layout.across);
        let mut extent = Extent { top: top + layout.title, bottom: top + layout.title, end: top };
        for (row, panels) in self.panels.chunks(layout.across).enumerate() {
            let y = extent.end + layout.title;
            let mut axis_height: f64 = 0.0;
            for (column, panel) in panels.iter().enumerate() {
                let corner = [layout.left + column as f64 * (width + GAP), y];
                let title = &layout.titles[row * layout.across + column];
                for (number, line) in title.iter().rev().enumerate() {
                    let position = [corner[0], y - 1.6 - number as f64 * TITLE_LINE];
                    page.text(position, &Letters::new(SMALL), &cut(line, SMALL, width));
                }
                self.draw_cells(page, panel, corner, layout.cell);
                if column == 0 {
                    self.draw_y_axis(page, corner, layout);
                }
                if row * layout.across + column >= last_row {
                    let below = [corner[0], y + height];
                    axis_height = axis_height.max(self.draw_x_axis(page, below, layout));
                }
            }
            extent.bottom = y + height;
            extent.end = extent.bottom + axis_height;
        }
        extent
    }

    /// Draws the labels of both axes. Returns the lower end of the x label, mm.
    fn draw_labels(&self, page: &mut Page, layout: &Layout, extent: &Extent) -> f64 {
        let middle = 0.5 * (extent.top + extent.bottom);
        let letters = Letters { upwards: true, ..Letters::new(MEDIUM).at(Anchor::Middle) };
        let label = cut(&self.y.0, MEDIUM, extent.bottom - extent.top + 8.0);
        page.text([MARGIN + MEDIUM, middle], &letters, &label);
        let label = cut(&self.x.0, MEDIUM, layout.inner_width);
        // A label that is wider than the maps starts at their left end.
        let middle = layout.left + 0.5 * layout.row_width().max(font::width(&label, MEDIUM));
        let letters = Letters::new(MEDIUM).at(Anchor::Middle);
        page.text([middle, extent.end + MEDIUM], &letters, &label);
        extent.end + 1.5 * MEDIUM
    }

    /// Least height of a cell, mm.
    fn min_cell_height(&self) -> f64 {
        let mut cells = self.panels.iter().flat_map(|panel| &panel.cells);
        let two = cells.any(|cell| !cell.below().is_empty());
        if two { MIN_HEIGHT_OF_TWO_LINES } else { MIN_CELL_HEIGHT }
    }

    /// Number of maps side by side: as many as leave the numbers legible.
    fn across(&self, inner_width: f64) -> usize {
        let columns = self.x.1.len().max(1) as f64;
        let numbers = self.panels.iter().flat_map(|panel| &panel.cells).map(|cell| match cell {
            Cell::Value { value, shared, text, below, .. } => {
                let number = font::width(&cell_text(*value, *shared, text), SMALL) + MARKER_WIDTH;
                number.max(font::width(below, SMALL) + 1.0)
            }
            _ => SMALL,
        });
        let names = self.x.1.iter().map(|name| font::width(name, SMALL) + 1.5);
        let min_width = numbers.chain(names).fold(0.0, f64::max) * columns;
        let fits = |across: &usize| *across as f64 * (min_width + GAP) - GAP <= inner_width;
        let most = if self.panels.len() > 9 { 4 } else { super::columns(self.panels.len()) };
        (1..=most).rev().find(fits).unwrap_or(1)
    }

    fn draw_y_axis(&self, page: &mut Page, corner: Position, layout: &Layout) {
        let (rows, [_, height]) = (self.y.1.len(), layout.cell);
        for (row, name) in self.y.1.iter().enumerate() {
            let middle = corner[1] + ((rows - 1 - row) as f64 + 0.5) * height;
            page.line([corner[0] - 1.0, middle], [corner[0], middle], &AXIS);
            let position = [corner[0] - 1.8, middle + 0.36 * SMALL];
            let name = cut(name, SMALL, layout.gutter + 0.1);
            page.text(position, &Letters::new(SMALL).at(Anchor::End), &name);
        }
    }

    /// Draws the x axis; wide texts stand alternately on two lines. Returns its height, mm.
    fn draw_x_axis(&self, page: &mut Page, corner: Position, layout: &Layout) -> f64 {
        let [width, _] = layout.cell;
        let lines: usize = if widest(&self.x.1) + 1.5 > width { 2 } else { 1 };
        for (column, name) in self.x.1.iter().enumerate() {
            let middle = corner[0] + (column as f64 + 0.5) * width;
            page.line([middle, corner[1]], [middle, corner[1] + 1.0], &AXIS);
            let down = (column % lines) as f64 * 1.25 * SMALL;
            let name = cut(name, SMALL, lines as f64 * width - 1.5);
            let position = [middle, corner[1] + 1.6 + 0.8 * SMALL + down];
            page.text(position, &Letters::new(SMALL).at(Anchor::Middle), &name);
        }
        1.6 + lines as f64 * 1.25 * SMALL
    }
}

/// Width of the widest of some small texts, mm.
fn widest(texts: &[String]) -> f64 {
    texts.iter().map(|text| font::width(text, SMALL)).fold(0.0, f64::max)
}

#[cfg(test)]
mod tests;
