//! Wavefront OBJ: vertices in m, faces counter-clockwise seen from outside, one group a piece of
//! film.

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

/// A surface as OBJ, its vertices at these places (m), in its own numbers.
pub fn surface(surface: &Surface, places: &[Vector3<f64>], title: &str) -> String {
    let mut text = header(title);
    for place in places {
        vertex(&mut text, *place);
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

/// The developed film as OBJ: the lateral sheet in the plane z = 0, cut open along its seam and seen
/// from outside, the caps beside it.
pub fn developed(pattern: &FoldPattern, title: &str) -> String {
    let sheet = Sheet::new(pattern);
    let mut text = header(title);
    for place in sheet.corners.iter().chain(&sheet.caps[0]).chain(&sheet.caps[1]) {
        vertex(&mut text, Vector3::new(place.x, place.y, 0.0));
    }
    let across = pattern.design.panels + 1;
    let mut storey = None;
    for facet in pattern.facets() {
        if storey != Some(facet.storey) {
            storey = Some(facet.storey);
            let _ = writeln!(text, "g {}", name(Part::Storey(facet.storey)));
        }
        face(&mut text, &facet.corners.map(|c| c.ring * across + c.corner));
    }
    let mut first = across * (pattern.design.storeys + 1);
    for part in [Part::BottomCap, Part::TopCap] {
        let _ = writeln!(text, "g {}", name(part));
        let corners: Vec<u32> = (first..first + pattern.design.panels).collect();
        face(&mut text, &corners);
        first += pattern.design.panels;
    }
    text
}

/// The flat pieces of film, laid out side by side, seen from outside, m.
#[derive(Debug, Clone, PartialEq)]
pub struct Sheet {
    /// Corners of the lateral film, ring by ring, N + 1 a ring.
    pub corners: Vec<Vector2<f64>>,
    /// Corners of the bottom and the top cap, counter-clockwise.
    pub caps: [Vec<Vector2<f64>>; 2],
}

impl Sheet {
    /// Lays a pattern out: the lateral film upright, the caps to its right, one above the other.
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
            let gap = 0.2 * pattern.polygon_radius(0);
            centre.x = right + pattern.polygon_radius(0) + gap;
            centre.y += radius;
            let polygon = (0..panels)
                .map(|corner| {
                    let turn = 2.0 * core::f64::consts::PI * f64::from(corner) / f64::from(panels);
                    let (sin, cos) = libm::sincos(turn);
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

fn vertex(text: &mut String, place: Vector3<f64>) {
    let _ = writeln!(text, "v {} {} {}", place.x, place.y, place.z);
}

fn face(text: &mut String, nodes: &[u32]) {
    text.push('f');
    for node in nodes {
        let _ = write!(text, " {}", node + 1);
    }
    text.push('\n');
}

/// Name of the group of a piece of film.
pub fn name(part: Part) -> String {
    match part {
        Part::Storey(storey) => format!("storey_{storey}"),
        Part::BottomCap => "bottom_cap".to_owned(),
        Part::TopCap => "top_cap".to_owned(),
    }
}
