//! Writes Wavefront OBJ: vertices in m, faces counter-clockwise seen from outside, one group for each
//! piece of film.

use std::fmt::Write;

use nalgebra::{Vector2, Vector3};

use crate::geometry::fold::{Corner, FoldPattern};
use crate::geometry::mesh::{Mesh, Part};
use crate::geometry::mesh_io::obj_reader::{Face, Surface};

/// A mesh as OBJ.
pub fn mesh(mesh: &Mesh, title: &str) -> String {
    let mut text = header(title);
    for position in &mesh.positions {
        vertex(&mut text, *position);
    }
    let mut group = None;
    for (triangle, part) in mesh.triangles.iter().zip(&mesh.parts) {
        if group != Some(*part) {
            group = Some(*part);
            let _ = writeln!(text, "g {}", name(*part));
        }
        face(&mut text, triangle);
    }
    text
}

/// A surface as OBJ with these vertex positions (m), in the order of its vertices.
pub fn surface(surface: &Surface, positions: &[Vector3<f64>], title: &str) -> String {
    let mut text = header(title);
    for position in positions {
        vertex(&mut text, *position);
    }
    let mut group = None;
    for Face { corners, names, .. } in &surface.faces {
        if group != Some(*names) {
            group = Some(*names);
            let _ = writeln!(text, "g {}", surface.names[*names].join(" "));
        }
        face(&mut text, corners);
    }
    text
}

/// The developed film as OBJ, in the plane z = 0 and seen from outside: the lateral sheet, cut open along
/// its seam, and the caps next to it.
pub fn developed(pattern: &FoldPattern, title: &str) -> String {
    let sheet = Sheet::new(pattern);
    let mut text = header(title);
    for corner in sheet.corners.iter().chain(&sheet.caps[0]).chain(&sheet.caps[1]) {
        vertex(&mut text, Vector3::new(corner.x, corner.y, 0.0));
    }
    let per_ring = pattern.design.panels + 1;
    let mut storey = None;
    for facet in pattern.facets() {
        if storey != Some(facet.storey) {
            storey = Some(facet.storey);
            let _ = writeln!(text, "g {}", name(Part::Storey(facet.storey)));
        }
        face(&mut text, &facet.corners.map(|c| c.ring * per_ring + c.corner));
    }
    let mut first = per_ring * (pattern.design.storeys + 1);
    for part in [Part::BottomCap, Part::TopCap] {
        let _ = writeln!(text, "g {}", name(part));
        let corners: Vec<u32> = (first..first + pattern.design.panels).collect();
        face(&mut text, &corners);
        first += pattern.design.panels;
    }
    text
}

/// Gap between the pieces of a layout over the circumradius of the bottom cap. Chosen: easy to see.
const GAP_OVER_RADIUS: f64 = 0.2;

/// Layout of the flat pieces of film, seen from outside, m.
#[derive(Debug, Clone, PartialEq)]
pub struct Sheet {
    /// Corners of the lateral film, ring by ring, N + 1 for each ring.
    pub corners: Vec<Vector2<f64>>,
    /// Corners of the bottom and the top cap, counter-clockwise.
    pub caps: [Vec<Vector2<f64>>; 2],
}

impl Sheet {
    /// The layout of a pattern: the lateral film upright, the caps to its right, one above the other.
    pub fn new(pattern: &FoldPattern) -> Self {
        let (panels, storeys) = (pattern.design.panels, pattern.design.storeys);
        let middle = pattern.sheet_middle();
        let corners: Vec<Vector2<f64>> = (0..=storeys)
            .flat_map(|ring| (0..=panels).map(move |corner| Corner { ring, corner }))
            .map(|corner| pattern.developed(corner, middle))
            .collect();
        let right = corners.iter().fold(f64::NEG_INFINITY, |right, c| right.max(c.x));
        let low = corners.iter().fold(f64::INFINITY, |low, c| low.min(c.y));
        let mut centre = Vector2::new(0.0, low);
        let caps = [0, storeys].map(|ring| {
            let radius = pattern.polygon_radius(ring);
            let gap = GAP_OVER_RADIUS * pattern.polygon_radius(0);
            centre.x = right + pattern.polygon_radius(0) + gap;
            centre.y += radius;
            let polygon = (0..panels)
                .map(|corner| {
                    let angle = 2.0 * core::f64::consts::PI * f64::from(corner) / f64::from(panels);
                    let (sin, cos) = libm::sincos(angle);
                    centre + radius * Vector2::new(cos, sin)
                })
                .collect();
            centre.y += radius + gap;
            polygon
        });
        Self { corners, caps }
    }
}

fn header(title: &str) -> String {
    format!("# {}\n# vertices in m\n", title.replace('\n', " "))
}

fn vertex(text: &mut String, position: Vector3<f64>) {
    let _ = writeln!(text, "v {} {} {}", position.x, position.y, position.z);
}

fn face(text: &mut String, nodes: &[u32]) {
    text.push('f');
    for node in nodes {
        let _ = write!(text, " {}", node + 1);
    }
    text.push('\n');
}

/// Group name of a piece of film.
pub fn name(part: Part) -> String {
    match part {
        Part::Storey(storey) => format!("storey_{storey}"),
        Part::BottomCap => "bottom_cap".to_owned(),
        Part::TopCap => "top_cap".to_owned(),
    }
}
