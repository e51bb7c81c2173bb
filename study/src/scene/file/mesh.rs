//! `mesh`: OBJ files of any program to film. Vertices no face uses are dropped, coinciding ones are
//! joined only where asked; the user's numbers stay.

use billow_solver::geometry::mesh_io::obj_reader::{self, Face, Surface};
use billow_solver::geometry::shell::{Shell, ShellError, flat};
use nalgebra::{Vector2, Vector3};

use super::Reader;
use super::object::Object;
use super::shape::{Numbering, Shape};
use crate::input::keys::{FLAT, Kind, MESH_KEYS};
use crate::input::study_file::Json;
use crate::platform::error::{Error, InputError, Result};

/// Reads `mesh`.
pub(super) fn read(json: &Json, reader: &mut Reader) -> Result<Shape> {
    let source = reader.source.clone();
    let object =
        Object::new(json, "mesh", "a mesh", MESH_KEYS, &["reference", "closure"], &source)?;
    let file = object.text("positions")?.ok_or_else(|| object.missing("positions"))?;
    let scale = object.needed("scale")?;
    let mut surface = surface(reader, "mesh.positions", &file, 0)?;
    for vertex in &mut surface.vertices {
        *vertex *= scale;
    }
    if surface.faces.is_empty() {
        let problem = "has no faces";
        return Err(object.error("positions", problem, "an OBJ file with f lines").into());
    }
    let joined = joined(&surface, object.number("weld")?);
    let closes = closing_groups(&object, &surface)?;
    let outside = match object.given("closure") {
        Some(Json::Text(name)) if is_file(name) => Some((
            name.clone(),
            self::surface(reader, "mesh.closure", name, surface.vertices.len())?,
        )),
        _ => None,
    };
    if let Some((name, other)) = &outside
        && !other.vertices.is_empty()
        && other.vertices.len() != surface.vertices.len()
    {
        let problem = format!(
            "has {} vertices, {file} has {}: its faces are to be over the same ones",
            other.vertices.len(),
            surface.vertices.len()
        );
        let allowed = "the same vertices in the same order, or none";
        return Err(refuse(name, "mesh.closure", problem, allowed, &source).into());
    }
    let film: Vec<bool> = surface.faces.iter().map(|face| !closes[face.names]).collect();
    if !film.contains(&true) {
        let problem = "names every face, so that nothing is film";
        return Err(object.error("closure", problem, "groups that leave some film").into());
    }
    let closing = surface.faces.iter().zip(&film).filter(|(_, film)| !**film).map(|(face, _)| face);
    let closing: Vec<&Face> =
        closing.chain(outside.iter().flat_map(|(_, other)| &other.faces)).collect();
    let node = nodes(&surface, &joined, &film, &closing);
    let corner = |vertex: u32| node[vertex as usize];
    let reference = reference(&object, &surface, &film, scale, reader)?;
    let mut shell = Shell::default();
    let mut vertices: Vec<(u32, u32)> =
        (0_u32..).zip(&node).filter_map(|(vertex, node)| Some(((*node)?, vertex))).collect();
    vertices.sort_unstable();
    vertices.dedup_by_key(|(node, _)| *node);
    shell.positions = vertices.iter().map(|(_, v)| surface.vertices[*v as usize]).collect();
    let mut element = Vec::new();
    let mut next = 0;
    for (at, (face, film)) in surface.faces.iter().zip(&film).enumerate() {
        for (part, fan) in face.fan().enumerate() {
            let triangle = fan.map(|k| corner(face.corners[k]).unwrap_or_default());
            check_triangle(&file, face, triangle, &source)?;
            if *film {
                shell.triangles.push(triangle);
                let corners = reference[at][part];
                shell.reference.push(flat_of(corners, face, &object)?);
                element.push(Some(next));
                next += 1;
            } else {
                element.push(None);
            }
        }
    }
    for face in closing {
        for fan in face.fan() {
            let triangle = fan.map(|k| corner(face.corners[k]).unwrap_or_default());
            check_triangle(&file, face, triangle, &source)?;
            shell.closure.push(triangle);
        }
    }
    let numbering = Numbering { surface, node, element };
    check_edges(&shell, &numbering, &file, &source)?;
    Ok(Shape {
        shell,
        numbering,
        rings: None,
        places: Vec::new(),
        centres: Vec::new(),
        folded: false,
        seats: None,
        file,
    })
}

fn is_file(name: &str) -> bool {
    name.rsplit_once('.').is_some_and(|(_, ending)| ending.eq_ignore_ascii_case("obj"))
}

/// An error about what stands in a file that a key names.
fn refuse(
    file: &str,
    key: &str,
    problem: impl Into<String>,
    allowed: impl Into<String>,
    source: &crate::input::source::Source,
) -> InputError {
    source.error(key, &Json::Text(file.to_owned()).brief(), problem, allowed)
}

fn surface(reader: &mut Reader, key: &str, name: &str, given: usize) -> Result<Surface> {
    let text = reader.text(key, name)?;
    obj_reader::read(&text, given).map_err(|error| {
        let problem = format!("line {}: {}", error.line, error.problem);
        Error::Input(refuse(name, key, problem, error.allowed, &reader.source))
    })
}

/// Which lists of names are of faces that close the volume without being film.
fn closing_groups(object: &Object<'_>, surface: &Surface) -> Result<Vec<bool>> {
    let named = match object.given("closure") {
        None => Vec::new(),
        Some(Json::Text(name)) if is_file(name) => Vec::new(),
        Some(Json::Text(name)) => vec![name.as_str()],
        Some(Json::List(items)) => {
            let text = |item: &'_ Json| matches!(item, Json::Text(_));
            if !items.iter().all(text) {
                let problem = "holds what is no name";
                return Err(object.error("closure", problem, CLOSURE).into());
            }
            items
                .iter()
                .filter_map(
                    |item| if let Json::Text(name) = item { Some(name.as_str()) } else { None },
                )
                .collect()
        }
        Some(_) => {
            return Err(object
                .error("closure", "is no name, list of names or file", CLOSURE)
                .into());
        }
    };
    let mut known: Vec<&str> = surface.names.iter().flatten().map(String::as_str).collect();
    known.sort_unstable();
    known.dedup();
    if let Some(stranger) = named.iter().find(|name| !known.contains(*name)) {
        let problem = format!("{stranger:?} is no group or object of positions");
        let allowed =
            if known.is_empty() { "the file names none".to_owned() } else { known.join(", ") };
        return Err(object.error("closure", problem, allowed).into());
    }
    let closes = |names: &Vec<String>| names.iter().any(|name| named.contains(&name.as_str()));
    Ok(surface.names.iter().map(closes).collect())
}

const CLOSURE: &str =
    "names of groups or objects of positions, or an OBJ file of faces over its vertices";

/// The vertex each vertex is one with: itself, or the first within the tolerance (m).
fn joined(surface: &Surface, tolerance: Option<f64>) -> Vec<u32> {
    let places = &surface.vertices;
    let mut first: Vec<u32> = (0_u32..).take(places.len()).collect();
    let Some(tolerance) = tolerance else { return first };
    let mut by_x = first.clone();
    by_x.sort_by(|a, b| places[*a as usize].x.total_cmp(&places[*b as usize].x).then(a.cmp(b)));
    for (at, a) in by_x.iter().enumerate() {
        let here = places[*a as usize];
        for b in &by_x[at + 1..] {
            let there = places[*b as usize];
            if there.x - here.x > tolerance {
                break;
            }
            if (there - here).norm() <= tolerance {
                let (low, high) = (root(&first, *a), root(&first, *b));
                first[low.max(high) as usize] = low.min(high);
            }
        }
    }
    (0_u32..).take(places.len()).map(|vertex| root(&first, vertex)).collect()
}

fn root(first: &[u32], mut vertex: u32) -> u32 {
    while first[vertex as usize] != vertex {
        vertex = first[vertex as usize];
    }
    vertex
}

/// Node of each vertex that a face uses, numbered in file order.
fn nodes(surface: &Surface, joined: &[u32], film: &[bool], closing: &[&Face]) -> Vec<Option<u32>> {
    let mut used = vec![false; joined.len()];
    let of_film = surface.faces.iter().zip(film).filter(|(_, film)| **film).map(|(face, _)| face);
    for face in of_film.chain(closing.iter().copied()) {
        for vertex in &face.corners {
            used[joined[*vertex as usize] as usize] = true;
        }
    }
    let mut next = 0;
    let number = |used: &bool| {
        used.then(|| {
            next += 1;
            next - 1
        })
    };
    let node: Vec<Option<u32>> = used.iter().map(number).collect();
    joined.iter().map(|vertex| node[*vertex as usize]).collect()
}

fn check_triangle(
    file: &str,
    face: &Face,
    [a, b, c]: [u32; 3],
    source: &crate::input::source::Source,
) -> Result<()> {
    if a != b && b != c && a != c {
        return Ok(());
    }
    let problem = format!("line {}: welding leaves a face without area", face.line);
    let mut error =
        refuse(file, "mesh.positions", problem, "faces larger than the tolerance", source);
    "choose a smaller mesh.weld".clone_into(&mut error.hint);
    Err(error.into())
}

/// Every edge has at most two faces, which run along it opposite ways.
fn check_edges(
    shell: &Shell,
    numbering: &Numbering,
    file: &str,
    source: &crate::input::source::Source,
) -> Result<()> {
    let Err(error) = shell.check() else { return Ok(()) };
    let ShellError::Edge { edge } = error else {
        let problem = error.to_string();
        return Err(refuse(file, "mesh.positions", problem, "", source).into());
    };
    let [a, b] = edge.map(|node| numbering.vertex(node).map_or(0, |vertex| vertex + 1));
    let problem = format!(
        "the edge between OBJ vertices {a} and {b} (counted from 1) belongs to more than two faces, or \
         to two that wind against each other"
    );
    let allowed = "a surface: at most two faces an edge, all wound the same way";
    let mut error = refuse(file, "mesh.positions", problem, allowed, source);
    "recalculate the normals so that all point outward; faces of closure wind as film does"
        .clone_into(&mut error.hint);
    Err(error.into())
}

/// Corners of each triangle of each face where it is free of stress, m; of faces that are no film too
/// where they are given.
type Reference = Vec<Vec<[Vector3<f64>; 3]>>;

fn reference(
    object: &Object<'_>,
    surface: &Surface,
    film: &[bool],
    scale: f64,
    reader: &mut Reader,
) -> Result<Reference> {
    let fans = |face: &Face, corners: &[Vector3<f64>]| -> Vec<[Vector3<f64>; 3]> {
        face.fan().map(|fan| fan.map(|k| corners[k])).collect()
    };
    let own = |face: &Face| -> Vec<Vector3<f64>> {
        face.corners.iter().map(|v| surface.vertices[*v as usize]).collect()
    };
    // Corners of the faces given, in order, with what to call each.
    let given: Vec<(Vec<Vector3<f64>>, String)> = match object.given("reference") {
        None => return Ok(surface.faces.iter().map(|face| fans(face, &own(face))).collect()),
        Some(Json::Text(name)) => {
            let flat = self::surface(reader, "mesh.reference", name, 0)?;
            let place = |v: &u32| flat.vertices[*v as usize] * scale;
            let corners = |face: &Face| face.corners.iter().map(place).collect();
            flat.faces.iter().map(|face| (corners(face), format!("line {}", face.line))).collect()
        }
        Some(Json::List(items)) => {
            let face = |(at, item): (usize, &Json)| {
                let problem = |problem| object.error("reference", problem, REFERENCE);
                let corners = inline(item).map_err(|why| problem(format!("face {at}: {why}")))?;
                Ok((corners, format!("face {at}")))
            };
            items.iter().enumerate().map(face).collect::<Result<_>>()?
        }
        Some(_) => {
            return Err(object.error("reference", "is no file and no list", REFERENCE).into());
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
        let (corners, name) = corners.unwrap_or_else(|| (own(face), String::new()));
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

const REFERENCE: &str = "an OBJ file with the faces of positions in the same order (of the film, or \
                         all), or a list of them as [[x, y], [x, y], [x, y]] in m";

/// Flat coordinates of one face's corners.
fn inline(json: &Json) -> std::result::Result<Vec<Vector3<f64>>, String> {
    let Kind::Quantity(length) = FLAT else { unreachable!("a length") };
    let Json::List(corners) = json else { return Err(format!("is {}", json.kind())) };
    let corner = |corner: &Json| match corner {
        Json::List(parts) if matches!(parts.len(), 2 | 3) => {
            let mut place = Vector3::zeros();
            for (k, part) in parts.iter().enumerate() {
                let value = length.read(part)?;
                place[k] = length.number(&value).unwrap_or_default();
            }
            Ok(place)
        }
        other => Err(format!("a corner is {}, not [x, y]", other.brief())),
    };
    corners.iter().map(corner).collect()
}

/// A triangle laid flat, by itself.
fn flat_of(
    corners: [Vector3<f64>; 3],
    face: &Face,
    object: &Object<'_>,
) -> Result<[Vector2<f64>; 3]> {
    let flat = flat(corners);
    let area = 0.5 * flat[1].x * flat[2].y;
    // Written so that what is no number is refused too.
    let sound = area > 0.0 && area.is_finite();
    if sound {
        return Ok(flat);
    }
    let key = if object.given("reference").is_some() { "reference" } else { "positions" };
    let problem = format!("the face on line {} of positions has no area there", face.line);
    Err(object
        .error(key, problem, "faces with an area, also after a polygon is cut into a fan")
        .into())
}
