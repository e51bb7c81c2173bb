//! Shapes of one run side by side, as SVG: the same view and scale in every panel, the sampled values below
//! it, one scale bar, one legend or colour bar.
//!
//! The colours are suitable for colour-blind readers. In grey, neighbouring storeys differ in brightness,
//! and the three states of the film differ more than the shading of one state. A quantity has the colours of
//! viridis, whose lightness increases evenly, with little shading.

use billow_solver::mechanics::material::Regime;
use billow_solver::output::frames::Frame;

use self::layout::Layout;
use super::figure::style;
use super::font;
use super::page::{self, Anchor, Letters, Page, Position, Stroke};
use super::projection::{Facet, View};

mod bar;
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

/// Colours of storeys, repeated: neighbours differ in hue and brightness (Okabe and Ito).
const STOREYS: [[u8; 3]; 7] = [
    [0x00, 0x72, 0xb2],
    [0xe6, 0x9f, 0x00],
    [0x00, 0x9e, 0x73],
    [0xf0, 0xe4, 0x42],
    [0xd5, 0x5e, 0x00],
    [0x56, 0xb4, 0xe9],
    [0xcc, 0x79, 0xa7],
];
/// Colour of both caps.
const CAPS: [u8; 3] = [0xd9, 0xd9, 0xd9];
/// Colour of film without storeys.
const PLAIN: [u8; 3] = [0xc2, 0xd2, 0xe0];
/// States of the film, from bright to dark.
const REGIMES: [(Regime, &str, [u8; 3]); 3] = [
    (Regime::Taut, "taut", [0xfd, 0xe7, 0x8c]),
    (Regime::Wrinkled, "wrinkled", [0x3d, 0x9f, 0xb5]),
    (Regime::Slack, "slack", [0x3f, 0x1f, 0x63]),
];

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
    /// Texts below each shape, one list of lines per frame: its time and sampled values.
    pub values: &'a [Vec<String>],
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
}

impl Filmstrip<'_> {
    /// The SVG text.
    pub fn svg(&self) -> String {
        let layout = Layout::of(self);
        let legend = self.legend();
        let below = LINE * layout.lines_below(&legend) as f64;
        let bar = if matches!(self.colour, Colour::Quantity(_)) { bar::HEIGHT } else { 0.0 };
        let notes: Vec<String> = self
            .notes
            .iter()
            .flat_map(|note| page::wrapped(note, LETTER, WIDTH - 2.0 * MARGIN))
            .collect();
        let height = layout.bottom() + below + bar + LINE * notes.len() as f64 + MARGIN;
        let mut page = Page::new();
        let title = page::cut(self.title, LETTER, WIDTH - 2.0 * MARGIN);
        page.text([MARGIN, MARGIN + LETTER], &Letters::new(LETTER), &title);
        for (number, frame) in self.frames.iter().enumerate() {
            self.panel(&mut page, &layout, number, frame);
            let [x, y] = layout.corner(number);
            let letters = Letters::new(LETTER).at(Anchor::Middle);
            for (line, text) in self.values.get(number).into_iter().flatten().enumerate() {
                let under = [x + 0.5 * layout.width, y + 1.3 * LETTER + line as f64 * VALUE_LINE];
                page.text(under, &letters, &page::cut(text, LETTER, layout.cell()));
            }
        }
        let baseline = layout.bottom() + LETTER;
        layout.scale_bar(&mut page, [MARGIN, baseline]);
        draw_legend(&mut page, &legend, [MARGIN + layout.bar_width(), baseline]);
        if let Colour::Quantity(quantity) = &self.colour {
            bar::draw(&mut page, quantity, [MARGIN + layout.bar_width(), baseline - LETTER]);
        }
        let grey = Letters { colour: "#444444", ..Letters::new(LETTER) };
        for (number, note) in notes.iter().enumerate() {
            let y = layout.bottom() + below + bar + LETTER + LINE * number as f64;
            page.text([MARGIN, y], &grey, note);
        }
        page.finish(WIDTH, height, self.title)
    }

    /// Draws one shape. The lines between elements are thinner if there are many elements.
    fn panel(&self, page: &mut Page, layout: &Layout, number: usize, frame: &Frame) {
        let facets = self.view.facets(self.triangles, frame);
        let line = (6.0 / (facets.len() as f64).sqrt()).clamp(0.03, 0.12);
        // Black edges are not visible on the dark end of viridis.
        let edge = if matches!(self.colour, Colour::Quantity(_)) { "#c0c0c0" } else { "#000000" };
        page.open(
            &format!("frame{number}"),
            &format!(
                "stroke=\"{edge}\" stroke-opacity=\"0.35\" stroke-width=\"{line:.3}\" \
                 stroke-linejoin=\"round\""
            ),
        );
        for facet in &facets {
            // Whole hundredths of a millimetre, relative to the previous corner: short, without
            // accumulated error.
            let corners =
                facet.corners.map(|corner| layout.page(number, corner).map(|mm| 100.0 * mm));
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
            page.path(&hexadecimal(self.fill(facet, number, frame)), &d);
        }
        page.close();
    }

    #[expect(
        clippy::cast_possible_truncation,
        clippy::cast_sign_loss,
        reason = "a colour between 0 and 255"
    )]
    fn fill(&self, facet: &Facet, number: usize, frame: &Frame) -> [u8; 3] {
        let (colour, dark) = match &self.colour {
            Colour::Plain => (PLAIN, 0.4),
            Colour::Storey => (self.storey_colour(self.storeys[facet.element]), 0.45),
            // The brightness shows the state; the shading is weak.
            Colour::Regime => {
                let regime = frame.regimes[facet.element];
                let known = REGIMES.iter().find(|(known, ..)| *known == regime);
                (known.map_or(PLAIN, |(.., colour)| *colour), 0.75)
            }
            // Shading would change the value that a colour shows, so it is weak, and equal on both sides.
            Colour::Quantity(quantity) => {
                (style::map_rgb(quantity.fraction(number, facet.element)), 0.85)
            }
        };
        let one_sided = !matches!(self.colour, Colour::Quantity(_)) && !facet.outside;
        let side = if one_sided { INSIDE_BRIGHTNESS } else { 1.0 };
        let bright = side * (dark + (1.0 - dark) * facet.light);
        colour.map(|part| (f64::from(part) * bright).round() as u8)
    }

    /// Storey number of the top cap: one more than the last storey.
    fn top_cap(&self) -> u32 {
        self.storeys.iter().copied().max().unwrap_or(0)
    }

    fn storey_colour(&self, storey: u32) -> [u8; 3] {
        if storey == 0 || storey == self.top_cap() {
            return CAPS;
        }
        STOREYS[(storey as usize - 1) % STOREYS.len()]
    }

    /// Names and colours of the legend.
    fn legend(&self) -> Vec<(String, [u8; 3])> {
        match self.colour {
            Colour::Plain | Colour::Quantity(_) => Vec::new(),
            Colour::Regime => {
                REGIMES.iter().map(|(_, name, colour)| ((*name).to_owned(), *colour)).collect()
            }
            Colour::Storey => {
                let storeys = self.top_cap().saturating_sub(1);
                // When the colours repeat, one entry stands for all storeys with its colour.
                let colours = u32::try_from(STOREYS.len()).unwrap_or(u32::MAX);
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
                let mut legend: Vec<_> = (1..=storeys.min(colours)).map(name).collect();
                legend.push(("caps".to_owned(), CAPS));
                legend
            }
        }
    }
}

/// Draws a legend, on as many lines as it needs, from `position` on.
fn draw_legend(page: &mut Page, legend: &[(String, [u8; 3])], position: Position) {
    let mut position = position;
    for (name, colour) in legend {
        let width = 1.6 * LETTER + font::width(name, LETTER);
        if position[0] + width > WIDTH - MARGIN {
            position = [MARGIN, position[1] + LINE];
        }
        let [x, y] = position;
        let (corner, size) = ([x, y - 0.9 * LETTER], [1.2 * LETTER, LETTER]);
        page.fill(corner, size, &hexadecimal(*colour));
        page.frame(corner, size, &Stroke::solid("#000000", 0.12));
        page.text([x + 1.6 * LETTER, y], &Letters::new(LETTER), name);
        position[0] += width + LETTER;
    }
}

fn hexadecimal([r, g, b]: [u8; 3]) -> String {
    format!("#{r:02x}{g:02x}{b:02x}")
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
