//! The colour bar of a figure of maps.

use super::{MAP_HEIGHT, MAX_CELL_HEIGHT, Maps};
use crate::render::figure::style::{self, AXIS, MEDIUM, SMALL};
use crate::render::figure::ticks;
use crate::render::font;
use crate::render::page::{Anchor, Letters, Page, Position, cut, wrapped};

/// Width of the colour bar, mm.
const BAR: f64 = 4.0;
/// Least height of the colour bar, mm.
pub(super) const MIN_BAR_HEIGHT: f64 = 30.0;

impl Maps {
    /// Ticks of the colour bar.
    fn bar_ticks(&self) -> Vec<ticks::Tick> {
        let Some([low, high]) = self.range else { return Vec::new() };
        ticks::linear(low, high, 7)
    }

    /// Width of the widest number of the colour bar, mm.
    fn bar_text_width(&self) -> f64 {
        self.bar_ticks().iter().map(|(_, text)| font::width(text, SMALL)).fold(0.0, f64::max)
    }

    /// Width of the colour bar with its numbers and label, mm.
    pub(super) fn bar_width(&self) -> f64 {
        if self.range.is_none() {
            return 0.0;
        }
        let lines = self.label_lines().len().max(1) as f64;
        4.0 + BAR + 1.8 + self.bar_text_width() + 2.0 + 1.3 * lines * MEDIUM
    }

    /// The lines of the label, which fit beside the lowest map of this number of rows.
    fn label_lines(&self) -> Vec<String> {
        let rows = self.y.1.len().max(1) as f64;
        let height = rows * (MAP_HEIGHT / rows).clamp(self.min_cell_height(), MAX_CELL_HEIGHT);
        wrapped(&self.label, MEDIUM, height.max(MIN_BAR_HEIGHT) + 6.0)
    }

    /// Draws the colour bar with its numbers and label.
    pub(super) fn draw_bar(
        &self,
        page: &mut Page,
        corner: Position,
        height: f64,
        [low, high]: [f64; 2],
    ) {
        const STEPS: u8 = 64;
        let step = height / f64::from(STEPS);
        for number in 0..STEPS {
            let (colour, _) = style::map_colour((f64::from(number) + 0.5) / f64::from(STEPS));
            // Each step overlaps the next one, so that no white line shows between them.
            let top = corner[1] + height - f64::from(number + 1) * step;
            let overlapping = if number == 0 { step } else { 1.5 * step };
            page.fill([corner[0], top], [BAR, overlapping], &colour);
        }
        page.frame(corner, [BAR, height], &AXIS);
        for (value, text) in self.bar_ticks() {
            let fraction = if high > low { (value - low) / (high - low) } else { 0.5 };
            let y = corner[1] + height * (1.0 - fraction);
            page.line([corner[0] + BAR, y], [corner[0] + BAR + 1.0, y], &AXIS);
            page.text([corner[0] + BAR + 1.8, y + 0.36 * SMALL], &Letters::new(SMALL), &text);
        }
        let letters = Letters { upwards: true, ..Letters::new(MEDIUM).at(Anchor::Middle) };
        let left = corner[0] + BAR + 1.8 + self.bar_text_width();
        for (number, line) in self.label_lines().iter().enumerate() {
            let x = left + 1.3 * MEDIUM * (number + 1) as f64;
            let line = cut(line, MEDIUM, height.max(MIN_BAR_HEIGHT) + 6.0);
            page.text([x, corner[1] + 0.5 * height], &letters, &line);
        }
    }
}
