//! Markers: their shape shows the series, their inside the outcome.

use super::Series;
use crate::render::page::{Page, Position, Stroke};

/// Style of a marker, which shows the outcome of a job.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
pub enum Fill {
    /// Filled: deployed.
    Filled,
    /// Its left half filled: some of several runs deployed.
    Half,
    /// White inside: partial.
    Open,
    /// White inside, with a cross: stalled, or no run deployed.
    Crossed,
}

/// Draws the marker of a series, about `size` mm wide.
pub fn marker(page: &mut Page, centre: Position, series: Series, fill: Fill, size: f64) {
    let inside = if fill == Fill::Filled { series.colour } else { "#ffffff" };
    draw_shape(page, centre, series.marker.unwrap_or(0), series.colour, (inside, fill), size);
}

/// Draws the marker of an outcome, for no series: a circle in one colour.
pub fn plain_marker(
    page: &mut Page,
    centre: Position,
    colour: &'static str,
    fill: Fill,
    size: f64,
) {
    draw_shape(
        page,
        centre,
        0,
        colour,
        (if fill == Fill::Filled { colour } else { "#ffffff" }, fill),
        size,
    );
}

/// The same marker, transparent inside, for a coloured cell.
pub fn map_marker(page: &mut Page, centre: Position, colour: &'static str, fill: Fill, size: f64) {
    draw_shape(
        page,
        centre,
        0,
        colour,
        (if fill == Fill::Filled { colour } else { "none" }, fill),
        size,
    );
}

/// Draws a marker shape (0 to 6) with its outline, inner colour, the cross of
/// [`Fill::Crossed`] and the filled half of [`Fill::Half`].
pub(super) fn draw_shape(
    page: &mut Page,
    centre: Position,
    shape: usize,
    colour: &'static str,
    (inside, fill): (&str, Fill),
    size: f64,
) {
    let stroke = Stroke::solid(colour, 0.35);
    let half = 0.5 * size;
    let corners = |corners: &[Position]| -> Vec<Position> {
        corners.iter().map(|[x, y]| [centre[0] + half * x, centre[1] + half * y]).collect()
    };
    match shape {
        0 => page.circle(centre, half, inside, &stroke),
        1 => page.polygon(
            &corners(&[[-0.9, -0.9], [0.9, -0.9], [0.9, 0.9], [-0.9, 0.9]]),
            inside,
            &stroke,
        ),
        2 => page.polygon(&corners(&[[0.0, -1.15], [1.1, 0.8], [-1.1, 0.8]]), inside, &stroke),
        3 => page.polygon(
            &corners(&[[0.0, -1.25], [1.25, 0.0], [0.0, 1.25], [-1.25, 0.0]]),
            inside,
            &stroke,
        ),
        4 => page.polygon(&corners(&[[0.0, 1.15], [1.1, -0.8], [-1.1, -0.8]]), inside, &stroke),
        5 => page.polygon(&corners(&[[1.15, 0.0], [-0.8, 1.1], [-0.8, -1.1]]), inside, &stroke),
        _ => page.polygon(&corners(&[[-1.15, 0.0], [0.8, 1.1], [0.8, -1.1]]), inside, &stroke),
    }
    if fill == Fill::Half {
        let (corner, size) =
            ([centre[0] - 1.3 * half, centre[1] - 1.3 * half], [1.3 * half, 2.6 * half]);
        page.clip(corner, size);
        draw_shape(page, centre, shape, colour, (colour, Fill::Filled), 2.0 * half);
        page.unclip();
    }
    if fill == Fill::Crossed {
        let thin = Stroke::solid(colour, 0.25);
        let arm = 0.55 * half;
        page.line([centre[0] - arm, centre[1] - arm], [centre[0] + arm, centre[1] + arm], &thin);
        page.line([centre[0] - arm, centre[1] + arm], [centre[0] + arm, centre[1] - arm], &thin);
    }
}

/// Draws the cross at the end of a failed run.
pub fn cross(page: &mut Page, centre: Position, colour: &'static str, size: f64) {
    let stroke = Stroke::solid(colour, 0.5);
    let arm = 0.5 * size;
    page.line([centre[0] - arm, centre[1] - arm], [centre[0] + arm, centre[1] + arm], &stroke);
    page.line([centre[0] - arm, centre[1] + arm], [centre[0] + arm, centre[1] - arm], &stroke);
}
