//! The crease pattern as a drawing to cut and fold: SVG in millimetres, 1:1.
//!
//! One layer (an SVG group) a kind of line, so that a cutter can take `cut` alone: `cut` solid,
//! `mountain` dash-dotted, `valley` dashed, `glue_flaps` thin, `dimensions` and `notes` for the
//! reader. Colours hold for the colour-blind and in grey; the dashes say the same.

use std::fmt::Write;

use billow_solver::geometry::fold::{Assignment, Corner, FoldPattern};
use billow_solver::geometry::mesh_io::obj::Sheet;
use nalgebra::Vector2;

/// Millimetres a metre.
const MM: f64 = 1e3;

/// Draws a pattern, seen from outside; `flap` is the width of the glue flaps, m, if there are any:
/// one along the right side of the seam, one along every edge of both caps.
pub fn svg(pattern: &FoldPattern, flap: Option<f64>) -> String {
    Drawing::new(pattern, flap.map(|width| width * MM)).draw()
}

struct Drawing<'a> {
    pattern: &'a FoldPattern,
    sheet: Sheet,
    flap: Option<f64>,
    /// Upper left corner of the page in sheet coordinates (y up), mm.
    origin: Vector2<f64>,
    size: Vector2<f64>,
    /// Height of letters, mm: legible on the whole sheet.
    letter: f64,
}

impl<'a> Drawing<'a> {
    fn new(pattern: &'a FoldPattern, flap: Option<f64>) -> Self {
        let mut sheet = Sheet::new(pattern);
        let [bottom_cap, top_cap] = &mut sheet.caps;
        for place in sheet.corners.iter_mut().chain(bottom_cap).chain(top_cap) {
            *place *= MM;
        }
        let all = || sheet.corners.iter().chain(sheet.caps.iter().flatten());
        let low = all().fold(Vector2::repeat(f64::INFINITY), |low, p| low.inf(p));
        let high = all().fold(Vector2::repeat(f64::NEG_INFINITY), |high, p| high.sup(p));
        let letter = 0.016 * (high.y - low.y).max(0.3 * (high.x - low.x));
        let margin = flap.unwrap_or(0.0) + 6.0 * letter;
        let below = 7.0 * letter;
        let origin = Vector2::new(low.x - margin, high.y + margin);
        let size = high - low + Vector2::new(2.0 * margin, 2.0 * margin + below);
        Self { pattern, sheet, flap, origin, size, letter }
    }

    fn draw(&self) -> String {
        let (w, h) = (self.size.x, self.size.y);
        let mut svg = format!(
            "<svg xmlns=\"http://www.w3.org/2000/svg\" width=\"{w:.3}mm\" height=\"{h:.3}mm\" \
             viewBox=\"0 0 {w:.3} {h:.3}\" font-family=\"sans-serif\" font-size=\"{:.3}\">\n\
             <title>{}</title>\n",
            self.letter,
            self.title()
        );
        let line = (0.03 * self.letter).max(0.1);
        self.lines(&mut svg, "cut", Assignment::Boundary, &stroke("#000000", 1.5 * line, ""));
        let dash = self.letter * 0.6;
        let dots = format!("{dash:.2} {:.2} {:.2} {:.2}", 0.4 * dash, 0.1 * dash, 0.4 * dash);
        self.lines(&mut svg, "mountain", Assignment::Mountain, &stroke("#d55e00", line, &dots));
        let dashes = format!("{:.2} {:.2}", 0.7 * dash, 0.5 * dash);
        self.lines(&mut svg, "valley", Assignment::Valley, &stroke("#0072b2", line, &dashes));
        self.flaps(&mut svg, &stroke("#666666", line, ""));
        self.dimensions(&mut svg, &stroke("#333333", 0.7 * line, ""));
        self.notes(&mut svg);
        svg.push_str("</svg>\n");
        svg
    }

    fn title(&self) -> String {
        let design = &self.pattern.design;
        format!("Crease pattern, N {} panels, M {} storeys", design.panels, design.storeys)
    }

    /// Page coordinates, y down.
    fn page(&self, place: Vector2<f64>) -> Vector2<f64> {
        Vector2::new(place.x - self.origin.x, self.origin.y - place.y)
    }

    fn corner(&self, corner: Corner) -> Vector2<f64> {
        let across = self.pattern.design.panels + 1;
        self.sheet.corners[(corner.ring * across + corner.corner) as usize]
    }

    fn lines(&self, svg: &mut String, id: &str, kind: Assignment, style: &str) {
        let _ = writeln!(svg, "<g id=\"{id}\" {style}>");
        for crease in self.pattern.creases().iter().filter(|crease| crease.assignment == kind) {
            self.segment(svg, crease.ends.map(|end| self.corner(end)));
        }
        if kind == Assignment::Boundary {
            for cap in &self.sheet.caps {
                let points: Vec<String> = cap
                    .iter()
                    .map(|place| self.page(*place))
                    .map(|p| format!("{:.4},{:.4}", p.x, p.y))
                    .collect();
                let _ = writeln!(svg, "<polygon points=\"{}\"/>", points.join(" "));
            }
        }
        svg.push_str("</g>\n");
    }

    fn segment(&self, svg: &mut String, [from, to]: [Vector2<f64>; 2]) {
        let (p, q) = (self.page(from), self.page(to));
        let _ = writeln!(
            svg,
            "<line x1=\"{:.4}\" y1=\"{:.4}\" x2=\"{:.4}\" y2=\"{:.4}\"/>",
            p.x, p.y, q.x, q.y
        );
    }

    fn flaps(&self, svg: &mut String, style: &str) {
        let Some(width) = self.flap else { return };
        let _ = writeln!(svg, "<g id=\"glue_flaps\" {style}>");
        let design = &self.pattern.design;
        for ring in 0..design.storeys {
            let side =
                [ring, ring + 1].map(|ring| self.corner(Corner { ring, corner: design.panels }));
            self.flap(svg, side, width);
        }
        for cap in &self.sheet.caps {
            for (i, from) in cap.iter().enumerate() {
                self.flap(svg, [*from, cap[(i + 1) % cap.len()]], width);
            }
        }
        svg.push_str("</g>\n");
    }

    /// A trapezium on the right-hand side of an edge, its ends cut at 45° so that neighbours clear
    /// one another.
    fn flap(&self, svg: &mut String, [from, to]: [Vector2<f64>; 2], width: f64) {
        let along = (to - from).normalize();
        let outward = Vector2::new(along.y, -along.x);
        let width = width.min(0.4 * (to - from).norm());
        let tip = [from + (along + outward) * width, to + (outward - along) * width];
        let points: Vec<String> = [from, tip[0], tip[1], to]
            .map(|place| self.page(place))
            .iter()
            .map(|p| format!("{:.4},{:.4}", p.x, p.y))
            .collect();
        let _ = writeln!(svg, "<polyline points=\"{}\"/>", points.join(" "));
    }

    /// The lengths of a panel in every storey, written along its lines, and the size of the sheet.
    fn dimensions(&self, svg: &mut String, style: &str) {
        let _ = writeln!(svg, "<g id=\"dimensions\" {style}>");
        let design = &self.pattern.design;
        for ring in 0..=design.storeys {
            let ends = [0, 1].map(|corner| self.corner(Corner { ring, corner }));
            self.label(svg, ends, &format!("{:.2}", (ends[1] - ends[0]).norm()));
        }
        for crease in self.pattern.creases() {
            let [from, to] = crease.ends;
            // One side and one diagonal a storey: the second panel's, clear of the seam.
            let second = from.corner.min(to.corner) == 1 && from.corner.max(to.corner) <= 2;
            if from.ring != to.ring && second {
                let ends = [self.corner(from), self.corner(to)];
                self.label(svg, ends, &format!("{:.2}", (ends[1] - ends[0]).norm()));
            }
        }
        let lateral = |pick: fn(f64, f64) -> f64, start: f64, of: fn(&Vector2<f64>) -> f64| {
            self.sheet.corners.iter().fold(start, |best, place| pick(best, of(place)))
        };
        let (left, right) = (
            lateral(f64::min, f64::INFINITY, |p| p.x),
            lateral(f64::max, f64::NEG_INFINITY, |p| p.x),
        );
        let (low, high) = (
            lateral(f64::min, f64::INFINITY, |p| p.y),
            lateral(f64::max, f64::NEG_INFINITY, |p| p.y),
        );
        let below = low - 1.5 * self.letter;
        let beside = left - 1.5 * self.letter;
        for ends in [
            [Vector2::new(left, below), Vector2::new(right, below)],
            [Vector2::new(beside, low), Vector2::new(beside, high)],
        ] {
            self.segment(svg, ends);
            self.label(svg, ends, &format!("{:.2}", (ends[1] - ends[0]).norm()));
        }
        for cap in &self.sheet.caps {
            self.label(svg, [cap[0], cap[1]], &format!("{:.2}", (cap[1] - cap[0]).norm()));
        }
        svg.push_str("</g>\n");
    }

    /// Text along a line, above its middle, never upside down.
    fn label(&self, svg: &mut String, ends: [Vector2<f64>; 2], text: &str) {
        let [mut p, mut q] = ends.map(|end| self.page(end));
        if q.x < p.x || (q.x <= p.x && q.y > p.y) {
            std::mem::swap(&mut p, &mut q);
        }
        let (middle, along) = (0.5 * (p + q), q - p);
        let degrees = libm::atan2(along.y, along.x).to_degrees();
        let _ = writeln!(
            svg,
            "<text transform=\"translate({:.3} {:.3}) rotate({degrees:.3})\" y=\"{:.3}\" \
             text-anchor=\"middle\" stroke=\"none\" fill=\"#333333\">{text}</text>",
            middle.x,
            middle.y,
            -0.3 * self.letter
        );
    }

    fn notes(&self, svg: &mut String) {
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
        svg.push_str("<g id=\"notes\" fill=\"#333333\">\n");
        let left = 6.0 * self.letter;
        for (row, note) in notes.iter().enumerate() {
            let y = self.size.y - (5.2 - 1.3 * row as f64) * self.letter;
            let _ = writeln!(svg, "<text x=\"{left:.3}\" y=\"{y:.3}\">{note}</text>");
        }
        svg.push_str("</g>\n");
    }
}

fn stroke(colour: &str, width: f64, dashes: &str) -> String {
    let dashes =
        if dashes.is_empty() { String::new() } else { format!(" stroke-dasharray=\"{dashes}\"") };
    format!("fill=\"none\" stroke=\"{colour}\" stroke-width=\"{width:.3}\"{dashes}")
}

#[cfg(test)]
mod tests {
    use billow_solver::scene::paper;

    use super::*;

    fn paper() -> FoldPattern {
        FoldPattern::new(&paper::design(1)).expect("the paper's capsule")
    }

    /// The lines of one layer, by their lengths.
    fn layer(svg: &str, id: &str) -> Vec<f64> {
        let (_, rest) = svg.split_once(&format!("<g id=\"{id}\"")).expect(id);
        let (layer, _) = rest.split_once("</g>").expect("a closed layer");
        layer
            .lines()
            .filter(|line| line.starts_with("<line"))
            .map(|line| {
                let at = |name: &str| -> f64 {
                    let (_, rest) = line.split_once(&format!("{name}=\"")).expect(name);
                    rest.split('"').next().expect("a value").parse().expect("a number")
                };
                Vector2::new(at("x2") - at("x1"), at("y2") - at("y1")).norm()
            })
            .collect()
    }

    #[test]
    fn is_drawn_one_to_one_in_millimetres() {
        let pattern = paper();
        let svg = svg(&pattern, None);
        let valleys = layer(&svg, "valley");
        assert_eq!(valleys.len(), 18);
        for storey in 0..3 {
            let diagonal = 1e3 * pattern.lengths(storey).ae;
            assert_eq!(valleys.iter().filter(|l| (*l - diagonal).abs() < 1e-3).count(), 6);
        }
        assert_eq!(layer(&svg, "cut").len(), 2 * 6 + 2 * 3);
        assert_eq!(layer(&svg, "mountain").len(), 2 * 6 + 3 * 5);
        assert!(!svg.contains("glue_flaps"));
        // The page says millimetres, and its user unit is one.
        let (_, size) = svg.split_once("width=\"").expect("a width");
        let width = size.split("mm").next().expect("millimetres");
        assert!(svg.contains(&format!("viewBox=\"0 0 {width} ")));
    }

    #[test]
    fn glue_flaps_stand_on_the_seam_and_round_the_caps() {
        let svg = svg(&paper(), Some(0.015));
        let (_, rest) = svg.split_once("glue_flaps").expect("the layer");
        let (flaps, _) = rest.split_once("</g>").expect("a closed layer");
        assert_eq!(flaps.matches("<polyline").count(), 3 + 2 * 6);
    }

    #[test]
    fn lengths_are_written_on_the_drawing() {
        let svg = svg(&paper(), None);
        for length in ["523.17", "446.07", "829.58", "381.91"] {
            assert!(svg.contains(&format!(">{length}</text>")), "{length}");
        }
    }
}
