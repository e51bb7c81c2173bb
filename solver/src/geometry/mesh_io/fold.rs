//! The FOLD format, specification 1.2 (Demaine, Ku, Lang: "A New File Standard to Represent Folded
//! Structures"). The key frame is the crease pattern of the lateral film, the second frame its stowed
//! shape. Caps are omitted: they have no creases.

use core::f64::consts::PI;
use std::collections::HashMap;

use nalgebra::Vector3;
use serde_json::{Value, json};

use crate::geometry::fold::{Assignment, Corner, Facet, FoldPattern};
use crate::geometry::mesh_io::obj::Sheet;

/// A pattern as FOLD text, lengths in m. The sheet is seen from outside, faces counter-clockwise, so
/// mountains (`M`, −180°) point outward, towards the viewer.
#[expect(clippy::missing_panics_doc, reason = "a JSON value of finite numbers is always printable")]
pub fn crease_pattern(pattern: &FoldPattern, title: &str) -> String {
    let per_ring = pattern.design.panels + 1;
    let index = |c: Corner| c.ring * per_ring + c.corner;
    let creases = pattern.creases();
    let letters: Vec<&str> = creases
        .iter()
        .map(|crease| match crease.assignment {
            Assignment::Mountain => "M",
            Assignment::Valley => "V",
            Assignment::Boundary => "B",
        })
        .collect();
    let fold_angles: Vec<Value> = creases
        .iter()
        .map(|crease| match crease.assignment {
            Assignment::Mountain => json!(-180),
            Assignment::Valley => json!(180),
            Assignment::Boundary => Value::Null,
        })
        .collect();
    let edges: Vec<[u32; 2]> = creases.iter().map(|crease| crease.ends.map(index)).collect();
    let faces: Vec<[u32; 3]> =
        pattern.facets().iter().map(|facet| facet.corners.map(index)).collect();
    let sheet: Vec<[f64; 2]> =
        Sheet::new(pattern).corners.iter().map(|corner| [corner.x, corner.y]).collect();
    let text = json!({
        "file_spec": 1.2,
        "file_creator": concat!("billow ", env!("CARGO_PKG_VERSION")),
        "file_title": title,
        "file_classes": ["singleModel"],
        "frame_title": "crease pattern, seen from outside",
        "frame_classes": ["creasePattern"],
        "frame_attributes": ["2D", "manifold", "orientable", "nonSelfTouching"],
        "frame_unit": "m",
        "vertices_coords": sheet,
        "edges_vertices": edges,
        "edges_assignment": letters,
        "edges_foldAngle": fold_angles,
        "faces_vertices": faces,
        "file_frames": [stowed(pattern)],
    });
    let mut text = serde_json::to_string_pretty(&text).expect("plain JSON");
    text.push('\n');
    text
}

/// The stowed shape: the same vertices in space. Both edges of the seam coincide.
fn stowed(pattern: &FoldPattern) -> Value {
    let panels = pattern.design.panels;
    let polygons = pattern.stowed_polygons(pattern.design.stowed_height);
    let positions: Vec<[f64; 3]> = polygons
        .iter()
        .flat_map(|polygon| (0..=panels).map(|corner| polygon.corner(corner % panels, panels)))
        .map(Into::into)
        .collect();
    let position =
        |c: Corner| Vector3::from(positions[(c.ring * (panels + 1) + c.corner) as usize]);
    let normals = left_normals(pattern, position);
    let angles: Vec<Value> = pattern
        .creases()
        .iter()
        .map(|crease| {
            let [from, to] = crease.ends;
            match (normals.get(&[from, to]), normals.get(&[to, from])) {
                (Some(left), Some(right)) => {
                    json!(fold_angle(left, right, &(position(to) - position(from))))
                }
                // One facet only: the boundary of the sheet.
                _ => Value::Null,
            }
        })
        .collect();
    json!({
        "frame_title": format!("stowed at {} m", pattern.design.stowed_height),
        "frame_classes": ["foldedForm"],
        "frame_attributes": ["3D", "manifold", "orientable", "nonSelfIntersecting"],
        "frame_unit": "m",
        "frame_parent": 0,
        "frame_inherit": true,
        "vertices_coords": positions,
        "edges_foldAngle": angles,
    })
}

/// The normal of the facet to the left of every directed edge.
fn left_normals(
    pattern: &FoldPattern,
    position: impl Fn(Corner) -> Vector3<f64>,
) -> HashMap<[Corner; 2], Vector3<f64>> {
    let mut normals = HashMap::new();
    for Facet { corners: [a, b, c], .. } in pattern.facets() {
        let normal = (position(b) - position(a)).cross(&(position(c) - position(a))).normalize();
        normals.extend([[a, b], [b, c], [c, a]].map(|edge| (edge, normal)));
    }
    normals
}

/// Fold angle at an edge with direction `along`, degrees: the angle between the normals of the facets
/// left and right of it, negative for a mountain.
fn fold_angle(left: &Vector3<f64>, right: &Vector3<f64>, along: &Vector3<f64>) -> f64 {
    180.0 / PI * libm::atan2(right.cross(left).dot(&along.normalize()), left.dot(right))
}
