//! Shapes of one run side by side, as SVG: the same view and scale in every panel, the sampled values below
//! it, one scale bar, one legend or colour bar.
//!
//! The colours are suitable for colour-blind readers. In grey, neighbouring storeys differ in brightness,
//! and the three states of the film differ more than the shading of one state. A quantity has the colours of
//! viridis, whose lightness increases evenly, with little shading.

use std::ops::Range;

use billow_solver::mechanics::material::Regime;
use billow_solver::output::frames::Frame;

use self::layout::Layout;
use super::figure::legend::{Legend, Sample};
use super::figure::map::{Cell, Ground};
use super::figure::{style, ticks};
use super::page::{self, Anchor, Letters, Page, Position, Stroke};
use super::projection::{Facet, View};

mod layout;

/// Width of the page, mm: across an A4 page with its margins.
const WIDTH: f64 = 180.0;
/// Largest height of all rows together, mm.
const MAX_HEIGHT: f64 = 110.0;
/// Margin of the page and space between panels, mm.
const MARGIN: f64 = 4.0;
/// Size of texts, mm.
const LETTER: f64 = 2.8;
/// Height of a line of text, mm.
const LINE: f64 = 1.7 * LETTER;
/// Distance of the lines of values below a shape, mm.
const VALUE_LINE: f64 = 1.35 * LETTER;
/// Brightness of the inside of the film over that of its outside.
const INSIDE_BRIGHTNESS: f64 = 0.72;

/// Smallest change of brightness that a smooth element shows. Chosen: one step of its colour.
const MIN_LIGHT_CHANGE: f64 = 1.0 / 256.0;

/// Colours of storeys, repeated: neighbours differ in hue and brightness (Okabe and Ito).
const STOREYS: [&str; 7] =
    ["#0072b2", "#e69f00", "#009e73", "#f0e442", "#d55e00", "#56b4e9", "#cc79a7"];
/// Colour of both caps.
const CAPS: &str = "#d9d9d9";
/// Colour of film without storeys.
const PLAIN: &str = "#c2d2e0";
/// States of the film, from bright to dark.
const REGIMES: [(Regime, &str, &str); 3] = [
    (Regime::Taut, "taut", "#fde78c"),
    (Regime::Wrinkled, "wrinkled", "#3d9fb5"),
    (Regime::Slack, "slack", "#3f1f63"),
];
/// Lines of the cross of a mark.
const MARK: Stroke = Stroke::solid("#d55e00", 0.6);
/// Size of the cross of a mark, mm.
const MARK_SIZE: f64 = 2.2;
/// Size of the colour bar of a quantity, mm.
const BAR: [f64; 2] = [70.0, 3.2];

/// Meaning of the colours.
#[derive(Debug, Clone, PartialEq)]
pub enum Colour {
    /// The storey of a capsule.
    Storey,
    /// The state of the film: taut, wrinkled, slack.
    Regime,
    /// One colour.
    Plain,
    /// A quantity of the elements.
    Quantity(Quantity),
}

/// A quantity that the colours show, on one scale in all panels.
#[derive(Debug, Clone, PartialEq)]
pub struct Quantity {
    /// Name and unit, as "speed (m/s)".
    pub label: String,
    /// Values of each element, one list per frame, in the unit of the label.
    pub values: Vec<Vec<f64>>,
    /// Values at both ends of the scale, low < high. Values beyond have the colours of the ends.
    pub range: [f64; 2],
}

/// A filmstrip to draw.
#[derive(Debug)]
pub struct Filmstrip<'a> {
    /// Title, cut if it is wider than the page.
    pub title: &'a str,
    /// Nodes of each element, counter-clockwise seen from outside.
    pub triangles: &'a [[u32; 3]],
    /// Storey of each element, as [`billow_solver::output::frames::Frames::storeys`].
    pub storeys: &'a [u32],
    /// Shapes, in the order in which they are shown: 1 to 64.
    pub frames: &'a [Frame],
    /// Direction of view.
    pub view: View,
    /// Meaning of the colours.
    pub colour: Colour,
    /// Whether the brightness is linear in each element and the mesh has no lines.
    pub smooth: bool,
    /// Texts below each shape, one list of lines per frame: its time and sampled values.
    pub values: &'a [Vec<String>],
    /// Places that crosses with their numbers, from 1, mark on every shape.
    pub marks: &'a [[f32; 3]],
    /// Lines of text at the end of the picture.
    pub notes: &'a [String],
}

impl Quantity {
    /// Position of the value of an element on the scale, 0 to 1.
    fn fraction(&self, frame: usize, element: usize) -> f64 {
        let [low, high] = self.range;
        let value = self.values.get(frame).and_then(|values| values.get(element)).copied();
        ((value.unwrap_or(low) - low) / (high - low)).clamp(0.0, 1.0)
    }

    /// Draws the scale with its upper left corner at `corner`. Returns its height, mm.
    fn draw_bar(&self, page: &mut Page, corner: Position) -> f64 {
        let [low, high] = self.range;
        style::colour_bar(page, corner, BAR);
        let below = corner[1] + BAR[1];
        let letters = Letters::new(LETTER).at(Anchor::Middle);
        for (value, text) in ticks::linear(low, high, 6) {
            let x = corner[0] + BAR[0] * (value - low) / (high - low);
            page.line([x, below], [x, below + 0.8], &style::AXIS);
            page.text([x, below + VALUE_LINE], &letters, &text);
        }
        page.text([corner[0], below + 2.0 * VALUE_LINE], &Letters::new(LETTER), &self.label);
        BAR[1] + 2.0 * VALUE_LINE + 1.5
    }
}

impl Filmstrip<'_> {
    /// The SVG text.
    pub fn svg(&self) -> String {
        self.drawn(&Layout::of(self, self.frames.len()), 0..self.frames.len())
    }

    /// One picture for each frame, all of one size and scale.
    pub fn pictures(&self) -> impl Iterator<Item = String> {
        let layout = Layout::of(self, 1);
        (0..self.frames.len()).map(move |number| self.drawn(&layout, number..number + 1))
    }

    /// A page with these frames.
    fn drawn(&self, layout: &Layout, numbers: Range<usize>) -> String {
        let mut page = Page::new();
        let title = page::cut(self.title, LETTER, WIDTH - 2.0 * MARGIN);
        page.text([MARGIN, MARGIN + LETTER], &Letters::new(LETTER), &title);
        let middle = Letters::new(LETTER).at(Anchor::Middle);
        for (at, number) in numbers.enumerate() {
            self.panel(&mut page, layout, at, number);
            let [x, y] = layout.corner(at);
            for (line, text) in self.values.get(number).into_iter().flatten().enumerate() {
                let under = [x + 0.5 * layout.width, y + 1.3 * LETTER + line as f64 * VALUE_LINE];
                page.text(under, &middle, &page::cut(text, LETTER, layout.cell()));
            }
        }
        let mut y = layout.bottom();
        let beside = layout.scale_bar(&mut page, [MARGIN, y + LETTER]);
        y += match &self.colour {
            Colour::Quantity(quantity) => quantity.draw_bar(&mut page, [beside, y]),
            _ => self.legend().draw(&mut page, [beside, y - 1.0], WIDTH - MARGIN - beside),
        }
        .max(LINE);
        let grey = Letters { colour: style::GREY, ..Letters::new(LETTER) };
        let width = WIDTH - 2.0 * MARGIN;
        for note in self.notes.iter().flat_map(|note| page::wrapped(note, LETTER, width)) {
            page.text([MARGIN, y + LETTER], &grey, &note);
            y += LINE;
        }
        page.finish(WIDTH, y + MARGIN, self.title)
    }

    /// Draws the shape of a frame in a panel. The lines between elements are thinner if there are many elements.
    fn panel(&self, page: &mut Page, layout: &Layout, at: usize, number: usize) {
        let frame = &self.frames[number];
        let facets = self.view.facets(self.triangles, frame, self.smooth);
        let line = (6.0 / (facets.len() as f64).sqrt()).clamp(0.03, 0.12);
        // Black edges are not visible on the dark end of viridis.
        let edge = if matches!(self.colour, Colour::Quantity(_)) { "#c0c0c0" } else { "#000000" };
        let opacity = if self.smooth { 1.0 } else { 0.35 };
        page.open(
            &format!("frame{number}"),
            &format!(
                "stroke=\"{edge}\" stroke-opacity=\"{opacity}\" stroke-width=\"{line:.3}\" \
                 stroke-linejoin=\"round\""
            ),
        );
        for (index, facet) in facets.iter().enumerate() {
            // Whole hundredths of a millimetre, relative to the previous corner: short, without
            // accumulated error.
            let corners = facet.corners.map(|corner| layout.page(at, corner).map(|mm| 100.0 * mm));
            let [a, b, c] = corners.map(|corner| corner.map(f64::round));
            let d = format!(
                "M{},{}l{},{} {},{}z",
                short(a[0]),
                short(a[1]),
                short(b[0] - a[0]),
                short(b[1] - a[1]),
                short(c[0] - b[0]),
                short(c[1] - b[1]),
            );
            let colour = |light: f64| {
                let [r, g, b] = self.fill(facet, light, number, frame);
                format!("#{r:02x}{g:02x}{b:02x}")
            };
            if !self.smooth {
                page.path(&colour(facet.lights[0]), None, &d);
                continue;
            }
            let corners = facet.corners.map(|corner| layout.page(at, corner));
            let name = format!("light{number}_{index}");
            let fill = match gradient(corners, facet.lights) {
                None => colour(facet.lights[0]),
                Some((ends, lights)) => page.gradient(&name, ends, lights.map(colour)),
            };
            // A stroke of the same colour closes the gaps between elements.
            page.path(&fill, Some(&fill), &d);
        }
        page.close();
        for (mark, place) in self.marks.iter().enumerate() {
            let [x, y] = layout.page(at, self.view.project(*place));
            style::cross(page, [x, y], &MARK, MARK_SIZE);
            let letters = Letters { colour: MARK.colour, ..Letters::new(LETTER) };
            page.text([x + MARK_SIZE, y - 0.5 * LETTER], &letters, &(mark + 1).to_string());
        }
    }

    #[expect(
        clippy::cast_possible_truncation,
        clippy::cast_sign_loss,
        reason = "a colour between 0 and 255"
    )]
    fn fill(&self, facet: &Facet, light: f64, number: usize, frame: &Frame) -> [u8; 3] {
        let (colour, dark) = match &self.colour {
            Colour::Plain => (rgb(PLAIN), 0.4),
            Colour::Storey => (rgb(self.storey_colour(self.storeys[facet.element])), 0.45),
            // The brightness shows the state; the shading is weak.
            Colour::Regime => {
                let regime = frame.regimes[facet.element];
                let known = REGIMES.iter().find(|(known, ..)| *known == regime);
                (rgb(known.map_or(PLAIN, |(.., colour)| colour)), 0.75)
            }
            // Shading would change the value that a colour shows, so it is weak, and equal on both sides.
            Colour::Quantity(quantity) => {
                (style::map_rgb(quantity.fraction(number, facet.element)), 0.85)
            }
        };
        let one_sided = !matches!(self.colour, Colour::Quantity(_)) && !facet.outside;
        let side = if one_sided { INSIDE_BRIGHTNESS } else { 1.0 };
        let bright = side * (dark + (1.0 - dark) * light);
        colour.map(|part| (f64::from(part) * bright).round() as u8)
    }

    /// Storey number of the top cap: one more than the last storey.
    fn top_cap(&self) -> u32 {
        self.storeys.iter().copied().max().unwrap_or(0)
    }

    fn storey_colour(&self, storey: u32) -> &'static str {
        if storey == 0 || storey == self.top_cap() {
            return CAPS;
        }
        STOREYS[(storey as usize - 1) % STOREYS.len()]
    }

    /// The names of the colours.
    fn legend(&self) -> Legend {
        let entries: Vec<(String, &'static str)> = match self.colour {
            Colour::Plain | Colour::Quantity(_) => Vec::new(),
            Colour::Regime => {
                REGIMES.iter().map(|(_, name, colour)| ((*name).to_owned(), *colour)).collect()
            }
            Colour::Storey => {
                let storeys = self.top_cap().saturating_sub(1);
                // When the colours repeat, one entry stands for all storeys with its colour.
                let name = |first: u32| {
                    let all: Vec<String> = (first..=storeys)
                        .step_by(STOREYS.len())
                        .map(|storey| storey.to_string())
                        .collect();
                    let all = match all.as_slice() {
                        [a, b, c, .., last] => format!("{a}, {b}, {c} … {last}"),
                        few => few.join(", "),
                    };
                    (format!("storey {all}"), self.storey_colour(first))
                };
                let names = (1..=storeys).take(STOREYS.len()).map(name);
                names.chain([("caps".to_owned(), CAPS)]).collect()
            }
        };
        let entry = |(name, colour): (String, &'static str)| {
            let ground = Ground::Colour(colour, "#000000");
            (Sample::Cell(Cell { ground, ..Cell::default() }), name)
        };
        Legend { heading: String::new(), entries: entries.into_iter().map(entry).collect() }
    }
}

/// Two positions and the brightness there, between which it is linear, from that at the corners of an element. `None`
/// where it hardly varies.
fn gradient(corners: [Position; 3], lights: [f64; 3]) -> Option<([Position; 2], [f64; 2])> {
    let [u, v] = [1, 2].map(|k| [corners[k][0] - corners[0][0], corners[k][1] - corners[0][1]]);
    let [a, b] = [lights[1] - lights[0], lights[2] - lights[0]];
    let determinant = u[0] * v[1] - u[1] * v[0];
    let slope = [(a * v[1] - b * u[1]) / determinant, (u[0] * b - v[0] * a) / determinant];
    let square = slope[0] * slope[0] + slope[1] * slope[1];
    let [low, high] = [f64::min, f64::max].map(|of| lights.into_iter().fold(lights[0], of));
    let place =
        |light: f64| [0, 1].map(|k| corners[0][k] + (light - lights[0]) * slope[k] / square);
    (high - low > MIN_LIGHT_CHANGE && square.is_finite())
        .then(|| ([place(low), place(high)], [low, high]))
}

/// The channels of a colour as `#0072b2`.
fn rgb(colour: &str) -> [u8; 3] {
    [1, 3, 5].map(|at| u8::from_str_radix(&colour[at..at + 2], 16).unwrap_or(0))
}

/// Hundredths of a millimetre as millimetres, in as few characters as possible.
fn short(hundredths: f64) -> String {
    let text = format!("{:.2}", hundredths / 100.0);
    let text = text.trim_end_matches('0').trim_end_matches('.');
    match text {
        "-0" => "0".to_owned(),
        text => {
            text.replacen("0.", ".", usize::from(text.starts_with("0.") || text.starts_with("-0.")))
        }
    }
}

#[cfg(test)]
mod tests;
