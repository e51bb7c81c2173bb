//! Figures: plots ([`plot`]) and maps ([`map`]) with a title above, a legend and notes below.
//!
//! Values are given in the units in which they are shown. Sizes are those of print: 160 mm wide, texts of
//! at least 8 pt. Series never differ in colour only ([`style`]).

use self::legend::Legend;
use self::style::{AXIS, GREY, LARGE, MARGIN, PAGE_WIDTH, SMALL};
use super::font;
use super::page::{Anchor, Letters, Page, cut, wrapped};

pub mod legend;
pub mod map;
pub mod plot;
pub mod scale;
pub mod style;
pub mod ticks;
pub mod unit;

/// The texts above and below the plots.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct Sheet {
    /// Title.
    pub title: String,
    /// Lines below the title: study and rows.
    pub subtitle: Vec<String>,
    /// Legends, one below the other.
    pub legends: Vec<Legend>,
    /// Notes below the legends.
    pub notes: Vec<String>,
}

/// Width between the margins, mm.
const INNER: f64 = PAGE_WIDTH - 2.0 * MARGIN;

impl Sheet {
    /// Draws title and subtitle. Returns the upper end of the plots, mm.
    fn head(&self, page: &mut Page) -> f64 {
        let mut y = MARGIN;
        for line in wrapped(&self.title, LARGE, INNER) {
            page.text([MARGIN, y + 0.8 * LARGE], &Letters::new(LARGE), &line);
            y += 1.3 * LARGE;
        }
        let grey = Letters { colour: GREY, ..Letters::new(SMALL) };
        for line in self.subtitle.iter().flat_map(|line| wrapped(line, SMALL, INNER)) {
            page.text([MARGIN, y + 0.8 * SMALL], &grey, &line);
            y += 1.4 * SMALL;
        }
        y + 1.5
    }

    /// Draws legends and notes below `y`, mm, and finishes the page.
    fn foot(&self, mut page: Page, y: f64) -> String {
        let mut y = y + 2.0;
        y += legend::draw(&self.legends, &mut page, [MARGIN, y], INNER);
        let grey = Letters { colour: GREY, ..Letters::new(SMALL) };
        y += 0.7;
        for line in self.notes.iter().flat_map(|note| wrapped(note, SMALL, INNER)) {
            page.text([MARGIN, y + 0.8 * SMALL], &grey, &line);
            y += 1.4 * SMALL;
        }
        page.finish(PAGE_WIDTH, y + MARGIN, &self.title)
    }
}

/// Number of columns for a number of panels.
pub fn columns(panels: usize) -> usize {
    match panels {
        0 | 1 => 1,
        2 | 4 => 2,
        _ => 3,
    }
}

/// Least distance between the texts of an axis, mm.
const MIN_TEXT_GAP: f64 = 1.5;

/// Width of the widest of some small texts, mm.
fn widest<'a>(texts: impl IntoIterator<Item = &'a String>) -> f64 {
    texts.into_iter().map(|text| font::width(text, SMALL)).fold(0.0, f64::max)
}

/// Draws names below an axis at these positions, at least `distance` mm apart. Names that are too wide stand in
/// turn on several lines. Returns their height, mm.
fn draw_names(page: &mut Page, names: &[ticks::Tick], top: f64, distance: f64) -> f64 {
    let needed = (widest(names.iter().map(|(_, text)| text)) + MIN_TEXT_GAP) / distance;
    // Chosen: eleven names of 25 characters fit.
    #[expect(clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "1 to 4")]
    let lines = needed.ceil().clamp(1.0, 4.0) as usize;
    for (number, (x, text)) in names.iter().enumerate() {
        page.line([*x, top], [*x, top + 1.0], &AXIS);
        let down = (number % lines) as f64 * 1.25 * SMALL;
        let text = cut(text, SMALL, lines as f64 * distance - MIN_TEXT_GAP);
        let letters = Letters::new(SMALL).at(Anchor::Middle);
        page.text([*x, top + 1.6 + 0.8 * SMALL + down], &letters, &text);
    }
    1.6 + lines as f64 * 1.25 * SMALL
}

#[cfg(test)]
pub mod check;
