//! Plots of quantities over one axis: panels that share it, stacked or side by side.
//!
//! Panels side by side also share the y axis of their row, so that heights can be compared. A job without
//! a value is a letter in a lane below the plot.

use super::scale::{Scale, Spread};
use super::style::{MARGIN, MEDIUM, SMALL};
use super::ticks::{self, Tick};
use super::{INNER, MIN_TEXT_GAP, Sheet, draw_names, widest};
use crate::render::font;
use crate::render::page::{Anchor, Letters, Page, cut, wrapped, wrapped_at_commas};

pub(super) mod frame;
mod lane;
mod line;
pub(super) mod panel;
mod words;

pub use self::lane::Mark;
pub use self::line::{Direction, Line};

use self::frame::Frame;

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
    /// Names at positions of its y axis, in the place of numbers: then values stand along x, rules are vertical, and bars
    /// and columns lie. Points remain position and value.
    pub names: Vec<Tick>,
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

/// A horizontal line across a plot: a limit, or an end of a range.
#[derive(Debug, Clone, PartialEq)]
pub struct Rule {
    /// Its value on the y axis.
    pub value: f64,
    /// Text beside it; empty for none.
    pub text: String,
    /// The side that is not allowed; `None` for a line alone, which is dashed.
    pub closed: Option<Direction>,
}

/// Height of a name of the y axis, and its width at most, mm.
const NAME_ROW: f64 = 8.0;
const MAX_NAME: f64 = 45.0;
/// Distance between plots side by side, mm.
const GAP: f64 = 5.0;

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

/// Note of a figure without space for each text beside a point.
const OMITTED_NOTE: &str = "Some texts k/n have no space here; the table has them all.";
/// Distance of the lines of a label, in sizes of its letters.
const LABEL_LINE: f64 = 1.3;
/// Height of a line of a title, mm.
const TITLE_LINE: f64 = 1.35 * SMALL;

impl Plots {
    /// The SVG text.
    pub fn svg(&self) -> String {
        let mut page = Page::new();
        let mut y = self.sheet.head(&mut page);
        let layout = self.layout();
        let mut omitted = false;
        for (row, panels) in self.panels.chunks(self.across.max(1)).enumerate() {
            y += layout.title;
            let bottom = y + layout.height;
            let lane_rows = layout.lanes[row];
            let below = bottom + lane::height(lane_rows);
            let mut end = below + 2.0;
            for (column, panel) in panels.iter().enumerate().filter(|(_, panel)| !panel.blank) {
                let number = row * self.across + column;
                let left = layout.columns[column];
                let frame = Frame {
                    left,
                    top: y,
                    width: layout.width,
                    height: layout.height,
                    x: self.x_scale(left, layout.width),
                    y: Scale::new(panels[0].spread, panels[0].range, [bottom, y]),
                    lying: panel.is_lying(),
                    x_ticks: self.x_ticks(layout.width),
                    lane_rows,
                    first: column == 0,
                };
                omitted |= panel.draw(&mut page, &frame, &layout.titles[number]);
                if self.panels.get(number + self.across).is_none_or(|panel| panel.blank) {
                    end = end.max(below + self.draw_x_axis(&mut page, &frame, below));
                }
            }
            y = end;
        }
        let left = layout.columns[0];
        let right = layout.columns[layout.columns.len() - 1] + layout.width;
        let label = cut(&self.x.label, MEDIUM, right - left);
        y += MEDIUM;
        let letters = Letters::new(MEDIUM).at(Anchor::Middle);
        page.text([0.5 * (left + right), y], &letters, &label);
        y += 0.5 * MEDIUM;
        let mut sheet = self.sheet.clone();
        if omitted {
            sheet.notes.insert(0, OMITTED_NOTE.to_owned());
        }
        sheet.foot(page, y)
    }

    fn layout(&self) -> Layout {
        let across = self.across.max(1);
        let rows = self.panels.len().div_ceil(across);
        let names = self.panels.iter().map(|panel| panel.names.len()).max().unwrap_or(0);
        let height = match (across, rows) {
            _ if names > 0 => NAME_ROW * (names + 1) as f64,
            (1, 0 | 1) => 78.0,
            (1, 2) => 56.0,
            (1, 3) => 44.0,
            (1, _) => 36.0,
            (2, _) => 50.0,
            _ => 40.0,
        };
        let first = || self.panels.iter().step_by(across);
        let ticks = first().flat_map(|panel| panel.y_ticks(height));
        let mut gutter = widest(&ticks.map(|(_, text)| text).collect::<Vec<_>>());
        if self.panels.iter().any(|panel| !panel.lane.is_empty()) {
            gutter = gutter.max(font::width(lane::NAME, SMALL));
        }
        let labels = first().map(|panel| panel.label_lines(height).len());
        let labels = labels.max().unwrap_or(0).max(1);
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
            let mut ticks = ticks::of(self.x.spread, [low, high], most);
            if apart(&ticks) || most == 2 {
                if !clear(&ticks) {
                    ticks.pop();
                }
                return ticks;
            }
        }
        Vec::new()
    }

    /// Draws the ticks of the x axis of a panel below `top`. Returns their height, mm.
    fn draw_x_axis(&self, page: &mut Page, frame: &Frame, top: f64) -> f64 {
        let place = |(value, text): &Tick| (frame.x.position(*value), text.clone());
        let ticks: Vec<Tick> = frame.x_ticks.iter().map(place).collect();
        let gaps = ticks.windows(2).map(|pair| pair[1].0 - pair[0].0);
        // Numbers have the space that they need.
        let distance = if self.x.names { gaps.fold(frame.width, f64::min) } else { INNER };
        draw_names(page, &ticks, top, distance)
    }
}

impl Panel {
    /// Whether values stand along x.
    fn is_lying(&self) -> bool {
        !self.names.is_empty()
    }

    /// Ticks of a y axis of this height, mm.
    fn y_ticks(&self, height: f64) -> Vec<Tick> {
        if self.is_lying() {
            let name = |(at, name): &Tick| (*at, cut(name, SMALL, MAX_NAME));
            return self.names.iter().map(name).collect();
        }
        #[expect(clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "at most 11")]
        let most = ((height / 7.0) as usize).clamp(3, 9);
        ticks::of(self.spread, self.range, most)
    }

    /// The lines of the label of a y axis of this height, mm.
    fn label_lines(&self, height: f64) -> Vec<String> {
        wrapped(&self.label, MEDIUM, height + 4.0)
    }
}

#[cfg(test)]
mod tests;
