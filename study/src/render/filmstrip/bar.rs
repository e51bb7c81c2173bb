//! The colour bar of a filmstrip, beside its scale bar.

use super::{LETTER, Quantity, VALUE_LINE};
use crate::render::figure::{style, ticks};
use crate::render::page::{Anchor, Letters, Page, Position, Stroke};

/// Height of the bar with its numbers and its label, mm.
pub(super) const HEIGHT: f64 = 3.2 + 2.0 * VALUE_LINE + 1.5;
/// Width of the bar, mm.
const WIDTH: f64 = 70.0;
/// Height of the colours, mm.
const BAR: f64 = 3.2;

/// Draws the bar with its upper left corner at `corner`.
pub(super) fn draw(page: &mut Page, quantity: &Quantity, corner: Position) {
    const STEPS: u8 = 70;
    let [low, high] = quantity.range;
    let step = WIDTH / f64::from(STEPS);
    for number in 0..STEPS {
        let (colour, _) = style::map_colour((f64::from(number) + 0.5) / f64::from(STEPS));
        // Each step overlaps the next one, so that no white line shows between them.
        let left = corner[0] + f64::from(number) * step;
        let width = if number + 1 == STEPS { step } else { 1.5 * step };
        page.fill([left, corner[1]], [width, BAR], &colour);
    }
    let stroke = Stroke::solid("#333333", 0.2);
    page.frame(corner, [WIDTH, BAR], &stroke);
    let below = corner[1] + BAR;
    let letters = Letters::new(LETTER).at(Anchor::Middle);
    for (value, text) in ticks::linear(low, high, 6) {
        let x = corner[0] + WIDTH * (value - low) / (high - low);
        page.line([x, below], [x, below + 0.8], &stroke);
        page.text([x, below + VALUE_LINE], &letters, &text);
    }
    page.text([corner[0], below + 2.0 * VALUE_LINE], &Letters::new(LETTER), &quantity.label);
}
