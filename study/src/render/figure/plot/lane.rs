//! The lane below a plot: a letter for every job without a value.

use super::super::scale::Scale;
use super::super::style::{self, AXIS, EMPTY, SMALL};
use crate::render::page::{Anchor, Letters, Page, Place};

/// A job without a value.
#[derive(Debug, Clone, PartialEq)]
pub struct Mark {
    /// Place on the x axis.
    pub x: f64,
    /// Which series.
    pub series: usize,
    /// The letter that stands for what became of it.
    pub letter: String,
}

/// Between a plot and the lane below it, mm: the lowest number of the y axis reaches into it.
const LANE_GAP: f64 = 1.6;
/// Height of a row of letters in the lane, mm.
const LANE_ROW: f64 = 3.6;
/// Width of a letter in the lane, mm.
pub const LANE_LETTER: f64 = 3.0;
/// What stands beside it.
pub const NAME: &str = "no value";

/// Height of a lane of so many rows with the gap above it, mm.
pub fn height(rows: usize) -> f64 {
    if rows == 0 { 0.0 } else { LANE_GAP + rows as f64 * LANE_ROW }
}

/// Draws a lane in its room: below a plot whose lower left corner is given, as wide and as high as
/// [`height`] has it. `first` is the leftmost of its row, which bears the name.
pub fn draw(
    page: &mut Page,
    marks: &[Mark],
    ([left, bottom], [width, height]): (Place, [f64; 2]),
    x: &Scale,
    first: bool,
) {
    let (top, height) = (bottom + LANE_GAP, height - LANE_GAP);
    page.fill([left, top], [width, height], EMPTY);
    page.frame([left, top], [width, height], &AXIS);
    if first {
        let place = [left - 1.6, top + 0.5 * height + 0.36 * SMALL];
        page.text(place, &Letters::new(SMALL).at(Anchor::End), NAME);
    }
    let (places, _) = places(marks, x, width);
    for (mark, [at, row]) in marks.iter().zip(places) {
        let colour = style::colour(mark.series);
        let letters = Letters { colour, ..Letters::new(SMALL).at(Anchor::Middle) };
        page.text([at, top + (row + 0.79) * LANE_ROW], &letters, &mark.letter);
    }
}

/// Places of the letters of a lane, and how many rows they take: those of one place of the axis stand
/// side by side as far as the next leaves room, then below.
pub fn places(marks: &[Mark], x: &Scale, width: f64) -> (Vec<[f64; 2]>, usize) {
    let mut places: Vec<f64> = marks.iter().map(|mark| x.place(mark.x)).collect();
    let centres = places.clone();
    places.sort_by(f64::total_cmp);
    places.dedup();
    let left = x.place_of_low();
    let nearest = places.windows(2).map(|pair| pair[1] - pair[0]).fold(width, f64::min);
    let edge = match places.as_slice() {
        [] => 0.0,
        [first, ..] => f64::min(first - left, left + width - places[places.len() - 1]),
    };
    // Two neighbours that the ends of the axis both push inwards still have to clear one another.
    let room = nearest.min(0.3 * width).min(0.5 * nearest + edge);
    #[expect(clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "a few")]
    let abreast = ((room / LANE_LETTER) as usize).max(1);
    let mut rows = 0;
    let mut found = Vec::with_capacity(marks.len());
    for (number, centre) in centres.iter().enumerate() {
        let same = |other: &&f64| other.total_cmp(centre).is_eq();
        let before = centres[..number].iter().filter(same).count();
        let all = centres.iter().filter(same).count();
        let row = before / abreast;
        let in_row = (all - row * abreast).min(abreast);
        let shift = (before % abreast) as f64 - 0.5 * (in_row - 1) as f64;
        // At the ends of the axis the letters stay inside.
        let spread = 0.5 * (in_row - 1) as f64 * LANE_LETTER;
        let inside = centre.clamp(left + spread + 1.5, left + width - spread - 1.5);
        rows = rows.max(row + 1);
        found.push([inside + shift * LANE_LETTER, row as f64]);
    }
    (found, rows)
}
