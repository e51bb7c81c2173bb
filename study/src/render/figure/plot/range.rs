//! Ranges of a line: shaded bands and columns, error bars, faint points of single runs, arrows.

use super::frame::Frame;
use super::line::{Direction, Line};
use crate::render::figure::style::{self, Series};
use crate::render::page::{Page, Position, Stroke};

/// Opacity of a band. Chosen: three bands on each other leave the lines visible.
const BAND_OPACITY: f64 = 0.2;
/// Opacity of a column.
const COLUMN_OPACITY: f64 = 0.3;
/// Width of an error bar, mm.
const BAR: f64 = 0.45;
/// Half the width of the ends of an error bar, mm.
const CAP: f64 = 1.0;
/// Width of a thin error bar, mm.
const ERROR_BAR: f64 = 0.18;
/// Half the width of the ends of a thin error bar, mm.
const ERROR_CAP: f64 = 0.7;
/// Size of a faint point, mm.
pub const FAINT: f64 = 1.3;
/// Opacity of a faint point.
pub const FAINT_OPACITY: f64 = 0.55;
/// Length of an arrow, mm.
const ARROW: f64 = 4.2;

/// A position with the shift of its line.
pub(super) fn shifted([x, y]: Position, line: &Line) -> Position {
    [x + line.shift, y]
}

/// Draws the bands, behind all lines.
pub(super) fn draw_bands(page: &mut Page, lines: &[Line], frame: &Frame) {
    for line in lines {
        for ([x, low, high], width) in &line.columns {
            let [low, high] = [*low, *high].map(|y| shifted(frame.position([*x, y]), line));
            let (left, right) = (low[0] - 0.5 * width, low[0] + 0.5 * width);
            let corners = [[left, low[1]], [right, low[1]], [right, high[1]], [left, high[1]]];
            page.shade(&corners, line.series.colour, COLUMN_OPACITY);
        }
        for band in line.bands.iter().filter(|band| band.len() > 1) {
            let side = |index: usize| {
                band.iter()
                    .map(move |point| shifted(frame.position([point[0], point[index]]), line))
            };
            let around: Vec<Position> = side(2).chain(side(1).rev()).collect();
            page.shade(&around, line.series.colour, BAND_OPACITY);
            let edge = Stroke::solid(line.series.colour, 0.1);
            page.polyline(&side(1).collect::<Vec<_>>(), &edge);
            page.polyline(&side(2).collect::<Vec<_>>(), &edge);
        }
    }
}

/// Draws faint points, error bars and arrows.
pub(super) fn draw_points(page: &mut Page, lines: &[Line], frame: &Frame) {
    for line in lines {
        // The band of a single point is a bar.
        let lone = line.bands.iter().filter(|band| band.len() == 1).flatten();
        for [x, low, high] in line.bars.iter().chain(lone) {
            let ends = [*low, *high].map(|y| shifted(frame.position([*x, y]), line));
            draw_bar(page, ends, line.series.colour);
        }
        for [x, low, high] in &line.errors {
            let ends = [*low, *high].map(|y| shifted(frame.position([*x, y]), line));
            draw_error(page, ends, line.series.colour);
        }
        for (point, fill) in &line.faint {
            let position = shifted(frame.position(*point), line);
            let faint = Series { marker: Some(0), ..line.series };
            page.fade(FAINT_OPACITY);
            style::marker(page, position, faint, *fill, FAINT);
            page.close();
        }
        for (point, direction) in &line.arrows {
            arrow(page, shifted(frame.position(*point), line), *direction, line.series.colour);
        }
    }
}

/// An error bar with short lines at its ends: the range of several runs.
pub fn draw_bar(page: &mut Page, ends: [Position; 2], colour: &'static str) {
    bar(page, ends, CAP, &Stroke::solid(colour, BAR));
}

/// A thin error bar with short lines at its ends: the error of the method.
pub fn draw_error(page: &mut Page, ends: [Position; 2], colour: &'static str) {
    bar(page, ends, ERROR_CAP, &Stroke::solid(colour, ERROR_BAR));
}

fn bar(page: &mut Page, [low, high]: [Position; 2], cap: f64, stroke: &Stroke) {
    page.line(low, high, stroke);
    for end in [low, high] {
        page.line([end[0] - cap, end[1]], [end[0] + cap, end[1]], stroke);
    }
}

/// An arrow that starts at a position.
pub fn arrow(page: &mut Page, from: Position, direction: Direction, colour: &'static str) {
    let sign = if direction == Direction::Up { -1.0 } else { 1.0 };
    let stroke = Stroke::solid(colour, BAR);
    let tip = [from[0], from[1] + sign * ARROW];
    page.line(from, [tip[0], tip[1] - sign * 1.2], &stroke);
    let back = tip[1] - sign * 1.7;
    page.polygon(&[tip, [tip[0] - 1.0, back], [tip[0] + 1.0, back]], colour, &stroke);
}
