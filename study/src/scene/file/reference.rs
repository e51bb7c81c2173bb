//! `mesh.reference`: the stress-free shape of each triangle.

use billow_solver::geometry::mesh_io::obj_reader::{Face, Surface};
use billow_solver::geometry::shell::flat;
use nalgebra::{Vector2, Vector3};

use super::reader::Reader;
use crate::input::json::Json;
use crate::input::object::Object;
use crate::platform::error::Result;

/// Stress-free corners of each face, m.
pub(super) type Reference = Vec<Vec<Vector3<f64>>>;

/// Reads the stress-free shape: an OBJ file, or the shape at the start.
pub(super) fn reference(
    object: &Object<'_>,
    surface: &Surface,
    film: &[bool],
    scale: f64,
    reader: &mut Reader,
) -> Result<Reference> {
    let start = |face: &Face| -> Vec<Vector3<f64>> {
        face.corners.iter().map(|v| surface.vertices[*v as usize]).collect()
    };
    // Corners of the given faces, in order, with the name of each for errors.
    let given: Vec<(Vec<Vector3<f64>>, String)> = match object.given("reference") {
        None => return Ok(surface.faces.iter().map(start).collect()),
        Some(Json::Text(name)) => {
            let flat = reader.surface("mesh.reference", name)?;
            let position = |v: &u32| flat.vertices[*v as usize] * scale;
            let corners = |face: &Face| face.corners.iter().map(position).collect();
            flat.faces.iter().map(|face| (corners(face), format!("line {}", face.line))).collect()
        }
        Some(_) => {
            return Err(object.error("reference", "is not the name of a file", REFERENCE).into());
        }
    };
    let films = film.iter().filter(|film| **film).count();
    let all = given.len() == surface.faces.len();
    if !all && given.len() != films {
        let closing = surface.faces.len() - films;
        let problem = format!(
            "has {} faces; positions has {films} of film{}",
            given.len(),
            if closing > 0 { format!(" and {closing} that close it") } else { String::new() }
        );
        return Err(object.error("reference", problem, REFERENCE).into());
    }
    let mut given = given.into_iter();
    let mut reference = Vec::with_capacity(surface.faces.len());
    for (face, film) in surface.faces.iter().zip(film) {
        let corners = if all || *film { given.next() } else { None };
        let (corners, name) = corners.unwrap_or_else(|| (start(face), String::new()));
        if corners.len() != face.corners.len() {
            let problem = format!(
                "{name} has {} corners, the face of positions on line {} has {}",
                corners.len(),
                face.line,
                face.corners.len()
            );
            return Err(object.error("reference", problem, REFERENCE).into());
        }
        reference.push(corners);
    }
    Ok(reference)
}

/// What `reference` may be, for errors.
const REFERENCE: &str =
    "an OBJ file with the faces of positions in the same order (of the film, or all)";

/// The stress-free triangle in its own plane.
pub(super) fn flattened(
    corners: [Vector3<f64>; 3],
    face: &Face,
    object: &Object<'_>,
) -> Result<[Vector2<f64>; 3]> {
    let flat = flat(corners);
    let area = 0.5 * flat[1].x * flat[2].y;
    // NaN is refused as well.
    if area > 0.0 && area.is_finite() {
        return Ok(flat);
    }
    let problem = format!("the face on line {} of positions has no area there", face.line);
    Err(object
        .error(
            flat_key(object),
            problem,
            "faces with an area, also after a polygon is cut into triangles",
        )
        .into())
}

/// The key whose file has the stress-free faces.
pub(super) fn flat_key(object: &Object<'_>) -> &'static str {
    if object.given("reference").is_some() { "reference" } else { "positions" }
}
