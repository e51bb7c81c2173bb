//! Layout of a filmstrip: panels with one scale, rows as high as their highest shape, scale bar, legend.

use super::{Filmstrip, LETTER, LINE, MARGIN, MAX_HEIGHT, VALUE_LINE, WIDTH};
use crate::input::value::short_number;
use crate::render::font;
use crate::render::page::{Letters, Page, Stroke};

/// Sizes and positions on the page, mm.
pub(super) struct Layout {
    /// Millimetres per metre.
    scale: f64,
    /// Lower left corner of the bounds of all shapes, m.
    low: [f64; 2],
    /// Width of a panel.
    pub(super) width: f64,
    /// Height of each row: that of its highest shape.
    heights: Vec<f64>,
    columns: usize,
    /// Height of the texts below a shape.
    texts: f64,
}

impl Layout {
    /// The layout of this number of panels, of all shapes or one: with the number of columns that gives the largest scale;
    /// full rows are preferred. A single panel has room for every shape.
    pub(super) fn of(strip: &Filmstrip<'_>, panels: usize) -> Self {
        let (mut low, mut right) = ([f64::INFINITY; 2], f64::NEG_INFINITY);
        let mut tops = Vec::with_capacity(strip.frames.len());
        // Only nodes of elements: other nodes may have any position.
        for frame in strip.frames {
            let mut top = f64::NEG_INFINITY;
            for node in strip.triangles.as_flattened() {
                let [x, y] = strip.view.project(frame.positions[*node as usize]);
                low = [low[0].min(x), low[1].min(y)];
                (right, top) = (right.max(x), top.max(y));
            }
            tops.push(top);
        }
        if panels == 1 {
            tops = vec![tops.iter().copied().fold(f64::NEG_INFINITY, f64::max)];
        }
        let lines = strip.values.iter().map(Vec::len).max().unwrap_or(0).max(1);
        let texts = LINE + VALUE_LINE * (lines - 1) as f64;
        // Film without extent is drawn as a dot.
        let width = (right - low[0]).max(1e-9);
        let heights = |columns: usize| -> Vec<f64> {
            let highest = |row: &[f64]| row.iter().copied().fold(low[1] + 1e-9, f64::max) - low[1];
            tops.chunks(columns).map(highest).collect()
        };
        let fitting = |columns: usize| {
            let heights = heights(columns);
            let across = WIDTH - 2.0 * MARGIN - MARGIN * (columns - 1) as f64;
            let down = MAX_HEIGHT - (texts + MARGIN) * heights.len() as f64;
            (across / (columns as f64 * width)).min(down / heights.iter().sum::<f64>())
        };
        // The score of a layout decreases with empty panels.
        let score = |columns: usize| {
            let places = columns * panels.div_ceil(columns);
            fitting(columns) * panels as f64 / places as f64
        };
        let mut columns = 1;
        for more in 2..=panels {
            if score(more) > score(columns) {
                columns = more;
            }
        }
        let scale = fitting(columns);
        let heights = heights(columns).iter().map(|height| scale * height).collect();
        Self { scale, low, width: scale * width, heights, columns, texts }
    }

    /// Upper end of the first row.
    fn top() -> f64 {
        MARGIN + LINE + 0.5 * MARGIN
    }

    /// Lower end of the shapes of a row.
    pub(super) fn ground(&self, row: usize) -> f64 {
        Self::top() + self.heights[..=row].iter().sum::<f64>() + (self.texts + MARGIN) * row as f64
    }

    /// Lower end of all rows.
    pub(super) fn bottom(&self) -> f64 {
        self.ground(self.heights.len() - 1) + self.texts + MARGIN
    }

    /// Width for the texts below a shape.
    pub(super) fn cell(&self) -> f64 {
        (WIDTH - MARGIN) / self.columns as f64 - 0.5 * MARGIN
    }

    /// Lower left corner of a panel; all columns have the same width.
    pub(super) fn corner(&self, number: usize) -> [f64; 2] {
        let (row, column) = (number / self.columns, number % self.columns);
        let cell = (WIDTH - MARGIN) / self.columns as f64;
        let margin = 0.5 * (cell - MARGIN - self.width);
        [MARGIN + column as f64 * cell + margin, self.ground(row)]
    }

    /// Position of a projected point on the page.
    pub(super) fn page(&self, number: usize, point: [f64; 2]) -> [f64; 2] {
        let [x, y] = self.corner(number);
        let right = self.scale * (point[0] - self.low[0]);
        let up = self.scale * (point[1] - self.low[1]);
        [x + right, y - up]
    }

    /// Length of the scale bar, m: the largest round length within 30 mm.
    fn bar(&self) -> f64 {
        let longest = 30.0 / self.scale;
        let ten = libm::exp10(libm::floor(libm::log10(longest)));
        let fits = [5.0, 2.0].into_iter().find(|times| times * ten <= longest);
        fits.unwrap_or(1.0) * ten
    }

    /// Draws the scale bar, 1, 2 or 5 times a power of ten long, with its length as text. Returns the end of its
    /// text with some space, mm.
    pub(super) fn scale_bar(&self, page: &mut Page, [x, y]: [f64; 2]) -> f64 {
        let length = self.bar();
        let (end, middle, tick) = (x + length * self.scale, y - 0.35 * LETTER, 0.35 * LETTER);
        let stroke = Stroke::solid("#000000", 0.25);
        page.open("scale", "");
        page.line([x, middle], [end, middle], &stroke);
        for x in [x, end] {
            page.line([x, middle - tick], [x, middle + tick], &stroke);
        }
        page.close();
        let label = length_label(length);
        page.text([end + 0.5 * LETTER, y], &Letters::new(LETTER), &label);
        end + font::width(&label, LETTER) + 3.0 * LETTER
    }
}

fn length_label(length: f64) -> String {
    match length {
        length if length >= 1.0 => format!("{} m", short_number(length)),
        length if length >= 1e-3 => format!("{} mm", short_number(1e3 * length)),
        length => format!("{} µm", short_number(1e6 * length)),
    }
}
