//! `mesh.reference`: the stress-free shape of each triangle.

use billow_solver::geometry::mesh_io::obj_reader::{Face, Surface};
use billow_solver::geometry::shell::flat;
use nalgebra::{Vector2, Vector3};

use super::reader::Reader;
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
    let unit = object.number("texture_unit")?;
    let given: Vec<(Vec<Vector3<f64>>, String)> = match object.given("reference") {
        Some(_) if unit.is_some() => {
            let problem = "is given beside reference: both are the stress-free shape";
            return Err(object.error("texture_unit", problem, "one of the two").into());
        }
        None => {
            let Some(unit) = unit else { return Ok(surface.faces.iter().map(start).collect()) };
            return texture(object, surface, unit);
        }
        Some(name) => {
            let (flat, _) = reader.surface("mesh.reference", name)?;
            let position = |v: &u32| flat.vertices[*v as usize] * scale;
            let corners = |face: &Face| face.corners.iter().map(position).collect();
            flat.faces
                .iter()
                .map(|face| (corners(face), format!("the face {}", face.place)))
                .collect()
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
                "{name} has {} corners, the face {} of positions has {}",
                corners.len(),
                face.place,
                face.corners.len()
            );
            return Err(object.error("reference", problem, REFERENCE).into());
        }
        reference.push(corners);
    }
    Ok(reference)
}

/// The texture coordinates of each face as its stress-free shape, with one unit of them this long, m.
fn texture(object: &Object<'_>, surface: &Surface, unit: f64) -> Result<Reference> {
    let of_face = |face: &Face| {
        let corners = face.texture.iter().map(|index| {
            let [u, v] = surface.texture[*index as usize];
            Vector3::new(u, v, 0.0) * unit
        });
        let corners: Vec<Vector3<f64>> = corners.collect();
        let is_finite = corners.iter().all(|corner| corner.iter().all(|x| x.is_finite()));
        if corners.len() == face.corners.len() && is_finite {
            return Ok(corners);
        }
        let problem = format!("the face {} of positions has no texture coordinates", face.place);
        let allowed = "an OBJ file whose faces all have them, as in `f 1/4 2/5 3/6` with `vt u v`";
        Err(object.error("texture_unit", problem, allowed).into())
    };
    surface.faces.iter().map(of_face).collect()
}

/// What `reference` may be, for errors.
const REFERENCE: &str =
    "a file with the faces of positions in the same order (of the film, or all)";

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
    let problem = format!("the face {} of positions has no area there", face.place);
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
    ["reference", "texture_unit"]
        .into_iter()
        .find(|key| object.given(key).is_some())
        .unwrap_or("positions")
}
