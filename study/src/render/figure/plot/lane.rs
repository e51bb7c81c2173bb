//! The lane below a plot: one letter per job without a value.

use super::frame::Frame;
use crate::render::figure::scale::Scale;
use crate::render::figure::style::{AXIS, EMPTY, SMALL, Series};
use crate::render::page::{Anchor, Letters, Page};

/// A job without a value.
#[derive(Debug, Clone, PartialEq)]
pub struct Mark {
    /// Value on the x axis.
    pub x: f64,
    /// The style of its series.
    pub series: Series,
    /// The letter of its outcome.
    pub letter: String,
}

/// Distance between a plot and its lane, mm: the lowest number of the y axis needs it.
const LANE_GAP: f64 = 1.6;
/// Height of a row of letters, mm.
const LANE_ROW: f64 = 3.6;
/// Width of a letter, mm.
const LANE_LETTER: f64 = 3.0;
/// Label of the lane.
pub(super) const NAME: &str = "no value";

/// Height of a lane with this number of rows and the gap above it, mm.
pub(super) fn height(rows: usize) -> f64 {
    if rows == 0 { 0.0 } else { LANE_GAP + rows as f64 * LANE_ROW }
}

/// Draws a lane below a plot. The first lane of a row has the label.
pub(super) fn draw(page: &mut Page, marks: &[Mark], frame: &Frame) {
    let (top, height) = (frame.bottom() + LANE_GAP, height(frame.lane_rows) - LANE_GAP);
    page.fill([frame.left, top], [frame.width, height], EMPTY);
    page.frame([frame.left, top], [frame.width, height], &AXIS);
    let letters = Letters::new(SMALL);
    if frame.first {
        let position = [frame.left - 1.6, top + 0.5 * height + 0.36 * SMALL];
        page.text(position, &letters.at(Anchor::End), NAME);
    }
    let (positions, _) = positions(marks, &frame.x, frame.width);
    for (mark, [at, row]) in marks.iter().zip(positions) {
        let letters = Letters { colour: mark.series.colour, ..letters.at(Anchor::Middle) };
        page.text([at, top + (row + 0.79) * LANE_ROW], &letters, &mark.letter);
    }
}

/// Positions of the letters (x, mm, and row), and the number of rows. Letters with the same value stand side
/// by side if the next value leaves enough space, else in several rows.
pub(super) fn positions(marks: &[Mark], x: &Scale, width: f64) -> (Vec<[f64; 2]>, usize) {
    let mut distinct: Vec<f64> = marks.iter().map(|mark| x.position(mark.x)).collect();
    let centres = distinct.clone();
    distinct.sort_by(f64::total_cmp);
    distinct.dedup();
    let left = x.start();
    let nearest = distinct.windows(2).map(|pair| pair[1] - pair[0]).fold(width, f64::min);
    let edge = match distinct.as_slice() {
        [] => 0.0,
        [first, ..] => f64::min(first - left, left + width - distinct[distinct.len() - 1]),
    };
    // Two groups that both ends of the axis push inwards must not overlap.
    let space = nearest.min(0.3 * width).min(0.5 * nearest + edge);
    #[expect(clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "a few")]
    let abreast = ((space / LANE_LETTER) as usize).max(1);
    let mut rows = 0;
    let mut found = Vec::with_capacity(marks.len());
    for (number, centre) in centres.iter().enumerate() {
        let same = |other: &&f64| other.total_cmp(centre).is_eq();
        let before = centres[..number].iter().filter(same).count();
        let all = centres.iter().filter(same).count();
        let row = before / abreast;
        let in_row = (all - row * abreast).min(abreast);
        let shift = (before % abreast) as f64 - 0.5 * (in_row - 1) as f64;
        // Letters near the ends of the axis stay inside.
        let spread = 0.5 * (in_row - 1) as f64 * LANE_LETTER;
        let inside = centre.clamp(left + spread + 1.5, left + width - spread - 1.5);
        rows = rows.max(row + 1);
        found.push([inside + shift * LANE_LETTER, row as f64]);
    }
    (found, rows)
}
