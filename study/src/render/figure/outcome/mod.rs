//! Maps of outcomes: how the run of each cell ended, over two axes, one panel a method.
//!
//! All cells have the same size, whatever the distances of the values along the axes. A cell has the ground and shape
//! of its outcome; beside the shape a letter and below it a text, where all cells have the space. A thick line
//! separates runs that ended well from the others.

use super::map::draw_missed;
use super::style::{AXIS, EMPTY, HATCH, MARGIN, MEDIUM, Outcome, SMALL};
use super::{INNER, Sheet};
use crate::render::font;
use crate::render::page::{Anchor, Letters, Page, Position, Stroke, cut};

mod layout;

use layout::Layout;

/// A figure of outcomes.
#[derive(Debug, Clone, PartialEq)]
pub struct Outcomes {
    /// Title, legends, notes.
    pub sheet: Sheet,
    /// Label of the x axis (quantity and unit), and the texts of its values.
    pub x: (String, Vec<String>),
    /// Label and texts of the y axis, the lowest value first.
    pub y: (String, Vec<String>),
    /// Headings of the texts at the right of every row; empty for none.
    pub headings: Vec<String>,
    /// Whether a line separates runs that ended well from the others.
    pub borders: bool,
    /// The panels, one below the other, or side by side where they fit.
    pub panels: Vec<Panel>,
}

/// The cells of a method.
#[derive(Debug, Clone, PartialEq)]
pub struct Panel {
    /// Title.
    pub title: String,
    /// Cells along x, those of the lowest y first; `None` for a run that is missing.
    pub cells: Vec<Option<Cell>>,
    /// Texts at the right of each row, one for each heading; the lowest y first.
    pub beside: Vec<Vec<String>>,
}

/// One cell.
#[derive(Debug, Clone, PartialEq)]
pub struct Cell {
    /// How the run ended.
    pub outcome: Outcome,
    /// Text beside the shape: a letter or a few.
    pub letter: String,
    /// Text below the shape.
    pub below: String,
    /// Whether a failure is expected.
    pub failure_expected: bool,
    /// Whether it is not as expected.
    pub missed: bool,
}

/// The line between runs that end well and those that fail.
pub const BORDER: Stroke = Stroke::solid("#000000", 0.9);
/// The lines between cells.
const GRID: Stroke = Stroke::solid("#ffffff", 0.3);
/// Size of the corner of a cell in which a failure is expected, mm.
const CORNER: f64 = 1.5;
/// Width of the shape and its distance from the letter, mm.
const SHAPE: f64 = 3.0;

/// Draws the corner of a cell in which a failure is expected.
pub fn draw_expected(page: &mut Page, [x, y]: Position, ink: &'static str) {
    let corners = [[x - CORNER, y], [x, y], [x, y + CORNER]];
    page.polygon(&corners, ink, &Stroke::solid(ink, 0.05));
}

impl Cell {
    /// Width that its texts need, mm.
    fn width(&self) -> f64 {
        let above = SHAPE + font::width(&self.letter, SMALL);
        above.max(font::width(&self.below, SMALL)) + 1.0
    }
}

impl Outcomes {
    /// The SVG text.
    pub fn svg(&self) -> String {
        let layout = Layout::new(self);
        let mut page = Page::new();
        let mut top = self.sheet.head(&mut page);
        let (first, rows) = (top + layout.title, self.panels.chunks(layout.across));
        let last_row = rows.len().saturating_sub(1);
        for (row, panels) in rows.enumerate() {
            let y = top + layout.title;
            for (column, panel) in panels.iter().enumerate() {
                let corner = [layout.left(column), y];
                self.draw_panel(&mut page, &layout, panel, corner, column == 0);
                // Panels of the last row, and those above an empty place.
                let below = (row + 1) * layout.across + column;
                if row == last_row || below >= self.panels.len() {
                    self.draw_x_axis(&mut page, &layout, [corner[0], y + layout.height()]);
                }
            }
            top = y + layout.height();
        }
        let middle = 0.5 * (first + top);
        let letters = Letters { upwards: true, ..Letters::new(MEDIUM).at(Anchor::Middle) };
        let label = cut(&self.y.0, MEDIUM, top - first + 12.0);
        page.text([MARGIN + MEDIUM, middle], &letters, &label);
        let end = top + layout.x_axis;
        let label = cut(&self.x.0, MEDIUM, INNER);
        let start = layout.left(0);
        let middle = start + 0.5 * layout.row_width().max(font::width(&label, MEDIUM));
        page.text([middle, end + MEDIUM], &Letters::new(MEDIUM).at(Anchor::Middle), &label);
        self.sheet.foot(page, end + 1.5 * MEDIUM)
    }

    fn draw_panel(
        &self,
        page: &mut Page,
        layout: &Layout,
        panel: &Panel,
        corner: Position,
        is_first: bool,
    ) {
        let [_, height] = layout.cell;
        let title = cut(&panel.title, SMALL, layout.width());
        page.text([corner[0], corner[1] - 1.6], &Letters::new(SMALL), &title);
        let columns = self.x.1.len();
        let place = |index: usize| layout.place(corner, index % columns, index / columns);
        for (index, cell) in panel.cells.iter().enumerate() {
            if let Some(cell) = cell {
                draw_cell(page, layout, cell, place(index));
            } else {
                page.fill(place(index), layout.cell, EMPTY);
                page.hatch(place(index), layout.cell, 1.8, &HATCH);
            }
        }
        page.frame(corner, [layout.width(), layout.height()], &AXIS);
        if self.borders {
            draw_borders(page, layout.cell, &panel.cells, columns, place);
        }
        if is_first {
            for (row, name) in self.y.1.iter().enumerate() {
                let middle = layout.place(corner, 0, row)[1] + 0.5 * height;
                page.line([corner[0] - 1.0, middle], [corner[0], middle], &AXIS);
                let name = cut(name, SMALL, layout.gutter + 0.1);
                let position = [corner[0] - 1.8, middle + 0.36 * SMALL];
                page.text(position, &Letters::new(SMALL).at(Anchor::End), &name);
            }
        }
        for (number, heading) in self.headings.iter().enumerate() {
            let x = corner[0] + layout.width() + layout.beside[number];
            page.text([x, corner[1] - 1.6], &Letters::new(SMALL), heading);
            for (row, texts) in panel.beside.iter().enumerate() {
                let middle = layout.place(corner, 0, row)[1] + 0.5 * height;
                if let Some(text) = texts.get(number) {
                    page.text([x, middle + 0.36 * SMALL], &Letters::new(SMALL), text);
                }
            }
        }
    }

    /// Draws the x axis; wide texts stand alternately on two lines.
    fn draw_x_axis(&self, page: &mut Page, layout: &Layout, corner: Position) {
        let [width, _] = layout.cell;
        for (column, name) in self.x.1.iter().enumerate() {
            let middle = corner[0] + (column as f64 + 0.5) * width;
            page.line([middle, corner[1]], [middle, corner[1] + 1.0], &AXIS);
            let down = (column % layout.x_lines) as f64 * 1.25 * SMALL;
            let name = cut(name, SMALL, layout.x_lines as f64 * width - 1.5);
            let position = [middle, corner[1] + 1.6 + 0.8 * SMALL + down];
            page.text(position, &Letters::new(SMALL).at(Anchor::Middle), &name);
        }
    }
}

/// Draws the line between done and failed cells.
fn draw_borders(
    page: &mut Page,
    [width, height]: [f64; 2],
    cells: &[Option<Cell>],
    columns: usize,
    place: impl Fn(usize) -> Position,
) {
    let is_done = |index: usize| Some(cells.get(index)?.as_ref()?.outcome == Outcome::Done);
    for index in 0..cells.len() {
        let [x, y] = place(index);
        let differs = |other: usize| {
            is_done(index).zip(is_done(other)).is_some_and(|(one, other)| one != other)
        };
        if (index + 1) % columns != 0 && differs(index + 1) {
            page.line([x + width, y], [x + width, y + height], &BORDER);
        }
        if differs(index + columns) {
            page.line([x, y], [x + width, y], &BORDER);
        }
    }
}

fn draw_cell(page: &mut Page, layout: &Layout, cell: &Cell, corner: Position) {
    let [width, height] = layout.cell;
    let ink = cell.outcome.ink();
    page.fill(corner, layout.cell, cell.outcome.ground());
    page.frame(corner, layout.cell, &GRID);
    let middle = [corner[0] + 0.5 * width, corner[1] + 0.5 * height];
    let letters = Letters { colour: ink, ..Letters::new(SMALL) };
    if layout.has_texts {
        let y = if layout.has_below { middle[1] - 0.62 * SMALL } else { middle[1] };
        let both = SHAPE + font::width(&cell.letter, SMALL);
        let left =
            middle[0] - if cell.letter.is_empty() { 0.5 * (SHAPE - 1.0) } else { 0.5 * both };
        cell.outcome.draw(page, [left + 1.0, y]);
        page.text([left + SHAPE, y + 0.36 * SMALL], &letters, &cell.letter);
        if layout.has_below {
            let position = [middle[0], middle[1] + 0.62 * SMALL + 0.36 * SMALL];
            page.text(position, &letters.at(Anchor::Middle), &cell.below);
        }
    } else {
        cell.outcome.draw(page, middle);
    }
    if cell.failure_expected {
        draw_expected(page, [corner[0] + width, corner[1]], ink);
    }
    if cell.missed {
        draw_missed(page, corner, layout.cell, ink);
    }
}

#[cfg(test)]
mod tests;
