//! Where a panel of a plot lies.

use crate::render::figure::scale::Scale;
use crate::render::figure::ticks::Tick;
use crate::render::page::Position;

/// Where a panel lies on the page, mm, and its scales.
#[derive(Default)]
pub struct Frame {
    /// Left end.
    pub left: f64,
    /// Upper end.
    pub top: f64,
    /// Width.
    pub width: f64,
    /// Height.
    pub height: f64,
    /// From x to the page.
    pub x: Scale,
    /// From y to the page.
    pub y: Scale,
    /// Whether points are given as y and x: position and value.
    pub lying: bool,
    /// Ticks of the x axis.
    pub x_ticks: Vec<Tick>,
    /// Number of rows of letters in the lane below.
    pub lane_rows: usize,
    /// Whether the panel is the first one of its row and has the y axis.
    pub first: bool,
}

impl Frame {
    pub(super) fn right(&self) -> f64 {
        self.left + self.width
    }

    pub(super) fn bottom(&self) -> f64 {
        self.top + self.height
    }

    /// Where a value stands along its axis, mm.
    pub(super) fn of_value(&self, value: f64) -> f64 {
        if self.lying { self.x.position(value) } else { self.y.position(value) }
    }

    /// The position at a place on the axis of values, and at one across it.
    pub(super) fn on_rule(&self, at: f64, along: f64) -> Position {
        if self.lying { [at, along] } else { [along, at] }
    }

    pub(super) fn contains(&self, [x, y]: Position) -> bool {
        (self.left..=self.right()).contains(&x) && (self.top..=self.bottom()).contains(&y)
    }
}
