//! `mesh.reference`: the stress-free shape of each triangle.

use billow_solver::geometry::mesh_io::obj_reader::{Face, Surface};
use billow_solver::geometry::shell::flat;
use nalgebra::{Vector2, Vector3};

use super::reader::Reader;
use crate::input::json::Json;
use crate::input::keys::{FLAT, KeyKind};
use crate::input::object::Object;
use crate::platform::error::Result;

/// Stress-free corners of each triangle of each face, m.
pub(super) type Reference = Vec<Vec<[Vector3<f64>; 3]>>;

/// Reads the stress-free shape: an OBJ file, flat coordinates, or the shape at the start.
pub(super) fn reference(
    object: &Object<'_>,
    surface: &Surface,
    film: &[bool],
    scale: f64,
    reader: &mut Reader,
) -> Result<Reference> {
    let fans = |face: &Face, corners: &[Vector3<f64>]| -> Vec<[Vector3<f64>; 3]> {
        face.fan().map(|fan| fan.map(|k| corners[k])).collect()
    };
    let start = |face: &Face| -> Vec<Vector3<f64>> {
        face.corners.iter().map(|v| surface.vertices[*v as usize]).collect()
    };
    // Corners of the given faces, in order, with the name of each for errors.
    let given: Vec<(Vec<Vector3<f64>>, String)> = match object.given("reference") {
        None => return Ok(surface.faces.iter().map(|face| fans(face, &start(face))).collect()),
        Some(Json::Text(name)) => {
            let flat = reader.surface("mesh.reference", name, 0)?;
            let position = |v: &u32| flat.vertices[*v as usize] * scale;
            let corners = |face: &Face| face.corners.iter().map(position).collect();
            flat.faces.iter().map(|face| (corners(face), format!("line {}", face.line))).collect()
        }
        Some(Json::List(items)) => {
            let face = |(index, item): (usize, &Json)| {
                let problem = |problem| object.error("reference", problem, REFERENCE);
                let corners =
                    inline(item).map_err(|why| problem(format!("face {index}: {why}")))?;
                Ok((corners, format!("face {index}")))
            };
            items.iter().enumerate().map(face).collect::<Result<_>>()?
        }
        Some(_) => {
            return Err(object
                .error("reference", "is neither a file nor a list", REFERENCE)
                .into());
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
        reference.push(fans(face, &corners));
    }
    Ok(reference)
}

/// What `reference` may be, for errors.
const REFERENCE: &str = "an OBJ file with the faces of positions in the same order (of the film, or \
                         all), or a list of them as [[x, y], [x, y], [x, y]] in m";

/// Flat coordinates of the corners of one face, m.
fn inline(json: &Json) -> std::result::Result<Vec<Vector3<f64>>, String> {
    let KeyKind::Quantity(length) = FLAT else { unreachable!("a length") };
    let Json::List(corners) = json else { return Err(format!("is {}, not a list", json.kind())) };
    let corner = |corner: &Json| match corner {
        Json::List(parts) if matches!(parts.len(), 2 | 3) => {
            let mut position = Vector3::zeros();
            for (k, part) in parts.iter().enumerate() {
                let value = length.read(part)?;
                position[k] = length.number(&value).unwrap_or_default();
            }
            Ok(position)
        }
        other => Err(format!("a corner is {other}, not [x, y]")),
    };
    corners.iter().map(corner).collect()
}

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
    let key = if object.given("reference").is_some() { "reference" } else { "positions" };
    let problem = format!("the face on line {} of positions has no area there", face.line);
    Err(object
        .error(key, problem, "faces with an area, also after a polygon is cut into a fan")
        .into())
}
