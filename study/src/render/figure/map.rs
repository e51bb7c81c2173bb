//! Maps: one quantity over two axes, one cell per point with its number.
//!
//! All cells have the same size, whatever the distances of the values along the axes. A cell without a
//! value is hatched and has a letter; a cell without a point of the study is an empty frame.

use super::style::{self, AXIS, EMPTY, Fill, HATCH, MARGIN, MEDIUM, SMALL};
use super::{INNER, Sheet, ticks};
use crate::input::value::short_number;
use crate::render::font;
use crate::render::page::{Anchor, Letters, Page, Position, cut, wrapped_at_commas};

mod bar;

use self::bar::MIN_BAR_HEIGHT;

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
    },
    /// No value: the letter of the outcome.
    Letter(String),
    /// No such point in the study.
    Absent,
}

/// Least height of a cell, mm.
const MIN_CELL_HEIGHT: f64 = 7.0;
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
        let cell_height = (MAP_HEIGHT / rows as f64).clamp(MIN_CELL_HEIGHT, max_height);
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

    /// Number of maps side by side: as many as leave the numbers legible.
    fn across(&self, inner_width: f64) -> usize {
        let columns = self.x.1.len().max(1) as f64;
        let numbers = self.panels.iter().flat_map(|panel| &panel.cells).map(|cell| match cell {
            Cell::Value { value, shared, .. } => {
                font::width(&cell_text(*value, *shared), SMALL) + MARKER_WIDTH
            }
            _ => SMALL,
        });
        let names = self.x.1.iter().map(|name| font::width(name, SMALL) + 1.5);
        let min_width = numbers.chain(names).fold(0.0, f64::max) * columns;
        let fits = |across: &usize| *across as f64 * (min_width + GAP) - GAP <= inner_width;
        let most = if self.panels.len() > 9 { 4 } else { super::columns(self.panels.len()) };
        (1..=most).rev().find(fits).unwrap_or(1)
    }

    fn draw_cells(&self, page: &mut Page, panel: &Panel, corner: Position, size: [f64; 2]) {
        let (columns, rows) = (self.x.1.len(), self.y.1.len());
        let [width, height] = size;
        for (index, cell) in panel.cells.iter().enumerate() {
            let (column, row) = (index % columns, index / columns);
            let cell_corner =
                [corner[0] + column as f64 * width, corner[1] + (rows - 1 - row) as f64 * height];
            match cell {
                Cell::Value { value, outcome, shared } => {
                    let text = cell_text(*value, *shared);
                    self.draw_value(page, (*value, &text, *outcome), cell_corner, size);
                }
                Cell::Letter(letter) => draw_letter(page, letter, cell_corner, size),
                Cell::Absent => page.frame(cell_corner, size, &HATCH),
            }
        }
        page.frame(corner, [width * columns as f64, height * rows as f64], &AXIS);
    }

    /// A cell with its colour, number and outcome marker. The marker stands before the number, or in the
    /// corner of the cell if there is no space for both.
    fn draw_value(
        &self,
        page: &mut Page,
        (value, text, fill): (f64, &str, Fill),
        corner: Position,
        size: [f64; 2],
    ) {
        let [width, height] = size;
        let middle = [corner[0] + 0.5 * width, corner[1] + 0.5 * height];
        let (colour, ink) = style::map_colour(self.fraction(value));
        page.fill(corner, size, &colour);
        let text_width = font::width(text, SMALL);
        let both_fit = text_width + MARKER_WIDTH <= width;
        let shift = if both_fit { 1.6 } else { 0.0 };
        if text_width + 0.6 <= width {
            let letters = Letters { colour: ink, ..Letters::new(SMALL).at(Anchor::Middle) };
            page.text([middle[0] + shift, middle[1] + 0.36 * SMALL], &letters, text);
        }
        let marker = if both_fit {
            [middle[0] + shift - 0.5 * text_width - 1.9, middle[1]]
        } else {
            [corner[0] + 1.3, corner[1] + 1.3]
        };
        style::map_marker(page, marker, ink, fill, 2.0);
    }

    /// Position of a value on the colour scale, 0 to 1.
    fn fraction(&self, value: f64) -> f64 {
        match self.range {
            Some([low, high]) if high > low => (value - low) / (high - low),
            _ => 0.5,
        }
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

/// Width of the widest of some small texts, mm.
fn widest(texts: &[String]) -> f64 {
    texts.iter().map(|text| font::width(text, SMALL)).fold(0.0, f64::max)
}

/// The text of a cell.
fn cell_text(value: f64, shared: bool) -> String {
    let number = cell_number(value);
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

#[cfg(test)]
mod tests;
