//! Where a panel lies on the page.

use crate::render::figure::scale::Scale;
use crate::render::figure::ticks::Tick;
use crate::render::page::Position;

/// Where a panel lies on the page, mm, and its scales.
pub(super) struct Frame {
    pub(super) left: f64,
    pub(super) top: f64,
    pub(super) width: f64,
    pub(super) height: f64,
    pub(super) x: Scale,
    pub(super) y: Scale,
    pub(super) x_ticks: Vec<Tick>,
    /// Number of rows of letters in the lane below.
    pub(super) lane_rows: usize,
    /// Whether the panel is the first one of its row and has the y axis.
    pub(super) first: bool,
}

impl Frame {
    pub(super) fn right(&self) -> f64 {
        self.left + self.width
    }

    pub(super) fn bottom(&self) -> f64 {
        self.top + self.height
    }

    pub(super) fn position(&self, [x, y]: [f64; 2]) -> Position {
        [self.x.position(x), self.y.position(y)]
    }

    pub(super) fn contains(&self, [x, y]: Position) -> bool {
        (self.left..=self.right()).contains(&x) && (self.top..=self.bottom()).contains(&y)
    }
}
