//! Plots of quantities over one axis: panels that share it, stacked or side by side.
//!
//! Panels side by side also share the y axis of their row, so that heights compare at a glance. A job
//! without a value is a letter in a lane below the plot, never nothing.

use super::scale::{Scale, Spread};
use super::style::{self, AXIS, Fill, GRID, MARGIN, MEDIUM, SMALL};
use super::ticks::{self, Tick};
use super::{INNER, Sheet, legend};
use crate::render::font;
use crate::render::page::{Anchor, Letters, Page, Place, cut, wrapped};

pub mod lane;

use self::lane::Mark;

/// A figure of plots.
#[derive(Debug, Clone, PartialEq)]
pub struct Plots {
    /// Title, legends, notes.
    pub sheet: Sheet,
    /// The axis they share.
    pub x: Axis,
    /// The plots, row by row.
    pub panels: Vec<Panel>,
    /// Plots side by side.
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
    /// Marks asked for, where there is room for them; none for round numbers.
    pub ticks: Vec<Tick>,
    /// Whether the marks are names, which nothing can stand for.
    pub names: bool,
}

/// One plot.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct Panel {
    /// What it shows, above it.
    pub title: String,
    /// Quantity and unit of its y axis.
    pub label: String,
    /// Ends of its y axis, low < high; those of the first panel of a row hold for the row.
    pub range: [f64; 2],
    /// Lines, the first lowest.
    pub lines: Vec<Line>,
    /// Jobs without a value.
    pub lane: Vec<Mark>,
    /// Said in the middle of the plot where there is nothing to draw.
    pub words: String,
}

/// One series of a plot.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct Line {
    /// Which series: decides colour, dashes, marker.
    pub series: usize,
    /// Runs of points, each joined by a line; all finite.
    pub runs: Vec<Vec<[f64; 2]>>,
    /// Markers at given points.
    pub marks: Vec<([f64; 2], Fill)>,
    /// Markers here and there along the line, to tell it in black and white.
    pub sparse: bool,
    /// Crosses: what is left of runs that failed.
    pub crosses: Vec<[f64; 2]>,
}

/// Between plots side by side, mm.
const BETWEEN: f64 = 5.0;

/// Where everything lies.
struct Layout {
    /// Left ends of the columns.
    columns: Vec<f64>,
    width: f64,
    height: f64,
    /// Rows of letters in the lane, by row of plots.
    lanes: Vec<usize>,
    title: f64,
}

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
        let last_full = self.panels.len().saturating_sub(self.across);
        for (row, panels) in self.panels.chunks(self.across.max(1)).enumerate() {
            y += layout.title;
            let bottom = y + layout.height;
            let mut below: f64 = 2.0;
            for (column, panel) in panels.iter().enumerate() {
                let left = layout.columns[column];
                let x = self.x_scale(left, layout.width);
                let range = panels[0].range;
                let scale = Scale::new(Spread::Linear, range, [bottom, y]);
                self.draw(&mut page, panel, &layout, [left, y], (&x, &scale), (row, column == 0));
                if row * self.across + column >= last_full {
                    let top = bottom + layout.lane_height(row);
                    below = below.max(self.x_axis(&mut page, &x, top, layout.width));
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
        self.sheet.foot(page, y)
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
            let ticks = y_ticks(panel.range, height);
            ticks.into_iter().map(|(_, text)| font::width(&text, SMALL))
        });
        let mut gutter = widths.fold(0.0, f64::max);
        if self.panels.iter().any(|panel| !panel.lane.is_empty()) {
            gutter = gutter.max(font::width(lane::NAME, SMALL));
        }
        let left = MARGIN + 1.8 * MEDIUM + gutter + 2.0;
        // Half of the last number of an axis stands out to the right.
        let room = INNER + MARGIN - left - 3.0;
        let width = (room - (across - 1) as f64 * BETWEEN) / across as f64;
        let columns: Vec<f64> =
            (0..across).map(|column| left + column as f64 * (width + BETWEEN)).collect();
        let x = self.x_scale(0.0, width);
        let rows = |panel: &Panel| lane::places(&panel.lane, &x, width).1;
        let lanes = self.panels.chunks(across);
        let lanes = lanes.map(|row| row.iter().map(rows).max().unwrap_or(0)).collect();
        let title = if self.panels.iter().any(|panel| !panel.title.is_empty()) { 5.5 } else { 1.5 };
        Layout { columns, width, height, lanes, title }
    }

    fn x_scale(&self, left: f64, width: f64) -> Scale {
        Scale::new(self.x.spread, self.x.range, [left, left + width])
    }

    /// Marks of the x axis that there is room for.
    fn x_ticks(&self, width: f64) -> Vec<Tick> {
        let x = self.x_scale(0.0, width);
        let half = |text: &str| 0.5 * font::width(text, SMALL);
        let apart = |ticks: &[Tick]| {
            ticks.windows(2).all(|pair| {
                x.place(pair[1].0) - x.place(pair[0].0) > half(&pair[0].1) + half(&pair[1].1) + 1.5
            })
        };
        // The last number of a panel stands clear of the first of the panel beside it.
        let clear = |ticks: &[Tick]| match ticks {
            [first, .., last] if self.across > 1 => {
                let next = x.place(first.0) + width + BETWEEN;
                next - x.place(last.0) > half(&first.1) + half(&last.1) + 1.5
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

    fn draw(
        &self,
        page: &mut Page,
        panel: &Panel,
        layout: &Layout,
        [left, top]: Place,
        (x, y): (&Scale, &Scale),
        (row, first): (usize, bool),
    ) {
        let (width, height) = (layout.width, layout.height);
        let (right, bottom) = (left + width, top + height);
        let title = cut(&panel.title, SMALL, width);
        page.text([left, top - 1.6], &Letters::new(SMALL), &title);
        for (value, text) in y_ticks(panel.range, height) {
            let at = y.place(value);
            page.line([left, at], [right, at], &GRID);
            if first {
                page.line([left - 1.0, at], [left, at], &AXIS);
                let place = [left - 1.6, at + 0.36 * SMALL];
                page.text(place, &Letters::new(SMALL).at(Anchor::End), &text);
            }
        }
        for (value, _) in self.x_ticks(width) {
            page.line([x.place(value), top], [x.place(value), bottom], &GRID);
        }
        if first {
            let letters = Letters { upwards: true, ..Letters::new(MEDIUM).at(Anchor::Middle) };
            let label = cut(&panel.label, MEDIUM, height + 4.0);
            page.text([MARGIN + MEDIUM, 0.5 * (top + bottom)], &letters, &label);
        }
        page.clip([left, top], [width, height]);
        for line in &panel.lines {
            for run in &line.runs {
                let places: Vec<Place> =
                    run.iter().map(|point| [x.place(point[0]), y.place(point[1])]).collect();
                page.polyline(&thinned(&places), &style::line(line.series));
            }
        }
        page.unclip();
        page.frame([left, top], [width, height], &AXIS);
        let sparse = panel.lines.iter().filter(|line| line.sparse).count();
        for (number, line) in panel.lines.iter().enumerate() {
            if line.sparse {
                let step = width / SPARSE;
                let shift = (number as f64 + 0.5) / sparse as f64;
                for place in along(line, (x, y), left + shift * step, step) {
                    if (left..=right).contains(&place[0]) && (top..=bottom).contains(&place[1]) {
                        style::marker(page, place, line.series, Fill::Filled, 1.7);
                    }
                }
            }
            for (point, fill) in &line.marks {
                let place = [x.place(point[0]), y.place(point[1])];
                style::marker(page, place, line.series, *fill, legend::MARKER);
            }
            for [at, value] in line.crosses.iter().copied() {
                style::cross(page, [x.place(at), y.place(value)], style::colour(line.series), 2.6);
            }
        }
        let rows = layout.lanes.get(row).copied().unwrap_or(0);
        if rows > 0 {
            lane::draw(page, &panel.lane, ([left, bottom], [width, lane::height(rows)]), x, first);
        }
        if !panel.words.is_empty() {
            let lines = wrapped(&panel.words, SMALL, width - 6.0);
            for (number, line) in lines.iter().enumerate() {
                let below = number as f64 - 0.5 * (lines.len() - 1) as f64;
                let place = [left + 0.5 * width, top + 0.5 * height + 1.4 * SMALL * below];
                page.text(place, &Letters::new(SMALL).at(Anchor::Middle), line);
            }
        }
    }

    /// Draws the marks of the x axis below `top`. The height they take, mm.
    fn x_axis(&self, page: &mut Page, x: &Scale, top: f64, width: f64) -> f64 {
        let ticks = self.x_ticks(width);
        let places: Vec<f64> = ticks.iter().map(|(value, _)| x.place(*value)).collect();
        let nearest = places.windows(2).map(|pair| pair[1] - pair[0]).fold(width, f64::min);
        let widest = ticks.iter().map(|(_, text)| font::width(text, SMALL)).fold(0.0, f64::max);
        // Names that do not fit side by side stand in turn on two lines.
        let rows: usize = if self.x.names && widest + 1.5 > nearest { 2 } else { 1 };
        for (number, ((_, text), at)) in ticks.iter().zip(&places).enumerate() {
            page.line([*at, top], [*at, top + 1.0], &AXIS);
            let down = (number % rows) as f64 * 1.25 * SMALL;
            let room = if self.x.names { rows as f64 * nearest - 1.5 } else { f64::INFINITY };
            let place = [*at, top + 1.6 + 0.8 * SMALL + down];
            let text = cut(text, SMALL, room);
            page.text(place, &Letters::new(SMALL).at(Anchor::Middle), &text);
        }
        1.6 + rows as f64 * 1.25 * SMALL
    }
}

/// Markers along a line that carries them here and there.
const SPARSE: f64 = 6.0;

fn y_ticks([low, high]: [f64; 2], height: f64) -> Vec<Tick> {
    #[expect(clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "a few")]
    ticks::linear(low, high, ((height / 7.0) as usize).clamp(3, 9))
}

/// Every `step` mm from `from` on, the places where a line is.
fn along(line: &Line, (x, y): (&Scale, &Scale), from: f64, step: f64) -> Vec<Place> {
    let mut found = Vec::new();
    for run in &line.runs {
        let mut next = 0;
        for pair in run.windows(2) {
            let ends = [x.place(pair[0][0]), x.place(pair[1][0])];
            while from + f64::from(next) * step <= ends[1] {
                let at = from + f64::from(next) * step;
                next += 1;
                if at < ends[0] {
                    continue;
                }
                let share =
                    if ends[1] > ends[0] { (at - ends[0]) / (ends[1] - ends[0]) } else { 0.0 };
                found.push([at, y.place(pair[0][1] + share * (pair[1][1] - pair[0][1]))]);
            }
        }
    }
    found
}

/// A line with no more points than show: of those within a tenth of a millimetre of the axis the first,
/// the lowest, the highest and the last.
fn thinned(places: &[Place]) -> Vec<Place> {
    const BIN: f64 = 0.1;
    let bin = |place: &Place| libm::floor(place[0] / BIN);
    let mut kept = Vec::new();
    for group in places.chunk_by(|one, other| bin(one).total_cmp(&bin(other)).is_eq()) {
        if group.len() < 4 {
            kept.extend_from_slice(group);
            continue;
        }
        let extreme = |better: fn(f64, f64) -> bool| {
            (0..group.len())
                .fold(0, |best, at| if better(group[at][1], group[best][1]) { at } else { best })
        };
        let (low, high) = (extreme(|a, b| a < b), extreme(|a, b| a > b));
        let mut picked = vec![0, low.min(high), low.max(high), group.len() - 1];
        picked.dedup();
        kept.extend(picked.into_iter().map(|at| group[at]));
    }
    kept
}

#[cfg(test)]
mod tests;
