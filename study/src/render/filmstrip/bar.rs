//! The colour bar of a filmstrip, beside its scale bar.

use super::{LETTER, Quantity, VALUE_LINE};
use crate::render::figure::{style, ticks};
use crate::render::page::{Anchor, Letters, Page, Position};

/// Height of the bar with its numbers and its label, mm.
pub(super) const HEIGHT: f64 = 3.2 + 2.0 * VALUE_LINE + 1.5;
/// Width of the bar, mm.
const WIDTH: f64 = 70.0;
/// Height of the colours, mm.
const BAR: f64 = 3.2;

/// Draws the bar with its upper left corner at `corner`.
pub(super) fn draw(page: &mut Page, quantity: &Quantity, corner: Position) {
    let [low, high] = quantity.range;
    style::colour_bar(page, corner, [WIDTH, BAR]);
    let below = corner[1] + BAR;
    let letters = Letters::new(LETTER).at(Anchor::Middle);
    for (value, text) in ticks::linear(low, high, 6) {
        let x = corner[0] + WIDTH * (value - low) / (high - low);
        page.line([x, below], [x, below + 0.8], &style::AXIS);
        page.text([x, below + VALUE_LINE], &letters, &text);
    }
    page.text([corner[0], below + 2.0 * VALUE_LINE], &Letters::new(LETTER), &quantity.label);
}
