//! A page of SVG in millimetres: lines, areas, texts. What is drawn first lies lowest.
//!
//! Letters are those of [`super::font`]; nothing here knows what a picture shows.

use std::fmt::Write;

use super::font;

/// A place on the page, mm from its upper left corner; y grows downwards.
pub type Place = [f64; 2];

/// How a line is drawn.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Stroke {
    /// Colour, as SVG writes it.
    pub colour: &'static str,
    /// Width, mm.
    pub width: f64,
    /// Lengths of dashes and gaps in turn, mm; none for a whole line.
    pub dashes: &'static [f64],
}

impl Stroke {
    /// A whole line.
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

/// Which part of a text stands at its place.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Anchor {
    /// Its left end.
    Start,
    /// Its middle.
    Middle,
    /// Its right end.
    End,
}

/// Letters and how they are set.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Letters<'a> {
    /// Size, mm.
    pub size: f64,
    /// Colour.
    pub colour: &'a str,
    /// Which part stands at the place.
    pub anchor: Anchor,
    /// Whether it is read from below to above.
    pub upwards: bool,
}

impl Letters<'_> {
    /// Black letters that begin at their place.
    pub const fn new(size: f64) -> Self {
        Self { size, colour: "#000000", anchor: Anchor::Start, upwards: false }
    }

    /// The same, otherwise anchored.
    #[must_use]
    pub const fn at(self, anchor: Anchor) -> Self {
        Self { anchor, ..self }
    }
}

/// A page being drawn. Its size is given at the end, when it is known.
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

    /// A straight line.
    pub fn line(&mut self, from: Place, to: Place, stroke: &Stroke) {
        let _ = writeln!(
            self.body,
            "<line x1=\"{}\" y1=\"{}\" x2=\"{}\" y2=\"{}\" {}/>",
            mm(from[0]),
            mm(from[1]),
            mm(to[0]),
            mm(to[1]),
            stroke.attributes()
        );
    }

    /// A line through several places; nothing for fewer than two.
    pub fn polyline(&mut self, places: &[Place], stroke: &Stroke) {
        if places.len() > 1 {
            let _ = writeln!(
                self.body,
                "<polyline points=\"{}\" fill=\"none\" stroke-linejoin=\"round\" {}/>",
                points(places),
                stroke.attributes()
            );
        }
    }

    /// A closed area.
    pub fn polygon(&mut self, places: &[Place], fill: &str, stroke: &Stroke) {
        let _ = writeln!(
            self.body,
            "<polygon points=\"{}\" fill=\"{fill}\" {}/>",
            points(places),
            stroke.attributes()
        );
    }

    /// A circle.
    pub fn circle(&mut self, centre: Place, radius: f64, fill: &str, stroke: &Stroke) {
        let _ = writeln!(
            self.body,
            "<circle cx=\"{}\" cy=\"{}\" r=\"{}\" fill=\"{fill}\" {}/>",
            mm(centre[0]),
            mm(centre[1]),
            mm(radius),
            stroke.attributes()
        );
    }

    /// A filled rectangle: its upper left corner, its size. Neighbours meet without a seam.
    pub fn fill(&mut self, corner: Place, size: [f64; 2], colour: &str) {
        let _ = writeln!(
            self.body,
            "<rect {} fill=\"{colour}\" shape-rendering=\"crispEdges\"/>",
            rectangle(corner, size)
        );
    }

    /// The outline of a rectangle: its upper left corner, its size.
    pub fn frame(&mut self, corner: Place, size: [f64; 2], stroke: &Stroke) {
        let _ = writeln!(
            self.body,
            "<rect {} fill=\"none\" {}/>",
            rectangle(corner, size),
            stroke.attributes()
        );
    }

    /// Lines at 45° across a rectangle, `gap` mm from one another along its edges.
    pub fn hatch(&mut self, corner: Place, size: [f64; 2], gap: f64, stroke: &Stroke) {
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

    /// A text on one line, its baseline at `place`. Characters that no XML holds are left out.
    pub fn text(&mut self, place: Place, letters: &Letters<'_>, text: &str) {
        let [x, y] = place.map(mm);
        let anchor = match letters.anchor {
            Anchor::Start => "start",
            Anchor::Middle => "middle",
            Anchor::End => "end",
        };
        let turned = if letters.upwards {
            format!(" transform=\"rotate(-90 {x} {y})\"")
        } else {
            String::new()
        };
        let _ = writeln!(
            self.body,
            "<text x=\"{x}\" y=\"{y}\" font-size=\"{}\" text-anchor=\"{anchor}\" \
             fill=\"{}\"{turned}>{}</text>",
            mm(letters.size),
            letters.colour,
            escaped(text)
        );
    }

    /// Opens a group of this name whose members share `attributes`, until [`Self::close`].
    pub fn open(&mut self, name: &str, attributes: &str) {
        let _ = writeln!(self.body, "<g id=\"{name}\" {attributes}>");
    }

    /// A filled path with the stroke of its group; `d` says it as SVG does.
    pub fn path(&mut self, fill: &str, d: &str) {
        let _ = writeln!(self.body, "<path fill=\"{fill}\" d=\"{d}\"/>");
    }

    /// Ends what [`Self::open`] began.
    pub fn close(&mut self) {
        self.body.push_str("</g>\n");
    }

    /// Draws only what lies in a rectangle, until [`Self::unclip`].
    pub fn clip(&mut self, corner: Place, size: [f64; 2]) {
        self.clips += 1;
        let _ = writeln!(
            self.body,
            "<clipPath id=\"clip{0}\"><rect {1}/></clipPath>\n<g clip-path=\"url(#clip{0})\">",
            self.clips,
            rectangle(corner, size)
        );
    }

    /// Ends what [`Self::clip`] began.
    pub fn unclip(&mut self) {
        self.body.push_str("</g>\n");
    }

    /// The SVG text, white behind; `title` is what a reader that cannot see it is told.
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

/// Breaks a text into lines no wider than `width`, at its spaces; a longer word stands alone.
pub fn wrapped(text: &str, size: f64, width: f64) -> Vec<String> {
    let mut lines: Vec<String> = Vec::new();
    for word in text.split_whitespace() {
        match lines.last_mut() {
            Some(line) if font::width(&format!("{line} {word}"), size) <= width => {
                line.push(' ');
                line.push_str(word);
            }
            _ => lines.push(word.to_owned()),
        }
    }
    lines
}

/// A text cut to a width, with an ellipsis where something is lost.
pub fn cut(text: &str, size: f64, width: f64) -> String {
    if font::width(text, size) <= width {
        return text.to_owned();
    }
    let mut kept: Vec<char> = text.chars().collect();
    loop {
        kept.pop();
        let shorter = format!("{}…", kept.iter().collect::<String>().trim_end());
        if kept.is_empty() || font::width(&shorter, size) <= width {
            return shorter;
        }
    }
}

fn rectangle([x, y]: Place, [width, height]: [f64; 2]) -> String {
    format!(
        "x=\"{}\" y=\"{}\" width=\"{}\" height=\"{}\"",
        mm(x),
        mm(y),
        mm(width.max(0.0)),
        mm(height.max(0.0))
    )
}

fn points(places: &[Place]) -> String {
    let pairs: Vec<String> = places.iter().map(|[x, y]| format!("{},{}", mm(*x), mm(*y))).collect();
    pairs.join(" ")
}

/// Micrometres are enough for any printer.
fn mm(length: f64) -> String {
    let text = format!("{length:.3}");
    let text = text.trim_end_matches('0').trim_end_matches('.');
    if text == "-0" { "0".to_owned() } else { text.to_owned() }
}

fn escaped(text: &str) -> String {
    let mut safe = String::with_capacity(text.len());
    for letter in text.chars() {
        match letter {
            '&' => safe.push_str("&amp;"),
            '<' => safe.push_str("&lt;"),
            '>' => safe.push_str("&gt;"),
            '"' => safe.push_str("&quot;"),
            '\t' | '\n' | '\r' => safe.push(' '),
            '\u{fffe}' | '\u{ffff}' => {}
            letter if letter.is_control() => {}
            letter => safe.push(letter),
        }
    }
    safe
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

        #[test]
        fn wrapped_lines_are_narrow_and_lose_nothing(
            words in prop::collection::vec("[a-z]{1,12}", 1..30), width in 20.0..60.0,
        ) {
            let text = words.join(" ");
            let lines = wrapped(&text, 3.0, width);
            prop_assert_eq!(lines.join(" "), text);
            for line in &lines {
                prop_assert!(!line.contains(' ') || font::width(line, 3.0) <= width);
            }
        }

        #[test]
        fn a_cut_text_fits(text in "[ -~]{0,60}", width in 5.0..80.0) {
            let shorter = cut(&text, 3.0, width);
            prop_assert!(font::width(&shorter, 3.0) <= width);
            prop_assert!(shorter == text || shorter.ends_with('…'));
        }

        #[test]
        fn a_hatch_stays_inside(width in 1.0..40.0, height in 1.0..40.0, gap in 0.5..5.0) {
            let mut page = Page::new();
            page.hatch([2.0, 3.0], [width, height], gap, &Stroke::solid("#000000", 0.1));
            let svg = page.finish(50.0, 50.0, "");
            let parsed = Document::parse(&svg).unwrap();
            for line in parsed.descendants().filter(|node| node.has_tag_name("line")) {
                let at = |name: &str| line.attribute(name).unwrap().parse::<f64>().unwrap();
                for x in [at("x1"), at("x2")] {
                    prop_assert!((1.999..=width + 2.001).contains(&x));
                }
                for y in [at("y1"), at("y2")] {
                    prop_assert!((2.999..=height + 3.001).contains(&y));
                }
            }
        }
    }
}
