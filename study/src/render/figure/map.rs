//! Maps: one quantity over two axes, a cell a point, its number in it.
//!
//! Cells are of one size, whatever the distance of the values along the axes. A cell without a value is
//! hatched and bears a letter; one that no point of the study fills is an empty frame.

use super::style::{self, AXIS, EMPTY, Fill, HATCH, MARGIN, MEDIUM, SMALL};
use super::{INNER, Sheet, ticks};
use crate::input::value::short_number;
use crate::render::font;
use crate::render::page::{Anchor, Letters, Page, Place, cut};

/// A figure of maps.
#[derive(Debug, Clone, PartialEq)]
pub struct Maps {
    /// Title, legends, notes.
    pub sheet: Sheet,
    /// Quantity and unit of the x axis, and its values in words.
    pub x: (String, Vec<String>),
    /// The same of the y axis, the lowest first.
    pub y: (String, Vec<String>),
    /// Quantity and unit of the cells.
    pub label: String,
    /// Values that the ends of the colours stand for; none where no cell has a value.
    pub range: Option<[f64; 2]>,
    /// The maps, row by row.
    pub panels: Vec<Panel>,
}

/// One map.
#[derive(Debug, Clone, PartialEq)]
pub struct Panel {
    /// What tells it from the others.
    pub title: String,
    /// Cells, those of the lowest y first, along x.
    pub cells: Vec<Cell>,
}

/// One cell.
#[derive(Debug, Clone, PartialEq)]
pub enum Cell {
    /// A value, and what became of the job.
    Value(f64, Fill),
    /// No value: the letter that stands for why.
    Letter(String),
    /// No such point in the study.
    Absent,
}

/// Height of a cell, mm: at least, at most, and at most where maps stand in one row.
const HEIGHT: [f64; 3] = [7.0, 11.0, 16.0];
/// Width of a cell, mm, at most.
const WIDEST: f64 = 26.0;
/// Width of the colour bar, mm.
const BAR: f64 = 4.0;
/// Between maps side by side, mm.
const BETWEEN: f64 = 5.0;

impl Maps {
    /// The SVG text.
    pub fn svg(&self) -> String {
        let mut page = Page::new();
        let top = self.sheet.head(&mut page);
        let (columns, rows) = (self.x.1.len().max(1), self.y.1.len().max(1));
        let gutter = self.y.1.iter().map(|name| font::width(name, SMALL)).fold(0.0, f64::max);
        let gutter = gutter.min(0.25 * INNER);
        let left = MARGIN + 1.8 * MEDIUM + gutter + 2.5;
        let bar = self.bar_width();
        let room = INNER + MARGIN - left - bar;
        let across = self.across(room);
        let width =
            ((room - (across - 1) as f64 * BETWEEN) / across as f64).min(columns as f64 * WIDEST);
        let tallest = if self.panels.len() > across { HEIGHT[1] } else { HEIGHT[2] };
        let cell = [width / columns as f64, (60.0 / rows as f64).clamp(HEIGHT[0], tallest)];
        let height = cell[1] * rows as f64;
        let title = if self.panels.iter().any(|panel| !panel.title.is_empty()) { 5.5 } else { 1.5 };
        let last_full = self.panels.len().saturating_sub(across);
        let mut y = top;
        let first_top = top + title;
        let mut bottom = first_top;
        for (row, panels) in self.panels.chunks(across).enumerate() {
            y += title;
            let mut below: f64 = 0.0;
            for (column, panel) in panels.iter().enumerate() {
                let corner = [left + column as f64 * (width + BETWEEN), y];
                let heading = cut(&panel.title, SMALL, width);
                page.text([corner[0], y - 1.6], &Letters::new(SMALL), &heading);
                self.cells(&mut page, panel, corner, cell);
                if column == 0 {
                    self.y_axis(&mut page, corner, cell, gutter);
                }
                if row * across + column >= last_full {
                    below = below.max(self.x_axis(&mut page, [corner[0], y + height], cell));
                }
            }
            bottom = y + height;
            y = bottom + below;
        }
        let middle = 0.5 * (first_top + bottom);
        let letters = Letters { upwards: true, ..Letters::new(MEDIUM).at(Anchor::Middle) };
        let label = cut(&self.y.0, MEDIUM, bottom - first_top + 8.0);
        page.text([MARGIN + MEDIUM, middle], &letters, &label);
        let wide = across as f64 * (width + BETWEEN) - BETWEEN;
        let label = cut(&self.x.0, MEDIUM, room);
        // A label wider than the map begins where the map does.
        let middle = left + 0.5 * wide.max(font::width(&label, MEDIUM));
        page.text([middle, y + MEDIUM], &Letters::new(MEDIUM).at(Anchor::Middle), &label);
        y += 1.5 * MEDIUM;
        if let Some(range) = self.range {
            let x = left + wide + 4.0;
            self.bar(&mut page, [x, first_top], (height).max(30.0), range);
            y = y.max(first_top + 30.0 + 2.0);
        }
        self.sheet.foot(page, y)
    }

    /// Maps side by side, as many as leave the numbers legible.
    fn across(&self, room: f64) -> usize {
        let columns = self.x.1.len().max(1) as f64;
        let numbers = self.panels.iter().flat_map(|panel| &panel.cells).map(|cell| match cell {
            Cell::Value(value, _) => font::width(&number(*value), SMALL) + 4.5,
            _ => SMALL,
        });
        let names = self.x.1.iter().map(|name| font::width(name, SMALL) + 1.5);
        let least = numbers.chain(names).fold(0.0, f64::max) * columns;
        let fits = |across: &usize| *across as f64 * (least + BETWEEN) - BETWEEN <= room;
        let most = if self.panels.len() > 9 { 4 } else { super::columns(self.panels.len()) };
        (1..=most).rev().find(fits).unwrap_or(1)
    }

    fn cells(&self, page: &mut Page, panel: &Panel, corner: Place, [width, height]: [f64; 2]) {
        let (columns, rows) = (self.x.1.len(), self.y.1.len());
        for (at, cell) in panel.cells.iter().enumerate() {
            let (column, row) = (at % columns, at / columns);
            let place =
                [corner[0] + column as f64 * width, corner[1] + (rows - 1 - row) as f64 * height];
            let middle = [place[0] + 0.5 * width, place[1] + 0.5 * height];
            let line = middle[1] + 0.36 * SMALL;
            match cell {
                Cell::Value(value, fill) => {
                    let (colour, ink) = style::map_colour(self.share(*value));
                    page.fill(place, [width, height], &colour);
                    let text = number(*value);
                    let wide = font::width(&text, SMALL);
                    // The mark stands before the number, or alone where both have no room.
                    let both = wide + 4.5 <= width;
                    let shift = if both { 1.6 } else { 0.0 };
                    if wide + 0.6 <= width {
                        let letters =
                            Letters { colour: ink, ..Letters::new(SMALL).at(Anchor::Middle) };
                        page.text([middle[0] + shift, line], &letters, &text);
                    }
                    let at = if both {
                        [middle[0] + shift - 0.5 * wide - 1.9, middle[1]]
                    } else {
                        [place[0] + 1.3, place[1] + 1.3]
                    };
                    style::map_marker(page, at, ink, *fill, 2.0);
                }
                Cell::Letter(letter) => {
                    page.fill(place, [width, height], EMPTY);
                    page.hatch(place, [width, height], 1.8, &HATCH);
                    let ground = font::width(letter, MEDIUM) + 1.2;
                    let under = [middle[0] - 0.5 * ground, middle[1] - 2.0];
                    page.fill(under, [ground, 4.0], EMPTY);
                    let letters = Letters::new(MEDIUM).at(Anchor::Middle);
                    page.text([middle[0], middle[1] + 0.36 * MEDIUM], &letters, letter);
                }
                Cell::Absent => page.frame(place, [width, height], &HATCH),
            }
        }
        page.frame(corner, [width * columns as f64, height * rows as f64], &AXIS);
    }

    fn share(&self, value: f64) -> f64 {
        match self.range {
            Some([low, high]) if high > low => (value - low) / (high - low),
            _ => 0.5,
        }
    }

    fn y_axis(&self, page: &mut Page, corner: Place, [_, height]: [f64; 2], gutter: f64) {
        let rows = self.y.1.len();
        for (row, name) in self.y.1.iter().enumerate() {
            let middle = corner[1] + ((rows - 1 - row) as f64 + 0.5) * height;
            page.line([corner[0] - 1.0, middle], [corner[0], middle], &AXIS);
            let place = [corner[0] - 1.8, middle + 0.36 * SMALL];
            let name = cut(name, SMALL, gutter + 0.1);
            page.text(place, &Letters::new(SMALL).at(Anchor::End), &name);
        }
    }

    /// The height it takes, mm.
    fn x_axis(&self, page: &mut Page, corner: Place, [width, _]: [f64; 2]) -> f64 {
        let widest = self.x.1.iter().map(|name| font::width(name, SMALL)).fold(0.0, f64::max);
        let rows: usize = if widest + 1.5 > width { 2 } else { 1 };
        for (column, name) in self.x.1.iter().enumerate() {
            let middle = corner[0] + (column as f64 + 0.5) * width;
            page.line([middle, corner[1]], [middle, corner[1] + 1.0], &AXIS);
            let down = (column % rows) as f64 * 1.25 * SMALL;
            let name = cut(name, SMALL, rows as f64 * width - 1.5);
            let place = [middle, corner[1] + 1.6 + 0.8 * SMALL + down];
            page.text(place, &Letters::new(SMALL).at(Anchor::Middle), &name);
        }
        1.6 + rows as f64 * 1.25 * SMALL
    }

    /// Marks of the colour bar.
    fn bar_ticks(&self) -> Vec<ticks::Tick> {
        let Some([low, high]) = self.range else { return Vec::new() };
        ticks::linear(low, high, 7)
    }

    fn bar_width(&self) -> f64 {
        if self.range.is_none() {
            return 0.0;
        }
        let widest =
            self.bar_ticks().iter().map(|(_, text)| font::width(text, SMALL)).fold(0.0, f64::max);
        4.0 + BAR + 1.8 + widest + 2.0 + 1.3 * MEDIUM
    }

    fn bar(&self, page: &mut Page, corner: Place, height: f64, [low, high]: [f64; 2]) {
        const STEPS: u8 = 64;
        let step = height / f64::from(STEPS);
        for number in 0..STEPS {
            let (colour, _) = style::map_colour((f64::from(number) + 0.5) / f64::from(STEPS));
            // A little of each lies below the next, so that no white shows between.
            let top = corner[1] + height - f64::from(number + 1) * step;
            let tall = if number == 0 { step } else { 1.5 * step };
            page.fill([corner[0], top], [BAR, tall], &colour);
        }
        page.frame(corner, [BAR, height], &AXIS);
        let ticks = self.bar_ticks();
        let mut widest: f64 = 0.0;
        for (value, text) in &ticks {
            let share = if high > low { (value - low) / (high - low) } else { 0.5 };
            let y = corner[1] + height * (1.0 - share);
            page.line([corner[0] + BAR, y], [corner[0] + BAR + 1.0, y], &AXIS);
            page.text([corner[0] + BAR + 1.8, y + 0.36 * SMALL], &Letters::new(SMALL), text);
            widest = widest.max(font::width(text, SMALL));
        }
        let letters = Letters { upwards: true, ..Letters::new(MEDIUM).at(Anchor::Middle) };
        let label = cut(&self.label, MEDIUM, height.max(30.0) + 6.0);
        let x = corner[0] + BAR + 1.8 + widest + 1.3 * MEDIUM;
        page.text([x, corner[1] + 0.5 * height], &letters, &label);
    }
}

/// A number in a cell: three significant digits.
fn number(value: f64) -> String {
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
mod tests {
    use proptest::prelude::*;

    use super::*;
    use crate::render::figure::check;
    use crate::render::png;

    fn maps(columns: usize, rows: usize, panels: usize, values: &[f64]) -> Maps {
        let finite = || values.iter().copied();
        let (low, high) =
            (finite().fold(f64::INFINITY, f64::min), finite().fold(f64::NEG_INFINITY, f64::max));
        let cell = |at: usize| match at % 5 {
            3 => Cell::Letter("S".to_owned()),
            4 if at.is_multiple_of(2) => Cell::Absent,
            _ => Cell::Value(values[at % values.len()], [Fill::Open, Fill::Crossed][at % 2]),
        };
        Maps {
            sheet: Sheet { title: "A map".to_owned(), ..Sheet::default() },
            x: (
                "mass_flow_rate (g/s)".to_owned(),
                (0..columns).map(|n| format!("{n}.5")).collect(),
            ),
            y: ("N".to_owned(), (0..rows).map(|n| n.to_string()).collect()),
            label: "peak_vz (m/s)".to_owned(),
            range: Some([low, high]),
            panels: (0..panels)
                .map(|panel| Panel {
                    title: format!("M {panel}"),
                    cells: (0..columns * rows).map(cell).collect(),
                })
                .collect(),
        }
    }

    proptest! {
        #![proptest_config(ProptestConfig::with_cases(60))]
        #[test]
        fn any_map_is_a_sound_figure(
            columns in 1..10_usize, rows in 1..9_usize, panels in 1..7_usize,
            values in prop::collection::vec(-1e4..1e4_f64, 1..40),
        ) {
            check::figure(&maps(columns, rows, panels, &values).svg());
        }
    }

    #[test]
    fn every_cell_shows_its_number_and_the_bar_its_unit() {
        let values = [12.0, 31.25, 0.5, 0.25, 1234.0];
        let svg = maps(5, 1, 1, &values).svg();
        let texts = check::figure(&svg);
        for text in ["12.0", "31.2", "0.500", "S", "peak_vz (m/s)", "mass_flow_rate (g/s)", "N"] {
            assert!(texts.iter().any(|other| other == text), "{text}: {texts:?}");
        }
        assert!(png::encode(&svg, 2.0).unwrap().len() > 1000);
    }

    #[test]
    fn one_value_for_all_cells_is_no_division_by_nothing() {
        check::figure(&maps(3, 2, 1, &[5.0]).svg());
        let mut none = maps(3, 2, 1, &[5.0]);
        none.range = None;
        none.panels[0].cells = vec![Cell::Letter("I".to_owned()); 6];
        check::figure(&none.svg());
    }
}
