//! Figures: plots ([`plot`]) and maps ([`map`]) under a title, over a legend and notes.
//!
//! A figure is what to draw, in the units it is drawn in; the sizes are those of print: 160 mm wide,
//! no letters below 8 pt. Colours are never the only difference ([`style`]).

use self::legend::Legend;
use self::style::{GREY, LARGE, MARGIN, PAGE_WIDTH, SMALL};
use super::page::{Letters, Page, wrapped};

pub mod legend;
pub mod map;
pub mod plot;
pub mod scale;
pub mod style;
pub mod ticks;
pub mod unit;

/// What stands above and below the plots.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct Sheet {
    /// Title.
    pub title: String,
    /// Lines below the title: which study, which rows.
    pub subtitle: Vec<String>,
    /// Legends, one below the other.
    pub legends: Vec<Legend>,
    /// What the reader has to know besides.
    pub notes: Vec<String>,
}

/// Width between the margins, mm.
const INNER: f64 = PAGE_WIDTH - 2.0 * MARGIN;

impl Sheet {
    /// Draws title and subtitle. Where the plots may begin, mm.
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

    /// Draws legend and notes from `y` on, and finishes the page.
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

/// Columns that hold so many panels well.
pub fn columns(panels: usize) -> usize {
    match panels {
        0 | 1 => 1,
        2 | 4 => 2,
        _ => 3,
    }
}

#[cfg(test)]
pub mod check;
