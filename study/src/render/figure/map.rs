//! Maps over two axes: one cell per point, with a colour, a sign and a few letters.
//!
//! All cells have the same size, whatever the distances of the values along the axes. A cell without a value is
//! hatched; a cell without a point of the study is an empty frame. Signs and texts are left out of a map in
//! which they do not fit.

use super::style::{self, AXIS, EMPTY, HATCH, MARGIN, MEDIUM, SMALL, Sign};
use super::{INNER, Sheet, draw_names, ticks, widest};
use crate::input::value::short_number;
use crate::render::font;
use crate::render::page::{
    Anchor, Letters, Page, Position, Stroke, cut, wrapped, wrapped_at_commas,
};

/// A figure of maps.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct Maps {
    /// Title, legends, notes.
    pub sheet: Sheet,
    /// Label of the x axis (quantity and unit), and the texts of its values.
    pub x: (String, Vec<String>),
    /// Label and texts of the y axis, the lowest value first.
    pub y: (String, Vec<String>),
    /// Quantity and unit of the colour scale, and its ends; `None` without a scale.
    pub scale: Option<(String, [f64; 2])>,
    /// The maps, row by row.
    pub panels: Vec<Panel>,
}

/// One map.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct Panel {
    /// Title: what distinguishes it from the other maps.
    pub title: String,
    /// Cells along x, those of the lowest y first.
    pub cells: Vec<Cell>,
}

/// One cell.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct Cell {
    /// What it stands on.
    pub ground: Ground,
    /// Sign before the text.
    pub sign: Option<Sign>,
    /// A number or a few letters.
    pub text: String,
    /// A text below it.
    pub below: String,
    /// Whether it has a thick frame.
    pub framed: bool,
}

/// The ground of a cell.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub enum Ground {
    /// None: there is no such point.
    #[default]
    Absent,
    /// A hatch: there is no value.
    Hatched,
    /// The colour of a value on the scale.
    Value(f64),
    /// A colour, and the colour of what is drawn on it.
    Colour(&'static str, &'static str),
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
/// Width of the sign and its distance from the text, mm.
const SIGN: f64 = 3.4;
/// Distance of the two lines of a cell, mm.
const LINE: f64 = 1.3 * SMALL;
/// Height of a line of a title, mm.
const TITLE_LINE: f64 = 1.35 * SMALL;
/// Width of the colour bar, mm.
const BAR: f64 = 4.0;
/// Least height of the colour bar, mm.
const MIN_BAR_HEIGHT: f64 = 30.0;

impl Cell {
    /// A cell with a value, written as a number.
    pub fn of(value: f64, sign: Sign) -> Self {
        let (ground, sign) = (Ground::Value(value), Some(sign));
        Self { ground, sign, text: number(value), ..Self::default() }
    }

    /// A cell without a value, with a letter.
    pub fn letter(letter: impl Into<String>) -> Self {
        Self { ground: Ground::Hatched, text: letter.into(), ..Self::default() }
    }

    /// Width of the sign and the text beside it, mm.
    fn line(&self) -> f64 {
        match (self.sign, self.text.as_str()) {
            (None, text) => font::width(text, SMALL),
            (Some(_), "") => SIGN - 1.4,
            (Some(_), text) => SIGN + font::width(text, SMALL),
        }
    }

    /// Width of its texts with some space, mm.
    fn width(&self) -> f64 {
        self.line().max(font::width(&self.below, SMALL)) + 1.0
    }

    /// Draws the cell; `texts` says whether its text and the text below it have space, `range` are the ends of the scale.
    pub(super) fn draw(
        &self,
        page: &mut Page,
        (corner, size): (Position, [f64; 2]),
        texts: [bool; 2],
        range: Option<[f64; 2]>,
    ) {
        let (ground, ink) = match self.ground {
            Ground::Absent => (None, "#000000"),
            Ground::Hatched => (Some(EMPTY.to_owned()), "#000000"),
            Ground::Colour(ground, ink) => (Some(ground.to_owned()), ink),
            Ground::Value(value) => {
                let range = range.filter(|[low, high]| high > low);
                let place = range.map_or(0.5, |[low, high]| (value - low) / (high - low));
                let (colour, ink) = style::map_colour(place);
                (Some(colour), ink)
            }
        };
        if let Some(colour) = ground {
            page.fill(corner, size, &colour);
        }
        let middle = [corner[0] + 0.5 * size[0], corner[1] + 0.5 * size[1]];
        match self.ground {
            Ground::Absent => page.frame(corner, size, &HATCH),
            Ground::Colour(..) => page.frame(corner, size, &Stroke::solid("#ffffff", 0.3)),
            Ground::Value(_) => {}
            Ground::Hatched => {
                page.hatch(corner, size, 1.6, &HATCH);
                if !self.text.is_empty() {
                    let free = [self.line() + 1.2, 1.1 * SMALL];
                    page.fill([0, 1].map(|axis| middle[axis] - 0.5 * free[axis]), free, EMPTY);
                }
            }
        }
        if self.framed {
            let inset = 0.65;
            let inner = size.map(|length| length - 2.0 * inset);
            page.frame(corner.map(|end| end + inset), inner, &Stroke::solid(ink, 0.8));
        }
        let letters = Letters { colour: ink, ..Letters::new(SMALL) };
        let up = if texts[1] && !self.below.is_empty() { 0.5 * LINE } else { 0.0 };
        let line = if texts[0] { self.line() } else { SIGN - 1.4 };
        let left = middle[0] - 0.5 * line;
        if let Some(sign) = self.sign {
            sign.draw(page, [left + 1.0, middle[1] - up], ink);
        }
        if texts[0] && !self.text.is_empty() {
            let left = if self.sign.is_some() { left + SIGN } else { left };
            page.text([left, middle[1] - up + 0.36 * SMALL], &letters, &self.text);
        }
        if up > 0.0 {
            let position = [middle[0], middle[1] + up + 0.36 * SMALL];
            page.text(position, &letters.at(Anchor::Middle), &self.below);
        }
    }
}

/// Sizes of the figure, mm.
struct Layout {
    /// Left end of the first map.
    left: f64,
    /// Width of the texts of the y axis.
    gutter: f64,
    /// Number of maps side by side.
    across: usize,
    /// Width and height of a cell, and of a map.
    cell: [f64; 2],
    map: [f64; 2],
    /// Titles of the maps, broken into lines, and the height above a map.
    titles: Vec<Vec<String>>,
    title: f64,
    /// Whether the cells have the space for their text, and for the text below.
    texts: [bool; 2],
}

impl Layout {
    fn new(maps: &Maps) -> Self {
        let (columns, rows) = (maps.x.1.len().max(1), maps.y.1.len().max(1));
        let gutter = widest(&maps.y.1).min(0.3 * INNER);
        let left = MARGIN + 1.8 * MEDIUM + gutter + 2.5;
        let inner = INNER + MARGIN - left - maps.bar_width();
        let cells = || maps.panels.iter().flat_map(|panel| &panel.cells);
        let needed = cells().map(Cell::width).fold(0.0, f64::max);
        let names = widest(&maps.x.1) + 1.5;
        let width_of =
            |across: usize| (inner - (across - 1) as f64 * GAP) / (across * columns) as f64;
        let most = match maps.panels.len() {
            many if many > 9 => 4,
            few => super::columns(few),
        };
        let across = (1..=most).rev().find(|across| width_of(*across) >= needed.max(names));
        let across = across.unwrap_or(1);
        let width = width_of(across).min(MAX_CELL_WIDTH);
        let line = cells().map(|cell| cell.line() + 0.6).fold(0.0, f64::max);
        let texts = [width >= line, width >= needed];
        let two_lines = texts[1] && cells().any(|cell| !cell.below.is_empty());
        let least = if two_lines { MIN_HEIGHT_OF_TWO_LINES } else { MIN_CELL_HEIGHT };
        let one_row = maps.panels.len() <= across;
        let most = if one_row { MAX_CELL_HEIGHT_OF_ONE_ROW } else { MAX_CELL_HEIGHT };
        let cell = [width, (MAP_HEIGHT / rows as f64).clamp(least, most)];
        let map = [width * columns as f64, cell[1] * rows as f64];
        let title = |panel: &Panel| wrapped_at_commas(&panel.title, SMALL, map[0]);
        let titles: Vec<Vec<String>> = maps.panels.iter().map(title).collect();
        let lines = titles.iter().map(Vec::len).max().unwrap_or(0);
        let title = 1.5 + TITLE_LINE * lines as f64;
        Self { left, gutter, across, cell, map, titles, title, texts }
    }

    /// Width of a full row of maps.
    fn row_width(&self) -> f64 {
        self.across as f64 * (self.map[0] + GAP) - GAP
    }
}

impl Maps {
    /// The SVG text.
    pub fn svg(&self) -> String {
        let layout = Layout::new(self);
        let mut page = Page::new();
        let mut end = self.sheet.head(&mut page);
        let first = end + layout.title;
        let mut bottom = first;
        for (number, panel) in self.panels.iter().enumerate() {
            let column = number % layout.across;
            if column == 0 {
                bottom = end + layout.title + layout.map[1];
                end = bottom;
            }
            let left = layout.left + column as f64 * (layout.map[0] + GAP);
            self.draw_panel(&mut page, &layout, number, [left, bottom - layout.map[1]]);
            if number + layout.across >= self.panels.len() {
                let place = |(at, name): (usize, &String)| {
                    (left + (at as f64 + 0.5) * layout.cell[0], name.clone())
                };
                let names: Vec<ticks::Tick> = self.x.1.iter().enumerate().map(place).collect();
                end = end.max(bottom + draw_names(&mut page, &names, bottom, layout.cell[0]));
            }
            debug_assert_eq!(panel.cells.len(), self.x.1.len() * self.y.1.len());
        }
        let middle = Letters::new(MEDIUM).at(Anchor::Middle);
        let letters = Letters { turn: -90.0, ..middle };
        let label = cut(&self.y.0, MEDIUM, bottom - first + 8.0);
        page.text([MARGIN + MEDIUM, 0.5 * (first + bottom)], &letters, &label);
        let label = cut(&self.x.0, MEDIUM, INNER + MARGIN - layout.left);
        // A label that is wider than the maps starts at their left end.
        let half = 0.5 * layout.row_width().max(font::width(&label, MEDIUM));
        page.text([layout.left + half, end + MEDIUM], &middle, &label);
        let mut y = end + 1.5 * MEDIUM;
        if self.scale.is_some() {
            let corner = [layout.left + layout.row_width() + 4.0, first];
            self.draw_bar(&mut page, corner, layout.map[1].max(MIN_BAR_HEIGHT));
            y = y.max(first + MIN_BAR_HEIGHT + 2.0);
        }
        self.sheet.foot(page, y)
    }

    /// Draws a map with its title, the texts beside it, and the y axis if it is the first one of a row.
    fn draw_panel(&self, page: &mut Page, layout: &Layout, number: usize, corner: Position) {
        let panel = &self.panels[number];
        let [width, height] = layout.cell;
        for (above, line) in layout.titles[number].iter().rev().enumerate() {
            let position = [corner[0], corner[1] - 1.6 - above as f64 * TITLE_LINE];
            page.text(position, &Letters::new(SMALL), &cut(line, SMALL, layout.map[0]));
        }
        let (columns, rows) = (self.x.1.len().max(1), self.y.1.len());
        let range = self.scale.as_ref().map(|(_, range)| *range);
        let top = |row: usize| corner[1] + (rows - 1 - row) as f64 * height;
        for (index, cell) in panel.cells.iter().enumerate() {
            let at = [corner[0] + (index % columns) as f64 * width, top(index / columns)];
            let letter = cell.ground == Ground::Hatched;
            cell.draw(page, (at, layout.cell), [layout.texts[0] || letter, layout.texts[1]], range);
        }
        page.frame(corner, layout.map, &AXIS);
        for (row, name) in self.y.1.iter().enumerate() {
            let y = top(row) + 0.5 * height;
            if number.is_multiple_of(layout.across) {
                page.line([corner[0] - 1.0, y], [corner[0], y], &AXIS);
                let name = cut(name, SMALL, layout.gutter + 0.1);
                let letters = Letters::new(SMALL).at(Anchor::End);
                page.text([corner[0] - 1.8, y + 0.36 * SMALL], &letters, &name);
            }
        }
    }

    /// Ticks of the colour bar, the lines of its label, and the width of the widest number, mm.
    fn bar(&self) -> Option<(Vec<ticks::Tick>, Vec<String>, f64)> {
        let (label, [low, high]) = self.scale.as_ref()?;
        let ticks = ticks::linear(*low, *high, 7);
        let widest = widest(ticks.iter().map(|(_, text)| text));
        // The lines fit beside the lowest map of this number of rows.
        let rows = self.y.1.len().max(1) as f64;
        let height = rows * (MAP_HEIGHT / rows).clamp(MIN_CELL_HEIGHT, MAX_CELL_HEIGHT);
        Some((ticks, wrapped(label, MEDIUM, height.max(MIN_BAR_HEIGHT) + 6.0), widest))
    }

    /// Width of the colour bar with its numbers and label, mm.
    fn bar_width(&self) -> f64 {
        self.bar().map_or(0.0, |(_, lines, widest)| {
            4.0 + BAR + 1.8 + widest + 2.0 + 1.3 * lines.len().max(1) as f64 * MEDIUM
        })
    }

    /// Draws the colour bar with its numbers and label.
    fn draw_bar(&self, page: &mut Page, corner: Position, height: f64) {
        let (Some((ticks, lines, widest)), Some((_, [low, high]))) = (self.bar(), &self.scale)
        else {
            return;
        };
        style::colour_bar(page, corner, [BAR, height]);
        let right = corner[0] + BAR;
        for (value, text) in ticks {
            let fraction = if high > low { (value - low) / (high - low) } else { 0.5 };
            let y = corner[1] + height * (1.0 - fraction);
            page.line([right, y], [right + 1.0, y], &AXIS);
            page.text([right + 1.8, y + 0.36 * SMALL], &Letters::new(SMALL), &text);
        }
        let letters = Letters { turn: -90.0, ..Letters::new(MEDIUM).at(Anchor::Middle) };
        for (number, line) in lines.iter().enumerate() {
            let x = right + 1.8 + widest + 1.3 * MEDIUM * (number + 1) as f64;
            let line = cut(line, MEDIUM, height.max(MIN_BAR_HEIGHT) + 6.0);
            page.text([x, corner[1] + 0.5 * height], &letters, &line);
        }
    }
}

/// A number in a cell: three significant digits.
fn number(value: f64) -> String {
    let exponent = libm::floor(libm::log10(value.abs()));
    ticks::minus(&match exponent {
        _ if value == 0.0 || !value.is_finite() => short_number(value),
        exponent if !(-3.0..5.0).contains(&exponent) => format!("{value:.1e}"),
        exponent if exponent >= 2.0 => format!("{value:.0}"),
        exponent if exponent >= 1.0 => format!("{value:.1}"),
        exponent if exponent >= 0.0 => format!("{value:.2}"),
        _ => format!("{value:.3}"),
    })
}

#[cfg(test)]
mod tests {
    use proptest::prelude::*;

    use super::*;
    use crate::render::figure::check;
    use crate::render::figure::style::Fill;
    use crate::render::png;

    const VALUES: [f64; 5] = [12.0, 31.25, 0.5, 0.25, -1234.0];

    /// Maps with cells of all kinds.
    fn maps(columns: usize, rows: usize, panels: usize, scale: bool) -> Maps {
        let cell = |index: usize| match index % 7 {
            3 => Cell::letter("S"),
            4 => Cell::default(),
            5 => Cell {
                ground: Ground::Colour("#d55e00", "#000000"),
                sign: Some([Sign::Dot, Sign::Cross, Sign::Bar, Sign::Marker(3)][index % 4]),
                text: ["S", "", "Tl"][index % 3].to_owned(),
                below: ["3.4 µs", "", "2e−5"][index % 3].to_owned(),
                ..Cell::default()
            },
            6 => Cell { below: "3/5".to_owned(), framed: true, ..Cell::letter("") },
            _ => Cell::of(VALUES[index % 5], Sign::Circle([Fill::Half, Fill::Crossed][index % 2])),
        };
        let panel = |panel: usize| Panel {
            title: format!("M {panel}, strategy rapid"),
            cells: (0..columns * rows).map(cell).collect(),
        };
        Maps {
            sheet: Sheet { title: "A map".to_owned(), ..Sheet::default() },
            x: (
                "mass_flow_rate (g/s)".to_owned(),
                (0..columns).map(|n| format!("{n}.5")).collect(),
            ),
            y: ("N".to_owned(), (0..rows).map(|n| n.to_string()).collect()),
            scale: scale.then(|| ("peak_vz (m/s)".to_owned(), [-1234.0, 31.25])),
            panels: (0..panels).map(panel).collect(),
        }
    }

    proptest! {
        #![proptest_config(ProptestConfig::with_cases(60))]
        #[test]
        fn any_map_is_a_valid_figure(
            columns in 1..17_usize, rows in 1..9_usize, panels in 1..11_usize, scale in any::<bool>(),
        ) {
            check::figure(&maps(columns, rows, panels, scale).svg());
        }
    }

    #[test]
    fn cells_have_their_texts_where_all_of_them_fit() {
        let shown = |columns: usize, texts: &[&str]| {
            let all = check::figure(&maps(columns, 2, 1, true).svg());
            texts.iter().all(|text| all.iter().any(|other| other == text))
        };
        assert!(shown(6, &["12.0", "0.500", "3/5", "Tl", "2e−5", "peak_vz (m/s)", "N", "S"]));
        assert!(!shown(16, &["12.0"]) && shown(16, &["S"]));
        assert_eq!(VALUES.map(number), ["12.0", "31.2", "0.500", "0.250", "−1234"]);
        assert!(png::encode(&maps(5, 1, 1, true).svg(), 2.0).unwrap().len() > 1000);
        // One value for all cells has a finite colour.
        let scale = Some(("x".to_owned(), [5.0, 5.0]));
        check::figure(&Maps { scale, ..maps(3, 2, 1, true) }.svg());
    }
}
