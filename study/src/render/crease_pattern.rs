//! The crease pattern as a drawing to cut and fold: SVG in millimetres, scale 1:1.
//!
//! Each type of line is a layer (an SVG group), so that a cutter can use `cut` alone: `cut` is solid,
//! `mountain` dash-dotted, `valley` dashed, `glue_flaps` thin; `dimensions` and `notes` are for the reader.
//! The colours are suitable for colour-blind readers and in grey; the dashes also distinguish the lines.

use billow_solver::geometry::fold::{Assignment, Corner, FoldPattern};
use billow_solver::geometry::mesh_io::obj::Sheet;
use nalgebra::Vector2;

use super::page::{Anchor, Letters, Page, Position};

/// Millimetres per metre.
const MM: f64 = 1e3;
/// Colour of texts.
const INK: &str = "#333333";

/// Draws a pattern, seen from outside. `flap` is the width of the glue flaps, m: one flap along the right
/// side of the seam, and one along every edge of both caps.
pub fn svg(pattern: &FoldPattern, flap: Option<f64>) -> String {
    Drawing::new(pattern, flap.map(|width| width * MM)).draw()
}

/// The lines of a pattern alone, each with its colour as Origami Simulator reads it: mountains red, valleys blue, edges
/// black (A. Ghassaei, its `pattern.js`).
pub fn for_origami_simulator(pattern: &FoldPattern) -> String {
    let mut drawing = Drawing::new(pattern, None);
    for (name, colour, assignment) in [
        ("cut", "#000000", Assignment::Boundary),
        ("mountain", "#ff0000", Assignment::Mountain),
        ("valley", "#0000ff", Assignment::Valley),
    ] {
        drawing.layer(name, colour, 0.03 * drawing.letter, "none");
        drawing.stroke = Some(colour);
        drawing.lines(assignment);
        drawing.page.close();
    }
    let title = drawing.title();
    drawing.page.finish(drawing.size.x, drawing.size.y, &title)
}

struct Drawing<'a> {
    pattern: &'a FoldPattern,
    /// The developed film, mm.
    sheet: Sheet,
    /// Width of the glue flaps, mm.
    flap: Option<f64>,
    /// Upper left corner of the page in sheet coordinates (y up), mm.
    origin: Vector2<f64>,
    size: Vector2<f64>,
    /// Size of the texts, mm: proportional to the sheet.
    letter: f64,
    /// Colour of each line, where it is not that of its layer alone.
    stroke: Option<&'static str>,
    page: Page,
}

/// Lower and upper corner of the bounds of some positions.
fn bounds<'a>(positions: impl Iterator<Item = &'a Vector2<f64>>) -> [Vector2<f64>; 2] {
    let start = [f64::INFINITY, f64::NEG_INFINITY].map(Vector2::repeat);
    positions.fold(start, |[low, high], position| [low.inf(position), high.sup(position)])
}

impl<'a> Drawing<'a> {
    fn new(pattern: &'a FoldPattern, flap: Option<f64>) -> Self {
        let mut sheet = Sheet::new(pattern);
        let [bottom_cap, top_cap] = &mut sheet.caps;
        for position in sheet.corners.iter_mut().chain(bottom_cap).chain(top_cap) {
            *position *= MM;
        }
        let [low, high] = bounds(sheet.corners.iter().chain(sheet.caps.iter().flatten()));
        let letter = 0.016 * (high.y - low.y).max(0.3 * (high.x - low.x));
        let margin = flap.unwrap_or(0.0) + 6.0 * letter;
        let below = 7.0 * letter;
        let origin = Vector2::new(low.x - margin, high.y + margin);
        let size = high - low + Vector2::new(2.0 * margin, 2.0 * margin + below);
        Self { pattern, sheet, flap, origin, size, letter, stroke: None, page: Page::new() }
    }

    fn draw(mut self) -> String {
        let line = (0.03 * self.letter).max(0.1);
        let dash = self.letter * 0.6;
        let dots = format!("{dash:.2} {:.2} {:.2} {:.2}", 0.4 * dash, 0.1 * dash, 0.4 * dash);
        let dashes = format!("{:.2} {:.2}", 0.7 * dash, 0.5 * dash);
        for (name, colour, width, dashes, assignment) in [
            ("cut", "#000000", 1.5 * line, "none", Assignment::Boundary),
            ("mountain", "#d55e00", line, &dots, Assignment::Mountain),
            ("valley", "#0072b2", line, &dashes, Assignment::Valley),
        ] {
            self.layer(name, colour, width, dashes);
            self.lines(assignment);
            self.page.close();
        }
        if let Some(width) = self.flap {
            self.layer("glue_flaps", "#666666", line, "none");
            self.flaps(width);
            self.page.close();
        }
        let [low, high] = bounds(self.sheet.corners.iter());
        let outside = low.add_scalar(-1.5 * self.letter);
        let sides = [
            [Vector2::new(low.x, outside.y), Vector2::new(high.x, outside.y)],
            [Vector2::new(outside.x, low.y), Vector2::new(outside.x, high.y)],
        ];
        self.layer("dimensions", INK, 0.7 * line, "none");
        for side in &sides {
            self.path(side, "");
        }
        self.page.close();
        self.page.open("notes", "");
        for side in sides {
            self.label(side);
        }
        self.lengths();
        self.notes();
        self.page.close();
        let title = self.title();
        self.page.finish(self.size.x, self.size.y, &title)
    }

    /// The lines of one kind.
    fn lines(&mut self, assignment: Assignment) {
        let creases = self.pattern.creases().into_iter();
        for crease in creases.filter(|crease| crease.assignment == assignment) {
            self.path(&crease.ends.map(|end| self.corner(end)), "");
        }
        if assignment == Assignment::Boundary {
            self.sheet.caps.clone().iter().for_each(|cap| self.path(cap, "z"));
        }
    }

    /// Opens a layer of lines.
    fn layer(&mut self, name: &str, colour: &str, width: f64, dashes: &str) {
        let style = format!("stroke=\"{colour}\" stroke-width=\"{width:.3}\"");
        self.page.open(name, &format!("{style} stroke-dasharray=\"{dashes}\""));
    }

    fn title(&self) -> String {
        let design = &self.pattern.design;
        format!("Crease pattern, N {} panels, M {} storeys", design.panels, design.storeys)
    }

    /// Page coordinates, y down.
    fn place(&self, position: Vector2<f64>) -> Position {
        [position.x - self.origin.x, self.origin.y - position.y]
    }

    fn corner(&self, corner: Corner) -> Vector2<f64> {
        let across = self.pattern.design.panels + 1;
        self.sheet.corners[(corner.ring * across + corner.corner) as usize]
    }

    /// A line through some positions; `end` is `z` for a closed one.
    fn path(&mut self, positions: &[Vector2<f64>], end: &str) {
        let places = positions.iter().map(|position| self.place(*position));
        let places: Vec<String> = places.map(|[x, y]| format!("{x:.4},{y:.4}")).collect();
        self.page.path("none", self.stroke, &format!("M{}{end}", places.join(" ")));
    }

    fn flaps(&mut self, width: f64) {
        let design = &self.pattern.design;
        let corner = |ring| self.corner(Corner { ring, corner: design.panels });
        let mut edges: Vec<_> =
            (0..design.storeys).map(|ring| [ring, ring + 1].map(corner)).collect();
        for cap in &self.sheet.caps {
            edges.extend((0..cap.len()).map(|i| [cap[i], cap[(i + 1) % cap.len()]]));
        }
        // A trapezium on the right-hand side of an edge. Its ends are cut at 45°, so that adjacent flaps
        // do not overlap.
        for [from, to] in edges {
            let along = (to - from).normalize();
            let outward = Vector2::new(along.y, -along.x);
            let width = width.min(0.4 * (to - from).norm());
            let tip = [from + (along + outward) * width, to + (outward - along) * width];
            self.path(&[from, tip[0], tip[1], to], "");
        }
    }

    /// The lengths of one panel per storey along its lines.
    fn lengths(&mut self) {
        for ring in 0..=self.pattern.design.storeys {
            self.label([0, 1].map(|corner| self.corner(Corner { ring, corner })));
        }
        for crease in self.pattern.creases() {
            let [from, to] = crease.ends;
            // One side and one diagonal per storey: those of the second panel, away from the seam.
            let second = from.corner.min(to.corner) == 1 && from.corner.max(to.corner) <= 2;
            if from.ring != to.ring && second {
                self.label([self.corner(from), self.corner(to)]);
            }
        }
        for [from, to] in [0, 1].map(|cap| [0, 1].map(|corner| self.sheet.caps[cap][corner])) {
            self.label([from, to]);
        }
    }

    /// The length of a line, mm, above its middle and never upside down.
    fn label(&mut self, ends: [Vector2<f64>; 2]) {
        let [mut p, mut q] = ends.map(|end| Vector2::from(self.place(end)));
        if q.x < p.x || (q.x <= p.x && q.y > p.y) {
            std::mem::swap(&mut p, &mut q);
        }
        let along = q - p;
        let above = Vector2::new(along.y, -along.x).normalize() * (0.3 * self.letter);
        let letters = Letters {
            turn: libm::atan2(along.y, along.x).to_degrees(),
            ..self.letters().at(Anchor::Middle)
        };
        let position = 0.5 * (p + q) + above;
        self.page.text(position.into(), &letters, &format!("{:.2}", along.norm()));
    }

    fn letters(&self) -> Letters<'static> {
        Letters { colour: INK, ..Letters::new(self.letter) }
    }

    fn notes(&mut self) {
        let pattern = self.pattern;
        let degrees = |angle: f64| angle.to_degrees();
        let angles = &pattern.angles;
        let flap = match self.flap {
            Some(width) => format!("glue flaps {width:.1} mm"),
            None => "no glue flaps".to_owned(),
        };
        let notes = [
            format!("{}. Seen from outside, 1:1, lengths in mm, {flap}.", self.title()),
            format!(
                "phi {:.4}°, alpha1 {:.4}°, beta1 {:.4}°, theta1 {:.4}°, theta2 {:.4}°, ring ratio \
                 {:.6}, half angle {:.4}°",
                degrees(angles.phi),
                degrees(angles.alpha1),
                degrees(angles.beta1),
                degrees(angles.theta1),
                degrees(angles.theta2),
                angles.ring_ratio,
                degrees(pattern.half_angle)
            ),
            format!(
                "bottom radius {:.2}, top radius {:.2}, height {:.2} mm, stowed {:.2} mm",
                pattern.bottom_radius * MM,
                pattern.top_radius * MM,
                pattern.height * MM,
                pattern.design.stowed_height * MM
            ),
            "cut: solid; mountain: dash-dotted; valley: dashed".to_owned(),
        ];
        for (row, note) in notes.iter().enumerate() {
            let y = self.size.y - (5.2 - 1.3 * row as f64) * self.letter;
            self.page.text([6.0 * self.letter, y], &self.letters(), note);
        }
    }
}

#[cfg(test)]
mod tests {
    use billow_solver::scene::paper;
    use resvg::usvg::roxmltree::{Document, Node};

    use super::*;

    /// The lines of a layer of the paper's capsule: their corners, mm.
    fn layer(svg: &str, name: &str) -> Vec<Vec<Vector2<f64>>> {
        let svg = Document::parse(svg).unwrap();
        let group = svg.descendants().find(|node| node.attribute("id") == Some(name));
        let corner = |pair: &str| {
            let [x, y] = [0, 1].map(|at| pair.split(',').nth(at).unwrap().parse::<f64>().unwrap());
            Vector2::new(x, y)
        };
        let corners = |path: Node<'_, '_>| -> Option<Vec<Vector2<f64>>> {
            Some(path.attribute("d")?.trim_matches(['M', 'z']).split(' ').map(corner).collect())
        };
        group.map_or_else(Vec::new, |group| group.children().filter_map(corners).collect())
    }

    #[test]
    fn the_pattern_is_drawn_one_to_one_in_millimetres() {
        let pattern = paper::empty_capsule(1, 1.0).design.pattern().unwrap();
        let plain = svg(&pattern, None);
        let count = |name: &str| layer(&plain, name).len();
        assert_eq!((count("cut"), count("mountain")), (2 * 6 + 2 * 3 + 2, 2 * 6 + 3 * 5));
        let valleys = layer(&plain, "valley");
        assert_eq!((valleys.len(), count("glue_flaps")), (18, 0));
        for storey in 0..3 {
            let diagonal = 1e3 * pattern.lengths(storey).ae;
            let long =
                |line: &&Vec<Vector2<f64>>| ((line[1] - line[0]).norm() - diagonal).abs() < 1e-3;
            assert_eq!(valleys.iter().filter(long).count(), 6);
        }
        // The user unit of the page is 1 mm.
        let width = plain.split("width=\"").nth(1).unwrap().split("mm").next().unwrap();
        assert!(plain.contains(&format!("viewBox=\"0 0 {width} ")));
        for length in ["523.17", "446.07", "829.58", "381.91"] {
            assert!(plain.contains(&format!(">{length}</text>")), "{length}");
        }
        let simulated = for_origami_simulator(&pattern);
        let red = "<path fill=\"none\" stroke=\"#ff0000\" d=\"M";
        assert_eq!(simulated.matches(red).count(), 2 * 6 + 3 * 5);
        assert_eq!(layer(&simulated, "valley").len(), 18);
        // The seam and the caps have glue flaps.
        assert_eq!(layer(&svg(&pattern, Some(0.015)), "glue_flaps").len(), 3 + 2 * 6);
    }
}
