//! A page of SVG in millimetres: lines, areas, texts. Later shapes cover earlier ones.
//!
//! Texts use [`super::font`].

use std::fmt::Write;

use super::font;

mod text;

pub use text::{cut, wrapped, wrapped_at_commas};

use text::escaped;

/// A position on the page, mm from its upper left corner; y grows downwards.
pub type Position = [f64; 2];

/// Style of a line.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Stroke {
    /// Colour, as SVG writes it.
    pub colour: &'static str,
    /// Width, mm.
    pub width: f64,
    /// Lengths of dashes and gaps alternately, mm; empty for a solid line.
    pub dashes: &'static [f64],
}

impl Stroke {
    /// A solid line.
    pub const fn solid(colour: &'static str, width: f64) -> Self {
        Self { colour, width, dashes: &[] }
    }

    fn attributes(&self) -> String {
        let mut text = format!("stroke=\"{}\" stroke-width=\"{}\"", self.colour, mm(self.width));
        if !self.dashes.is_empty() {
            let dashes: Vec<String> = self.dashes.iter().map(|length| mm(*length)).collect();
            let _ = write!(text, " stroke-dasharray=\"{}\"", dashes.join(" "));
        }
        text
    }
}

/// Part of a text that lies at its position.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Anchor {
    /// Its left end.
    Start,
    /// Its middle.
    Middle,
    /// Its right end.
    End,
}

/// Style of a text.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Letters<'a> {
    /// Size, mm.
    pub size: f64,
    /// Colour.
    pub colour: &'a str,
    /// Part of the text at its position.
    pub anchor: Anchor,
    /// Clockwise turn, degrees.
    pub turn: f64,
}

impl Letters<'_> {
    /// Black text that starts at its position.
    pub const fn new(size: f64) -> Self {
        Self { size, colour: "#000000", anchor: Anchor::Start, turn: 0.0 }
    }

    /// The same style with another anchor.
    #[must_use]
    pub const fn at(self, anchor: Anchor) -> Self {
        Self { anchor, ..self }
    }
}

/// A page that is being drawn. Its size is given at the end.
#[derive(Debug, Clone, Default)]
pub struct Page {
    body: String,
    clips: usize,
}

impl Page {
    /// An empty page.
    pub fn new() -> Self {
        Self::default()
    }

    /// Adds an element: its name and geometry, then its style.
    fn add(&mut self, shape: &str, style: &str) {
        let _ = writeln!(self.body, "<{shape} {style}/>");
    }

    /// A straight line.
    pub fn line(&mut self, [a, b]: Position, [c, d]: Position, stroke: &Stroke) {
        let [a, b, c, d] = [a, b, c, d].map(mm);
        let line = format!("line x1=\"{a}\" y1=\"{b}\" x2=\"{c}\" y2=\"{d}\"");
        self.add(&line, &stroke.attributes());
    }

    /// A line through several positions; nothing for fewer than two.
    pub fn polyline(&mut self, positions: &[Position], stroke: &Stroke) {
        if positions.len() > 1 {
            let line = format!("polyline points=\"{}\" fill=\"none\"", points(positions));
            self.add(&line, &format!("stroke-linejoin=\"round\" {}", stroke.attributes()));
        }
    }

    /// A closed area.
    pub fn polygon(&mut self, positions: &[Position], fill: &str, stroke: &Stroke) {
        let area = format!("polygon points=\"{}\" fill=\"{fill}\"", points(positions));
        self.add(&area, &stroke.attributes());
    }

    /// A closed area in a colour with an opacity from 0 to 1.
    pub fn shade(&mut self, positions: &[Position], colour: &str, opacity: f64) {
        let area = format!("polygon points=\"{}\" fill=\"{colour}\"", points(positions));
        self.add(&area, &format!("fill-opacity=\"{opacity}\" stroke=\"none\""));
    }

    /// A circle.
    pub fn circle(&mut self, [x, y]: Position, radius: f64, fill: &str, stroke: &Stroke) {
        let [x, y, radius] = [x, y, radius].map(mm);
        let circle = format!("circle cx=\"{x}\" cy=\"{y}\" r=\"{radius}\" fill=\"{fill}\"");
        self.add(&circle, &stroke.attributes());
    }

    /// A filled rectangle with this upper left corner and size. Adjacent rectangles show no gap.
    pub fn fill(&mut self, corner: Position, size: [f64; 2], colour: &str) {
        let style = format!("fill=\"{colour}\" shape-rendering=\"crispEdges\"");
        self.add(&rectangle(corner, size), &style);
    }

    /// The outline of a rectangle with this upper left corner and size.
    pub fn frame(&mut self, corner: Position, size: [f64; 2], stroke: &Stroke) {
        self.add(&rectangle(corner, size), &format!("fill=\"none\" {}", stroke.attributes()));
    }

    /// Lines at 45° across a rectangle, at a distance of `gap` mm along its edges.
    pub fn hatch(&mut self, corner: Position, size: [f64; 2], gap: f64, stroke: &Stroke) {
        let [width, height] = size;
        let mut along = gap;
        while along < width + height {
            let inside = |x: f64, y: f64| [corner[0] + x, corner[1] + y];
            let from = inside(along.min(width), (along - width).max(0.0));
            let to = inside((along - height).max(0.0), along.min(height));
            self.line(from, to, stroke);
            along += gap;
        }
    }

    /// A text on one line with its baseline at `position`. Characters that XML does not allow are ignored.
    pub fn text(&mut self, position: Position, letters: &Letters<'_>, text: &str) {
        let [x, y] = position.map(mm);
        let anchor = match letters.anchor {
            Anchor::Start => "start",
            Anchor::Middle => "middle",
            Anchor::End => "end",
        };
        let rotation = match letters.turn {
            0.0 => String::new(),
            turn => format!(" transform=\"rotate({} {x} {y})\"", mm(turn)),
        };
        let _ = writeln!(
            self.body,
            "<text x=\"{x}\" y=\"{y}\" font-size=\"{}\" text-anchor=\"{anchor}\" \
             fill=\"{}\"{rotation}>{}</text>",
            mm(letters.size),
            letters.colour,
            escaped(text)
        );
    }

    /// Opens a group with this name and these attributes; [`Self::close`] ends it.
    pub fn open(&mut self, name: &str, attributes: &str) {
        let _ = writeln!(self.body, "<g id=\"{name}\" {attributes}>");
    }

    /// Opens a group that is drawn with an opacity from 0 to 1; [`Self::close`] ends it.
    pub fn fade(&mut self, opacity: f64) {
        let _ = writeln!(self.body, "<g opacity=\"{opacity}\">");
    }

    /// A filled SVG path `d` with this stroke, or that of its group.
    pub fn path(&mut self, fill: &str, stroke: Option<&str>, d: &str) {
        let stroke = stroke.map_or_else(String::new, |stroke| format!("stroke=\"{stroke}\" "));
        self.add("path", &format!("fill=\"{fill}\" {stroke}d=\"{d}\""));
    }

    /// A fill that changes linearly between two colours at two positions, by its name.
    pub fn gradient(&mut self, name: &str, ends: [Position; 2], colours: [String; 2]) -> String {
        let [[a, b], [c, d]] = ends.map(|end| end.map(mm));
        let [from, to] = colours;
        let _ = writeln!(
            self.body,
            "<linearGradient id=\"{name}\" gradientUnits=\"userSpaceOnUse\" x1=\"{a}\" y1=\"{b}\" x2=\"{c}\" \
             y2=\"{d}\"><stop stop-color=\"{from}\"/><stop offset=\"1\" stop-color=\"{to}\"/></linearGradient>"
        );
        format!("url(#{name})")
    }

    /// Ends the group of [`Self::open`], [`Self::fade`] or [`Self::clip`].
    pub fn close(&mut self) {
        self.body.push_str("</g>\n");
    }

    /// Clips the following shapes to a rectangle; [`Self::close`] ends it.
    pub fn clip(&mut self, corner: Position, size: [f64; 2]) {
        self.clips += 1;
        let _ = writeln!(
            self.body,
            "<clipPath id=\"clip{0}\"><{1}/></clipPath>\n<g clip-path=\"url(#clip{0})\">",
            self.clips,
            rectangle(corner, size)
        );
    }

    /// The SVG text on a white ground; `title` is the title for screen readers.
    pub fn finish(self, width: f64, height: f64, title: &str) -> String {
        let (width, height) = (mm(width), mm(height));
        format!(
            "<svg xmlns=\"http://www.w3.org/2000/svg\" width=\"{width}mm\" height=\"{height}mm\" \
             viewBox=\"0 0 {width} {height}\" font-family=\"{}, sans-serif\">\n\
             <title>{}</title>\n\
             <rect width=\"{width}\" height=\"{height}\" fill=\"#ffffff\"/>\n{}</svg>\n",
            font::FAMILY,
            escaped(title),
            self.body
        )
    }
}

fn rectangle([x, y]: Position, [width, height]: [f64; 2]) -> String {
    let [x, y, width, height] = [x, y, width.max(0.0), height.max(0.0)].map(mm);
    format!("rect x=\"{x}\" y=\"{y}\" width=\"{width}\" height=\"{height}\"")
}

fn points(positions: &[Position]) -> String {
    let pairs: Vec<String> =
        positions.iter().map(|[x, y]| format!("{},{}", mm(*x), mm(*y))).collect();
    pairs.join(" ")
}

/// A length with micrometre resolution, without trailing zeros.
fn mm(length: f64) -> String {
    let text = format!("{length:.3}");
    let text = text.trim_end_matches('0').trim_end_matches('.');
    if text == "-0" { "0".to_owned() } else { text.to_owned() }
}

#[cfg(test)]
mod tests {
    use proptest::prelude::*;
    use resvg::usvg::roxmltree::Document;

    use super::*;

    proptest! {
        #[test]
        fn any_text_gives_well_formed_svg(text in any::<String>()) {
            let mut page = Page::new();
            page.text([1.0, 2.0], &Letters::new(3.0), &text);
            let svg = page.finish(10.0, 10.0, &text);
            let parsed = Document::parse(&svg).unwrap();
            let shown = parsed.descendants().find(|node| node.has_tag_name("text")).unwrap();
            let printable: String = text.chars().filter(|c| !c.is_control() && !c.is_whitespace()).collect();
            let read: String =
                shown.text().unwrap_or("").chars().filter(|c| !c.is_whitespace()).collect();
            prop_assert_eq!(read, printable.replace(['\u{fffe}', '\u{ffff}'], ""));
        }
    }
}
