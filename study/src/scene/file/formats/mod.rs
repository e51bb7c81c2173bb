//! Mesh files of other programs beside OBJ: STL, PLY, Gmsh (MSH) and FOLD, by the ending of their names.
//!
//! An STL file has three corners a face and no vertices: corners at equal coordinates are joined.

mod msh;

use std::collections::HashMap;
use std::io::Cursor;

use billow_solver::geometry::mesh_io::obj_reader::{self, Face, Place, Surface};
use nalgebra::Vector3;
use ply_rs_bw::parser::Parser;
use ply_rs_bw::ply::{DefaultElement, Property};
use serde_json::Value;

/// A surface, and what a reader of its results must know of how it was read.
pub(super) struct Read {
    pub surface: Surface,
    pub note: Option<String>,
}

/// What is wrong with a file, and what is allowed.
pub(super) type Fault = (String, &'static str);

/// The formats, for errors.
pub(super) const FORMATS: &str =
    "a file in OBJ (.obj), STL (.stl), PLY (.ply), Gmsh (.msh, text) or FOLD (.fold)";

/// Reads the surface of a file with this name.
pub(super) fn read(name: &str, bytes: &[u8]) -> Result<Read, Fault> {
    let ending = name.rsplit_once('.').map_or("", |(_, ending)| ending).to_ascii_lowercase();
    let text = || {
        std::str::from_utf8(bytes).map_err(|error| {
            (format!("is not UTF-8 from byte {} on", error.valid_up_to()), FORMATS)
        })
    };
    let plain = |surface| Read { surface, note: None };
    match ending.as_str() {
        "stl" => stl(bytes),
        "ply" => ply(bytes).map(plain),
        "msh" => msh::read(text()?).map(plain),
        "fold" => fold(text()?).map(plain),
        _ => {
            let surface = obj_reader::read(text()?);
            surface
                .map(plain)
                .map_err(|error| (format!("line {}: {}", error.line, error.problem), error.allowed))
        }
    }
}

/// A surface of these vertices and faces; each face with the index of its name. Refuses a vertex that does not exist or
/// is not finite.
fn surface(
    vertices: Vec<Vector3<f64>>,
    faces: Vec<(Vec<u32>, usize)>,
    names: Vec<Vec<String>>,
    allowed: &'static str,
) -> Result<Surface, Fault> {
    if let Some(index) = vertices.iter().position(|v| !v.iter().all(|x| x.is_finite())) {
        return Err((format!("vertex {} has no finite coordinates", index + 1), allowed));
    }
    let mut surface = Surface { vertices, names, ..Surface::default() };
    for (index, (corners, names)) in faces.into_iter().enumerate() {
        let place = Place::Number(index + 1);
        let unknown = corners.iter().find(|corner| **corner as usize >= surface.vertices.len());
        if let Some(corner) = unknown {
            let vertices = surface.vertices.len();
            let problem = format!("the face {place} names vertex {corner} of {vertices}");
            return Err((problem, allowed));
        }
        let twice = (1..corners.len()).any(|k| corners[..k].contains(&corners[k]));
        if corners.len() < 3 || twice {
            return Err((
                format!("the face {place} has fewer than three different vertices"),
                allowed,
            ));
        }
        surface.faces.push(Face { corners, names, texture: Vec::new(), place });
    }
    Ok(surface)
}

fn stl(bytes: &[u8]) -> Result<Read, Fault> {
    let allowed = "an STL file, text or binary, with triangles";
    let fault = |error: &dyn std::fmt::Display| (error.to_string(), allowed);
    let mut cursor = Cursor::new(bytes);
    let triangles = stl_io::create_stl_reader(&mut cursor).map_err(|error| fault(&error))?;
    let mut known: HashMap<[u32; 3], u32> = HashMap::new();
    let (mut vertices, mut faces) = (Vec::new(), Vec::new());
    for triangle in triangles {
        let triangle = triangle.map_err(|error| fault(&error))?;
        let corners = triangle.vertices.iter().map(|corner| {
            // 0 and −0 are one place.
            let key = corner.0.map(|x| (x + 0.0).to_bits());
            *known.entry(key).or_insert_with(|| {
                vertices.push(Vector3::from(corner.0.map(f64::from)));
                u32::try_from(vertices.len() - 1).unwrap_or(u32::MAX)
            })
        });
        faces.push((corners.collect(), 0));
    }
    let (corners, joined) = (3 * faces.len(), vertices.len());
    let surface = surface(vertices, faces, vec![Vec::new()], allowed)?;
    let note = if joined == corners {
        format!("no two of {corners} corners of the STL file have equal coordinates")
    } else {
        format!("{corners} corners at equal coordinates of the STL file are {joined} vertices")
    };
    Ok(Read { surface, note: Some(note) })
}

fn ply(bytes: &[u8]) -> Result<Surface, Fault> {
    let allowed = "a PLY file with x, y, z of vertex and vertex_indices of face";
    let file = Parser::<DefaultElement>::new().read_ply(&mut Cursor::new(bytes));
    let file = file.map_err(|error| (error.to_string(), allowed))?;
    let elements = |name: &str| file.payload.get(name).map_or(&[][..], Vec::as_slice);
    let number = |property: Option<&Property>| match property {
        Some(Property::Float(x)) => Some(f64::from(*x)),
        Some(Property::Double(x)) => Some(*x),
        Some(Property::Int(x)) => Some(f64::from(*x)),
        Some(Property::Short(x)) => Some(f64::from(*x)),
        _ => None,
    };
    let vertex = |element: &DefaultElement| {
        let [x, y, z] = ["x", "y", "z"].map(|axis| number(element.get(axis)));
        Some(Vector3::new(x?, y?, z?))
    };
    let face = |element: &DefaultElement| {
        let corners = element.get("vertex_indices").or_else(|| element.get("vertex_index"))?;
        Some((corners.to_u32_list()?, 0))
    };
    let vertices: Option<Vec<_>> = elements("vertex").iter().map(vertex).collect();
    let faces: Option<Vec<_>> = elements("face").iter().map(face).collect();
    let vertices = vertices.ok_or(("has a vertex without x, y and z".to_owned(), allowed))?;
    let faces = faces.ok_or(("has a face without vertex_indices".to_owned(), allowed))?;
    surface(vertices, faces, vec![Vec::new()], allowed)
}

fn fold(text: &str) -> Result<Surface, Fault> {
    let allowed = "a FOLD file with vertices_coords and faces_vertices";
    let json: Value = serde_json::from_str(text).map_err(|error| (error.to_string(), allowed))?;
    let list = |key: &str| json[key].as_array().ok_or((format!("has no {key}"), allowed));
    let vertex = |item: &Value| {
        let numbers: Option<Vec<f64>> = item.as_array()?.iter().map(Value::as_f64).collect();
        match numbers?[..] {
            [x, y] => Some(Vector3::new(x, y, 0.0)),
            [x, y, z] => Some(Vector3::new(x, y, z)),
            _ => None,
        }
    };
    let face = |item: &Value| {
        let corner = |corner: &Value| u32::try_from(corner.as_u64()?).ok();
        Some((item.as_array()?.iter().map(corner).collect::<Option<Vec<u32>>>()?, 0))
    };
    let vertices: Option<Vec<_>> = list("vertices_coords")?.iter().map(vertex).collect();
    let faces: Option<Vec<_>> = list("faces_vertices")?.iter().map(face).collect();
    let vertices =
        vertices.ok_or(("has a vertex that is not two or three numbers".to_owned(), allowed))?;
    let faces = faces.ok_or(("has a face that is not a list of vertices".to_owned(), allowed))?;
    surface(vertices, faces, vec![Vec::new()], allowed)
}

#[cfg(test)]
mod tests;
