//! Writes Wavefront OBJ: vertices in m, faces counter-clockwise seen from outside, one group for each
//! piece of film.

use std::collections::BTreeMap;
use std::fmt::Write;

use nalgebra::{Isometry2, Point2, Rotation2, Translation2, Vector2, Vector3};

use crate::geometry::fold::{Corner, Facet, FoldPattern};
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

/// A surface as OBJ with these vertex positions (m), in the order of its vertices, and its texture coordinates.
pub fn surface(surface: &Surface, positions: &[Vector3<f64>], title: &str) -> String {
    let mut text = header(title);
    for position in positions {
        vertex(&mut text, *position);
    }
    for [u, v] in &surface.texture {
        let _ = writeln!(text, "vt {u} {v}");
    }
    let mut group = None;
    for Face { corners, names, texture, .. } in &surface.faces {
        if group != Some(*names) {
            group = Some(*names);
            let _ = writeln!(text, "g {}", surface.names[*names].join(" "));
        }
        if texture.len() != corners.len() {
            face(&mut text, corners);
            continue;
        }
        let both = corners.iter().zip(texture).map(|(v, t)| format!(" {}/{}", v + 1, t + 1));
        let _ = writeln!(text, "f{}", both.collect::<Vec<_>>().concat());
    }
    text
}

/// The developed film as OBJ, in the plane z = 0 and seen from outside: the lateral sheet, cut open along its seam, and
/// the caps next to it. Its faces are those of the mesh, in their order: it is the reference of every other shape.
pub fn developed(pattern: &FoldPattern, mesh: &Mesh, title: &str) -> String {
    let places = layout(pattern);
    let of_piece = mesh.triangles.len() / places.len();
    // A node of the seam, and of a ring, is at several places of the layout.
    let tolerance = VERTEX_TOLERANCE * pattern.polygon_radius(0);
    let mut vertices: BTreeMap<(u32, [i64; 2]), u32> = BTreeMap::new();
    let (mut text, mut faces) = (header(title), String::new());
    let mut group = None;
    for (element, (triangle, part)) in mesh.triangles.iter().zip(&mesh.parts).enumerate() {
        if group != Some(*part) {
            group = Some(*part);
            let _ = writeln!(faces, "g {}", name(*part));
        }
        let mut number = |corner: usize| {
            let place = places[element / of_piece] * Point2::from(mesh.reference[element][corner]);
            #[expect(
                clippy::cast_possible_truncation,
                reason = "lengths of a film over its tolerance"
            )]
            let rounded = [place.x, place.y].map(|x| libm::round(x / tolerance) as i64);
            let next = u32::try_from(vertices.len()).unwrap_or(u32::MAX);
            *vertices.entry((triangle[corner], rounded)).or_insert_with(|| {
                vertex(&mut text, Vector3::new(place.x, place.y, 0.0));
                next
            })
        };
        let numbers = [number(0), number(1), number(2)];
        face(&mut faces, &numbers);
    }
    text + &faces
}

/// Where each piece of a mesh lies in the layout, from the coordinates of its reference: the facets, then the wedges of the
/// bottom and of the top cap.
fn layout(pattern: &FoldPattern) -> Vec<Isometry2<f64>> {
    let sheet = Sheet::new(pattern);
    let middle = pattern.sheet_middle();
    let of_facet = |facet: Facet| {
        // The first corner of a facet has x = 0 in its reference.
        let zero = pattern.erected_angle(facet.corners[0]);
        let [a, b] = [0, 1].map(|k| pattern.developed(facet.corners[k], zero));
        let [c, d] = [0, 1].map(|k| pattern.developed(facet.corners[k], middle));
        let rotation = Rotation2::rotation_between(&(b - a), &(d - c));
        let shift = c - rotation * a;
        Isometry2::from_parts(Translation2::from(shift), rotation.into())
    };
    let panels = pattern.design.panels;
    let wedge = 2.0 * core::f64::consts::PI / f64::from(panels);
    let of_cap = |cap: usize| {
        let corners = &sheet.caps[cap];
        let centre = corners.iter().sum::<Vector2<f64>>() / corners.len() as f64;
        // Seen from outside, the panels of the bottom go round clockwise.
        (0..panels).map(move |panel| {
            let steps = if cap == 0 { -f64::from(panel + 1) } else { f64::from(panel) };
            Isometry2::new(centre, steps * wedge)
        })
    };
    pattern.facets().into_iter().map(of_facet).chain(of_cap(0)).chain(of_cap(1)).collect()
}

/// Distance up to which places of one node are one vertex, over the circumradius of the bottom cap. Chosen: far above
/// rounding, far below an element.
const VERTEX_TOLERANCE: f64 = 1e-7;

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
