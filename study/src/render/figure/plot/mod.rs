//! Plots of quantities over one axis: panels that share it, stacked or side by side.
//!
//! Panels side by side also share the y axis of their row, so that heights can be compared. A job without
//! a value is a letter in a lane below the plot.

use super::scale::{Scale, Spread};
use super::style::{AXIS, MARGIN, MEDIUM, SMALL};
use super::ticks::{self, Tick};
use super::{INNER, Sheet};
use crate::render::font;
use crate::render::page::{Anchor, Letters, Page, cut, wrapped, wrapped_at_commas};

mod band;
mod frame;
pub mod lane;
pub mod line;
mod panel;
pub mod range;
pub mod rule;
mod words;

pub use self::line::{Direction, Line};

use self::frame::Frame;
use self::lane::Mark;
use self::panel::Drawn;
use self::rule::Rule;

/// A figure of plots.
#[derive(Debug, Clone, PartialEq)]
pub struct Plots {
    /// Title, legends, notes.
    pub sheet: Sheet,
    /// The shared x axis.
    pub x: Axis,
    /// The plots, row by row.
    pub panels: Vec<Panel>,
    /// Number of plots side by side.
    pub across: usize,
}

/// An x axis.
#[derive(Debug, Clone, PartialEq)]
pub struct Axis {
    /// Quantity and unit.
    pub label: String,
    /// How its values are spread.
    pub spread: Spread,
    /// Its ends, low < high.
    pub range: [f64; 2],
    /// Preferred ticks, used if they fit; without them the ticks are round numbers.
    pub ticks: Vec<Tick>,
    /// Whether the ticks are names, which are always shown.
    pub names: bool,
}

/// One plot.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct Panel {
    /// Title above the plot.
    pub title: String,
    /// Quantity and unit of its y axis.
    pub label: String,
    /// Ends of its y axis, low < high; those of the first panel of a row apply to the row.
    pub range: [f64; 2],
    /// How the values of its y axis are spread; that of the first panel of a row applies to the row.
    pub spread: Spread,
    /// Horizontal lines across the plot, as those of limits.
    pub rules: Vec<Rule>,
    /// Lines, in drawing order.
    pub lines: Vec<Line>,
    /// Jobs without a value.
    pub lane: Vec<Mark>,
    /// Text in the middle of an empty plot.
    pub message: String,
    /// Whether the place of the panel stays empty.
    pub blank: bool,
}

/// Distance between plots side by side, mm.
const GAP: f64 = 5.0;
/// Least distance between the texts of an axis, mm.
const MIN_TEXT_GAP: f64 = 1.5;
/// Most lines of names below an axis. Chosen: eleven names of 25 characters fit.
const MAX_NAME_LINES: f64 = 4.0;

/// Sizes of the figure, mm.
struct Layout {
    /// Left ends of the columns.
    columns: Vec<f64>,
    /// Width of a plot.
    width: f64,
    /// Height of a plot.
    height: f64,
    /// Number of rows of letters in the lane, by row of plots.
    lanes: Vec<usize>,
    /// Titles of the plots, broken into lines.
    titles: Vec<Vec<String>>,
    /// Height of the title above a plot.
    title: f64,
}

/// Note of a figure with a band.
const BAND_NOTE: &str = "Shaded bands: the range of a line that turns too often to be drawn.";
/// Note of a figure without space for each text beside a point.
const OMITTED_NOTE: &str = "Some texts k/n have no space here; the table has them all.";
/// Distance of the lines of a label, in sizes of its letters.
const LABEL_LINE: f64 = 1.3;
/// Height of a line of a title, mm.
const TITLE_LINE: f64 = 1.35 * SMALL;

impl Layout {
    fn lane_height(&self, row: usize) -> f64 {
        lane::height(self.lanes.get(row).copied().unwrap_or(0))
    }
}

impl Plots {
    /// The SVG text.
    pub fn svg(&self) -> String {
        let mut page = Page::new();
        let mut y = self.sheet.head(&mut page);
        let layout = self.layout();
        let mut all = Drawn::default();
        let last_row = self.panels.len().saturating_sub(self.across);
        for (row, panels) in self.panels.chunks(self.across.max(1)).enumerate() {
            y += layout.title;
            let bottom = y + layout.height;
            let mut below: f64 = 2.0;
            for (column, panel) in panels.iter().enumerate() {
                if panel.blank {
                    continue;
                }
                let left = layout.columns[column];
                let number = row * self.across + column;
                let frame = Frame {
                    left,
                    top: y,
                    width: layout.width,
                    height: layout.height,
                    x: self.x_scale(left, layout.width),
                    y: Scale::new(panels[0].spread, panels[0].range, [bottom, y]),
                    x_ticks: self.x_ticks(layout.width),
                    lane_rows: layout.lanes.get(row).copied().unwrap_or(0),
                    first: column == 0,
                };
                let drawn = panel.draw(&mut page, &frame, &layout.titles[number]);
                all.bands |= drawn.bands;
                all.omitted |= drawn.omitted;
                let below_is_blank =
                    self.panels.get(number + self.across).is_none_or(|panel| panel.blank);
                if number >= last_row || below_is_blank {
                    let top = bottom + layout.lane_height(row);
                    below = below.max(self.draw_x_axis(&mut page, &frame, top));
                }
            }
            y = bottom + layout.lane_height(row) + below;
        }
        let left = layout.columns[0];
        let right = layout.columns[layout.columns.len() - 1] + layout.width;
        let label = cut(&self.x.label, MEDIUM, right - left);
        y += MEDIUM;
        let letters = Letters::new(MEDIUM).at(Anchor::Middle);
        page.text([0.5 * (left + right), y], &letters, &label);
        y += 0.5 * MEDIUM;
        let mut sheet = self.sheet.clone();
        if all.omitted {
            sheet.notes.insert(0, OMITTED_NOTE.to_owned());
        }
        if all.bands {
            sheet.notes.insert(0, BAND_NOTE.to_owned());
        }
        sheet.foot(page, y)
    }

    fn layout(&self) -> Layout {
        let across = self.across.max(1);
        let rows = self.panels.len().div_ceil(across);
        let height = match (across, rows) {
            (1, 0 | 1) => 78.0,
            (1, 2) => 56.0,
            (1, 3) => 44.0,
            (1, _) => 36.0,
            (2, _) => 50.0,
            _ => 40.0,
        };
        let widths = self.panels.iter().step_by(across).flat_map(|panel| {
            let ticks = y_ticks(panel.spread, panel.range, height);
            ticks.into_iter().map(|(_, text)| font::width(&text, SMALL))
        });
        let mut gutter = widths.fold(0.0, f64::max);
        if self.panels.iter().any(|panel| !panel.lane.is_empty()) {
            gutter = gutter.max(font::width(lane::NAME, SMALL));
        }
        let labels = self.panels.iter().step_by(across);
        let labels = labels.map(|panel| panel.label_lines(height).len()).max().unwrap_or(0).max(1);
        let left = MARGIN + (0.5 + LABEL_LINE * labels as f64) * MEDIUM + gutter + 2.0;
        // Half of the last number of the x axis extends beyond the plot.
        let inner_width = INNER + MARGIN - left - 3.0;
        let width = (inner_width - (across - 1) as f64 * GAP) / across as f64;
        let columns: Vec<f64> =
            (0..across).map(|column| left + column as f64 * (width + GAP)).collect();
        let x = self.x_scale(0.0, width);
        let rows = |panel: &Panel| lane::positions(&panel.lane, &x, width).1;
        let lanes = self.panels.chunks(across);
        let lanes = lanes.map(|row| row.iter().map(rows).max().unwrap_or(0)).collect();
        let titles: Vec<Vec<String>> =
            self.panels.iter().map(|panel| wrapped_at_commas(&panel.title, SMALL, width)).collect();
        let lines = titles.iter().map(Vec::len).max().unwrap_or(0);
        let title = 1.5 + TITLE_LINE * lines as f64;
        Layout { columns, width, height, lanes, titles, title }
    }

    fn x_scale(&self, left: f64, width: f64) -> Scale {
        Scale::new(self.x.spread, self.x.range, [left, left + width])
    }

    /// Ticks of the x axis that fit: the preferred ones, or as many round numbers as possible.
    fn x_ticks(&self, width: f64) -> Vec<Tick> {
        let x = self.x_scale(0.0, width);
        let half = |text: &str| 0.5 * font::width(text, SMALL);
        let apart = |ticks: &[Tick]| {
            ticks.windows(2).all(|pair| {
                x.position(pair[1].0) - x.position(pair[0].0)
                    > half(&pair[0].1) + half(&pair[1].1) + MIN_TEXT_GAP
            })
        };
        // The last number of a panel must not touch the first one of the next panel.
        let clear = |ticks: &[Tick]| match ticks {
            [first, .., last] if self.across > 1 => {
                let next = x.position(first.0) + width + GAP;
                next - x.position(last.0) > half(&first.1) + half(&last.1) + MIN_TEXT_GAP
            }
            _ => true,
        };
        let fits = apart(&self.x.ticks) && clear(&self.x.ticks);
        if !self.x.ticks.is_empty() && (self.x.names || fits) {
            return self.x.ticks.clone();
        }
        let [low, high] = self.x.range;
        for most in (2..=9).rev() {
            let mut ticks = match self.x.spread {
                Spread::Linear => ticks::linear(low, high, most),
                Spread::Logarithmic => ticks::logarithmic(low, high, most),
            };
            if apart(&ticks) || most == 2 {
                if !clear(&ticks) {
                    ticks.pop();
                }
                return ticks;
            }
        }
        Vec::new()
    }

    /// Draws the x axis of a panel below `top`. Names that are too wide stand in turn on several
    /// lines.
    /// Returns its height, mm.
    fn draw_x_axis(&self, page: &mut Page, frame: &Frame, top: f64) -> f64 {
        let ticks = &frame.x_ticks;
        let positions: Vec<f64> = ticks.iter().map(|(value, _)| frame.x.position(*value)).collect();
        let nearest =
            positions.windows(2).map(|pair| pair[1] - pair[0]).fold(frame.width, f64::min);
        let widest = ticks.iter().map(|(_, text)| font::width(text, SMALL)).fold(0.0, f64::max);
        let needed = ((widest + MIN_TEXT_GAP) / nearest).ceil();
        #[expect(clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "1 to 4")]
        let lines = if self.x.names { needed.clamp(1.0, MAX_NAME_LINES) as usize } else { 1 };
        for (number, ((_, text), x)) in ticks.iter().zip(&positions).enumerate() {
            page.line([*x, top], [*x, top + 1.0], &AXIS);
            let down = (number % lines) as f64 * 1.25 * SMALL;
            let max_width =
                if self.x.names { lines as f64 * nearest - MIN_TEXT_GAP } else { f64::INFINITY };
            let position = [*x, top + 1.6 + 0.8 * SMALL + down];
            let text = cut(text, SMALL, max_width);
            page.text(position, &Letters::new(SMALL).at(Anchor::Middle), &text);
        }
        1.6 + lines as f64 * 1.25 * SMALL
    }
}

impl Panel {
    /// The lines of the label of a y axis of this height, mm.
    fn label_lines(&self, height: f64) -> Vec<String> {
        wrapped(&self.label, MEDIUM, height + 4.0)
    }
}

/// Ticks of a y axis of this height, mm.
fn y_ticks(spread: Spread, [low, high]: [f64; 2], height: f64) -> Vec<Tick> {
    #[expect(clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "at most 11")]
    let most = ((height / 7.0) as usize).clamp(3, 9);
    match spread {
        Spread::Linear => ticks::linear(low, high, most),
        Spread::Logarithmic => ticks::logarithmic(low, high, most),
    }
}

#[cfg(test)]
mod tests;
